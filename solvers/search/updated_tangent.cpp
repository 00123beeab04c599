#include "solvers/search/updated_tangent.hpp"

#include <algorithm>
#include <utility>

#include "solvers/linear/ldlt.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/dense/symmetric_system.hpp"

namespace peristat {
namespace {

/// Relative residual of the columns of Z: the body's motion since the linearisation, which K
/// neglects, matters more.
constexpr double column_tolerance = 1e-4;

/// A pivot of the inner matrix below this fraction of the others is round-off.
constexpr double least_pivot = 1e-12;

}  // namespace

struct UpdatedTangent::Correction {
  using Direction = BondDirection::Shares;

  std::map<Offset, std::size_t> column_of;
  std::vector<BondDirection> directions;
  std::vector<double> stiffness;
  std::vector<std::vector<float>> columns;   // of Z, in half the memory
  std::vector<std::vector<double>> between;  // columns of G^T Z, upper half
  SymmetricFactors inner;                    // factors of C^-1 - G^T Z
  bool is_current = true;
  std::vector<double> known_side, known_solution;
  std::vector<double> freed_side, freed_solution;  // forces that bonds have just lost; with K_0

  static double along(const Direction& g, std::span<const double> v) {
    double sum = 0.0;
    for (const auto& [equation, share] : g) sum += share * v[std::size_t(equation)];
    return sum;
  }

  [[nodiscard]] bool factorize() {
    const std::size_t size = columns.size();
    std::vector<double> matrix(size * size);
    for (std::size_t c = 0; c < size; ++c) {
      for (std::size_t r = 0; r <= c; ++r) {
        matrix[c * size + r] = matrix[r * size + c] = -between[c][r];
      }
      matrix[c * size + c] += 1.0 / stiffness[c];
    }
    inner.compute(matrix, int(size));
    is_current = true;
    return inner.is_positive(least_pivot);
  }

  void apply(std::vector<double>& x) const {
    const std::size_t size = columns.size();
    if (size == 0) return;
    std::vector<double> shares(size);
    for (std::size_t k = 0; k < size; ++k) shares[k] = along(directions[k].free, x);
    inner.solve(shares);
    for (std::size_t k = 0; k < size; ++k) add_column(x, shares[k], k);
  }

  void add_column(std::vector<double>& to, double share, std::size_t k) const {
    const std::vector<float>& column = columns[k];
    for (std::size_t e = 0; e < to.size(); ++e) to[e] += share * double(column[e]);
  }

  /// Notes what bonds no longer bear: the body's first answer to it follows from their columns.
  void set_free(std::span<const LostStiffness> lost) {
    freed_side.clear();
    if (columns.empty()) return;
    freed_side.assign(columns.front().size(), 0.0);
    freed_solution.assign(freed_side.size(), 0.0);
    for (const LostStiffness& bond : lost) {
      const auto known = column_of.find(bond.bond);
      if (known == column_of.end()) continue;
      for (const auto& [equation, share] : directions[known->second].free) {
        freed_side[std::size_t(equation)] += share * bond.force;
      }
      add_column(freed_solution, bond.force, known->second);
    }
  }

  [[nodiscard]] bool is_freed(std::span<const double> side, double tolerance) const {
    if (freed_side.empty()) return false;
    const auto apart = [&](std::size_t e) { return side[e] - freed_side[e]; };
    return norm_of(side.size(), apart) <= tolerance * norm(side);
  }
};

UpdatedTangent::UpdatedTangent(const EquilibriumProblem& problem, LinearSolver& solver,
                               TangentOperator& tangent)
    : problem_(problem), solver_(solver), tangent_(tangent) {}
UpdatedTangent::~UpdatedTangent() = default;

void UpdatedTangent::forget() {
  is_there_ = false;
  reference_ = {};
}

void UpdatedTangent::become(const TangentReference& reference) {
  const TangentReference kept = reference;
  if (kept.at.displacement.empty() || refresh(kept.at) != LinearOutcome::solved) return forget();
  is_direct_ = tells_pivots();
  lose(kept.lost);
  if (is_there_) reference_.known = kept.known;
}

LinearOutcome UpdatedTangent::refresh(State at, std::span<const double> foreseen) {
  forget();
  correction_ = std::make_unique<Correction>();
  ++refreshed_;
  Assembler& assembler = problem_.assembler;
  StateView view(at, Damage::held);
  touches_ = false;
  if (assembler.has_contacts()) {
    view.foreseen = foreseen.empty() ? std::span<const double>(at.displacement) : foreseen;
    static_cast<void>(assembler.cover_contacts(view));
    view.foreseen = foreseen;
    touches_ = !assembler.closed_contacts(view).empty();
  }
  tangent_.linearise(assembler, view, 0.0);
  reference_.at = std::move(at);
  solver_.count_pivots(false);
  indefinite_in_force_ = false;
  LinearOutcome outcome = solver_.factorize(tangent_, FactorUse::factorize_for_many);
  if (outcome == LinearOutcome::not_positive_definite) outcome = take_indefinite();
  is_there_ = outcome == LinearOutcome::solved;
  return outcome;
}

LinearOutcome UpdatedTangent::take_indefinite() {
  if (!tangent_.as_tangent()) return LinearOutcome::not_positive_definite;
  if (!indefinite_) {
    indefinite_ = std::make_unique<Ldlt>();
    const LinearOutcome outcome = indefinite_->analyze(tangent_.pattern, problem_.free);
    if (outcome != LinearOutcome::solved) return outcome;
  }
  indefinite_in_force_ = true;
  return indefinite_->factorize(tangent_, FactorUse::factorize_now);
}

LinearOutcome UpdatedTangent::solve_for(std::span<const double> side, double tolerance,
                                        std::vector<double>& solution) {
  solution.assign(side.size(), 0.0);
  LinearOutcome outcome = present().solve(side, solution, tolerance);
  if (outcome == LinearOutcome::not_positive_definite && !indefinite_in_force_) {
    outcome = take_indefinite();  // iterations have met negative curvature
    if (outcome == LinearOutcome::solved) outcome = present().solve(side, solution, tolerance);
  }
  is_direct_ = outcome == LinearOutcome::solved && present().last_iterations() == 0;
  return outcome;
}

std::vector<double> UpdatedTangent::right_hand_side(std::span<const double> force,
                                                    std::span<const double> jump) const {
  std::vector<double> side(std::size_t(problem_.free.count()));
  problem_.free.restrict_to_free(force, side);
  if (jump.empty()) return side;
  std::vector<double> of_supports(jump.size());
  tangent_.multiply(jump, of_supports);
  for (std::size_t e = 0; e < side.size(); ++e) side[e] -= of_supports[problem_.free.dof[e]];
  // The linearised tangent still has the stiffness that bonds to the supports have lost.
  for (std::size_t k = 0; k < correction_->directions.size(); ++k) {
    const BondDirection& bond = correction_->directions[k];
    const double lost = correction_->stiffness[k] * Correction::along(bond.held, jump);
    for (const auto& [equation, share] : bond.free) side[std::size_t(equation)] += share * lost;
  }
  return side;
}

LinearOutcome UpdatedTangent::solve(std::span<const double> force, double tolerance,
                                    std::vector<double>& direction) {
  std::vector<double> side = right_hand_side(force, {}), of_known(side.size()), solution;
  LinearOutcome outcome = LinearOutcome::solved;
  if (correction_->is_freed(side, tolerance)) {
    solution = correction_->freed_solution;
  } else {
    reference_.known.take_off(side, of_known);
    outcome = solve_for(side, tolerance, solution);
  }
  if (outcome == LinearOutcome::solved) correction_->apply(solution);
  add_scaled(solution, 1.0, of_known);
  direction.resize(problem_.free.equation.size());
  problem_.free.extend_by_zero(solution, direction);
  return outcome;
}

void UpdatedTangent::learn(std::span<const double> solution, std::span<const double> change) {
  std::vector<double> correction(std::size_t(problem_.free.count())),
      of_residual(correction.size());
  problem_.free.restrict_to_free(solution, correction);
  problem_.free.restrict_to_free(change, of_residual);
  reference_.known.add(correction, of_residual);
}

LinearOutcome UpdatedTangent::solve_again(std::span<const double> force,
                                          std::span<const double> jump, double tolerance,
                                          std::vector<double>& direction) {
  std::vector<double> side = right_hand_side(force, jump);
  Correction& known = *correction_;
  if (side != known.known_side) {
    known.known_side.clear();
    const LinearOutcome outcome = solve_for(side, tolerance, known.known_solution);
    if (outcome != LinearOutcome::solved) return outcome;
    known.known_side = std::move(side);
  }
  std::vector<double> solution = known.known_solution;
  correction_->apply(solution);
  direction.resize(problem_.free.equation.size());
  problem_.free.extend_by_zero(solution, direction);
  return LinearOutcome::solved;
}

bool UpdatedTangent::is_worth_updating() const {
  return is_there_ && is_direct_ && correction_->columns.size() < std::size_t(most_columns);
}

UpdatedTangent::BondDirection UpdatedTangent::direction_of(const LostStiffness& lost) const {
  BondDirection found;
  const auto d = std::size_t(problem_.free.dimension);
  for (const auto& [point, sign] : {std::pair(lost.first, -1.0), std::pair(lost.second, 1.0)}) {
    for (const Dependence& on :
         problem_.conditions.constraints().dependences(point, reference_.at.displacement)) {
      for (std::size_t c = 0; c < d; ++c) {
        double share = 0.0;
        for (std::size_t r = 0; r < d; ++r) share += lost.direction[r] * on.block[r][c];
        if (share == 0.0) continue;
        const Index dof = on.master * Index(d) + Index(c);
        const Index equation = problem_.free.equation[std::size_t(dof)];
        if (equation == FreeDofs::none) {
          found.held.emplace_back(dof, sign * share);
        } else {
          found.free.emplace_back(equation, sign * share);
        }
      }
    }
  }
  return found;
}

LinearOutcome UpdatedTangent::add_column(const LostStiffness& lost) {
  Correction& c = *correction_;
  const auto known = c.column_of.find(lost.bond);
  if (known != c.column_of.end()) {
    c.stiffness[known->second] += lost.stiffness;
    return LinearOutcome::solved;
  }
  BondDirection g = direction_of(lost);
  if (g.free.empty()) return LinearOutcome::solved;
  std::vector<double> side(std::size_t(problem_.free.count()));
  for (const auto& [equation, share] : g.free) side[std::size_t(equation)] += share;
  std::vector<double> column;
  const LinearOutcome outcome = solve_for(side, column_tolerance, column);
  if (outcome != LinearOutcome::solved) return outcome;
  std::vector<double>& between = c.between.emplace_back();
  for (const BondDirection& other : c.directions) {
    between.push_back(Correction::along(other.free, column));
  }
  between.push_back(Correction::along(g.free, column));
  c.column_of[lost.bond] = c.columns.size();
  c.directions.push_back(std::move(g));
  c.stiffness.push_back(lost.stiffness);
  c.columns.emplace_back(column.begin(), column.end());
  return LinearOutcome::solved;
}

void UpdatedTangent::lose(std::span<const LostStiffness> lost) {
  for (const LostStiffness& bond : lost) {
    if (!is_worth_updating() || add_column(bond) != LinearOutcome::solved) return forget();
    reference_.lost.push_back(bond);
    reference_.known.lose(bond.stiffness, direction_of(bond).free);
  }
  if (!correction_->columns.empty() && !correction_->factorize()) return forget();
  correction_->set_free(lost);
}

}  // namespace peristat
