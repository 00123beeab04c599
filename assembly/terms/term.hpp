#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "assembly/energy/energy.hpp"
#include "assembly/energy/evaluation.hpp"
#include "assembly/energy/state.hpp"
#include "assembly/operators/block_pattern.hpp"
#include "assembly/operators/tangent.hpp"
#include "assembly/terms/balances.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

class Model;
class Sharing;
struct Workspace;

/// Whether a pass overwrites what its result held or adds to it.
enum class Write { over, onto };

/// The passes over a term's interactions, with the buffers that they need. Arrays are points x
/// dimension, row major; `history` is that of all terms.
class TermPasses {
 public:
  virtual ~TermPasses() = default;

  /// E [J] and dE/dx [N]; a pass that needs a value per point first finds it here, too.
  /// @param gradient left out if empty
  virtual Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) = 0;

  /// As `gradient`, and moves the term's history to the state: E is what is stored after that.
  /// Terms before it have committed already.
  virtual Evaluation commit(std::span<const double> displacement,
                            const SharedEnvironment& environment, History& history,
                            std::span<double> gradient, Write how) {
    return this->gradient({displacement, history, Damage::grows, environment}, gradient, how);
  }

  /// As `commit`, but the energy may be left out.
  virtual Evaluation commit_forces(std::span<const double> displacement,
                                   const SharedEnvironment& environment, History& history,
                                   std::span<double> gradient, Write how) {
    return commit(displacement, environment, history, gradient, how);
  }

  /// Adds the forces of loads that follow the deformation [N]: the gradient holds them with the
  /// other sign.
  virtual void follower_force(const StateView&, std::span<double> /*force*/) {}

  /// What committing the state would damage.
  virtual DamageGrowth growth(const StateView&) { return {}; }

  /// d2E/dx2 [N/m], in the blocks of the pattern.
  /// @param projection see Assembler::tangent
  virtual void tangent(const StateView& at, double projection, Tangent& tangent, Write how) = 0;

  /// d2E/dx2 v [N]
  virtual void product(const StateView& at, std::span<const double> v, double projection,
                       std::span<double> product, Write how) = 0;

  /// Visits the rows of its tangent without storing it; only of a term that visits_rows.
  /// @param diagonal overwritten; empty: not wanted
  virtual void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                             std::span<double> diagonal);

  /// Of a term without a potential or without rows: see Energy::rows, Energy::outline_rows and
  /// Energy::stencil. What others have besides its diagonal blocks has no place there.
  [[nodiscard]] virtual SparseRows rows(const StateView& at, RowReach reach);
  [[nodiscard]] virtual double bytes_of_rows() const { return 0.0; }
  [[nodiscard]] virtual LatticeStencil stencil(const StateView&) { return {}; }
  virtual void outline_rows(const StateView& at, std::span<double> diagonal,
                            std::span<double> row_sums);

  /// An equal share of its interactions' energy for each of their points [J].
  virtual void point_energies(const StateView& at, std::span<double> energies, Write how) = 0;

  /// Whether the energies that its passes find of a part of a body are, of each interaction, the
  /// share of the points that the rank owns; otherwise they are of all interactions that it has.
  [[nodiscard]] virtual bool shares_energy() const { return false; }

  /// Adds to every point its equal share of the virials of its interactions, sum_a dE/dx_a (x) A_a
  /// with the reference arms A_a to their other points [J]: points x dimension x dimension, row
  /// major, the first index that of the force. Loads and supports have none.
  virtual void add_virials(const StateView&, std::span<double> /*virials*/) {}
};

/// Where the passes of a term are to work; everything outlives them.
struct TermSetting {
  const Points& points;
  const Model& model;
  const BlockPattern& pattern;
  Workspace& workspace;
  /// Null: the body is whole. Otherwise the points are a part of it, and a commit, which all ranks
  /// make, may ask the others what history is to come of it. No other pass does.
  const Sharing* sharing = nullptr;
};

/// How many interactions of a kind there are.
struct InteractionCount {
  std::string name;  ///< "bonds"
  Offset count = 0;  ///< each counted once
  std::string per_point_name, per_point_meaning;
  std::vector<std::int32_t> per_point;  ///< that a point takes part in
  std::int32_t orders = 1;              ///< of an interaction's other points, if these count apart
};

/// One kind of interaction with its law: what a model is a sum of. Constant in a solve, but for
/// what is stored of it.
class Term {
 public:
  virtual ~Term() = default;

  /// The points it couples: the blocks of its tangent. The arrays belong to the term.
  [[nodiscard]] virtual Couplings couplings() const = 0;
  /// Whether each of its off-diagonal blocks is symmetric.
  [[nodiscard]] virtual bool has_symmetric_blocks() const { return false; }
  /// Whether the rows of its tangent can be found one by one, and product and v be one array: its
  /// tangent need not be stored.
  [[nodiscard]] virtual bool visits_rows() const { return false; }

  /// Whether its tangent has rows at all: see Energy::has_rows.
  [[nodiscard]] virtual bool has_rows() const { return true; }

  [[nodiscard]] virtual Balances balances() const = 0;

  /// Whether states damage it, for good.
  [[nodiscard]] virtual bool can_be_damaged() const { return false; }

  /// Of a body to which nothing has happened; empty if the term remembers nothing.
  [[nodiscard]] virtual std::vector<double> initial_history() const { return {}; }
  /// Brings up to date what it remembers of other terms' histories.
  virtual void follow(const Model&, History&) const {}

  [[nodiscard]] virtual std::vector<InteractionCount> counts() const { return {}; }

  /// Memory that storing its interactions takes, instead of finding them anew in every pass, and
  /// that it has taken for it [bytes].
  [[nodiscard]] virtual double bytes_to_store() const { return 0.0; }
  [[nodiscard]] virtual double stored_bytes() const { return 0.0; }
  virtual void store(const Points&, int /*threads*/) {}

  [[nodiscard]] virtual std::unique_ptr<TermPasses> passes(const TermSetting& setting) const = 0;
};

}  // namespace peristat
