#include "solvers/linear/iterative_solver.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "assembly/operators/tangent.hpp"
#include "solvers/linear/assembled_preconditioner.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/rigid_pieces.hpp"
#include "solvers/linear/sines.hpp"
#include "solvers/linear/surrogate.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::BoxSetting;

constexpr KrylovMethod cg = KrylovMethod::conjugate_gradients;

enum class Kind {
  jacobi,
  block_jacobi,
  rigid_pieces,
  surrogate,
  sines,
  riluk,
  chebyshev,
  multigrid
};

std::unique_ptr<Preconditioner> make(Kind kind, const Points& points) {
  std::string why_not;
  switch (kind) {
    case Kind::jacobi:
      return std::make_unique<BlockJacobi>(BlockJacobi::Blocks::entries);
    case Kind::block_jacobi:
      return std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points);
    case Kind::rigid_pieces:
      return std::make_unique<RigidPieces>();
    case Kind::sines:
      return std::make_unique<Sines>(
          std::make_shared<LatticeBox>(lattice_box(points, why_not).value()));
    case Kind::riluk:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::riluk);
    case Kind::chebyshev:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::chebyshev);
    case Kind::multigrid:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::multigrid);
    case Kind::surrogate:
      break;
  }
  return std::make_unique<Surrogate>();
}

std::string name_of(Kind kind) {
  return std::vector<std::string>{
      "jacobi", "block_jacobi", "rigid_pieces", "surrogate",
      "sines",  "riluk",        "chebyshev",    "multigrid"}[std::size_t(kind)];
}

constexpr Kind all_kinds[] = {Kind::jacobi,    Kind::block_jacobi, Kind::rigid_pieces,
                              Kind::surrogate, Kind::sines,        Kind::riluk,
                              Kind::chebyshev, Kind::multigrid};
bool feels_size(Kind kind) {
  return kind == Kind::jacobi || kind == Kind::block_jacobi || kind == Kind::chebyshev;
}

constexpr KrylovMethod all_methods[] = {KrylovMethod::conjugate_gradients, KrylovMethod::minres,
                                        KrylovMethod::gmres};

/// A tangent of a box clamped over `clamped` spacings on the left.
struct System {
  BoxBody body;
  FreeDofs free;
  Tangent tangent;
  std::vector<double> b, x;

  explicit System(const BoxSetting& box, int clamped = 2, int threads = 1)
      : System(BoxBody(box), clamp(BoxBody(box), clamped * box.spacing), threads) {}
  System(BoxBody from, const std::vector<char>& prescribed, int threads = 1)
      : body(std::move(from)),
        free(prescribed, body.points.dimension),
        tangent(BlockPattern(body.model.bonds()), body.points.dimension, threads),
        b(tests::Random(3).vector(std::size_t(free.count()))),
        x(b.size()) {
    linearise(std::vector<double>(body.dofs(), 0.0));
  }

  static std::vector<char> clamp(const BoxBody& body, double width) {
    std::vector<char> prescribed(body.dofs(), 0);
    for (Index i = 0; i < body.points.count(); ++i) {
      if (body.points.position(i)[0] > width) continue;
      for (int c = 0; c < body.points.dimension; ++c) {
        prescribed[std::size_t(i) * body.points.dimension + c] = 1;
      }
    }
    return prescribed;
  }

  void linearise(const std::vector<double>& state) {
    Assembler(body.points, body.model, 1).tangent(state, tangent);
  }

  /// Scales the stiffness of the bonds that begin in the right half.
  void scale_right_half(double by) {
    const BlockPattern& pattern = tangent.pattern;
    const double middle = 0.5 * body.points.position(body.points.count() - 1)[0];
    for (Index i = 0; i < pattern.points(); ++i) {
      if (body.points.position(i)[0] < middle) continue;
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        scale_bond(i, bond, by);
      }
    }
  }

  void scale_bond(Index i, Offset bond, double by) {
    const std::size_t entries = std::size_t(tangent.dimension) * tangent.dimension;
    const std::size_t j = std::size_t(tangent.pattern.partner(i, bond));
    for (std::size_t k = 0; k < entries; ++k) {
      double& entry = tangent.off_diagonal[std::size_t(bond) * entries + k];
      tangent.diagonal[std::size_t(i) * entries + k] -= (by - 1.0) * entry;
      tangent.diagonal[j * entries + k] -= (by - 1.0) * entry;
      entry *= by;
    }
  }

  LinearOutcome solve(LinearSolver& solver, double tolerance = 1e-10,
                      FactorUse use = FactorUse::factorize_now) {
    LinearOutcome outcome = solver.factorize(tangent, use);
    if (outcome == LinearOutcome::solved) outcome = solver.solve(b, x, tolerance);
    return outcome;
  }

  /// Iterations to a tolerance, or -1 with a failure.
  int iterations(Kind kind, double tolerance = 1e-8, KrylovMethod method = cg) {
    IterativeSolver solver(method, make(kind, body.points), 5000);
    EXPECT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
    const LinearOutcome outcome = solve(solver, tolerance);
    EXPECT_EQ(outcome, LinearOutcome::solved) << name_of(kind) << ' ' << name(outcome);
    return outcome == LinearOutcome::solved ? solver.last_iterations() : -1;
  }

  std::vector<double> direct_solution() {
    Cholesky solver;
    EXPECT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
    EXPECT_EQ(solve(solver), LinearOutcome::solved);
    return x;
  }
};

BoxSetting box_of(int dimension, std::array<int, 3> extent, double horizon_ratio = 3.015) {
  BoxSetting box = tests::small_box(dimension);
  box.extent = extent;
  box.horizon_ratio = horizon_ratio;
  return box;
}

/// Cuts the bonds across the plane x = `at`, below the height y = `height` (both in spacings).
BoxBody cracked(const BoxSetting& box, double at, double height) {
  BoxBody body(box);
  body.remove_bonds([&](Index i, Offset bond) {
    const Coordinates a = body.points.position(i),
                      b = body.points.position(body.model.bonds().partner(i, bond));
    return (a[0] - at * box.spacing) * (b[0] - at * box.spacing) < 0.0 &&
           0.5 * (a[1] + b[1]) < height * box.spacing;
  });
  return body;
}

TEST(IterativeSolver, SolvesWhatTheDirectSolverSolves) {
  struct Body {
    std::string name;
    System system;
  };
  std::vector<std::unique_ptr<Body>> bodies;
  const auto add = [&](const std::string& name, auto&&... arguments) -> System& {
    bodies.push_back(std::make_unique<Body>(
        Body{name, System(std::forward<decltype(arguments)>(arguments)...)}));
    return bodies.back()->system;
  };
  add("line", box_of(1, {60, 0, 0}));
  add("plate", box_of(2, {20, 15, 0}));
  add("block", box_of(3, {9, 8, 7}));
  add("short horizon", box_of(3, {9, 8, 7}, 1.5));
  add("slender", box_of(2, {120, 4, 0}));
  add("two threads", box_of(3, {9, 8, 7}), 2, 2);
  const BoxSetting plate = box_of(2, {24, 18, 0});
  add("cracked", cracked(plate, 12.0, 12.0), System::clamp(BoxBody(plate), 2 * plate.spacing));
  BoxSetting cloud = box_of(2, {20, 15, 0});
  cloud.perturbation = 0.3;
  add("cloud", cloud);
  BoxSetting cpd = box_of(2, {14, 10, 0});
  cpd.triangles = 0.5;
  add("triangles", cpd);
  System& deformed = add("deformed", box_of(3, {9, 8, 7}));
  std::vector<double> state(deformed.body.dofs());
  for (std::size_t k = 0; k < state.size(); ++k) {
    state[k] = 0.3 * deformed.body.points.reference[k - k % 3];  // 30 % along each axis from x
  }
  deformed.linearise(state);
  // Single components prescribed, all over the body.
  std::vector<char> some = System::clamp(BoxBody(plate), plate.spacing);
  for (std::size_t k = 0; k < some.size(); k += 7) some[k] = 1;
  add("partly prescribed", BoxBody(plate), some);

  // Faces that may only slide: whole groups of points without one of the motions.
  const BoxSetting block = box_of(3, {9, 8, 7}, 2.015);
  const BoxBody sliding(block);
  std::vector<char> faces(sliding.dofs(), 0);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    faces[k] = sliding.points.reference[k] < 3.0 * block.spacing;
  }
  add("sliding", BoxBody(block), faces);

  for (const auto& body : bodies) {
    System& system = body->system;
    const std::vector<double> expected = system.direct_solution();
    for (const Kind kind : all_kinds) {
      for (const KrylovMethod method : all_methods) {
        SCOPED_TRACE(body->name + ", " + name_of(kind) + ", method " + std::to_string(int(method)));
        IterativeSolver solver(method, make(kind, system.body.points), 5000);
        ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
        const LinearOutcome outcome = system.solve(solver, 1e-12);
        // GMRES forgets at each restart and stalls where the others need many iterations.
        if (body->name == "slender" && method == KrylovMethod::gmres && feels_size(kind)) {
          EXPECT_EQ(outcome, LinearOutcome::inaccurate);
          continue;
        }
        EXPECT_EQ(outcome, LinearOutcome::solved) << name(outcome);
        EXPECT_GT(solver.last_iterations(), 0);
        EXPECT_LE(tests::distance(system.x, expected), 1e-8 * tests::norm(expected));
      }
    }
  }
}

TEST(IterativeSolver, IteratesAlikeWithAndWithoutStoredBlocks) {
  for (const int dimension : {1, 2, 3}) {
    System system(box_of(dimension, {dimension == 1 ? 60 : 12, 10, 8}));
    Assembler assembler(system.body.points, system.body.model, 2);
    MatrixFreeTangent tangent(assembler);
    tangent.linearise(assembler, std::vector<double>(system.body.dofs(), 0.0), 0.0);
    const std::vector<double> expected = system.direct_solution();
    for (const Kind kind :
         {Kind::jacobi, Kind::block_jacobi, Kind::rigid_pieces, Kind::surrogate, Kind::sines}) {
      SCOPED_TRACE(name_of(kind));
      const int stored_iterations = system.iterations(kind, 1e-10);
      IterativeSolver solver(cg, make(kind, system.body.points), 5000);
      ASSERT_EQ(solver.analyze(tangent.pattern, system.free), LinearOutcome::solved);
      ASSERT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
      ASSERT_EQ(solver.solve(system.b, system.x, 1e-10), LinearOutcome::solved);
      EXPECT_NEAR(solver.last_iterations(), stored_iterations, 1);
      EXPECT_LE(tests::distance(system.x, expected), 1e-7 * tests::norm(expected));
    }
  }
}

TEST(IterativeSolver, PreconditionersDoNotFeelSize) {
  // Jacobi's iterations grow with the length of the body; those of the others must not.
  for (const int dimension : {2, 3}) {
    std::vector<int> jacobi, pieces, surrogate;
    for (const int size : dimension == 2 ? std::vector{16, 32, 64} : std::vector{8, 12, 18}) {
      System system(box_of(dimension, {size, size, dimension == 3 ? size : 0}));
      jacobi.push_back(system.iterations(Kind::jacobi));
      pieces.push_back(system.iterations(Kind::rigid_pieces));
      surrogate.push_back(system.iterations(Kind::surrogate));
    }
    EXPECT_GE(jacobi.back(), dimension == 2 ? 200 : 90);
    for (const int iterations : pieces) EXPECT_LE(iterations, 36);
    for (const int iterations : surrogate) EXPECT_LE(iterations, 16);
  }
}

TEST(IterativeSolver, PreconditionersDoNotFeelSlenderness) {
  for (const int length : {40, 160, 400}) {
    System system(box_of(3, {length, 4, 4}));
    EXPECT_LE(system.iterations(Kind::rigid_pieces), 48) << length;
    EXPECT_LE(system.iterations(Kind::surrogate), 18) << length;
  }
  System bar(box_of(3, {160, 4, 4}));
  EXPECT_GE(bar.iterations(Kind::block_jacobi), 300);
}

TEST(IterativeSolver, PreconditionersDoNotFeelCracks) {
  const BoxSetting box = box_of(2, {48, 36, 0});
  // Along the pieces' edges and through their middle.
  for (const double at : {24.0, 25.0, 26.0, 27.0}) {
    System system(cracked(box, at, 24.0), System::clamp(BoxBody(box), 2 * box.spacing));
    EXPECT_LE(system.iterations(Kind::rigid_pieces), 45) << at;
    EXPECT_LE(system.iterations(Kind::surrogate), 18) << at;
    EXPECT_GE(system.iterations(Kind::block_jacobi), 200) << at;
  }
}

TEST(IterativeSolver, HeldFragmentsDoNotSpoilConvergence) {
  // A plate in two, the loose half held by a statically determinate set of pins, and a few loose
  // points that are held in place.
  const BoxSetting box = box_of(2, {48, 36, 0});
  BoxBody body = cracked(box, 25.0, 100.0);
  const Index points = body.points.count();
  std::vector<char> prescribed = System::clamp(body, 2 * box.spacing);
  const std::size_t last = std::size_t(points) - 1;
  prescribed[last * 2] = prescribed[last * 2 + 1] = prescribed[(last - 20) * 2] = 1;
  for (const Index loose : {points / 2, points / 3}) {
    body.remove_bonds([&](Index i, Offset bond) {
      return i == loose || body.model.bonds().partner(i, bond) == loose;
    });
    prescribed[std::size_t(loose) * 2] = prescribed[std::size_t(loose) * 2 + 1] = 1;
  }
  System system(std::move(body), prescribed);
  const std::vector<double> expected = system.direct_solution();
  EXPECT_LE(system.iterations(Kind::rigid_pieces), 60);
  EXPECT_LE(tests::distance(system.x, expected), 1e-4 * tests::norm(expected));
  EXPECT_LE(system.iterations(Kind::surrogate), 25);
  EXPECT_LE(tests::distance(system.x, expected), 1e-4 * tests::norm(expected));
  EXPECT_GE(system.iterations(Kind::block_jacobi), 200);
}

TEST(IterativeSolver, DamagedBondsDivideTheRigidPieces) {
  // Broken bonds keep their place in the pattern, with a block of zeros.
  const BoxSetting box = box_of(2, {48, 36, 0});
  System system(box);
  const BlockPattern& pattern = system.tangent.pattern;
  for (Index i = 0; i < pattern.points(); ++i) {
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
      const Index j = pattern.partner(i, bond);
      const Coordinates a = system.body.points.position(i), b = system.body.points.position(j);
      const double plane = 26.0 * box.spacing;
      if ((a[0] - plane) * (b[0] - plane) >= 0.0 || a[1] + b[1] > 48.0 * box.spacing) continue;
      system.scale_bond(i, bond, 0.0);
    }
  }
  const std::vector<double> expected = system.direct_solution();
  EXPECT_LE(system.iterations(Kind::rigid_pieces), 45);
  EXPECT_LE(tests::distance(system.x, expected), 1e-5 * tests::norm(expected));
  EXPECT_LE(system.iterations(Kind::surrogate), 18);
}

TEST(IterativeSolver, NegativeCurvatureIsTold) {
  for (const Kind kind : all_kinds) {
    SCOPED_TRACE(name_of(kind));
    // A plate compressed by a third along its length has buckled.
    System system(box_of(2, {40, 6, 0}));
    std::vector<double> state(system.body.dofs());
    for (std::size_t k = 0; k < state.size(); k += 2) {
      state[k] = -0.35 * system.body.points.reference[k];
    }
    system.linearise(state);
    Cholesky direct;
    ASSERT_EQ(direct.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    ASSERT_EQ(system.solve(direct), LinearOutcome::not_positive_definite);
    IterativeSolver solver(cg, make(kind, system.body.points), 5000);
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    const LinearOutcome outcome = system.solve(solver);
    if (kind == Kind::multigrid) {
      // On a body this small it is the exact inverse: the solution is found at once, and no
      // negative curvature on the way.
      EXPECT_EQ(outcome, LinearOutcome::solved);
      EXPECT_EQ(solver.last_iterations(), 1);
    } else if (kind == Kind::riluk) {
      EXPECT_EQ(outcome, LinearOutcome::inaccurate);  // there are no incomplete factors
    } else {
      EXPECT_EQ(outcome, LinearOutcome::not_positive_definite);
    }
  }
}

TEST(IterativeSolver, MinresAndGmresSolveIndefiniteSystems) {
  System system(box_of(2, {40, 6, 0}));
  std::vector<double> state(system.body.dofs());
  for (std::size_t k = 0; k < state.size(); k += 2) {
    state[k] = -0.35 * system.body.points.reference[k];
  }
  system.linearise(state);
  for (const KrylovMethod method : {KrylovMethod::minres, KrylovMethod::gmres}) {
    // Only a positive definite preconditioner can be built of an indefinite tangent.
    IterativeSolver solver(method, make(Kind::chebyshev, system.body.points), 5000);
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    const LinearOutcome outcome = system.solve(solver, 1e-8);
    ASSERT_EQ(outcome, LinearOutcome::solved) << name(outcome);
    std::vector<double> full(system.body.dofs()), product(full.size()), residual(system.b.size());
    system.free.extend_by_zero(system.x, full);
    system.tangent.multiply(full, product);
    system.free.restrict_to_free(product, residual);
    EXPECT_LE(tests::distance(residual, system.b), 1.1e-8 * tests::norm(system.b));
  }
}

TEST(IterativeSolver, OutcomesOfWhatCannotBeSolved) {
  for (const Kind kind : all_kinds) {
    SCOPED_TRACE(name_of(kind));
    System system(box_of(2, {20, 15, 0}));
    if (kind != Kind::multigrid) {  // which is exact here
      IterativeSolver impatient(cg, make(kind, system.body.points), 2);
      ASSERT_EQ(impatient.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
      EXPECT_EQ(system.solve(impatient), LinearOutcome::inaccurate);
      EXPECT_EQ(impatient.last_iterations(), 2);
    }

    IterativeSolver solver(cg, make(kind, system.body.points), 500);
    ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
    system.b.assign(system.b.size(), 0.0);
    EXPECT_EQ(system.solve(solver), LinearOutcome::solved);
    EXPECT_EQ(tests::largest(system.x), 0.0);

    system.b[0] = 1.0;
    system.tangent.diagonal.back() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(system.solve(solver), LinearOutcome::singular);
    // A point that nothing holds.
    system.linearise(std::vector<double>(system.body.dofs(), 0.0));
    std::fill(system.tangent.diagonal.end() - 4, system.tangent.diagonal.end(), 0.0);
    EXPECT_EQ(system.solve(solver), LinearOutcome::singular);

    FreeDofs none(std::vector<char>(system.body.dofs(), 1), 2);
    ASSERT_EQ(solver.analyze(system.tangent.pattern, none), LinearOutcome::solved);
    EXPECT_EQ(solver.factorize(system.tangent, FactorUse::factorize_now), LinearOutcome::solved);
    EXPECT_EQ(solver.solve({}, {}, 1e-10), LinearOutcome::solved);
  }
}

TEST(IterativeSolver, KeepsAPreconditionerUntilItIsWorn) {
  System system(box_of(2, {20, 15, 0}));
  IterativeSolver solver(cg, make(Kind::rigid_pieces, system.body.points), 2000);
  ASSERT_EQ(solver.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  ASSERT_EQ(system.solve(solver, 1e-10, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(solver.statistics().factorisations, 1);
  system.scale_right_half(0.5);
  ASSERT_EQ(system.solve(solver, 1e-10, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(solver.statistics().factorisations, 1);
  system.scale_right_half(1e-3);  // this solve wears it out, and the next one builds it anew
  ASSERT_EQ(system.solve(solver, 1e-10, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(solver.statistics().factorisations, 1);
  const int with_the_old = solver.last_iterations();
  ASSERT_EQ(system.solve(solver, 1e-10, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(solver.statistics().factorisations, 2);
  EXPECT_LT(solver.last_iterations(), with_the_old / 1.5);
  // What is too little for the old one is enough for a new one, within the same solve.
  IterativeSolver strict(cg, make(Kind::rigid_pieces, system.body.points), with_the_old * 2 / 3);
  ASSERT_EQ(strict.analyze(system.tangent.pattern, system.free), LinearOutcome::solved);
  system.linearise(std::vector<double>(system.body.dofs(), 0.0));
  ASSERT_EQ(system.solve(strict, 1e-10, FactorUse::may_reuse), LinearOutcome::solved);
  system.scale_right_half(5e-4);
  ASSERT_EQ(system.solve(strict, 1e-10, FactorUse::may_reuse), LinearOutcome::solved);
  EXPECT_EQ(strict.statistics().factorisations, 2);
}

TEST(IterativeSolver, ResidualsAreTrue) {
  System system(box_of(3, {9, 8, 7}));
  for (const Kind kind : all_kinds) {
    SCOPED_TRACE(name_of(kind));
    for (const double tolerance : {1e-2, 1e-6, 1e-12}) {
      ASSERT_GT(system.iterations(kind, tolerance), 0);
      std::vector<double> full(system.body.dofs()), product(full.size()), residual(system.b.size());
      system.free.extend_by_zero(system.x, full);
      system.tangent.multiply(full, product);
      system.free.restrict_to_free(product, residual);
      EXPECT_LE(tests::distance(residual, system.b), 1.1 * tolerance * tests::norm(system.b));
    }
  }
}

}  // namespace
}  // namespace peristat
