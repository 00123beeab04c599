// Linear solvers side by side: ./peristat bench --linear [BODY...] [--solvers a,b,...]
//
// Each body is a lattice at rest, of horizon 3.015 or the one after an r in its name, held over
// three layers at one end, plates with a hole at both, with a random right-hand side; K x = b is
// solved to a relative residual of 1e-8. Prints a table.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "assembly/operators/tangent.hpp"
#include "benchmarks/lattice_bodies.hpp"
#include "solvers/linear/make_linear_solver.hpp"

namespace {

using namespace peristat;

struct BodyShape {
  int dimension = 3;
  std::array<int, 3> extent{};
  bool is_cracked = false;  // two thirds through, in the middle
  double horizon = benchmark_bodies::horizon;
  bool has_hole = false;  // a fifth wide, in the middle; cracks run from it on both sides

  /// A square plate with a hole.
  static BodyShape with_hole(int size, double horizon = benchmark_bodies::horizon,
                             bool is_cracked = false) {
    return {2, {size, size, 0}, is_cracked, horizon, true};
  }
};

const std::vector<std::pair<std::string, BodyShape>> bodies{
    {"cube-10", {3, {10, 10, 10}}},
    {"cube-20", {3, {20, 20, 20}}},
    {"cube-30", {3, {30, 30, 30}}},
    {"cube-40", {3, {40, 40, 40}}},
    {"cube-50", {3, {50, 50, 50}}},
    {"cube-60", {3, {60, 60, 60}}},
    {"cube-20-cracked", {3, {20, 20, 20}, true}},
    {"cube-30-cracked", {3, {30, 30, 30}, true}},
    {"bar-10", {3, {80, 8, 8}}},
    {"bar-30", {3, {240, 8, 8}}},
    {"bar-100", {3, {800, 8, 8}}},
    {"bar-100-cracked", {3, {800, 8, 8}, true}},
    {"plate-100", {2, {100, 100, 0}}},
    {"plate-300", {2, {300, 300, 0}}},
    {"plate-300-cracked", {2, {300, 300, 0}, true}},
    {"plate-1000", {2, {1000, 1000, 0}}},
    {"cube-30-r5", {3, {30, 30, 30}, false, 5.1}},
    {"cube-100", {3, {100, 100, 100}}},
    {"hole-50", BodyShape::with_hole(50)},
    {"hole-100", BodyShape::with_hole(100)},
    {"hole-200", BodyShape::with_hole(200)},
    {"hole-300", BodyShape::with_hole(300)},
    {"hole-50-r5", BodyShape::with_hole(50, 5.1)},
    {"hole-100-r5", BodyShape::with_hole(100, 5.1)},
    {"hole-200-r5", BodyShape::with_hole(200, 5.1)},
    {"hole-300-r5", BodyShape::with_hole(300, 5.1)},
    {"hole-50-r8", BodyShape::with_hole(50, 8.015)},
    {"hole-100-r8", BodyShape::with_hole(100, 8.015)},
    {"hole-200-r8", BodyShape::with_hole(200, 8.015)},
    {"hole-300-r8", BodyShape::with_hole(300, 8.015)},
    {"hole-100-cracked", BodyShape::with_hole(100, benchmark_bodies::horizon, true)},
};

struct SolverKind {
  LinearMethod method;
  PreconditionerKind preconditioner;
  bool is_stored;
};

constexpr auto pcg = LinearMethod::conjugate_gradients;
const std::vector<std::pair<std::string, SolverKind>> solvers{
    {"cholesky", {LinearMethod::cholesky, PreconditionerKind::automatic, true}},
    {"jacobi", {pcg, PreconditionerKind::jacobi, false}},
    {"block_jacobi", {pcg, PreconditionerKind::block_jacobi, false}},
    {"rigid_pieces", {pcg, PreconditionerKind::rigid_pieces, false}},
    {"rigid_pieces-stored", {pcg, PreconditionerKind::rigid_pieces, true}},
    {"surrogate", {pcg, PreconditionerKind::surrogate, false}},
    {"sines", {pcg, PreconditionerKind::sines, false}},
    {"multigrid", {pcg, PreconditionerKind::multigrid, true}},
    {"riluk", {pcg, PreconditionerKind::riluk, true}},
    {"chebyshev", {pcg, PreconditionerKind::chebyshev, true}},
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Two thirds through from one side; with a hole, along the middle on both of its sides, as far as
/// its radius.
void cut(Model& model, const Points& points, const BodyShape& shape) {
  const int across = shape.has_hole ? 1 : 0, along = 1 - across;
  const double plane = 0.5 * shape.extent[across], length = shape.extent[along];
  Bonds bonds = model.bonds();
  bonds.remove_if([&](Index i, Offset bond) {
    const Coordinates a = points.position(i), b = points.position(bonds.partner[bond]);
    const double at = 0.5 * (a[along] + b[along]);
    const bool is_cut =
        shape.has_hole ? std::abs(at - 0.5 * length) < 0.2 * length : at < 2.0 / 3.0 * length;
    return (a[across] - plane) * (b[across] - plane) < 0.0 && is_cut;
  });
  model = Model(std::move(bonds), model.bond_failure()->potential());
}

Points points_of(const BodyShape& shape) {
  if (!shape.has_hole) return benchmark_bodies::box(shape.dimension, shape.extent);
  const double middle = 0.5 * shape.extent[0];
  return benchmark_bodies::box(
      shape.dimension, shape.extent,
      {{ShapeStep::Action::subtract, Disk{{middle, middle}, 0.2 * middle}}});
}

/// Flags of the degrees of freedom that are held.
std::vector<char> held(const Points& points, const BodyShape& shape) {
  std::vector<char> prescribed(points.reference.size(), 0);
  const auto d = std::size_t(shape.dimension), axis = std::size_t(shape.has_hole ? 1 : 0);
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    const double at = points.reference[k - k % d + axis];
    prescribed[k] = at < 3.0 || (shape.has_hole && at > shape.extent[1] - 3.0);
  }
  return prescribed;
}

void measure(const std::string& name, const BodyShape& shape,
             const std::vector<std::string>& wanted) {
  const Points points = points_of(shape);
  Model model = benchmark_bodies::model(points, shape.horizon);
  if (shape.is_cracked) cut(model, points, shape);
  Assembler assembler(points, model, omp_get_max_threads());
  const FreeDofs free(held(points, shape), shape.dimension);
  std::string why_not;
  LinearProblem problem;
  problem.box = std::make_shared<LatticeBox>(lattice_box(points, why_not).value());
  const BlockPattern pattern(model.bonds());
  std::vector<double> b(std::size_t(free.count())), x(b.size());
  std::mt19937_64 engine(3);
  for (double& entry : b) entry = double(engine() >> 11) * 0x1p-52 - 1.0;
  const std::vector<double> at_rest(points.reference.size(), 0.0);

  for (const auto& [solver_name, kind] : solvers) {
    if (std::find(wanted.begin(), wanted.end(), solver_name) == wanted.end()) continue;
    std::unique_ptr<TangentOperator> tangent;
    if (kind.is_stored) {
      tangent = std::make_unique<Tangent>(assembler);
    } else {
      tangent = std::make_unique<MatrixFreeTangent>(assembler);
    }
    const auto solver = make_linear_solver({kind.method, kind.preconditioner}, problem, {}).solver;
    LinearOutcome outcome = LinearOutcome::solved;
    const double analysis = seconds_of([&] { outcome = solver->analyze(pattern, free); });
    const double assembly = seconds_of([&] { tangent->linearise(assembler, at_rest, 0.0); });
    const double build = seconds_of([&] {
      if (outcome == LinearOutcome::solved) {
        outcome = solver->factorize(*tangent, FactorUse::factorize_now);
      }
    });
    const double solve = seconds_of([&] {
      if (outcome == LinearOutcome::solved) outcome = solver->solve(b, x, 1e-8);
    });
    const std::string result = outcome == LinearOutcome::solved
                                   ? std::to_string(solver->last_iterations())
                                   : peristat::name(outcome);
    fmt::print("| {} | {} | {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n", name, points.count(),
               solver_name, result, analysis + assembly, build, solve,
               analysis + assembly + build + solve);
    std::fflush(stdout);
  }
}

/// Names the first word that is not in the list.
template <class List>
bool are_known(const char* what, const std::vector<std::string>& words, const List& list) {
  for (const std::string& word : words) {
    const auto same = [&](const auto& known) { return known.first == word; };
    if (std::any_of(list.begin(), list.end(), same)) continue;
    fmt::print(stderr, "no {} {}: it is one of", what, word);
    for (const auto& known : list) fmt::print(stderr, " {}", known.first);
    fmt::print(stderr, "\n");
    return false;
  }
  return true;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> wanted_bodies, wanted_solvers;
  for (int k = 1; k < count; ++k) {
    const std::string argument = arguments[k];
    if (argument == "--solvers" && k + 1 < count) {
      wanted_solvers = split(arguments[++k]);
    } else {
      wanted_bodies.push_back(argument);
    }
  }
  if (wanted_solvers.empty()) {
    wanted_solvers = {"cholesky", "jacobi", "rigid_pieces", "surrogate", "multigrid"};
  }
  if (wanted_bodies.empty()) wanted_bodies = {"cube-20", "bar-30", "plate-100"};
  if (!are_known("body", wanted_bodies, bodies) || !are_known("solver", wanted_solvers, solvers)) {
    return 2;
  }
  fmt::print(
      "| body | points | solver | iterations | analysis and assembly [s] | build [s] | solve [s] | "
      "total [s] |\n|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, shape] : bodies) {
    if (std::find(wanted_bodies.begin(), wanted_bodies.end(), name) != wanted_bodies.end()) {
      measure(name, shape, wanted_solvers);
    }
  }
  return 0;
}
