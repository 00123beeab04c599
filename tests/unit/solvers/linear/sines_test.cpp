#include "solvers/linear/sines.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "assembly/operators/tangent.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "solvers/linear/make_linear_solver.hpp"
#include "src/geometry/lattice.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::BoxSetting;

/// Whether a component is held at a place in spacings.
using Held = std::function<bool(const std::array<Index, 3>& place, int component)>;

/// Lattice points of unit spacing with their tangent at rest.
struct System {
  BoxBody body;
  std::shared_ptr<const LatticeBox> box;
  FreeDofs free;
  Assembler assembler;
  MatrixFreeTangent tangent;

  System(const Points& points, const BoxSetting& setting, const Held& held, int threads = 1)
      : body(points, setting),
        box(box_of(points)),
        free(flags(*box, held), points.dimension),
        assembler(body.points, body.model, threads),
        tangent(assembler) {
    linearise(std::vector<double>(body.dofs(), 0.0));
  }

  void linearise(const std::vector<double>& state) { tangent.linearise(assembler, state, 0.0); }

  static std::shared_ptr<const LatticeBox> box_of(const Points& points) {
    std::string why_not;
    return std::make_shared<LatticeBox>(lattice_box(points, why_not).value());
  }
  static std::vector<char> flags(const LatticeBox& box, const Held& held) {
    std::vector<char> flags;
    for (const Index place : box.place) {
      for (int c = 0; c < box.dimension; ++c) flags.push_back(held(box.numbers(place), c));
    }
    return flags;
  }

  int iterations(std::unique_ptr<Preconditioner> preconditioner) {
    IterativeSolver solver(KrylovMethod::conjugate_gradients, std::move(preconditioner), 5000);
    const std::vector<double> b = tests::Random(3).vector(std::size_t(free.count()));
    std::vector<double> x(b.size());
    EXPECT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
    EXPECT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
    EXPECT_EQ(solver.solve(b, x, 1e-8), LinearOutcome::solved);
    return solver.last_iterations();
  }
  int iterations() { return iterations(std::make_unique<Sines>(box)); }
  int jacobi_iterations() {
    return iterations(std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points));
  }
};

BoxSetting setting_of(int dimension, double horizon_ratio = 3.015) {
  BoxSetting setting;
  setting.dimension = dimension;
  setting.spacing = 1.0;
  setting.horizon_ratio = horizon_ratio;
  return setting;
}

Points box_points(const std::array<double, 3>& extent, int dimension, double hole = 0.0) {
  Lattice lattice;
  lattice.dimension = dimension;
  lattice.spacing = 1.0;
  lattice.shapes.push_back({ShapeStep::Action::add, Box{{}, {extent[0], extent[1], extent[2]}}});
  if (hole > 0.0) {
    lattice.shapes.push_back(
        {ShapeStep::Action::subtract, Disk{{0.5 * extent[0], 0.5 * extent[1]}, hole}});
  }
  return make_points(lattice);
}

/// Three layers held at one end, or at both ends of `last` places.
Held at_ends(int axis, Index last = 0) {
  return [=](const std::array<Index, 3>& place, int) {
    return place[axis] < 3 || (last > 0 && place[axis] >= last - 3);
  };
}

TEST(Sines, IterationsOfSquarePlatesWithAHoleFeelNeitherSizeNorHorizon) {
  for (const double ratio : {3.015, 5.1, 8.015}) {
    for (const int size : {50, 100}) {
      System system(box_points({double(size), double(size), 0.0}, 2, 0.1 * size),
                    setting_of(2, ratio), at_ends(1, size));
      EXPECT_LE(system.iterations(), 22) << size << ", " << ratio;
    }
  }
  System large(box_points({200.0, 200.0, 0.0}, 2, 20.0), setting_of(2), at_ends(1, 200));
  EXPECT_LE(large.iterations(), 25);
  EXPECT_GE(large.jacobi_iterations(), 350);
}

TEST(Sines, IterationsOfCubesDoNotFeelSize) {
  for (const double size : {10.0, 20.0}) {
    System system(box_points({size, size, size}, 3), setting_of(3), at_ends(0), 2);
    EXPECT_LE(system.iterations(), 31) << size;
  }
}

TEST(Sines, FindTheHeldSidesOfEachComponent) {
  // One component held on a side of its own each, the others free there.
  const Held sliding = [](const std::array<Index, 3>& place, int c) { return place[c] < 3; };
  System plate(box_points({60.0, 60.0, 0.0}, 2), setting_of(2), sliding);
  EXPECT_LE(plate.iterations(), 22);
  System cube(box_points({12.0, 12.0, 12.0}, 3), setting_of(3, 2.015), sliding);
  EXPECT_LE(cube.iterations(), 22);
  // Held on the part of a side alone, and inside: taken for free, and solved all the same.
  const Held patch = [](const std::array<Index, 3>& place, int) {
    return (place[0] < 2 && place[1] < 20) || (place[0] == 40 && place[1] == 40);
  };
  System held(box_points({60.0, 60.0, 0.0}, 2), setting_of(2), patch);
  EXPECT_LE(held.iterations(), 80);
}

TEST(Sines, NotchesCutOutsAndLShapesAreFilled) {
  Lattice lattice;
  lattice.dimension = 2;
  lattice.spacing = 1.0;
  lattice.shapes = {{ShapeStep::Action::add, Box{{}, {60.0, 60.0}}},
                    {ShapeStep::Action::subtract, Box{{30.0, 30.0}, {61.0, 61.0}}},
                    {ShapeStep::Action::subtract, Box{{-1.0, 20.0}, {12.0, 24.0}}}};
  System system(make_points(lattice), setting_of(2), at_ends(1));
  EXPECT_LE(system.iterations(), 50);
  EXPECT_GE(system.jacobi_iterations(), 150);
}

TEST(Sines, DeformedTrianglesAndPerturbedBodiesAreSolvedAsFast) {
  const Points points = box_points({40.0, 40.0, 0.0}, 2, 6.0);
  System deformed(points, setting_of(2), at_ends(1, 40));
  std::vector<double> state(deformed.body.dofs());
  for (std::size_t k = 1; k < state.size(); k += 2) {
    state[k] = 0.15 * deformed.body.points.reference[k];
  }
  deformed.linearise(state);
  EXPECT_LE(deformed.iterations(), 22);

  BoxSetting perturbed = setting_of(2);
  perturbed.extent = {40, 40, 0};
  perturbed.perturbation = 0.25;
  EXPECT_LE(System(tests::box_points(perturbed), perturbed, at_ends(1, 40)).iterations(), 26);
}

TEST(Sines, TrianglesAreInTheMeanStencil) {
  BoxSetting setting = setting_of(2, 2.015);
  setting.triangles = 0.5;
  const Points points = box_points({24.0, 24.0, 0.0}, 2);
  const BoxBody body(points, setting);
  ASSERT_NE(body.simplex_term(), nullptr);
  const auto box = System::box_of(points);
  const FreeDofs free(System::flags(*box, at_ends(1)), 2);
  Assembler assembler(body.points, body.model, 1);
  Tangent tangent(assembler);
  tangent.linearise(assembler, std::vector<double>(body.dofs(), 0.0), 0.0);
  IterativeSolver solver(KrylovMethod::conjugate_gradients, std::make_unique<Sines>(box), 500);
  const std::vector<double> b = tests::Random(3).vector(std::size_t(free.count()));
  std::vector<double> x(b.size());
  ASSERT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
  ASSERT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
  ASSERT_EQ(solver.solve(b, x, 1e-8), LinearOutcome::solved);
  EXPECT_LE(solver.last_iterations(), 45);
}

/// A chain of springs whose tangent is known: free at both ends, on a foundation.
struct Chain {
  static constexpr Index count = 12;
  static constexpr double foundation = 0.3;
  BoxBody body;
  FreeDofs free;
  Tangent tangent;
  double spring = 0.0;

  Chain()
      : body(box_points({count, 0.0, 0.0}, 1), setting_of(1, 1.1)),
        free(std::vector<char>(body.dofs(), 0), 1),
        tangent(BlockPattern(body.model.bonds()), 1) {
    Assembler(body.points, body.model, 1).tangent(std::vector<double>(body.dofs(), 0.0), tangent);
    spring = -tangent.off_diagonal[0];
    for (double& entry : tangent.diagonal) entry += foundation * spring;
  }
};

TEST(Sines, InvertAFreeChainOfSpringsOnAFoundationModeByMode) {
  // Its modes are cosines, its eigenvalues 2 k (1 - cos) + the foundation's. N - 1 springs stand
  // for N points.
  const Chain chain;
  ASSERT_GT(chain.spring, 0.0);
  Sines sines(System::box_of(chain.body.points));
  sines.analyze(chain.tangent.pattern, chain.free);
  ASSERT_EQ(sines.build(chain.tangent), LinearOutcome::solved);
  constexpr Index n = Chain::count;
  for (Index j = 0; j < n; ++j) {
    const double wave = std::numbers::pi * j / n;
    const double eigenvalue =
        chain.spring *
        (2.0 * (1.0 - std::cos(wave)) * double(n - 1) / double(n) + Chain::foundation);
    std::vector<double> mode, correction(std::size_t(n), 7.0);
    for (Index i = 0; i < n; ++i) mode.push_back(std::cos(wave * (i + 0.5)));
    sines.apply(mode, correction);
    for (Index i = 0; i < n; ++i) {
      EXPECT_NEAR(correction[i] * eigenvalue, mode[i], 2e-7) << j << ", " << i;  // in floats
    }
  }
}

TEST(Sines, AreSymmetricAndPositiveDefinite) {
  const Points points = box_points({14.0, 11.0, 0.0}, 2, 2.5);
  for (const Held& held : {at_ends(0), at_ends(1, 11), Held([](const auto&, int) { return false; }),
                           Held([](const auto&place, int c) { return c == 0 || place[1] < 3; })}) {
    System system(points, setting_of(2), held, 2);
    Sines sines(system.box);
    sines.analyze(system.tangent.pattern, system.free);
    ASSERT_EQ(sines.build(system.tangent), LinearOutcome::solved);
    const std::size_t count = std::size_t(system.free.count());
    const std::vector<double> a = tests::Random(1).vector(count),
                              b = tests::Random(2).vector(count);
    std::vector<double> to_a(count), to_b(count);
    sines.apply(a, to_a);
    sines.apply(b, to_b);
    EXPECT_GT(tests::dot(a, to_a), 0.0);
    EXPECT_NEAR(tests::dot(a, to_b), tests::dot(b, to_a),
                1e-13 * tests::norm(a) * tests::norm(to_b));
  }
}

TEST(Sines, StiffnessAgainstTranslationsIsInTheSymbol) {
  // What the inertia of a small time step adds: the body is nearly diagonal.
  BoxBody body(box_points({30.0, 30.0, 0.0}, 2), setting_of(2));
  const auto box = System::box_of(body.points);
  const FreeDofs free(System::flags(*box, at_ends(0)), 2);
  Tangent tangent(BlockPattern(body.model.bonds()), 2);
  Assembler(body.points, body.model, 1).tangent(std::vector<double>(body.dofs(), 0.0), tangent);
  const double mass = 3.0 * tangent.diagonal[0];
  for (std::size_t k = 0; k < tangent.diagonal.size(); k += 4) {
    tangent.diagonal[k] += mass;
    tangent.diagonal[k + 3] += mass;
  }
  IterativeSolver solver(KrylovMethod::conjugate_gradients, std::make_unique<Sines>(box), 500);
  const std::vector<double> b = tests::Random(3).vector(std::size_t(free.count()));
  std::vector<double> x(b.size());
  ASSERT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
  ASSERT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
  ASSERT_EQ(solver.solve(b, x, 1e-8), LinearOutcome::solved);
  EXPECT_LE(solver.last_iterations(), 10);
}

TEST(Sines, AreTheFirstRungWhereABoxIsGivenAndGiveWayToRigidPieces) {
  LinearProblem problem;
  problem.bonds = 1e6;
  problem.factor_flops = 1e12;
  problem.factor_bytes = 1e9;
  problem.is_stored = false;
  const auto ladder_for = [&](System& system, std::string& told) {
    problem.box = system.box;
    ChosenSolver chosen = make_linear_solver({}, problem, [&](const auto& why) { told = why; });
    EXPECT_FALSE(chosen.is_direct);
    EXPECT_EQ(chosen.solver->analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    const std::vector<double> b = tests::Random(3).vector(std::size_t(system.free.count()));
    std::vector<double> x(b.size());
    EXPECT_EQ(chosen.solver->factorize(system.tangent, FactorUse::factorize_now),
              LinearOutcome::solved);
    EXPECT_EQ(chosen.solver->solve(b, x, 1e-8), LinearOutcome::solved);
    return std::move(chosen.solver);
  };
  std::string told;
  System plate(box_points({30.0, 30.0, 0.0}, 2), setting_of(2), at_ends(0));
  EXPECT_EQ(ladder_for(plate, told)->rung(), 0);
  EXPECT_EQ(told, "");
  // A slender bar, for which nobody should give a box, takes more iterations than they are given.
  System bar(box_points({160.0, 4.0, 4.0}, 3), setting_of(3), at_ends(0));
  const auto solver = ladder_for(bar, told);
  EXPECT_EQ(solver->rung(), 1);
  EXPECT_NE(told.find("pcg with sines"), std::string::npos) << told;
  EXPECT_NE(solver->describe().find("rigid pieces"), std::string::npos);
}

TEST(Sines, AreNoneWhereNothingIsStiffOrDegreesOfFreedomAreNotThePoints) {
  const Chain chain;
  Tangent soft = chain.tangent;
  soft.clear();
  Sines sines(System::box_of(chain.body.points));
  sines.analyze(soft.pattern, chain.free);
  EXPECT_EQ(sines.build(soft), LinearOutcome::inaccurate);
  const FreeDofs more(std::vector<char>(chain.body.dofs() + 1, 0), 1);
  EXPECT_THROW(sines.analyze(soft.pattern, more), std::logic_error);
}

}  // namespace
}  // namespace peristat
