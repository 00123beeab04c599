#include "solvers/study/rest_stability.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "solvers/body/require_memory_for.hpp"
#include "solvers/body/without_equation.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "solvers/linear/rigid_pieces.hpp"
#include "solvers/study/linear_systems.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Iterations and relative residual of the search for negative curvature. A residual this small
/// leaves no direction of negative curvature in which the start has a component, and a start that
/// oscillates like this has one in all of them.
constexpr int most_iterations = 5'000;
constexpr double search_tolerance = 1e-8;

struct Stability {
  LinearOutcome outcome;
  std::optional<Inertia> inertia;
};

/// @param before number of equations of earlier ranks
Stability at_rest(LinearSolver& solver, const TangentOperator& tangent, const FreeDofs& free,
                  std::int64_t before) {
  LinearOutcome outcome = solver.analyze(tangent.pattern, free);
  if (outcome == LinearOutcome::solved) {
    outcome = solver.factorize(tangent, FactorUse::factorize_now);
  }
  if (outcome == LinearOutcome::solved && !solver.inertia()) {
    std::vector<double> start(std::size_t(free.count())), x(start.size(), 0.0);
    for (std::size_t k = 0; k < start.size(); ++k) {
      start[k] = std::sin(1.0 + 1e4 * double(before + std::int64_t(k)));
    }
    outcome = solver.solve(start, x, search_tolerance);
  }
  return {outcome, solver.inertia()};
}

/// A material with a negative constant, and the key of that constant; the key is empty if there is
/// none.
std::pair<PointMaterials::Material, std::string> negative_material(const Body& body) {
  const Formulation& formulation = formulation_of(body.specification);
  if (!formulation.negative_constant) return {};
  const PointMaterials materials(body.specification, body.points);
  for (const auto& material : all_materials(body.specification, materials)) {
    const std::string negative = formulation.negative_constant(*material.of, material.key,
                                                               body.setting, body.points.spacing);
    if (!negative.empty()) return {material, negative};
  }
  return {};
}

}  // namespace

void refuse_unstable_rest(const Body& body, const StudyOptions& options) {
  const auto [of, negative] = negative_material(body);
  if (negative.empty()) return;
  const FreeDofs free(without_equation(body), body.points.dimension);
  const Communicator& ranks = body.index_map->ranks();
  const Communicator::Counts equations = ranks.count_all(free.count());
  if (equations.all == 0) return;

  const LinearSystems systems = choose_linear_systems(options, body, {});
  require_memory_for(body, systems.bytes);
  Assembler assembler(body.points, body.model, usable_threads(options.threads), *body.index_map,
                      systems.pattern_of());
  const Constraints& constraints = body.conditions->constraints();
  const std::unique_ptr<TangentOperator> tangent = systems.make_tangent(assembler, constraints);
  const std::vector<double> reference(constraints.dofs(), 0.0);
  const History history = assembler.initial_history();
  tangent->linearise(assembler, {reference, history}, 0.0);
  std::unique_ptr<LinearSolver> solver;
  if (systems.chosen.is_direct) {
    solver = std::make_unique<Cholesky>(FactorReuse{0});
  } else {
    std::unique_ptr<Preconditioner> preconditioner = std::make_unique<RigidPieces>(*body.index_map);
    if (!systems.has_rows) {
      preconditioner = std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points);
    }
    solver = std::make_unique<IterativeSolver>(KrylovMethod::conjugate_gradients,
                                               std::move(preconditioner), most_iterations,
                                               KrylovOptions{}.restart, ranks);
  }
  const auto [outcome, inertia] = at_rest(*solver, *tangent, free, equations.before);
  if (outcome != LinearOutcome::not_positive_definite) return;
  const std::string pivots =
      inertia ? fmt::format(" (its tangent has {} negative pivots)", inertia->negative) : "";
  const MaterialSpecification& material = *of.of;
  throw InputError(
      of.key + "." + (material.poisson_ratio ? "poisson_ratio" : negative),
      number_text(material.poisson_ratio ? *material.poisson_ratio
                  : negative == "c2"     ? material.c2
                                         : material.c3),
      fmt::format("the body is unstable before anything is loaded{}: its {} is negative, and some "
                  "of its interactions store less energy the more they deform. Give it a larger "
                  "Poisson's ratio (constant), a smaller lattice.perturbation or a larger horizon",
                  pivots, negative));
}

}  // namespace peristat
