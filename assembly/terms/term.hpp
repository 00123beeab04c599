#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assembly/energy/evaluation.hpp"
#include "assembly/energy/state.hpp"
#include "assembly/energy/tangent_forms.hpp"
#include "assembly/energy/write.hpp"
#include "assembly/operators/block_pattern.hpp"
#include "assembly/operators/tangent.hpp"
#include "assembly/terms/balances.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "assembly/terms/failure/failure_model.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

class Model;
struct Workspace;

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

  /// Lowers the integrities of the bonds that the state damages by release, before the terms
  /// commit: the forces of all of them depend on it. Nothing: it is no matter of this term.
  virtual std::optional<DamageGrowth> release(const StateView& /*at*/, History& /*history*/) {
    return std::nullopt;
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

  /// Adds to the squared equivalent stretches of bonds that fail by release, which have those of
  /// their own stretches so far, what else drives them. A term with stretches of its own begins
  /// with these.
  /// @param drives of all bonds
  virtual void add_drive(const StateView&, const StateLine&, std::span<BondDrive> /*drives*/) {}

  /// Its tangent, in the form of Term::tangent_kind; rows also as products. Blocks that can be
  /// visited can also be stored.
  [[nodiscard]] virtual TangentForms forms() = 0;

  /// d2E/dx2 v [N]
  virtual void product(const StateView& at, std::span<const double> v, double projection,
                       std::span<double> product, Write how) = 0;
  /// True if products are faster where single precision is allowed, see Precision.
  [[nodiscard]] virtual bool has_single_products() const { return false; }

  /// An equal share of its interactions' energy for each of their points [J].
  virtual void point_energies(const StateView& at, std::span<double> energies, Write how) = 0;

  /// True if the energies that passes return on a part of a body weight each interaction by the
  /// share of its points that the rank owns; otherwise all interactions on the rank count in full.
  [[nodiscard]] virtual bool shares_energy() const { return false; }

  /// True for contacts, of which the functions below tell.
  [[nodiscard]] virtual bool has_contacts() const { return false; }
  /// Contacts that count as closed where a predictor foresees a displacement (StateView::foreseen),
  /// by numbers of the term's own.
  [[nodiscard]] virtual std::vector<Index> closed_contacts(const StateView&) { return {}; }
  /// Largest share of a step, from 0 to 1, that no contact passes its largest depth within.
  [[nodiscard]] virtual double longest_step(const StateView&, std::span<const double> /*step*/) {
    return 1.0;
  }
  /// Largest share of the gap to its largest depth that a contact closes from one state to another;
  /// gaps are those of the first.
  [[nodiscard]] virtual double largest_closing(const StateView& /*from*/, const StateView& /*to*/) {
    return 0.0;
  }
  /// True if a contact that is open in both states was beyond its largest depth on the straight way
  /// between them.
  [[nodiscard]] virtual bool has_passed(const StateView& /*from*/, const StateView& /*to*/) {
    return false;
  }
  /// Adds to each degree of freedom the stiffness of contacts that touch at a state or are within a
  /// spacing of it [N/m]. It is a bound while they close no more than a fifth of their gap.
  /// @param most_depth share of the largest depth beyond which the stiffness is that at this share
  virtual void add_contact_stiffness(const StateView&, double /*most_depth*/,
                                     std::span<double> /*stiffness*/) {}
  /// Work that obstacles do on the body from one state to another by the trapezoidal rule [J].
  [[nodiscard]] virtual double work_of_obstacles(const StateView& /*from*/,
                                                 const StateView& /*to*/) {
    return 0.0;
  }
  /// True if contacts rub: their friction depends on a normal force that the history has.
  [[nodiscard]] virtual bool has_friction() const { return false; }
  /// Lets all contacts that touch stick, where a search begins.
  virtual void stick(const StateView& /*at*/, History& /*history*/) {}
  /// Takes the normal forces of friction from a state of a search that began at another. Returns
  /// the largest change and the largest of them [N].
  virtual std::array<double, 2> lag_friction(const StateView& /*at*/, const StateView& /*start*/,
                                             History& /*history*/) {
    return {};
  }
  /// Points that contacts couple at a state, beside those of Term::couplings. The passes own the
  /// arrays.
  [[nodiscard]] virtual std::optional<Couplings> contact_couplings(const StateView&) {
    return std::nullopt;
  }

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
  /// A commit, which is collective, may communicate to agree on the new history, and contacts on
  /// whether all that may touch is on the ranks. No other pass communicates.
  const IndexMap& index_map = whole_body();
};

/// Blocks of a term's stored tangent.
struct BlockCount {
  double blocks = 0.0;        ///< off the diagonal, each pair of points once
  double bytes_beside = 0.0;  ///< that their positions take, where the body has none of these
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
  /// Points that the rows of RowVisits couple.
  [[nodiscard]] virtual Couplings visited_couplings() const { return couplings(); }
  /// Number of the blocks, which may be an estimate from above.
  [[nodiscard]] virtual BlockCount block_count(int /*dimension*/) const {
    return {double(couplings().partner.size()), 0.0};
  }
  /// Whether each of its off-diagonal blocks is symmetric.
  [[nodiscard]] virtual bool has_symmetric_blocks() const { return false; }
  [[nodiscard]] virtual TangentKind tangent_kind() const { return TangentKind::stored; }

  /// True if its passes keep values of bonds, such as blocks, for rows of later parts: these would
  /// be many with more parts than threads.
  [[nodiscard]] virtual bool spills_bonds() const { return false; }

  [[nodiscard]] virtual Balances balances() const = 0;

  /// How states damage the body by what the term remembers; null: they don't.
  [[nodiscard]] virtual std::shared_ptr<const FailureModel> failure() const { return nullptr; }
  /// True if it drives bonds that fail by release, beside their stretches, and damages them.
  [[nodiscard]] virtual bool drives_bonds() const { return false; }
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
