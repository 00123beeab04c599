#include "cases/runner/commands/check_tangent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "assembly/operators/unsymmetric_tangent.hpp"
#include "cases/runner/setup/body.hpp"
#include "solvers/motion/newmark.hpp"
#include "solvers/study/linear_systems.hpp"
#include "solvers/study/motion.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/geometry/expression_at_points.hpp"

namespace peristat {
namespace {

/// A homogeneous deformation plus a bending-like part, different in every direction.
std::string default_deformation(const Points& points) {
  double length = points.spacing;
  for (double at : points.reference) length = std::max(length, std::abs(at));
  const std::string l = number_text(length);
  switch (points.dimension) {
    case 1:
      return "1.03*x + 0.01*" + l + "*sin(2*x/" + l + ")";
    case 2:
      return "1.03*x + 0.02*y + 0.02*x*y/" + l + "; 0.98*y - 0.01*x + 0.015*x*x/" + l;
    default:
      return "1.03*x + 0.02*y - 0.01*z + 0.02*x*y/" + l + "; 0.98*y - 0.01*x + 0.015*x*z/" + l +
             "; 1.01*z + 0.02*x - 0.015*y*y/" + l;
  }
}

std::vector<double> displacement_of(const std::string& deformation, const Points& points) {
  std::vector<Expression> component;
  std::istringstream parts(deformation);
  for (std::string part; std::getline(parts, part, ';');) {
    component.push_back(expression_of(part, points));
  }
  if (component.size() != std::size_t(points.dimension)) {
    throw InputError("", '"' + deformation + '"',
                     "needs " + std::to_string(points.dimension) +
                         " expressions of the current coordinates, separated by ';'");
  }
  std::vector<double> displacement(points.reference.size());
  for (Index i = 0; i < points.count(); ++i) {
    for (int c = 0; c < points.dimension; ++c) {
      const std::size_t dof = std::size_t(i) * points.dimension + c;
      displacement[dof] = value_at(component[c], points, i) - points.reference[dof];
    }
  }
  return displacement;
}

/// Fits each generalised degree of freedom (handle) by itself to a deformation of the points.
void fit_handles(const Constraints& constraints, const Points& points,
                 std::vector<double>& displacement) {
  const std::size_t d = std::size_t(points.dimension);
  displacement.resize(constraints.dofs(), 0.0);
  const std::vector<double> rest(displacement.size(), 0.0);
  std::vector<double> sum(displacement.size(), 0.0), weight(displacement.size(), 0.0);
  for (Index i = 0; i < points.count(); ++i) {
    if (constraints.stands_alone(i)) continue;
    Coordinates left{};
    const std::vector<Dependence> all = constraints.dependences(i, rest);
    for (std::size_t r = 0; r < d; ++r) {
      left[r] = displacement[std::size_t(i) * d + r];
      for (const Dependence& on : all) {
        if (on.master >= points.count()) continue;
        for (std::size_t c = 0; c < d; ++c) {
          left[r] -= on.block[r][c] * displacement[std::size_t(on.master) * d + c];
        }
      }
    }
    for (const Dependence& on : all) {
      if (on.master < points.count()) continue;
      for (std::size_t c = 0; c < d; ++c) {
        for (std::size_t r = 0; r < d; ++r) {
          sum[std::size_t(on.master) * d + c] += on.block[r][c] * left[r];
          weight[std::size_t(on.master) * d + c] += on.block[r][c] * on.block[r][c];
        }
      }
    }
  }
  for (std::size_t dof = points.reference.size(); dof < displacement.size(); ++dof) {
    if (weight[dof] > 0.0) displacement[dof] = sum[dof] / weight[dof];
  }
}

/// The energy as a function of the independent degrees of freedom, without loads.
class Reduced {
 public:
  Reduced(Assembler& assembler, const Constraints& constraints, const History& history,
          Damage damage, SharedEnvironment environment)
      : assembler_(assembler),
        constraints_(constraints),
        history_(history),
        damage_(damage),
        environment_(std::move(environment)) {}

  [[nodiscard]] StateView at(const std::vector<double>& displacement) const {
    return {displacement, history_, damage_, environment_};
  }

  /// Moves dependent degrees of freedom and finds the gradient, whose entries there are zero.
  Evaluation gradient(std::vector<double> displacement, std::vector<double>& gradient) const {
    if (constraints_.none()) return assembler_.gradient(at(displacement), gradient);
    constraints_.move(displacement);
    const Evaluation found = assembler_.gradient(at(displacement), gradient);
    fold(displacement, gradient);
    return found;
  }

  /// Energies of all points, at a displacement of the independent degrees of freedom.
  [[nodiscard]] std::vector<double> point_energies(std::vector<double> displacement) const {
    if (!constraints_.none()) constraints_.move(displacement);
    std::vector<double> energies(assembler_.points().volume.size());
    assembler_.point_energies(at(displacement), energies);
    return energies;
  }

  /// Potential of the forces on obstacles, which no point has a part of.
  [[nodiscard]] double potential(const Obstacles& obstacles,
                                 std::vector<double> displacement) const {
    if (!constraints_.none()) constraints_.move(displacement);
    return obstacles.potential(displacement, environment_);
  }

  /// Adds forces on dependent degrees of freedom to those that they follow.
  void fold(const std::vector<double>& displacement, std::vector<double>& forces) const {
    if (constraints_.none()) return;
    constraints_.fold(displacement, no_load(), forces);
    for (std::size_t dof = 0; dof < forces.size(); ++dof) {
      if (constraints_.dependent()[dof]) forces[dof] = 0.0;
    }
  }

  /// Curvature of rigid sets, at a displacement whose dependent degrees of freedom have moved.
  [[nodiscard]] std::vector<Tensor> curvature(const std::vector<double>& displacement) const {
    std::vector<double> forces(displacement.size());
    static_cast<void>(assembler_.gradient(at(displacement), forces));
    constraints_.fold(displacement, no_load(), forces);
    return constraints_.curvature(displacement, no_load(), forces);
  }

 private:
  [[nodiscard]] std::vector<double> no_load() const {
    return std::vector<double>(constraints_.dofs(), 0.0);
  }

  Assembler& assembler_;
  const Constraints& constraints_;
  const History& history_;
  Damage damage_;
  SharedEnvironment environment_;
};

/// Fixed pseudo-random direction with entries of the size of the spacing.
std::vector<double> test_direction(const Points& points, const std::vector<char>& dependent) {
  std::vector<double> direction(dependent.size());
  std::uint64_t state = 88172645463325252ULL;
  for (double& entry : direction) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    entry = points.spacing * (2.0 * double(state >> 11) / 9007199254740992.0 - 1.0);
  }
  for (std::size_t dof = 0; dof < direction.size(); ++dof) {
    if (dependent[dof]) direction[dof] = 0.0;
  }
  return direction;
}

/// Adds a little of the gradient's direction: where steps have to be small, the slope along a
/// random direction may be small, too, and drown in round-off.
void steepen(const std::vector<double>& gradient, double size, std::vector<double>& direction) {
  constexpr double share = 0.05;
  double largest = 0.0;
  for (const double entry : gradient) largest = std::max(largest, std::abs(entry));
  if (largest > 0.0) add_scaled(direction, share * size / largest, gradient);
}

/// Keeps finite differences off the kinks (or jumps) that forces with damage have at the onset and
/// at the critical stretch, across which no difference converges. Sets the direction to zero at
/// points whose bonds are close to one.
/// @return the largest step along the direction at which no bond reaches one
double keep_off_kinks(const Body& body, const std::vector<double>& displacement,
                      const std::vector<double>& gradient, std::vector<double>& direction,
                      double largest_step) {
  const BondFailure* const failing = body.model.failing_bonds();
  if (!failing) return largest_step;
  steepen(gradient, body.points.spacing, direction);
  const std::vector<double> history = failing->initial_history();
  const auto range_of = [&](Offset bond) {
    DamageRange<double> range{};
    failing->with_damage_law(history,
                             [&](const auto& laws) { range = laws.of_bond(bond).ranges(bond); });
    return range;
  };
  double margin = std::numeric_limits<double>::infinity();  // the least of all bonds

  const Points& points = body.points;
  const Bonds& bonds = body.model.bonds();
  const auto d = std::size_t(points.dimension);
  const auto place = [&](Index i) {
    Coordinates at = points.position(i);
    for (std::size_t c = 0; c < d; ++c) at[c] += displacement[std::size_t(i) * d + c];
    return at;
  };
  double shortest = std::numeric_limits<double>::infinity();
  const std::vector<double> all = direction;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      const Coordinates a = place(i), b = place(j);
      const double stretch =
          std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) * bonds.inverse_length(bond) - 1.0;
      shortest = std::min(shortest, bonds.length(bond));
      const auto [onset, critical] = range_of(bond);
      const double near = 0.02 * (critical > onset ? critical - onset : critical);
      margin = std::min(margin, near);
      if (std::abs(stretch - onset) >= near && std::abs(stretch - critical) >= near) continue;
      for (const Index point : {points.source(i), points.source(j)}) {
        std::fill_n(direction.begin() + std::ptrdiff_t(std::size_t(point) * d), d, 0.0);
      }
    }
  }
  if (norm(direction) == 0.0) direction = all;  // a homogeneous stretch on a kink: let it show
  double fastest = 0.0;
  for (const double entry : direction) fastest = std::max(fastest, std::abs(entry));
  return std::min(largest_step, margin * shortest / (2.0 * std::sqrt(double(d)) * fastest));
}

struct Convergence {
  double error = 0.0;
  std::optional<double> order;

  /// As JSON: null if round-off affects all step sizes.
  [[nodiscard]] std::string order_text() const {
    return order ? fmt::format("{:.6g}", *order) : "null";
  }
};

/// The smallest error or, as it may be small by chance, the middle one of it and its neighbours.
double round_off_of(const std::vector<double>& errors) {
  const auto least = std::min_element(errors.begin(), errors.end());
  if (least == errors.begin() || least + 1 == errors.end()) return *least;
  std::array<double, 3> around{*(least - 1), *least, *(least + 1)};
  std::sort(around.begin(), around.end());
  return around[1];
}

/// Smallest error, and the order at the smallest step whose error is still well above round-off:
/// 100 times or, if no step's is, 15 times, which gives an order of 2 an error of up to 0.1.
Convergence convergence_of(const std::vector<double>& errors) {
  Convergence result;
  result.error = *std::min_element(errors.begin(), errors.end());
  const double round_off = round_off_of(errors);
  for (const double clear_of_round_off : {100.0, 15.0}) {
    for (std::size_t k = 0; k + 1 < errors.size() && !result.order; ++k) {
      const bool is_last = k + 2 == errors.size() || errors[k + 2] < clear_of_round_off * round_off;
      if (errors[k + 1] < clear_of_round_off * round_off) break;
      if (is_last) result.order = std::log2(errors[k] / errors[k + 1]);
    }
  }
  return result;
}

double relative_force_sum(const Points& points, const std::vector<double>& gradient) {
  Coordinates sum{};
  double size = 0.0;
  for (std::size_t dof = 0; dof < gradient.size(); ++dof) {
    sum[dof % std::size_t(points.dimension)] += gradient[dof];
    size += std::abs(gradient[dof]);
  }
  return size > 0.0 ? std::hypot(sum[0], sum[1], sum[2]) / size : 0.0;
}

double relative_moment_sum(const Points& points, const std::vector<double>& displacement,
                           const std::vector<double>& gradient) {
  Coordinates sum{};
  double size = 0.0;
  for (Index i = 0; i < points.count(); ++i) {
    Coordinates at = points.position(i), force{};
    for (int c = 0; c < points.dimension; ++c) {
      const std::size_t dof = std::size_t(i) * points.dimension + c;
      at[c] += displacement[dof];
      force[c] = gradient[dof];
    }
    sum[0] += at[1] * force[2] - at[2] * force[1];
    sum[1] += at[2] * force[0] - at[0] * force[2];
    sum[2] += at[0] * force[1] - at[1] * force[0];
    size += std::hypot(at[0], at[1], at[2]) * std::hypot(force[0], force[1], force[2]);
  }
  return size > 0.0 ? std::hypot(sum[0], sum[1], sum[2]) / size : 0.0;
}

/// As JSON: null for a tangent without entries.
std::string frobenius_norm(const TangentOperator& tangent) {
  const Tangent* const stored = tangent.as_tangent();
  if (!stored && !tangent.as_unsymmetric()) return "null";
  return fmt::format(
      "{:.17g}", stored ? stored->frobenius_norm() : norm(tangent.as_unsymmetric()->rows().value));
}

/// Gradients that differenced_block evaluates for a column.
constexpr double passes_per_column = 6.0;

/// Sample of degrees of freedom, of neighbouring points at several places of the body, whose
/// columns of the tangent are found by differences.
/// @param direction of the check; where it is zero a difference would meet a kink
std::vector<std::size_t> sampled_dofs(const Body& body, const std::vector<double>& direction) {
  constexpr Index places = 6, most_partners = 8;
  constexpr double most_work = 1e8;  // interactions in all passes, some seconds
  const Bonds& bonds = body.model.bonds();
  double interactions = 0.0;
  for (const auto& term : body.model.terms()) {
    for (const InteractionCount& kind : term->counts()) interactions += double(kind.count);
  }
  const auto d = std::size_t(body.points.dimension);
  const auto most =
      std::size_t(std::max(2.0 * double(d), most_work / (passes_per_column * interactions)));

  std::vector<Index> points;
  for (Index k = 0; k < std::min(places, bonds.points()); ++k) {
    const Index i = bonds.points() / std::min(places, bonds.points()) * k;
    points.push_back(i);
    const Offset last = std::min(bonds.offset[i + 1], bonds.offset[i] + most_partners);
    for (Offset bond = bonds.offset[i]; bond < last; ++bond)
      points.push_back(bonds.partner(i, bond));
  }
  std::vector<std::size_t> dofs;
  for (const Index point : points) {
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t dof = std::size_t(point) * d + c;
      const bool is_known = std::find(dofs.begin(), dofs.end(), dof) != dofs.end();
      if (!is_known && direction[dof] != 0.0 && dofs.size() < most) dofs.push_back(dof);
    }
  }
  return dofs;
}

/// Entries of the columns of some degrees of freedom in their own rows, by central differences of
/// the gradient with steps h, h/2 and h/4 and Richardson's extrapolation: an error of order h^6.
std::vector<double> differenced_block(const Reduced& body, const std::vector<double>& displacement,
                                      const std::vector<std::size_t>& dofs, double step) {
  const std::size_t count = dofs.size();
  std::vector<double> block(count * count), shifted(displacement.begin(), displacement.end());
  std::vector<double> forward(displacement.size()), backward(displacement.size());
  constexpr double weights[] = {1.0 / 45.0, -20.0 / 45.0, 64.0 / 45.0};
  for (std::size_t j = 0; j < count; ++j) {
    double h = step;
    for (const double weight : weights) {
      shifted[dofs[j]] = displacement[dofs[j]] + h;
      static_cast<void>(body.gradient(shifted, forward));
      shifted[dofs[j]] = displacement[dofs[j]] - h;
      static_cast<void>(body.gradient(shifted, backward));
      for (std::size_t i = 0; i < count; ++i) {
        block[i * count + j] += weight * (forward[dofs[i]] - backward[dofs[i]]) / (2.0 * h);
      }
      h *= 0.5;
    }
    shifted[dofs[j]] = displacement[dofs[j]];
  }
  return block;
}

/// Largest |K_ij - K_ji| over the largest |K_ij|. Needs a block from differences: the tangent
/// itself is stored once for both places of a block, and can't be unsymmetric.
double asymmetry_of(const std::vector<double>& block, std::size_t count) {
  double difference = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      largest = std::max(largest, std::abs(block[i * count + j]));
      difference = std::max(difference, std::abs(block[i * count + j] - block[j * count + i]));
    }
  }
  return largest > 0.0 ? difference / largest : 0.0;
}

/// Eigenstrains, pressures, and displacements of grounds and obstacles at the end of the load;
/// under displacement control at the load 1. For implicit time steps also the inertia, which holds
/// the points at this displacement.
SharedEnvironment environment_at_end(const Case& from, const Body& body,
                                     const std::vector<double>& displacement) {
  const Conditions& conditions = *body.conditions;
  const double end = conditions.programme().end();
  const SharedEnvironment there =
      conditions.environment(conditions.control() ? LoadPoint(end, 1.0) : LoadPoint(end));
  if (!from.dynamics.is_implicit()) return there;
  auto with = there ? std::make_shared<Environment>(*there) : std::make_shared<Environment>();
  const MotionSetting setting = make_motion_setting(body);
  with->inertia = {setting.mass, displacement};
  const double dt = from.dynamics.time_step;
  const double per_mass = NewmarkCoefficients(from.dynamics.spectral_radius).stiffness_per_mass(dt);
  for (std::size_t dof = 0; dof < setting.mass.size(); ++dof) {
    const double rate = setting.absorption.empty() ? 0.0 : setting.absorption[dof];
    with->inertia.stiffness[dof] *= per_mass / (2.0 * DragFactors(rate * dt).phi2);
  }
  return with;
}

}  // namespace

Exit check_tangent(const Case& from, const std::string& deformation, int threads, std::FILE* out) {
  const std::unique_ptr<const Body> made = make_body(from, threads);
  const Body& body = *made;
  const Points& points = body.points;
  const std::string text = deformation.empty() ? default_deformation(points) : deformation;
  std::vector<double> displacement;
  try {
    displacement = displacement_of(text, points);
  } catch (const InputError& error) {
    throw InputError("--deformation", error.value(), error.allowed());
  }
  const Constraints& constraints = body.conditions->constraints();
  if (!constraints.none()) {
    fit_handles(constraints, points, displacement);
    constraints.move(displacement);
  }
  Assembler assembler(points, body.model, threads);
  const std::size_t dofs = displacement.size();
  std::vector<double> gradient(dofs), image(dofs), shifted(dofs), forward(dofs), backward(dofs);
  History history = assembler.initial_history();
  const SharedEnvironment environment = environment_at_end(from, body, displacement);
  // In mode path the body is elastic between events: damage of this deformation is committed, then
  // held.
  const bool goes_by_events = body.specification.teeth > 0;
  if (goes_by_events) assembler.commit(displacement, history, {}, environment);
  const Reduced reduced(assembler, constraints, history,
                        goes_by_events ? Damage::held : Damage::grows, environment);
  const StateView at = reduced.at(displacement);
  // Not folded, without the forces of foundations and obstacles.
  std::vector<double> internal_force(dofs);
  static_cast<void>(assembler.gradient(at, internal_force));
  body.conditions->foundations().add_force(displacement, environment, 1.0, internal_force);
  body.conditions->obstacles().add_force(displacement, environment, history.slips(), 1.0,
                                         internal_force);
  const Evaluation found = reduced.gradient(displacement, gradient);
  if (found.degenerate) {
    throw InputError(
        "--deformation", '"' + text + '"',
        "collapses a bond to zero length, or presses a point deeper into what it touches than it "
        "may go");
  }
  const std::unique_ptr<TangentOperator> made_tangent =
      LinearSystems().make_tangent(assembler, constraints);
  TangentOperator& tangent = *made_tangent;
  const std::vector<Tensor> of_rigid_sets = reduced.curvature(displacement);
  StateView state = at;
  state.curvature = of_rigid_sets;
  tangent.linearise(assembler, state, 0.0);
  std::vector<double> direction = test_direction(points, constraints.dependent());
  double largest_step = 0.05;
  // Without a potential, forces depend on committed damage only.
  if (!goes_by_events && assembler.has_potential()) {
    largest_step = keep_off_kinks(body, displacement, gradient, direction, largest_step);
  }
  tangent.multiply(direction, image);
  // Follower forces have no part in the energy.
  std::vector<double> follower_force(dofs);
  assembler.follower_force(at, follower_force);
  reduced.fold(displacement, follower_force);
  const double slope = dot(gradient, direction) + dot(follower_force, direction);
  const double curvature = dot(image, direction);
  // At a state without forces the slope is round-off: there the energy of a unit step is the scale.
  constexpr double no_slope = 1e-10;
  const double energy_scale =
      std::abs(slope) > no_slope * std::abs(curvature) ? std::abs(slope) : std::abs(curvature);
  const double force_scale = norm(image);
  if (energy_scale == 0.0 || force_scale == 0.0) {
    throw InputError("", "", "the case has no bonds whose derivatives could be checked");
  }

  const Obstacles& obstacles = body.conditions->obstacles();
  std::vector<double> residual_errors, tangent_errors;
  constexpr int halvings = 20;
  double step = largest_step;
  for (int k = 0; k < halvings; ++k, step *= 0.5) {
    shifted = displacement;
    add_scaled(shifted, step, direction);
    static_cast<void>(reduced.gradient(shifted, forward));
    const double potential_ahead = reduced.potential(obstacles, shifted);
    const std::vector<double> ahead = reduced.point_energies(shifted);
    shifted = displacement;
    add_scaled(shifted, -step, direction);
    static_cast<void>(reduced.gradient(shifted, backward));
    const double potential_behind = reduced.potential(obstacles, shifted);
    const std::vector<double> behind = reduced.point_energies(shifted);
    // Point by point: differences of the whole energy would be lost in the round-off of its sum.
    double difference = potential_ahead - potential_behind;
    for (std::size_t i = 0; i < ahead.size(); ++i) difference += ahead[i] - behind[i];
    difference /= 2.0 * step;
    residual_errors.push_back(std::abs(difference - slope) / energy_scale);
    add_scaled(forward, -1.0, backward);
    for (double& entry : forward) entry /= 2.0 * step;
    add_scaled(forward, -1.0, image);
    tangent_errors.push_back(norm(forward) / force_scale);
  }
  const std::vector<std::size_t> sample = sampled_dofs(body, direction);
  double fastest = 0.0;
  for (const double entry : direction) fastest = std::max(fastest, std::abs(entry));
  const double sample_step = std::min(0.01 * points.spacing, 0.25 * largest_step * fastest);
  const double asymmetry =
      asymmetry_of(differenced_block(reduced, displacement, sample, sample_step), sample.size());

  const Convergence of_residual = convergence_of(residual_errors);
  const Convergence of_tangent = convergence_of(tangent_errors);
  const bool has_potential = assembler.has_potential();
  const std::string error_of_residual =
      has_potential ? fmt::format("{:.6g}", of_residual.error) : "null";

  fmt::print(out,
             "{{\n"
             "  \"deformation\": \"{}\",\n"
             "  \"energy\": {:.17g},\n"
             "  \"residual_norm\": {:.17g},\n"
             "  \"tangent_frobenius_norm\": {},\n"
             "  \"asymmetry\": {:.6g},\n"
             "  \"force_sum\": {:.6g},\n"
             "  \"moment_sum\": {:.6g},\n"
             "  \"residual_error\": {},\n"
             "  \"tangent_error\": {:.6g},\n"
             "  \"residual_order\": {},\n"
             "  \"tangent_order\": {}\n"
             "}}\n",
             text, found.energy, norm(gradient), frobenius_norm(tangent), asymmetry,
             relative_force_sum(points, internal_force),
             relative_moment_sum(points, displacement, internal_force), error_of_residual,
             of_tangent.error, has_potential ? of_residual.order_text() : "null",
             of_tangent.order_text());
  if (!has_potential) {
    fmt::print(stderr,
               "forces by collocation have no potential: the asymmetry is expected, and the energy "
               "does not check the residual\n");
  }
  return Exit::done;
}

}  // namespace peristat
