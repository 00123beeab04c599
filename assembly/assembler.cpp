#include "assembly/assembler.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "assembly/operators/rows_of_blocks.hpp"
#include "assembly/terms/bonds/deformation_gradients.hpp"
#include "assembly/terms/bonds/point_stretches.hpp"
#include "assembly/terms/bonds/stretches_along.hpp"
#include "assembly/terms/bonds_alone.hpp"
#include "src/core/stopwatch.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Clears the entries of ghosts and of their images, which belong to other ranks.
void clear_ghosts(const IndexMap& index_map, int dimension, std::span<double> gradient) {
  if (gradient.empty() || index_map.is_whole()) return;
  const auto fill = [&](Index first, std::ptrdiff_t last) {
    std::fill(gradient.begin() + std::ptrdiff_t(first) * dimension, gradient.begin() + last, 0.0);
  };
  fill(index_map.owned(), std::ptrdiff_t(index_map.first_image()) * dimension);
  fill(index_map.first_image() + index_map.owned_images(), std::ptrdiff_t(gradient.size()));
}

/// Sums the ranks' evaluations, except for the utilisation, see Evaluation. Collective.
Evaluation sum_of(const Communicator& ranks, const Evaluation& mine) {
  const std::vector<double> sums =
      ranks.sum({mine.energy, mine.round_off, mine.released, double(mine.degenerate),
                 double(mine.moves_equilibrium), double(mine.growth.degrading),
                 double(mine.growth.breaking)});
  Evaluation all;
  all.energy = sums[0];
  all.round_off = sums[1];
  all.released = sums[2];
  all.degenerate = sums[3] > 0.0 || !std::isfinite(all.energy);
  all.moves_equilibrium = sums[4] > 0.0;
  all.growth = {Index(sums[5]), Index(sums[6])};
  return all;
}

/// Lets no onset grow at points at which a bond has started: cracks would need more energy to run.
void keep_toughness(const Points& points, const Bonds& bonds, std::span<const double> stretches,
                    std::span<StrengthOnsets::PointOnset> of_points) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!(stretches[std::size_t(bond)] > 0.0)) continue;
      for (const Index point : {i, bonds.partner(i, bond)}) {
        auto& range = of_points[std::size_t(points.source(point))].factor;
        if (range) (*range)[1] = 1.0;
      }
    }
  }
}

std::vector<RowRange> parts_of(const Points& points, const Model& model,
                               const BlockPattern& pattern, int threads) {
  const Index own = points.own_rows();
  const bool spill =
      std::ranges::any_of(model.terms(), [](const auto& term) { return term->spills_bonds(); });
  return partition_rows(pattern, spill ? threads : parts_of_rows(pattern, threads, own), own);
}

}  // namespace

Assembler::Assembler(const Points& points, const Model& model, int threads,
                     const IndexMap& index_map, PatternOf pattern_of)
    : points_(points),
      model_(model),
      pattern_of_(pattern_of),
      of_model_(pattern_of == PatternOf::blocks ? model.pattern() : model.visited_pattern()),
      in_contact_(BlockPattern::diagonal(points.count())),
      pattern_(of_model_),
      workspace_(pattern_, points.dimension, threads, parts_of(points, model, pattern_, threads)),
      index_map_(index_map) {
  if (model.terms().empty()) throw std::logic_error("a model without terms has no energy");
  for (const auto& term : model.terms()) terms_.push_back(passes_of(*term));
  if (index_map.is_whole()) return;
  if (model.tangent_kind() == TangentKind::products) {
    throw std::logic_error("Assembler: convolutions have no ranks");
  }
  of_points_.resize(points.volume.size());
}
Assembler::~Assembler() = default;

std::unique_ptr<TermPasses> Assembler::passes_of(const Term& term) {
  return term.passes({points_, model_, pattern_, workspace_, index_map_});
}

template <class Visit>
void Assembler::for_each_term(const Visit& visit, Write how) {
  const Stopwatch watch(seconds_);
  for (const auto& passes : terms_) {
    visit(*passes, how);
    how = Write::onto;
  }
}

History Assembler::initial_history() const {
  History history;
  const auto& terms = model_.terms();
  for (std::size_t slot = 0; slot < terms.size(); ++slot) {
    const std::shared_ptr<const FailureModel> failure = terms[slot]->failure();
    if (failure && failure->can_fail()) history.replace(slot, failure->initial_history());
  }
  return history;
}

History Assembler::history_of(std::span<const double> bond_stretches, const History& before) const {
  const BondFailure* const bonds = model_.failing_bonds();
  if (!bonds) return {};
  History history = initial_history();
  history.take_contacts(before);
  const std::span<const double> rest = model_.failure_history(before.terms() ? before : history);
  history.replace(model_.slot_of(*bonds), bonds->history_of(bond_stretches, rest));
  for (const auto& term : model_.terms()) term->follow(model_, history);
  return history;
}

Evaluation Assembler::energy(const StateView& at) { return gradient(at, {}); }

Evaluation Assembler::gradient(const StateView& at, std::span<double> gradient) {
  Evaluation found;
  for_each_term([&](TermPasses& term, Write how) {
    found += of_part(term, at, term.gradient(at, gradient, how));
  });
  return of_all(found, gradient);
}

Evaluation Assembler::of_part(TermPasses& term, const StateView& at, Evaluation found) {
  if (index_map_.is_whole() || term.shares_energy()) return found;
  term.point_energies(at, of_points_, Write::over);
  found.energy = 0.0;
  for (Index i = 0; i < points_.count(); ++i) {
    if (points_.owns(i)) found.energy += of_points_[std::size_t(i)];
  }
  return found;
}

Evaluation Assembler::of_all(const Evaluation& mine, std::span<double> gradient) const {
  if (index_map_.is_whole()) return mine;
  clear_ghosts(index_map_, points_.dimension, gradient);
  return sum_of(index_map_.ranks(), mine);
}

std::vector<BondDrive> Assembler::drives(const StateView& at) {
  std::vector<BondDrive> all =
      stretches_along(points_, model_.bonds(), at, {}, workspace_.threads());
  add_drive(at, {}, all);
  return all;
}

History Assembler::with_onsets(const StateView& at) {
  History renewed = at.history;
  const BondFailure* const bonds = model_.failing_bonds();
  if (!bonds || !bonds->onsets()) return renewed;
  const std::vector<double> largest =
      largest_driving(points_, bonds->bonds(), drives(at), broken_bonds(model_, at.history));
  const DeformationGradients gradients = deformation_gradients(points_, model_, at);
  const std::span<const double> free = at.eigenstretch();
  std::vector<StrengthOnsets::PointOnset> of_points(std::size_t(points_.own()));
  const auto entries = std::size_t(points_.dimension * points_.dimension);
  for (std::size_t i = 0; i < of_points.size(); ++i) {
    if (!gradients.is_determined[i]) continue;
    of_points[i] =
        bonds->onsets()->of_point(i, points_.dimension, &gradients.displacement[i * entries],
                                  free.empty() ? 0.0 : free[i], largest[i]);
  }
  keep_toughness(points_, bonds->bonds(), bond_stretches(model_, at.history), of_points);
  bonds->renew_onsets(points_, of_points, renewed.change(model_.slot_of(*bonds)));
  return renewed;
}

Evaluation Assembler::release(std::span<const double> displacement, History& history,
                              const SharedEnvironment& environment) {
  Evaluation found;
  if (!model_.fails_by_release()) return found;
  const auto at = [&] { return StateView{displacement, history, Damage::grows, environment}; };
  history = with_onsets(at());
  if (model_.drives_bonds()) {
    for_each_term([&](TermPasses& term, Write) {
      if (const auto growth = term.release(at(), history)) found.growth = *growth;
    });
  } else {
    const BondFailure& bonds = *model_.failing_bonds();
    found.growth =
        damage_bonds_alone(bonds, points_, drives(at()), history.change(model_.slot_of(bonds)));
  }
  found.moves_equilibrium = found.growth.degrading > 0;
  if (may_damage(found)) history.note_damage();
  return found;
}

Evaluation Assembler::commit(std::span<const double> displacement, History& history,
                             std::span<double> gradient, const SharedEnvironment& environment) {
  Evaluation found = release(displacement, history, environment);
  for_each_term([&](TermPasses& term, Write how) {
    const std::uint64_t before = history.version();
    const Evaluation of_term = term.commit(displacement, environment, history, gradient, how);
    // A term that has noted its damage itself has done so for all of it.
    if (may_damage(of_term) && history.version() == before) history.note_damage();
    found += of_part(term, {displacement, history, Damage::grows, environment}, of_term);
  });
  cut_struts(displacement, history, gradient, environment, found);
  return of_all(found, gradient);
}

Evaluation Assembler::commit_forces(std::span<const double> displacement, History& history,
                                    std::span<double> gradient,
                                    const SharedEnvironment& environment) {
  Evaluation found = release(displacement, history, environment);
  for_each_term([&](TermPasses& term, Write how) {
    const std::uint64_t before = history.version();
    const Evaluation of_term =
        term.commit_forces(displacement, environment, history, gradient, how);
    // A term that has noted its damage itself has done so for all of it.
    if (may_damage(of_term) && history.version() == before) history.note_damage();
    found += of_term;
  });
  cut_struts(displacement, history, gradient, environment, found);
  return of_all(found, gradient);
}

std::vector<Offset> Assembler::find_struts(const StateView& at) const {
  const Struts* const struts = model_.struts();
  if (!struts) return {};
  return struts->find(*model_.failing_bonds(), points_, at, model_.failure_history(at.history),
                      threads());
}

void Assembler::cut_struts(std::span<const double> displacement, History& history,
                           std::span<double> gradient, const SharedEnvironment& environment,
                           Evaluation& found) {
  const auto at = [&] { return StateView{displacement, history, Damage::grows, environment}; };
  const std::vector<Offset> struts = find_struts(at());
  if (struts.empty()) return;
  const BondFailure& failure = *model_.failing_bonds();
  const Bonds& bonds = failure.bonds();
  const std::span<const double> largest = bond_stretches(model_, history);
  std::vector<double> after(largest.begin(), largest.end());
  double of_law = 0.0;
  failure.with_damage_law(model_.failure_history(history), [&](const auto& laws) {
    for (const Offset bond : struts) {
      const auto law = laws.of_bond(bond);
      double& stretch = after[std::size_t(bond)];
      of_law += bonds.weight(bond) * bonds.length(bond) *
                (law.dissipated(law.law.critical()) - law.dissipated(stretch));
      stretch = law.law.critical();
    }
  });
  const double before = energy(at()).energy;
  history = history_of(after, history);
  const Evaluation cut = this->gradient(at(), gradient);
  found.energy = cut.energy;
  found.round_off = cut.round_off;
  found.degenerate |= cut.degenerate;
  const auto count = Index(struts.size());
  found.growth += {count, count, 0.0, before - cut.energy};
  found.released += before - cut.energy - of_law;
  found.moves_equilibrium = true;
}

void Assembler::follower_force(const StateView& at, std::span<double> force) {
  std::fill(force.begin(), force.end(), 0.0);
  for_each_term([&](TermPasses& term, Write) { term.follower_force(at, force); });
  clear_ghosts(index_map_, points_.dimension, force);
}

DamageGrowth Assembler::growth(const StateView& at) {
  const History history = with_onsets(at);
  StateView now(at.displacement, history, at.damage, at.environment);
  now.curvature = at.curvature;
  DamageGrowth growth = growth_by_laws(now);
  const auto struts = Index(find_struts(now).size());
  growth += {struts, struts};
  return growth;
}

DamageGrowth Assembler::growth_by_laws(const StateView& now) {
  if (model_.fails_by_release() && !model_.drives_bonds()) {
    const BondFailure& bonds = *model_.failing_bonds();
    return of_all(
        growth_of_bonds_alone(bonds, points_, drives(now), now.history.of(model_.slot_of(bonds))));
  }
  Evaluation found;
  for_each_term([&](TermPasses& term, Write) {
    Evaluation of_term;
    of_term.growth = term.growth(now);
    found += of_term;
  });
  return of_all(found.growth);
}

bool Assembler::may_damage(const Evaluation& of_commit) const {
  // Bonds between two ranks are counted by one of them.
  return of_commit.growth.degrading > 0 || (index_map_.ranks().count() > 1 && model_.has_history());
}

bool Assembler::has_contacts() const {
  return std::ranges::any_of(terms_, [](const auto& term) { return term->has_contacts(); });
}

std::vector<Index> Assembler::closed_contacts(const StateView& at) {
  std::vector<Index> closed;
  for_each_term([&](TermPasses& term, Write) {
    const std::vector<Index> of_term = term.closed_contacts(at);
    closed.insert(closed.end(), of_term.begin(), of_term.end());
  });
  return closed;
}

double Assembler::longest_step(const StateView& at, std::span<const double> step) {
  double longest = 1.0;
  for_each_term(
      [&](TermPasses& term, Write) { longest = std::min(longest, term.longest_step(at, step)); });
  return has_contacts() ? -index_map_.ranks().max(-longest) : longest;
}

double Assembler::largest_closing(const StateView& from, const StateView& to) {
  double largest = 0.0;
  for_each_term([&](TermPasses& term, Write) {
    largest = std::max(largest, term.largest_closing(from, to));
  });
  return index_map_.ranks().max(largest);
}

bool Assembler::has_passed(const StateView& from, const StateView& to) {
  if (!has_contacts()) return false;
  double passed = 0.0;
  for_each_term([&](TermPasses& term, Write) {
    if (term.has_passed(from, to)) passed = 1.0;
  });
  return index_map_.ranks().max(passed) > 0.0;
}

double Assembler::work_of_obstacles(const StateView& from, const StateView& to) {
  if (!has_contacts()) return 0.0;
  double work = 0.0;
  for_each_term([&](TermPasses& term, Write) { work += term.work_of_obstacles(from, to); });
  return index_map_.ranks().sum(work);
}

void Assembler::add_contact_stiffness(const StateView& at, double most_depth,
                                      std::span<double> stiffness) {
  for_each_term(
      [&](TermPasses& term, Write) { term.add_contact_stiffness(at, most_depth, stiffness); });
}

bool Assembler::has_friction() const {
  return std::ranges::any_of(terms_, [](const auto& term) { return term->has_friction(); });
}

void Assembler::stick(const StateView& at, History& history) {
  for_each_term([&](TermPasses& term, Write) { term.stick(at, history); });
}

double Assembler::lag_friction(const StateView& at, const StateView& start, History& history) {
  double change = 0.0, largest = 0.0;
  for_each_term([&](TermPasses& term, Write) {
    const auto [of_term, force] = term.lag_friction(at, start, history);
    change = std::max(change, of_term);
    largest = std::max(largest, force);
  });
  if (!std::isfinite(change)) return 1.0;
  return change > 0.0 ? change / std::max(change, largest) : 0.0;
}

int Assembler::cover_contacts(const StateView& at) {
  if (!has_contacts()) return version_of_pattern_;
  std::vector<Couplings> in_contact;
  for_each_term([&](TermPasses& term, Write) {
    if (const auto couplings = term.contact_couplings(at)) in_contact.push_back(*couplings);
  });
  BlockPattern now = in_contact.empty() ? BlockPattern::diagonal(points_.count())
                                        : BlockPattern::united(in_contact, points_.count()).kept();
  // Tangents on all ranks are laid out anew if one is.
  const bool stays = now == in_contact_;
  if (!any_of_all(index_map_.ranks(), !stays)) return version_of_pattern_;
  ++version_of_pattern_;
  if (stays) return version_of_pattern_;
  in_contact_ = std::move(now);
  pattern_ = in_contact_.partner.empty()
                 ? of_model_
                 : BlockPattern::united({of_model_, in_contact_}, points_.count()).kept();
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    if (!terms_[k]->has_contacts()) terms_[k] = passes_of(*model_.terms()[k]);
  }
  return version_of_pattern_;
}

void Assembler::add_drive(const StateView& at, const StateLine& line, std::span<BondDrive> drives) {
  for_each_term([&](TermPasses& term, Write) { term.add_drive(at, line, drives); });
}

DamageGrowth Assembler::of_all(const DamageGrowth& mine) const {
  const Communicator& ranks = index_map_.ranks();
  const std::vector<double> counts = ranks.sum({double(mine.degrading), double(mine.breaking)});
  return {Index(counts[0]), Index(counts[1]), ranks.max(mine.utilisation)};
}

DamageState Assembler::assess(const History& history, std::span<const double> cut_weight,
                              std::span<double> damage) const {
  DamageState state = assess_damage(model_, history, cut_weight, damage, &points_);
  const Communicator& ranks = index_map_.ranks();
  // All ranks know what failing points have dissipated in total: it is counted once.
  if (model_.failure().parts() == FailingParts::points && ranks.rank() > 0)
    state.dissipated_energy = 0.0;
  const std::vector<double> sums = ranks.sum({state.dissipated_energy, double(state.broken_bonds)});
  return {sums[0], Index(sums[1]), ranks.max(state.max_damage)};
}

TangentForms Assembler::forms() {
  const TangentKind kind = tangent_kind();
  const bool is_nearby = kind == TangentKind::nearby;
  const bool has_blocks = pattern_of_ == PatternOf::blocks;
  return {.blocks = kind <= TangentKind::stored && (has_blocks || !is_nearby) ? this : nullptr,
          .visits = kind == TangentKind::visited || (is_nearby && !has_blocks) ? this : nullptr,
          .rows = kind <= TangentKind::rows ? this : nullptr,
          .products = this};
}

void Assembler::tangent(const StateView& at, Tangent& tangent, double projection, Write how) {
  tangent.reference = points_.reference;
  for (std::size_t k = 0; k < points_.reference.size(); ++k) {
    tangent.position[k] = points_.reference[k] + at.displacement[k];
  }
  const auto add = [&](TermPasses& term, Write as) {
    term.forms().blocks->tangent(at, tangent, projection, as);
  };
  for_each_term(add, how);
}

void Assembler::visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                              std::span<double> diagonal) {
  for_each_term([&](TermPasses& term, Write) {
    term.forms().visits->visit_tangent(at, projection, visit, diagonal);
  });
}

void Assembler::find_diagonal(const StateView& at, double projection, std::span<double> diagonal) {
  for_each_term([&](TermPasses& term, Write) {
    term.forms().visits->find_diagonal(at, projection, diagonal);
  });
}

double Assembler::most_over_visited() const {
  return terms_.front()->forms().visits->most_over_visited();
}

void Assembler::product(const StateView& at, std::span<const double> v, std::span<double> product,
                        double projection) {
  for_each_term(
      [&](TermPasses& term, Write how) { term.product(at, v, projection, product, how); });
}

bool Assembler::has_single_products() const {
  return std::ranges::any_of(terms_, [](const auto& term) { return term->has_single_products(); });
}

std::optional<Tangent> Assembler::sum_of_blocks(const StateView& at) {
  const bool couples_points = std::ranges::any_of(model_.terms(), [](const auto& term) {
    return term->tangent_kind() <= TangentKind::stored && !term->couplings().partner.empty();
  });
  std::optional<Tangent> sum;
  for_each_term([&](TermPasses& term, Write) {
    BlockTangent* const of_term = term.forms().blocks;
    if (!of_term) return;
    if (!sum) {
      sum.emplace(couples_points ? pattern_ : BlockPattern::diagonal(points_.count()),
                  points_.dimension);
    }
    of_term->tangent(at, *sum, 0.0, Write::onto);
  });
  return sum;
}

SparseRows Assembler::rows(const StateView& at, RowReach reach) {
  SparseRows sum;
  for_each_term([&](TermPasses& term, Write) {
    if (RowOperator* const of_term = term.forms().rows) sum.add(of_term->rows(at, reach));
  });
  if (const std::optional<Tangent> blocks = sum_of_blocks(at)) sum.add(rows_of_blocks(*blocks));
  return sum;
}

double Assembler::bytes_of_rows() const {
  double bytes = 0.0;
  for (const auto& term : terms_) {
    if (const RowOperator* const of_term = term->forms().rows) bytes += of_term->bytes_of_rows();
  }
  return bytes;
}

void Assembler::outline(const StateView& at, std::span<double> diagonal,
                        std::span<double> row_sums) {
  for_each_term([&](TermPasses& term, Write) {
    if (ProductOperator* const of_term = term.forms().products) {
      of_term->outline(at, diagonal, row_sums);
    }
  });
  const std::optional<Tangent> blocks = sum_of_blocks(at);
  if (!blocks) return;
  std::vector<double> sums(row_sums.size());
  blocks->absolute_row_sums(sums);
  add_scaled(row_sums, 1.0, sums);
  add_scaled(diagonal, 1.0, blocks->diagonal);
}

LatticeStencil Assembler::stencil(const StateView& at) {
  LatticeStencil sum;
  for_each_term([&](TermPasses& term, Write) {
    ProductOperator* const of_term = term.forms().products;
    const LatticeStencil found = of_term ? of_term->stencil(at) : LatticeStencil();
    sum.insert(sum.end(), found.begin(), found.end());
  });
  return sum;
}

void Assembler::point_energies(const StateView& at, std::span<double> energies) {
  for_each_term([&](TermPasses& term, Write how) { term.point_energies(at, energies, how); });
}

void Assembler::virials(const StateView& at, std::span<double> virials) {
  std::fill(virials.begin(), virials.end(), 0.0);
  for_each_term([&](TermPasses& term, Write) { term.add_virials(at, virials); });
}

}  // namespace peristat
