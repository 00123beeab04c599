#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/constrained_product.hpp"
#include "assembly/operators/constrained_tangent.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "solvers/linear/rigid_pieces.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "solvers/study/body.hpp"
#include "solvers/study/without_equation.hpp"
#include "src/conditions/pressed_boundary.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/slab.hpp"
#include "tests/bodies.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

constexpr double round_off = 1e-11;

/// A body with its sets, as one rank and as all make it.
struct BodyOfTest {
  std::string name;
  Lattice lattice;
  BodySpecification of;
  std::vector<SetRule> sets{};
  bool has_pressures = false;
};

Part part_of(const BodyOfTest& body) {
  const Communicator& ranks = all_ranks();
  Part slab = make_slab(body.lattice, ranks);
  double reach = reach_of_bonds(slab.points, body.of.surface_correction,
                                bond_setting(body.of, slab.points), ranks);
  if (body.has_pressures) reach = std::max(reach, reach_of_pressures(slab.points));
  std::vector<ImageKind> images = kinds_of_images(body.of, slab.points, ranks);
  Part part = distribute(std::move(slab), body.of.horizon, reach, ranks, 1, std::move(images));
  for (const SetRule& rule : body.sets) part.points.sets[rule.name] = select(part.points, rule);
  return part;
}

Points whole_of(const BodyOfTest& body) {
  Points points = make_points(body.lattice);
  for (const SetRule& rule : body.sets) add_set(points, rule);
  return points;
}

/// Of a plate 1.7 x 2.6 with a hole, or of half of it.
BodyOfTest plate(const std::string& name) {
  BodyOfTest body{name, plate_with_hole().lattice, {}, {}};
  body.of.horizon = 0.3015;
  body.of.material.youngs_modulus = 3.0;
  body.of.material.density = 2.0;
  body.of.supports = {{"below", {"0", "0", {}}}};
  body.sets = {{"upper", "y > 1.6"}, {"inner", "sqrt((x-1.2)^2 + (y-1.7)^2) < 0.55"}};
  return body;
}

std::vector<BodyOfTest> bodies_of_test() {
  std::vector<BodyOfTest> all;
  BodyOfTest regions = plate("regions, fibres, random fields");
  regions.of.surface_correction = SurfaceCorrection::energy;
  regions.of.volume_correction = VolumeCorrection::linear;
  MaterialSpecification stiff = regions.of.material;
  stiff.youngs_modulus = 9.0;
  stiff.fibre = FibreSpecification{30.0, {}, 4.0, {}, {}};
  stiff.scatter = {{ScatterSpecification::Quantity::stiffness, {}, {8.0, 0.3, 5}}};
  regions.of.regions = {{"upper", stiff}};
  all.push_back(regions);
  regions.name = "an interface with constants of its own";
  MaterialSpecification between;
  between.youngs_modulus = 0.5;
  regions.of.interfaces = {{{"upper", "material"}, {}, between}};
  all.push_back(regions);

  BodyOfTest shares = plate("exact shares, another influence");
  shares.of.surface_correction = SurfaceCorrection::volume;
  shares.of.volume_correction = VolumeCorrection::exact_centroids;
  shares.of.material.influence = "gaussian";
  shares.of.material.calibration = Calibration::lattice;
  all.push_back(shares);

  BodyOfTest square = plate("square horizons of a turned lattice");
  square.lattice.angle = 25.0;
  square.of.horizon_shape = HorizonShape::box;
  all.push_back(square);

  BodyOfTest polygons = plate("polygons");
  polygons.lattice.cell_perturbation = 0.2;
  polygons.of.volume_correction = VolumeCorrection::exact;
  all.push_back(polygons);

  BodyOfTest loads = plate("loads");
  using Kind = LoadSpecification::Kind;
  loads.of.loads = {{Kind::body_force, "upper", {"load*x", "y", "0"}},
                    {Kind::total_force, "upper", {"3*load", "1", "0"}},
                    {Kind::gravity, "", {"0", "-9.81", "0"}}};
  LoadSpecification traction{Kind::traction, "", {"load", "2*x", "0"}};
  traction.side = Side{1, 1};
  loads.of.loads.push_back(traction);
  traction.side = Side{0, 1};
  traction.depth = Depth::horizon;
  loads.of.loads.push_back(traction);
  loads.of.eigenstrains.given = {{"inner", "0.01*load"}, {"", "0.002*y"}};
  loads.of.foundations = {{"soil", "upper", {}, {}, {5.0, 7.0, 0.0}, {"0.01*load", "x", "0"}},
                          {"side", "", Side{0, 1}, {3.0, 0.0, 0.0}, {}}};
  all.push_back(loads);

  BodyOfTest pressed = plate("pressures");
  LoadSpecification pressure{Kind::pressure, "inner", {"load*(1+x)", "0", "0"}};
  pressed.of.loads = {pressure};
  pressure.set.clear();
  pressure.side = Side{1, 1};
  pressed.of.loads.push_back(pressure);
  pressed.has_pressures = true;
  all.push_back(pressed);
  return all;
}

/// With images of points beyond planes and periods, and with sets that turn.
std::vector<BodyOfTest> constrained_bodies() {
  std::vector<BodyOfTest> all;
  BodyOfTest half = plate("a plane of symmetry");
  half.of.surface_correction = SurfaceCorrection::energy;
  half.lattice.layers = {{"below", {1, -1}, 3}};
  half.of.constraints.symmetries = {{0, 2.0}};
  half.of.eigenstrains.given = {{"", "0.002*y"}};
  all.push_back(half);

  BodyOfTest between = half;
  between.name = "between two planes, thinner than the horizon";
  between.lattice = lattice_box(2, {2, 26, 0}, {0.1, 0.1, 0.1});
  between.lattice.layers = {{"below", {1, -1}, 3}};
  between.of.surface_correction = SurfaceCorrection::volume;
  between.sets = {};
  between.of.constraints.symmetries = {{0, 0.3}, {0, 0.5}};
  all.push_back(between);

  BodyOfTest cell = plate("a periodic cell");
  cell.of.surface_correction = SurfaceCorrection::volume;
  cell.lattice.layers = {};
  cell.lattice.volumes = CellVolumes::fractional;
  cell.of.volume_correction = VolumeCorrection::linear;
  cell.of.supports = {};
  cell.of.constraints.periods = {{{0, 0.3, 2.0}, {"1e-3*load", "0", "0"}},
                                 {{1, 0.3, 2.9}, {"0", "2e-3*load", "0"}}};
  all.push_back(cell);

  BodyOfTest few = cell;
  few.name = "three points that repeat";
  few.lattice = lattice_box(2, {1, 3, 0}, {0.1, 0.1, 0.1});
  few.of.volume_correction = VolumeCorrection::none;
  few.sets = {};
  few.of.constraints.periods = {{{0, 0.3, 0.4}, {"1e-3*load", "0", "0"}},
                                {{1, 0.3, 0.6}, {"0", {}, "0"}}};
  all.push_back(few);

  BodyOfTest turned = plate("rigid sets that turn");
  turned.of.constraints.rigid_sets = {{"upper", {}, {"0.1*load", {}, "0"}, {"0.2*load", "0", "0"}}};
  all.push_back(turned);

  BodyOfTest sliding = plate("rollers");
  sliding.sets = {{"upper", "y > 2.3"}, {"flank", "x < 0.5 && y > 0.6 && y < 2"}};
  sliding.of.constraints.rollers = {{"upper", "", {}, {}, {1.0, 3.0, 0.0}, "0.1*load*(1+x)"},
                                    {"flank", "", {}, {}, {2.0, -1.0, 0.0}, "free"}};
  all.push_back(sliding);

  // Means of sets that overlap, and over points that a support holds; each over several ranks.
  BodyOfTest means = plate("linear constraints");
  means.sets = {{"upper", "y > 1.6"}, {"column", "x > 0.8 && x < 1"}, {"all", "y > 0"}};
  means.of.constraints.linear = {{"one", {{"upper", {1.0, 0.5, 0.0}}}, "0.02*load"},
                                 {"two", {{"upper", {0.0, 1.0, 0.0}}, {"all", {0.3, -0.2, 0.0}}}},
                                 {"three", {{"column", {1.0, 1.0, 0.0}}}, "-0.01*load"}};
  means.of.constraints.rollers = {{"", "slope", Coordinates{0.9, 2.9, 0.0}, {}, {1.0, 4.0, 0.0}}};
  all.push_back(means);

  BodyOfTest mirrored = half;
  mirrored.name = "linear constraints beside a plane of symmetry";
  mirrored.sets = {{"middle", "x > 1.8 && y > 1"}};
  mirrored.of.constraints.linear = {{"height", {{"middle", {0.2, 1.0, 0.0}}}, "0.02*load"}};
  all.push_back(mirrored);

  BodyOfTest cube{"rollers along lines", lattice_box(3, {5, 6, 7}, {0.1, 0.1, 0.1}), {}, {}};
  cube.lattice.layers = {{"below", {2, -1}, 2}};
  cube.of.horizon = 0.2015;
  cube.of.material.youngs_modulus = 3.0;
  cube.of.supports = {{"below", {"0", "0", "0"}}};
  cube.sets = {{"front", "x > 0.7"}};
  const Coordinates from{0.3, 0.6, 1.0}, to{0.8, 0.6, 1.0};
  cube.of.constraints.rollers = {{"", "edge", from, to, {0.0, 0.0, 1.0}, "-0.01*load"}};
  cube.of.constraints.linear = {{"twist", {{"front", {0.0, 1.0, 0.2}}}, "0.01*load"}};
  all.push_back(cube);

  BodyOfTest turning = plate("a free rigid set that repeats");
  turning.lattice.layers = {{"below", {1, -1}, 3}};
  turning.of.constraints.periods = {{{0, 0.3, 2.0}, {{}, "1e-3*load", "0"}}};
  turning.of.constraints.rigid_sets = {RigidSetSpecification{.set = "inner"}};
  all.push_back(turning);
  return all;
}

/// Expects per point what the whole body has.
void expect_same(const Part& part, const std::vector<double>& mine,
                 const std::vector<double>& whole, std::size_t width, const std::string& what,
                 double tolerance = round_off) {
  const double scale = largest(whole);
  for (Index i = 0; i < part.owned; ++i) {
    for (std::size_t c = 0; c < width; ++c) {
      const double expected = whole[std::size_t(part.number[std::size_t(i)]) * width + c];
      EXPECT_NEAR(mine[std::size_t(i) * width + c], expected, tolerance * scale) << what;
    }
  }
}

/// Energy, and forces folded onto what is followed, in a random state at an end of the programme.
struct Evaluated {
  double energy = 0.0;
  std::vector<double> forces, loads, strain;
};

Evaluated evaluate(const Body& body, const std::function<GlobalIndex(Index)>& number,
                   std::size_t dofs_of_whole) {
  const auto d = std::size_t(body.points.dimension);
  const std::vector<double> random = Random(5).vector(dofs_of_whole, 0.05 * body.points.spacing);
  const Conditions& conditions = *body.conditions;
  const Constraints& constraints = conditions.constraints();
  std::vector<double> u(constraints.dofs());
  for (Index i = 0; i < body.points.own(); ++i) {
    for (std::size_t c = 0; c < d; ++c) {
      u[std::size_t(i) * d + c] = random[std::size_t(number(i)) * d + c];
    }
  }
  conditions.prescribe(1.0, u);
  constraints.move(u);
  if (body.part) {
    const auto first = u.begin() + std::ptrdiff_t(std::size_t(body.part->owned()) * d);
    std::fill(first, u.begin() + std::ptrdiff_t(std::size_t(body.points.own()) * d), 1e3);
    body.part->update_ghosts(u);
  }
  Assembler assembler(body.points, body.model, 1, body.part.get());
  Evaluated found;
  found.forces.resize(u.size());
  found.loads.resize(u.size());
  conditions.external_force(1.0, found.loads);
  const SharedEnvironment environment = conditions.environment(1.0);
  if (environment) found.strain = environment->eigenstretch;
  const History history = assembler.initial_history();
  found.energy = assembler.gradient({u, history, Damage::grows, environment}, found.forces).energy;
  constraints.fold(u, found.loads, found.forces);
  return found;
}

TEST(PartBody, is_that_of_the_whole_body) {
  for (const BodyOfTest& of : bodies_of_test()) {
    SCOPED_TRACE(of.name);
    const auto whole = make_body(whole_of(of), of.of, 1);
    const Part part = part_of(of);
    const auto mine = make_body(part, of.of, all_ranks(), 1);
    const auto d = std::size_t(whole->points.dimension);
    const std::size_t dofs = std::size_t(whole->points.own()) * d;
    const Evaluated expected = evaluate(
        *whole, [](Index i) { return GlobalIndex(i); }, dofs);
    const Evaluated found = evaluate(
        *mine, [&](Index i) { return part.number[std::size_t(i)]; }, dofs);
    EXPECT_GT(expected.energy, 0.0);
    EXPECT_NEAR(found.energy, expected.energy, round_off * expected.energy);
    expect_same(part, found.forces, expected.forces, d, "forces");
    expect_same(part, found.loads, expected.loads, d, "loads");
    EXPECT_EQ(found.strain.empty(), expected.strain.empty());
    if (!found.strain.empty()) expect_same(part, found.strain, expected.strain, 1, "strain");
    EXPECT_EQ(count_bonds(mine->points, mine->model.bonds(), all_ranks()),
              whole->model.bonds().count());
    EXPECT_EQ(mine->region.empty(), whole->region.empty());
    EXPECT_EQ(mine->factors.stiffness.empty(), whole->factors.stiffness.empty());
    for (Index i = 0; i < part.owned; ++i) {
      const auto here = std::size_t(i), there = std::size_t(part.number[here]);
      if (!whole->region.empty()) {
        EXPECT_EQ(mine->region[here], whole->region[there]);
      }
      if (!whole->factors.stiffness.empty()) {
        EXPECT_EQ(mine->factors.stiffness[here], whole->factors.stiffness[there]);
      }
    }
  }
}

/// A state, what is found in it, and the tangent there.
struct InEquations {
  InEquations(const Body& body, const std::function<GlobalIndex(Index)>& number,
              std::size_t dofs_of_whole)
      : free(without_equation(body), body.points.dimension),
        assembler(body.points, body.model, 1, body.part.get()) {
    const Constraints& constraints = body.conditions->constraints();
    const auto d = std::size_t(body.points.dimension);
    const std::size_t of_points = body.points.reference.size();
    const auto random = [&](unsigned seed, double size) {
      const std::vector<double> points = Random(seed).vector(dofs_of_whole, size),
                                handles =
                                    Random(seed + 1).vector(constraints.dofs() - of_points, size);
      std::vector<double> values(constraints.dofs(), 7e3);  // of ghosts and images
      for (Index i = 0; i < body.points.own(); ++i) {
        if (!body.points.owns(i)) continue;
        for (std::size_t c = 0; c < d; ++c) {
          values[std::size_t(i) * d + c] = points[std::size_t(number(i)) * d + c];
        }
      }
      const bool owns_handles = !body.part || body.part->ranks().rank() == 0;
      for (std::size_t k = of_points; owns_handles && k < values.size(); ++k) {
        values[k] = handles[k - of_points];
      }
      return values;
    };
    trial.displacement = random(5, 0.05 * body.points.spacing);
    trial.history = assembler.initial_history();
    body.conditions->prescribe(1.0, trial.displacement);
    trial.environment = body.conditions->environment(1.0);
    std::vector<double> loads(constraints.dofs());
    body.conditions->external_force(1.0, loads);
    const EquilibriumProblem problem{assembler, *body.conditions, free};
    evaluate(problem, loads, trial);
    scale = load_norm(problem, loads, trial, Damage::grows);
    const Sharing* const sharing = body.part.get();
    std::vector<double> factor = random(9, 1.0);
    for (std::size_t dof = 0; dof < factor.size(); ++dof) {
      if (constraints.dependent()[dof]) factor[dof] = 0.0;
    }
    ConstrainedProduct of_products(std::make_unique<Tangent>(assembler), body.points, constraints,
                                   sharing);
    of_products.linearise(assembler, trial.at(), 0.0);
    product_alone.resize(factor.size());
    of_products.multiply(factor, product_alone);
    diagonal_of_product = of_products.diagonal;
    ConstrainedTangent tangent(assembler, constraints, sharing);
    tangent.linearise(assembler, trial.at(), 0.0);
    product.resize(factor.size());
    tangent.multiply(factor, product);
    diagonal = tangent.diagonal;
    row_sums.resize(factor.size());
    tangent.absolute_row_sums(row_sums);
    solve(tangent, body.part.get());
    reactions =
        body.conditions->reactions(trial.gradient, loads, trial.displacement, trial.environment);
    moments = body.conditions->moments(trial.displacement, trial.gradient, loads);
  }

  /// For what has that product, preconditioned by rigid pieces.
  void solve(const TangentOperator& tangent, const Sharing* sharing) {
    IterativeSolver solver(KrylovMethod::conjugate_gradients,
                           std::make_unique<RigidPieces>(sharing), 1000, KrylovOptions{}.restart,
                           sharing ? &sharing->ranks() : nullptr);
    EXPECT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
    EXPECT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
    std::vector<double> b(std::size_t(free.count())), x(b.size());
    free.restrict_to_free(product, b);
    EXPECT_EQ(solver.solve(b, x, 1e-12), LinearOutcome::solved);
    iterations = solver.last_iterations();
    solution.resize(product.size());
    free.extend_by_zero(x, solution);
  }

  FreeDofs free;
  Assembler assembler;
  Trial trial;
  double scale = 0.0;
  std::vector<double> product, product_alone, diagonal, diagonal_of_product, row_sums, solution;
  int iterations = 0;
  std::map<std::string, Coordinates> reactions, moments;
};

void expect_same_sums(const std::map<std::string, Coordinates>& mine,
                      const std::map<std::string, Coordinates>& whole, double scale) {
  EXPECT_EQ(mine.size(), whole.size());
  for (const auto& [name, expected] : whole) {
    const auto found = mine.find(name);
    EXPECT_NE(found, mine.end()) << name;
    const Coordinates share = found == mine.end() ? Coordinates{} : found->second;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(all_ranks().sum(share[c]), expected[c], 1e-9 * scale) << name;
    }
  }
}

TEST(PartBody, follows_as_the_whole_body_does) {
  for (const BodyOfTest& of : constrained_bodies()) {
    SCOPED_TRACE(of.name);
    const auto whole = make_body(whole_of(of), of.of, 1);
    const Part part = part_of(of);
    const auto mine = make_body(part, of.of, all_ranks(), 1);
    const auto d = std::size_t(whole->points.dimension);
    const std::size_t dofs = std::size_t(whole->points.own()) * d;
    const InEquations expected(
        *whole, [](Index i) { return GlobalIndex(i); }, dofs);
    const InEquations found(
        *mine, [&](Index i) { return part.number[std::size_t(i)]; }, dofs);
    EXPECT_EQ(count_bonds(mine->points, mine->model.bonds(), all_ranks()),
              whole->model.bonds().count());
    EXPECT_EQ(all_ranks().sum(double(found.free.count())), double(expected.free.count()));
    EXPECT_GT(expected.trial.stored_energy, 0.0);
    const auto expect_near = [](double one, double other) {
      EXPECT_NEAR(one, other, round_off * std::abs(other));
    };
    expect_near(found.trial.stored_energy, expected.trial.stored_energy);
    expect_near(found.trial.residual_norm, expected.trial.residual_norm);
    expect_near(found.scale, expected.scale);
    expect_same(part, found.trial.displacement, expected.trial.displacement, d, "displacement");
    expect_same(part, found.trial.gradient, expected.trial.gradient, d, "gradient");
    expect_same(part, found.product, expected.product, d, "product");
    expect_same(part, found.product_alone, expected.product, d, "product alone");
    expect_same(part, found.diagonal, expected.diagonal, d * d, "diagonal");
    expect_same(part, found.diagonal_of_product, expected.diagonal, d * d, "its diagonal");
    expect_same(part, found.row_sums, expected.row_sums, d, "sums of rows");
    const auto expect_same_handles = [&](const std::vector<double>& one,
                                         const std::vector<double>& other, std::size_t width,
                                         const std::string& what) {
      const std::size_t here = mine->points.volume.size() * width,
                        there = whole->points.volume.size() * width;
      EXPECT_EQ(one.size() - here, other.size() - there);
      for (std::size_t k = 0; k < other.size() - there; ++k) {
        EXPECT_NEAR(one[here + k], other[there + k], round_off * largest(other)) << what;
      }
    };
    expect_same_handles(found.trial.displacement, expected.trial.displacement, d, "displacement");
    expect_same_handles(found.trial.gradient, expected.trial.gradient, d, "gradient");
    expect_same_handles(found.product, expected.product, d, "product");
    expect_same_handles(found.product_alone, expected.product, d, "product alone");
    expect_same_handles(found.diagonal_of_product, expected.diagonal, d * d, "its diagonal");
    if (all_ranks().rank() == 0) {
      expect_same_handles(found.diagonal, expected.diagonal, d * d, "diagonal");
    }
    expect_same_handles(found.row_sums, expected.row_sums, d, "sums of rows");
    // The same pieces on any number of ranks.
    EXPECT_NEAR(found.iterations, expected.iterations, 1);
    EXPECT_LE(found.iterations, 80);
    expect_same(part, found.solution, expected.solution, d, "solution", 1e-8);
    expect_same_sums(found.reactions, expected.reactions, largest(expected.trial.gradient));
    expect_same_sums(found.moments, expected.moments, largest(expected.trial.gradient));
  }
}

TEST(PartBody, refuses_an_interface_that_no_rank_crosses) {
  BodyOfTest body = plate("two parts far from one another");
  body.sets = {{"low", "y < 0.6"}, {"high", "y > 2.4"}};
  MaterialSpecification other = body.of.material;
  other.youngs_modulus = 5.0;
  body.of.regions = {{"low", other}, {"high", other}};
  body.of.interfaces = {{{"low", "material"}, {}, {}}};
  EXPECT_NE(make_body(part_of(body), body.of, all_ranks(), 1), nullptr);
  body.of.interfaces = {{{"low", "high"}, {}, {}}};
  std::string key;
  try {
    static_cast<void>(make_body(part_of(body), body.of, all_ranks(), 1));
  } catch (const InputError& error) {
    key = error.key();
  }
  EXPECT_EQ(key, "interfaces[0]");
}

}  // namespace
}  // namespace peristat::tests
