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
#include "src/parallel/index_map.hpp"

namespace peristat {

class Model;
struct Workspace;

/// Whether a pass overwrites what its result held or adds to it.
enum class Write { over, onto };

/// The passes over a term's interactions, with the buffers that they need. Arrays are points x
/// dimension, row major; `history` is that of all terms.
class TermPasses {
 public:
  virtual ~TermPasses() = default;

  /// E [J] and dE/dx [N]; also computes the values per point that some terms need first.
  /// @param gradient left out if empty
  virtual Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) = 0;

  /// As `gradient`, after updating the term's history to the state: E is the energy that is stored
  /// after the update. Terms before it have committed already.
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

  /// Adds the follower forces of the loads [N], which the gradient has with the other sign.
  virtual void follower_force(const StateView&, std::span<double> /*force*/) {}

  /// Damage that committing the state would cause.
  virtual DamageGrowth growth(const StateView&) { return {}; }

  /// d2E/dx2 [N/m], in the blocks of the pattern.
  /// @param projection see Assembler::tangent
  virtual void tangent(const StateView& at, double projection, Tangent& tangent, Write how) = 0;

  /// d2E/dx2 v [N]
  virtual void product(const StateView& at, std::span<const double> v, double projection,
                       std::span<double> product, Write how) = 0;

  /// Visits the rows of the tangent without storing it; only for a term that visits_rows.
  /// @param diagonal overwritten; empty: not wanted
  virtual void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                             std::span<double> diagonal);

  /// For a term without a potential or without rows, see Energy::rows, Energy::outline_rows and
  /// Energy::stencil. Other terms beside it may have diagonal blocks only.
  [[nodiscard]] virtual SparseRows rows(const StateView& at, RowReach reach);
  [[nodiscard]] virtual double bytes_of_rows() const { return 0.0; }
  [[nodiscard]] virtual LatticeStencil stencil(const StateView&) { return {}; }
  virtual void outline_rows(const StateView& at, std::span<double> diagonal,
                            std::span<double> row_sums);

  /// An equal share of its interactions' energy for each of their points [J].
  virtual void point_energies(const StateView& at, std::span<double> energies, Write how) = 0;

  /// True if the energies that passes return on a part of a body weight each interaction by the
  /// share of its points that the rank owns; otherwise all interactions on the rank count in full.
  [[nodiscard]] virtual bool shares_energy() const { return false; }

  /// Adds to every point its equal share of the virials of its interactions, sum_a dE/dx_a (x) A_a
  /// with the reference arms A_a to their other points [J]: points x dimension x dimension, row
  /// major, the first index that of the force. Loads and supports have none.
  virtual void add_virials(const StateView&, std::span<double> /*virials*/) {}
};

/// Setting of a term's passes; everything in it outlives them.
struct TermSetting {
  const Points& points;
  const Model& model;
  const BlockPattern& pattern;
  Workspace& workspace;
  /// A commit, which is collective, may communicate to agree on the new history. No other pass
  /// communicates.
  const IndexMap& index_map = whole_body();
};

/// How many interactions of a kind there are.
struct InteractionCount {
  std::string name;  ///< "bonds"
  Offset count = 0;  ///< each counted once
  std::string per_point_name, per_point_meaning;
  std::vector<std::int32_t> per_point;  ///< interactions that each point takes part in
  std::int32_t orders = 1;  ///< orderings of an interaction's other points that count apart
};

/// One kind of interaction with its law; a model is a sum of these. Constant during a solve, except
/// for stored interactions.
class Term {
 public:
  virtual ~Term() = default;

  /// Points that it couples: the blocks of its tangent. The term owns the arrays.
  [[nodiscard]] virtual Couplings couplings() const = 0;
  /// Whether each of its off-diagonal blocks is symmetric.
  [[nodiscard]] virtual bool has_symmetric_blocks() const { return false; }
  /// True if the tangent need not be stored: its rows can be computed one by one, and product and v
  /// may be one array.
  [[nodiscard]] virtual bool visits_rows() const { return false; }

  /// True if the tangent has rows, see Energy::has_rows.
  [[nodiscard]] virtual bool has_rows() const { return true; }

  [[nodiscard]] virtual Balances balances() const = 0;

  /// True if states damage the term, irreversibly.
  [[nodiscard]] virtual bool can_be_damaged() const { return false; }

  /// History before any load; empty if the term remembers nothing.
  [[nodiscard]] virtual std::vector<double> initial_history() const { return {}; }
  /// Updates the part of its history that follows from other terms' histories.
  virtual void follow(const Model&, History&) const {}

  [[nodiscard]] virtual std::vector<InteractionCount> counts() const { return {}; }

  /// Memory that storing its interactions takes, instead of finding them in every pass, and memory
  /// that stored ones take now [bytes].
  [[nodiscard]] virtual double bytes_to_store() const { return 0.0; }
  [[nodiscard]] virtual double stored_bytes() const { return 0.0; }
  virtual void store(const Points&, int /*threads*/) {}

  [[nodiscard]] virtual std::unique_ptr<TermPasses> passes(const TermSetting& setting) const = 0;
};

}  // namespace peristat
