#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/constrained_product.hpp"
#include "assembly/operators/constrained_tangent.hpp"
#include "assembly/terms/damage.hpp"
#include "solvers/body/body.hpp"
#include "solvers/body/without_equation.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "solvers/linear/rigid_pieces.hpp"
#include "solvers/problem/equilibrium.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "src/conditions/pressed_boundary.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/image_number.hpp"
#include "src/geometry/slab.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"
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
  turning.of.constraints.periods = cell.of.constraints.periods;
  turning.of.constraints.periods.pop_back();
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

/// One of both bodies, and its points' numbers in the whole one.
struct NumberedBody {
  const Body& body;
  std::function<GlobalIndex(Index)> number;
  std::size_t dofs_of_whole;

  /// The same of all points and handles, as their owners have it: what ghosts and images have means
  /// nothing.
  [[nodiscard]] std::vector<double> random(unsigned seed, double size) const {
    const Points& points = body.points;
    const auto d = std::size_t(points.dimension);
    const std::size_t dofs = body.conditions->constraints().dofs();
    const std::vector<double> of_points = Random(seed).vector(dofs_of_whole, size),
                              handles =
                                  Random(seed + 1).vector(dofs - points.reference.size(), size);
    std::vector<double> values(dofs, 7e3);
    for (Index i = 0; i < points.own(); ++i) {
      if (!points.owns(i)) continue;
      for (std::size_t c = 0; c < d; ++c) {
        values[std::size_t(i) * d + c] = of_points[std::size_t(number(i)) * d + c];
      }
    }
    const bool owns_handles = body.index_map->is_first_rank();
    const std::size_t first = points.reference.size();
    for (std::size_t k = first; owns_handles && k < values.size(); ++k) {
      values[k] = handles[k - first];
    }
    return values;
  }

  /// A random state at an end of the programme, all that follows in its place.
  [[nodiscard]] std::vector<double> displacement(unsigned seed, double share_of_spacing) const {
    std::vector<double> u = random(seed, share_of_spacing * body.points.spacing);
    body.conditions->prescribe(1.0, u);
    body.index_map->update_ghosts(u);
    body.conditions->constraints().move(u);
    return u;
  }
};

/// A body as one rank makes it, and as all do.
struct Both {
  explicit Both(const BodyOfTest& of)
      : whole(make_body(whole_of(of), of.of, 1)),
        part(part_of(of)),
        mine(make_body(part, of.of, all_ranks(), 1)),
        d(std::size_t(whole->points.dimension)) {}

  [[nodiscard]] NumberedBody of_whole() const {
    return {*whole, [](Index i) { return GlobalIndex(i); }, dofs()};
  }
  [[nodiscard]] NumberedBody of_mine() const {
    return {*mine, [this](Index i) { return part.number[std::size_t(i)]; }, dofs()};
  }
  [[nodiscard]] std::size_t dofs() const { return std::size_t(whole->points.own()) * d; }

  std::unique_ptr<const Body> whole;
  Part part;
  std::unique_ptr<const Body> mine;
  std::size_t d;
};

/// Energy, and forces folded onto what is followed, in a random state at an end of the programme.
struct Evaluated {
  double energy = 0.0;
  std::vector<double> forces, loads, strain;
};

Evaluated evaluate(const NumberedBody& of) {
  const Body& body = of.body;
  const Conditions& conditions = *body.conditions;
  const Constraints& constraints = conditions.constraints();
  const std::vector<double> u = of.displacement(5, 0.05);
  Assembler assembler(body.points, body.model, 1, *body.index_map);
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
    const Both both(of);
    const auto& [whole, part, mine, d] = both;
    const Evaluated expected = evaluate(both.of_whole()), found = evaluate(both.of_mine());
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

/// Whether what follows depends on points of other ranks, so that no rank has whole rows.
bool slides(const BodySpecification& of) {
  const ConstraintSpecification& constraints = of.constraints;
  return !constraints.rollers.empty() || !constraints.linear.empty();
}

/// A state, what is found in it, and the tangent there.
struct InEquations {
  explicit InEquations(const NumberedBody& of)
      : free(without_equation(of.body), of.body.points.dimension),
        assembler(of.body.points, of.body.model, 1, *of.body.index_map) {
    const Body& body = of.body;
    const Constraints& constraints = body.conditions->constraints();
    trial.displacement = of.random(5, 0.05 * body.points.spacing);
    trial.history = assembler.initial_history();
    body.conditions->prescribe(1.0, trial.displacement);
    trial.environment = body.conditions->environment(1.0);
    std::vector<double> loads(constraints.dofs());
    body.conditions->external_force(1.0, loads);
    const EquilibriumProblem problem{assembler, *body.conditions, free};
    evaluate(problem, loads, trial);
    scale = load_norm(problem, loads, trial, Damage::grows);
    const IndexMap& index_map = *body.index_map;
    std::vector<double> factor = of.random(9, 1.0);
    for (std::size_t dof = 0; dof < factor.size(); ++dof) {
      if (constraints.dependent()[dof]) factor[dof] = 0.0;
    }
    ConstrainedProduct of_products(std::make_unique<Tangent>(assembler), body.points, constraints,
                                   index_map);
    of_products.linearise(assembler, trial.at(), 0.0);
    product_alone.resize(factor.size());
    of_products.multiply(factor, product_alone);
    diagonal_of_product = of_products.diagonal;
    if (!index_map.is_whole() && slides(body.specification)) {
      product = product_alone;
      diagonal = diagonal_of_product;
    } else {
      ConstrainedTangent tangent(assembler, constraints, index_map);
      tangent.linearise(assembler, trial.at(), 0.0);
      product.resize(factor.size());
      tangent.multiply(factor, product);
      diagonal = tangent.diagonal;
      row_sums.resize(factor.size());
      tangent.absolute_row_sums(row_sums);
      solve(tangent, index_map);
    }
    reactions =
        body.conditions->reactions(trial.gradient, loads, trial.displacement, trial.environment);
    moments = body.conditions->moments(trial.displacement, trial.gradient, loads);
  }

  /// For what has that product, preconditioned by rigid pieces.
  void solve(const TangentOperator& tangent, const IndexMap& index_map) {
    IterativeSolver solver(KrylovMethod::conjugate_gradients,
                           std::make_unique<RigidPieces>(index_map), 1000, KrylovOptions{}.restart,
                           index_map.ranks());
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
    const Both both(of);
    const auto& [whole, part, mine, d] = both;
    const InEquations expected(both.of_whole()), found(both.of_mine());
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
    const auto expect_same_handles = [&both](const std::vector<double>& one,
                                             const std::vector<double>& other, std::size_t width,
                                             const std::string& what) {
      const std::size_t here = both.mine->points.volume.size() * width,
                        there = both.whole->points.volume.size() * width;
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
    if (!slides(of.of)) {
      expect_same(part, found.row_sums, expected.row_sums, d, "sums of rows");
      expect_same_handles(found.row_sums, expected.row_sums, d, "sums of rows");
      // The same pieces on any number of ranks.
      EXPECT_NEAR(found.iterations, expected.iterations, 1);
      EXPECT_LE(found.iterations, 80);
      expect_same(part, found.solution, expected.solution, d, "solution", 1e-8);
    }
    expect_same_sums(found.reactions, expected.reactions, largest(expected.trial.gradient));
    expect_same_sums(found.moments, expected.moments, largest(expected.trial.gradient));
  }
}

/// What a rank knows of a bond between two of them: the ends as all know them, and some numbers.
struct SharedBond {
  std::array<GlobalIndex, 3> ends{};  // numbers, and which image of the second it ends at
  std::array<double, 3> known{};
};

/// Of all ranks, as all know them.
std::map<std::array<GlobalIndex, 3>, std::vector<std::array<double, 3>>> told_of(
    const std::vector<SharedBond>& mine) {
  std::vector<double> flat;
  for (const auto& [ends, known] : mine) {
    flat.insert(flat.end(), ends.begin(), ends.end());
    flat.insert(flat.end(), known.begin(), known.end());
  }
  flat = concatenated(all_ranks(), flat);
  std::map<std::array<GlobalIndex, 3>, std::vector<std::array<double, 3>>> told;
  for (auto next = flat.begin(); next != flat.end(); next += 6) {
    told[{GlobalIndex(next[0]), GlobalIndex(next[1]), GlobalIndex(next[2])}].push_back(
        {next[3], next[4], next[5]});
  }
  return told;
}

/// Expects both ranks of each bond between two to know the same of it, to the last bit.
/// @return how many of these go to images
int expect_agreement(const Both& both, const History& history) {
  const Body& body = *both.mine;
  const Points& points = body.points;
  const Bonds& bonds = body.model.bonds();
  const std::span<const double> stretches = bond_stretches(body.model, history);
  std::vector<SharedBond> shared;
  for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
    if (points.owns(i) == points.owns(j)) return;
    GlobalIndex first = both.part.number[std::size_t(i)],
                second = both.part.number[std::size_t(points.source(j))];
    if (!points.is_image(j) && second < first) std::swap(first, second);
    shared.push_back(
        {{first, second, image_number(points, j)},
         {bonds.inverse_length(bond), bonds.weight(bond), stretches[std::size_t(bond)]}});
  });
  int to_images = 0;
  for (const auto& [ends, told] : told_of(shared)) {
    EXPECT_EQ(told.size(), 2u) << ends[0] << " " << ends[1] << " " << ends[2];
    EXPECT_EQ(told.front(), told.back()) << ends[0] << " " << ends[1] << " " << ends[2];
    to_images += ends[2] > 0;
  }
  return to_images;
}

TEST(PartBody, breaks_as_the_whole_body_does) {
  int to_images = 0;
  for (BodyOfTest of : constrained_bodies()) {
    if (slides(of.of)) continue;  // refused with damage
    SCOPED_TRACE(of.name);
    of.of.material.damage.law = DamageLaw::tanh;
    of.of.material.damage.onset = 0.01;
    of.of.material.damage.critical = 0.05;
    of.of.material.damage.rate = 3.0;
    of.of.cracks = {CrackSegment{{0.35, 1.93, 0.0}, {5.0, 1.55, 0.0}}};  // through the plane
    const Both both(of);
    const auto& [whole, part, mine, d] = both;
    Assembler all(whole->points, whole->model, 1),
        here(mine->points, mine->model, 1, *mine->index_map);
    History of_all = all.initial_history(), of_part = here.initial_history();
    Index breaking = 0;
    for (unsigned pass = 0; pass < 3; ++pass) {
      const std::vector<double> u = both.of_whole().displacement(5 + pass, 0.03 + 0.03 * pass),
                                mine_u = both.of_mine().displacement(5 + pass, 0.03 + 0.03 * pass);
      std::vector<double> forces(u.size()), forces_here(mine_u.size());
      const Evaluation expected = all.commit(u, of_all, forces),
                       found = here.commit(mine_u, of_part, forces_here);
      EXPECT_EQ(found.growth.degrading, expected.growth.degrading);
      EXPECT_EQ(found.growth.breaking, expected.growth.breaking);
      EXPECT_NEAR(found.energy, expected.energy, round_off * expected.energy);
      whole->conditions->constraints().fold_images(forces);
      mine->conditions->constraints().fold_images(forces_here);
      expect_same(part, forces_here, forces, d, "forces");
      breaking += expected.growth.breaking;
      std::vector<double> damage(whole->points.volume.size()),
          damage_here(mine->points.volume.size());
      const DamageState state = all.assess(of_all, whole->cut_weight, damage),
                        state_here = here.assess(of_part, mine->cut_weight, damage_here);
      EXPECT_EQ(state_here.broken_bonds, state.broken_bonds);
      EXPECT_NEAR(state_here.dissipated_energy, state.dissipated_energy,
                  round_off * state.dissipated_energy);
      expect_same(part, damage_here, damage, 1, "damage");
      to_images += expect_agreement(both, of_part);
    }
    EXPECT_GT(breaking, 0);
  }
  EXPECT_EQ(to_images > 0, all_ranks().count() > 1);
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
