#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "assembly/energy/energy.hpp"
#include "assembly/energy/evaluation.hpp"
#include "assembly/energy/tangent_forms.hpp"
#include "assembly/operators/tangent.hpp"
#include "assembly/terms/damage.hpp"
#include "assembly/terms/model.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Energy, gradient, tangent and matrix-free product of the discrete energy E(u) of a model, the
/// sum over its terms, each of which visits its interactions once, on several threads.
///
/// All arrays are points x dimension, row major. No call allocates but visit_tangent,
/// find_diagonal, commit. For a given number of threads every result is reproducible to the last
/// bit. A model whose bonds can be damaged needs a history (initial_history), which only `commit`
/// changes.
class Assembler : public Energy, BlockTangent, RowVisits, RowOperator {
 public:
  /// Whose pattern the assembler has: the tangent's blocks, or the rows that are visited instead
  /// of storing these. They differ for TangentKind::nearby alone.
  enum class PatternOf { blocks, visited_rows };

  /// Points and model must outlive the assembler.
  /// @param index_map null: the body is whole. Otherwise points and model are one rank's part of
  /// it:
  ///        energies are those of the whole body, and dE/dx and products are right in the rows of
  ///        owned points, once ghosts hold their owners' values. dE/dx of ghosts is zero. All calls
  ///        are collective.
  /// @throws std::logic_error for a model without terms, and for convolutions on a part of a body
  Assembler(const Points& points, const Model& model, int threads,
            const IndexMap& index_map = whole_body(), PatternOf pattern_of = PatternOf::blocks);
  ~Assembler() override;

  /// Initial history, before any load.
  [[nodiscard]] History initial_history() const;

  /// History that holds these largest stretches of the bonds (see bond_stretches).
  /// @param before from which the rest is taken; empty: before any load
  [[nodiscard]] History history_of(std::span<const double> bond_stretches,
                                   const History& before = {}) const;

  /// E [J]
  [[nodiscard]] Evaluation energy(const StateView& at);

  /// E [J] and dE/dx [N] (minus the internal force).
  [[nodiscard]] Evaluation gradient(const StateView& at, std::span<double> gradient);

  /// Commits a state: updates the history of every bond that the state damages. E is then the
  /// energy that is stored after the update. dE/dx, unless it is left out, has the bonds' forces,
  /// which the update does not change unless it is by release, and the forces of other terms after
  /// they have lost stiffness with the bonds. Only accepted states are committed; relaxation that
  /// breaks bonds on the way commits every iteration.
  Evaluation commit(std::span<const double> displacement, History& history,
                    std::span<double> gradient = {}, const SharedEnvironment& environment = {});

  /// As `commit` without the energy, for time steps. Values that are not finite show in dE/dx
  /// alone.
  Evaluation commit_forces(std::span<const double> displacement, History& history,
                           std::span<double> gradient, const SharedEnvironment& environment = {});

  /// Follower forces of the loads [N], every entry overwritten. They do not contribute to E, and
  /// enter dE/dx with the other sign.
  void follower_force(const StateView& at, std::span<double> force);

  /// Damage that committing the state would cause.
  [[nodiscard]] DamageGrowth growth(const StateView& at);

  /// True if points may touch one another or obstacles.
  [[nodiscard]] bool has_contacts() const;
  /// Contacts that count as closed at a state with a foreseen displacement, see TermPasses.
  [[nodiscard]] std::vector<Index> closed_contacts(const StateView& at);
  /// Largest share of a step, from 0 to 1, that no contact passes its largest depth within.
  [[nodiscard]] double longest_step(const StateView& at, std::span<const double> step);
  /// See TermPasses; of all ranks.
  [[nodiscard]] double largest_closing(const StateView& from, const StateView& to);
  [[nodiscard]] bool has_passed(const StateView& from, const StateView& to);
  [[nodiscard]] double work_of_obstacles(const StateView& from, const StateView& to);
  /// Of this rank's points.
  void add_contact_stiffness(const StateView& at, double most_depth, std::span<double> stiffness);
  [[nodiscard]] bool has_friction() const;
  /// Lets all contacts with friction that touch stick, where a search begins.
  void stick(const StateView& at, History& history);
  /// Takes the normal forces of friction from a state of a search that began at another. Returns
  /// their largest change over the largest of them.
  double lag_friction(const StateView& at, const StateView& start, History& history);
  int cover_contacts(const StateView& at) override;

  /// What drives bonds that fail by release.
  /// @param drives of all bonds; given are those by their stretches in the deformed configuration
  void add_drive(const StateView& at, const StateLine& line, std::span<BondDrive> drives);

  /// Damage state of a history, see assess_damage; the damage of ghosts is meaningless.
  [[nodiscard]] DamageState assess(const History& history, std::span<const double> cut_weight,
                                   std::span<double> damage) const;

  void tangent(const StateView& at, Tangent& tangent, double projection = 0.0,
               Write how = Write::over) override;
  void product(const StateView& at, std::span<const double> v, std::span<double> product,
               double projection = 0.0) override;
  [[nodiscard]] bool has_single_products() const override;
  void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                     std::span<double> diagonal) override;
  void find_diagonal(const StateView& at, double projection, std::span<double> diagonal) override;
  [[nodiscard]] double most_over_visited() const override;

  [[nodiscard]] SparseRows rows(const StateView& at, RowReach reach) override;
  [[nodiscard]] double bytes_of_rows() const override;
  void outline(const StateView& at, std::span<double> diagonal,
               std::span<double> row_sums) override;
  [[nodiscard]] LatticeStencil stencil(const StateView& at) override;

  /// Energy of each point: an equal share of the energy of each of its interactions [J].
  void point_energies(const StateView& at, std::span<double> energies);

  /// Virial of each point, an equal share of its interactions' [J]: points x dimension x dimension,
  /// see TermPasses::add_virials. Divided by the point's volume it is the derivative of the energy
  /// density with respect to a homogeneous deformation gradient.
  void virials(const StateView& at, std::span<double> virials);

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const IndexMap& index_map() const { return index_map_; }
  [[nodiscard]] const Points& points() const override { return points_; }
  [[nodiscard]] const BlockPattern& pattern() const override { return pattern_; }
  [[nodiscard]] int threads() const override { return workspace_.threads(); }
  [[nodiscard]] const std::vector<RowRange>& parts() const override { return workspace_.ranges; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return model_.has_symmetric_blocks(); }
  [[nodiscard]] bool has_potential() const override { return model_.balances().potential; }
  [[nodiscard]] TangentKind tangent_kind() const override { return model_.tangent_kind(); }
  [[nodiscard]] TangentForms forms() override;
  [[nodiscard]] double seconds_spent() const { return seconds_; }  ///< wall time of all calls [s]

 private:
  /// Squared equivalent stretches of all bonds, without rates.
  [[nodiscard]] std::vector<BondDrive> drives(const StateView& at);
  [[nodiscard]] std::unique_ptr<TermPasses> passes_of(const Term& term);
  /// A history before which bonds start to fail as the state says, see StrengthOnsets.
  [[nodiscard]] History with_onsets(const StateView& at);
  /// Damages by release, if the model's bonds fail so. Returns its growth.
  Evaluation release(std::span<const double> displacement, History& history,
                     const SharedEnvironment& environment);
  /// True if a commit may have changed integrities of bonds of this rank.
  [[nodiscard]] bool may_damage(const Evaluation& of_commit) const;
  /// Bonds that a commit in this state would cut as struts.
  [[nodiscard]] std::vector<Offset> find_struts(const StateView& at) const;
  /// Cuts the struts of a committed state, and evaluates it anew if there are some.
  void cut_struts(std::span<const double> displacement, History& history,
                  std::span<double> gradient, const SharedEnvironment& environment,
                  Evaluation& found);
  /// `growth` without struts.
  [[nodiscard]] DamageGrowth growth_by_laws(const StateView& now);
  /// Returns a term's evaluation, on a part of a body with the energy of owned points alone.
  [[nodiscard]] Evaluation of_part(TermPasses& term, const StateView& at, Evaluation found);
  /// Sums the ranks' evaluations to that of the whole body, and clears the forces of ghosts.
  /// Collective.
  [[nodiscard]] Evaluation of_all(const Evaluation& mine, std::span<double> gradient) const;
  [[nodiscard]] DamageGrowth of_all(const DamageGrowth& mine) const;

  /// Tangent of the terms that have blocks; nothing if none has.
  [[nodiscard]] std::optional<Tangent> sum_of_blocks(const StateView& at);

  /// Calls visit(passes, how) for every term: the first writes its result, the others add to it.
  template <class Visit>
  void for_each_term(const Visit& visit, Write how = Write::over);

  const Points& points_;
  const Model& model_;
  PatternOf pattern_of_;
  BlockPattern of_model_;    // pattern without contacts
  BlockPattern in_contact_;  // what these couple beside it
  BlockPattern pattern_;     // of both
  int version_of_pattern_ = 0;
  Workspace workspace_;
  std::vector<std::unique_ptr<TermPasses>> terms_;
  const IndexMap& index_map_;
  std::vector<double> of_points_;  // energies of points, on a part of a body
  double seconds_ = 0.0;
};

}  // namespace peristat
