#include "solvers/linear/trilinos/matrix_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/compressed_rows.hpp"
#include "solvers/linear/trilinos/krylov.hpp"
#include "tests/bodies.hpp"

namespace peristat {

/// Found by argument: in the namespace of the kind.
void PrintTo(MatrixPreconditionerKind kind, std::ostream* out) {
  *out << std::vector<std::string>{"Riluk", "Chebyshev", "Multigrid"}[std::size_t(kind)];
}

namespace {

using Kind = MatrixPreconditionerKind;

enum class Support {
  clamped,  ///< the outermost points in x, all components
  roller,   ///< their x, and here and there a component more: most points have an equation less
};

/// A lattice at rest.
struct System {
  tests::BoxBody body;
  FreeDofs free;
  Tangent tangent;
  CompressedRows matrix;
  NearNullSpace motions;
  std::vector<double> b;

  System(int dimension, int points_per_side, Support support = Support::clamped)
      : System(setting(dimension, points_per_side), support) {}

  System(const tests::BoxSetting& box, Support support)
      : body(box),
        free(prescribed(body.points, support), box.dimension),
        tangent(BlockPattern(body.model.bonds()), box.dimension) {
    const std::vector<double> rest(body.dofs(), 0.0);
    Assembler(body.points, body.model, 1).tangent(rest, tangent);
    matrix = compressed_rows(tangent, free);
    motions = rigid_motions(body.points.reference, free);
    b = tests::Random(3).vector(free.dof.size());
  }

  static tests::BoxSetting setting(int dimension, int points_per_side) {
    tests::BoxSetting box;
    box.dimension = dimension;
    box.extent = {points_per_side, points_per_side, dimension == 3 ? points_per_side : 0};
    box.horizon_ratio = 3.015;
    box.cross_section = 1.0;
    return box;
  }

  static std::vector<char> prescribed(const Points& points, Support support) {
    const int d = points.dimension;
    std::vector<char> flags(points.reference.size(), 0);
    for (Index i = 0; i < points.count(); ++i) {
      const bool at_face = points.position(i)[0] < points.spacing;
      for (int c = 0; c < d; ++c) {
        const bool all = support == Support::clamped || i % 7 == 0;
        if (at_face && (c == 0 || all)) flags[std::size_t(i) * d + c] = 1;
      }
      if (support == Support::roller && i % 31 == 5) flags[std::size_t(i) * d + 1] = 1;
    }
    return flags;
  }

  [[nodiscard]] EquationBlocks blocks() const { return equation_blocks(free); }

  [[nodiscard]] VectorMap product() const {
    return [this](const double* v, double* result) {
      for (int row = 0; row < matrix.rows; ++row) {
        double sum = 0.0;
        for (std::size_t k = matrix.begin[row]; k < matrix.begin[row + 1]; ++k) {
          sum += matrix.value[k] * v[matrix.column[k]];
        }
        result[row] = sum;
      }
    };
  }

  [[nodiscard]] KrylovResult solve(const VectorMap& preconditioner, std::vector<double>& x,
                                   double tolerance = 1e-8) const {
    x.resize(b.size());
    return solve_krylov(matrix.rows, product(), preconditioner, b.data(), x.data(),
                        {KrylovMethod::conjugate_gradients, tolerance, 2000, 50});
  }

  /// Iterations of conjugate gradients to a relative residual of 1e-8.
  [[nodiscard]] int iterations(const VectorMap& preconditioner = {}) const {
    std::vector<double> x;
    const KrylovResult result = solve(preconditioner, x);
    EXPECT_EQ(result.outcome, KrylovOutcome::converged);
    return result.iterations;
  }
};

VectorMap map_of(MatrixPreconditioner& preconditioner) {
  return [&](const double* r, double* z) { preconditioner.apply(r, z); };
}

int iterations_with(const System& system, Kind kind, const EquationBlocks& blocks,
                    const NearNullSpace& motions) {
  MatrixPreconditioner preconditioner(kind);
  EXPECT_TRUE(preconditioner.build(system.matrix, blocks, motions)) << preconditioner.failure();
  return system.iterations(map_of(preconditioner));
}

int iterations_with(const System& system, Kind kind) {
  return iterations_with(system, kind, system.blocks(), system.motions);
}

const System& system_of(int dimension, Support support) {
  static const System plate(2, 40, Support::clamped), rolling_plate(2, 40, Support::roller),
      cube(3, 9, Support::clamped), rolling_cube(3, 9, Support::roller);
  if (dimension == 2) return support == Support::clamped ? plate : rolling_plate;
  return support == Support::clamped ? cube : rolling_cube;
}

void PrintTo(Support support, std::ostream* out) {
  *out << (support == Support::clamped ? "Clamped" : "Roller");
}

class MatrixPreconditioners : public testing::TestWithParam<std::tuple<Kind, int, Support>> {
 protected:
  [[nodiscard]] static Kind kind() { return std::get<0>(GetParam()); }
  [[nodiscard]] static const System& system() {
    return system_of(std::get<1>(GetParam()), std::get<2>(GetParam()));
  }
};

std::string name_of(const testing::TestParamInfo<std::tuple<Kind, int, Support>>& tested) {
  const auto [kind, dimension, support] = tested.param;
  return testing::PrintToString(kind) + std::to_string(dimension) + "D" +
         testing::PrintToString(support);
}

INSTANTIATE_TEST_SUITE_P(
    All, MatrixPreconditioners,
    testing::Combine(testing::Values(Kind::riluk, Kind::chebyshev, Kind::multigrid),
                     testing::Values(2, 3), testing::Values(Support::clamped, Support::roller)),
    name_of);

TEST_P(MatrixPreconditioners, GiveTheSolutionOfCholesky) {
  Cholesky direct;
  ASSERT_EQ(direct.analyze(system().tangent.pattern, system().free), LinearOutcome::solved);
  ASSERT_EQ(direct.factorize(system().tangent, FactorUse::factorize_now), LinearOutcome::solved);
  std::vector<double> expected(system().b.size()), x;
  ASSERT_EQ(direct.solve(system().b, expected, 1e-12), LinearOutcome::solved);

  MatrixPreconditioner preconditioner(kind());
  ASSERT_TRUE(preconditioner.build(system().matrix, system().blocks(), system().motions))
      << preconditioner.failure();
  const KrylovResult result = system().solve(map_of(preconditioner), x, 1e-12);
  EXPECT_EQ(result.outcome, KrylovOutcome::converged);
  // 1e-12 in the residual times a condition number of some thousands.
  EXPECT_LT(tests::distance(x, expected), 1e-8 * tests::norm(expected));
}

TEST_P(MatrixPreconditioners, AreSymmetricAndPositive) {
  MatrixPreconditioner preconditioner(kind());
  ASSERT_TRUE(preconditioner.build(system().matrix, system().blocks(), system().motions));
  const std::size_t size = system().b.size();
  const std::vector<double> p = tests::Random(5).vector(size), q = tests::Random(6).vector(size);
  std::vector<double> m_p(size), m_q(size);
  preconditioner.apply(p.data(), m_p.data());
  preconditioner.apply(q.data(), m_q.data());
  const double energy = tests::dot(p, m_p);
  EXPECT_GT(energy, 0.0);
  EXPECT_GT(std::abs(tests::dot(q, m_p)), 1e-6 * energy);  // or there is nothing to compare
  EXPECT_NEAR(tests::dot(q, m_p), tests::dot(p, m_q), 1e-12 * energy);
}

TEST_P(MatrixPreconditioners, SaveMostOfTheIterations) {
  EXPECT_LT(2.5 * iterations_with(system(), kind()), system().iterations());
}

TEST_P(MatrixPreconditioners, PrintNothing) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  (void)iterations_with(system(), kind());
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_P(MatrixPreconditioners, DependOnTheLastMatrixAlone) {
  System other(std::get<1>(GetParam()), 6);
  MatrixPreconditioner used(kind()), fresh(kind());
  ASSERT_TRUE(used.build(system().matrix, system().blocks(), system().motions));
  ASSERT_TRUE(used.build(other.matrix, other.blocks(), other.motions));
  ASSERT_TRUE(fresh.build(other.matrix, other.blocks(), other.motions));
  std::vector<double> z(other.b.size()), expected(other.b.size());
  used.apply(other.b.data(), z.data());
  fresh.apply(other.b.data(), expected.data());
  EXPECT_GT(tests::norm(z), 0.0);
  EXPECT_EQ(z, expected);  // to the last bit

  for (double& value : other.matrix.value) value *= 2.0;
  ASSERT_TRUE(used.build(other.matrix, other.blocks(), other.motions));
  used.apply(other.b.data(), z.data());
  for (double& entry : z) entry *= 2.0;
  EXPECT_LT(tests::distance(z, expected), 1e-10 * tests::norm(expected));
}

TEST_P(MatrixPreconditioners, RefuseWhatHasNone) {
  MatrixPreconditioner preconditioner(kind());
  const CompressedRows empty{0, {0}, {}, {}};
  EXPECT_FALSE(preconditioner.build(empty));
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const CompressedRows matrix{2, {0, 1, 2}, {0, 1}, {1.0, bad}};
    EXPECT_FALSE(preconditioner.build(matrix)) << bad;
    EXPECT_FALSE(preconditioner.failure().empty());
  }
  EXPECT_TRUE(preconditioner.build(system().matrix, system().blocks(), system().motions));
  EXPECT_EQ(preconditioner.failure(), "");
}

TEST_P(MatrixPreconditioners, DescribeThemselves) {
  MatrixPreconditioner preconditioner(kind());
  ASSERT_TRUE(preconditioner.build(system().matrix, system().blocks(), system().motions));
  const std::string library = kind() == Kind::multigrid ? "MueLu" : "Ifpack2";
  EXPECT_NE(preconditioner.describe().find(library), std::string::npos);
}

TEST(Riluk, ReportsAPivotThatIsNotPositive) {
  const CompressedRows indefinite{2, {0, 2, 4}, {0, 1, 0, 1}, {1.0, 2.0, 2.0, 1.0}};
  const CompressedRows singular{2, {0, 2, 4}, {0, 1, 0, 1}, {1.0, 1.0, 1.0, 1.0}};
  MatrixPreconditioner preconditioner(Kind::riluk);
  EXPECT_FALSE(preconditioner.build(indefinite));
  EXPECT_NE(preconditioner.failure().find("pivot"), std::string::npos);
  EXPECT_FALSE(preconditioner.build(singular));
  EXPECT_NE(preconditioner.failure().find("pivot"), std::string::npos);
}

TEST(Riluk, WithTheWholePatternIsTheInverse) {
  // All points of a small plate are neighbours: nothing is left out of the factors.
  tests::BoxSetting box = System::setting(2, 4);
  box.extent[1] = 3;
  box.horizon_ratio = 4.0;
  EXPECT_EQ(iterations_with(System(box, Support::clamped), Kind::riluk), 1);
}

TEST(Multigrid, OnOneLevelIsTheInverse) {
  // Proves the direct solver of the coarsest level.
  for (const Support support : {Support::clamped, Support::roller}) {
    for (const int dimension : {2, 3}) {
      const System system(dimension, dimension == 2 ? 20 : 6, support);
      MatrixPreconditionerOptions options;
      options.largest_coarse_system = 2 * system.matrix.rows;
      MatrixPreconditioner preconditioner(Kind::multigrid, options);
      ASSERT_TRUE(preconditioner.build(system.matrix, system.blocks(), system.motions));
      EXPECT_NE(preconditioner.describe().find("1 level"), std::string::npos);
      EXPECT_EQ(system.iterations(map_of(preconditioner)), 1);
    }
  }
}

TEST(Multigrid, NeedsTheRotations) {
  for (const int dimension : {2, 3}) {
    const System& system = system_of(dimension, Support::clamped);
    const int with = iterations_with(system, Kind::multigrid);
    // Translations are what MueLu takes by itself.
    const int without = iterations_with(system, Kind::multigrid, system.blocks(), {});
    EXPECT_LT(1.3 * with, without);
  }
}

TEST(Multigrid, NeedsThePoints) {
  const System& system = system_of(2, Support::roller);
  const int grouped = iterations_with(system, Kind::multigrid);
  const int single = iterations_with(system, Kind::multigrid, {}, {});
  EXPECT_LT(2 * grouped, single);
  // Prescribing single components costs next to nothing.
  EXPECT_LE(grouped, iterations_with(system_of(2, Support::clamped), Kind::multigrid) + 3);
}

TEST(Multigrid, HardlyKnowsTheSize) {
  std::vector<int> plain, multigrid;
  for (const int points_per_side : {30, 60, 120}) {
    const System system(2, points_per_side);
    plain.push_back(system.iterations());
    multigrid.push_back(iterations_with(system, Kind::multigrid));
  }
  EXPECT_GT(plain[2], 3 * plain[0]);
  EXPECT_LE(*std::max_element(multigrid.begin(), multigrid.end()),
            *std::min_element(multigrid.begin(), multigrid.end()) + 5);
  EXPECT_GT(multigrid[0], 1);  // more than one level
}

TEST(Minres, SolvesAShiftedLatticeWithMultigridOfTheUnshifted) {
  const System& system = system_of(2, Support::clamped);
  // A shift by a small multiple of the diagonal: several eigenvalues turn negative.
  const double shift = 0.003 * system.matrix.value[0];
  const VectorMap shifted = [&](const double* v, double* result) {
    system.product()(v, result);
    for (int row = 0; row < system.matrix.rows; ++row) result[row] -= shift * v[row];
  };
  MatrixPreconditioner preconditioner(Kind::multigrid);
  ASSERT_TRUE(preconditioner.build(system.matrix, system.blocks(), system.motions));
  std::vector<double> x(system.b.size()), image(system.b.size());
  KrylovOptions options{KrylovMethod::conjugate_gradients, 1e-9, 2000, 50};
  EXPECT_EQ(solve_krylov(system.matrix.rows, shifted, map_of(preconditioner), system.b.data(),
                         x.data(), options)
                .outcome,
            KrylovOutcome::negative_curvature);
  options.method = KrylovMethod::minres;
  const KrylovResult result = solve_krylov(system.matrix.rows, shifted, map_of(preconditioner),
                                           system.b.data(), x.data(), options);
  EXPECT_EQ(result.outcome, KrylovOutcome::converged);
  EXPECT_LT(result.iterations, 200);
  shifted(x.data(), image.data());
  EXPECT_LE(tests::distance(image, system.b), 1.01e-9 * tests::norm(system.b));
}

}  // namespace
}  // namespace peristat
