#include "solvers/linear/trilinos/krylov.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {

/// Found by argument: in the namespace of the method.
void PrintTo(KrylovMethod method, std::ostream* out) {
  *out << std::vector<std::string>{"ConjugateGradients", "Minres", "Gmres",
                                   "Bicgstab"}[std::size_t(method)];
}

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int size = 40;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

VectorMap map_of(const MatrixXd& matrix) {
  return [&matrix](const double* v, double* result) {
    Eigen::Map<VectorXd>(result, size) = matrix * Eigen::Map<const VectorXd>(v, size);
  };
}

MatrixXd random_matrix(std::uint64_t seed) {
  const std::vector<double> numbers = tests::Random(seed).vector(size * size);
  return Eigen::Map<const MatrixXd>(numbers.data(), size, size);
}

MatrixXd matrix_of(const VectorXd& eigenvalues) {
  const MatrixXd basis = random_matrix(2).householderQr().householderQ();
  return basis * eigenvalues.asDiagonal() * basis.transpose();
}

/// A symmetric matrix with eigenvalues from 1 to 100, of which the first few may be negated.
MatrixXd symmetric_matrix(int negative) {
  VectorXd eigenvalues = VectorXd::LinSpaced(size, 1.0, 100.0);
  eigenvalues.head(negative) *= -1.0;
  return matrix_of(eigenvalues);
}

struct Solve {
  KrylovResult result;
  VectorXd x = VectorXd::Constant(size, 7.0);
};

const std::vector<double>& right_hand_side() {
  static const std::vector<double> b = tests::Random(1).vector(size);
  return b;
}

Solve solve(KrylovMethod method, const VectorMap& matrix, const VectorMap& preconditioner = {},
            double tolerance = 1e-12, int max_iterations = 200,
            const std::vector<double>& b = right_hand_side()) {
  Solve solved;
  solved.result = solve_krylov(size, matrix, preconditioner, b.data(), solved.x.data(),
                               {method, tolerance, max_iterations, size});
  return solved;
}

VectorXd b_vector() { return Eigen::Map<const VectorXd>(right_hand_side().data(), size); }

double true_residual(const MatrixXd& matrix, const VectorXd& x) {
  return (b_vector() - matrix * x).norm() / b_vector().norm();
}

class Krylov : public testing::TestWithParam<KrylovMethod> {};

std::string name_of(const testing::TestParamInfo<KrylovMethod>& tested) {
  return testing::PrintToString(tested.param);
}

INSTANTIATE_TEST_SUITE_P(Methods, Krylov,
                         testing::Values(KrylovMethod::conjugate_gradients, KrylovMethod::minres,
                                         KrylovMethod::gmres, KrylovMethod::bicgstab),
                         name_of);

TEST_P(Krylov, AgreesWithADenseSolve) {
  const MatrixXd matrix = symmetric_matrix(0);
  const MatrixXd jacobi = matrix.diagonal().cwiseInverse().asDiagonal();
  const VectorXd expected = matrix.ldlt().solve(b_vector());
  for (const VectorMap& preconditioner : {VectorMap{}, map_of(jacobi)}) {
    const Solve solved = solve(GetParam(), map_of(matrix), preconditioner);
    EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
    EXPECT_GT(solved.result.iterations, 10);
    EXPECT_LE(solved.result.relative_residual, 1e-12);
    EXPECT_GT(solved.result.relative_residual, 0.0);
    // It may be as small as round-off, which depends on the order of the sums.
    EXPECT_NEAR(solved.result.relative_residual, true_residual(matrix, solved.x), 1e-14);
    // 1e-12 in the residual times the condition number of 100.
    EXPECT_LT((solved.x - expected).norm(), 1e-10 * expected.norm());
  }
}

TEST_P(Krylov, NeedsOneIterationWithTheInverse) {
  const MatrixXd matrix = symmetric_matrix(0), inverse = matrix.inverse();
  const Solve solved = solve(GetParam(), map_of(matrix), map_of(inverse), 1e-10);
  EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
  EXPECT_EQ(solved.result.iterations, 1);
}

TEST_P(Krylov, GivesZeroForAZeroRightHandSide) {
  const MatrixXd matrix = symmetric_matrix(0);
  const Solve solved = solve(GetParam(), map_of(matrix), {}, 1e-12, 10, std::vector(size, 0.0));
  EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
  EXPECT_EQ(solved.result.iterations, 0);
  EXPECT_EQ(solved.result.relative_residual, 0.0);
  EXPECT_EQ(solved.x.norm(), 0.0);
}

TEST_P(Krylov, HandsOverWhatTheLimitAllowed) {
  const MatrixXd matrix = symmetric_matrix(0);
  const Solve few = solve(GetParam(), map_of(matrix), {}, 1e-12, 12);
  EXPECT_EQ(few.result.outcome, KrylovOutcome::iteration_limit);
  EXPECT_EQ(few.result.iterations, 12);
  EXPECT_LT(few.result.relative_residual, 0.5);
  EXPECT_NEAR(few.result.relative_residual, true_residual(matrix, few.x), 1e-12);
  const Solve none = solve(GetParam(), map_of(matrix), {}, 1e-12, 0);
  EXPECT_EQ(none.result.outcome, KrylovOutcome::iteration_limit);
  EXPECT_EQ(none.result.relative_residual, 1.0);
  EXPECT_EQ(none.x.norm(), 0.0);
}

TEST_P(Krylov, BreaksDownAtValuesThatAreNotFinite) {
  const MatrixXd matrix = symmetric_matrix(0), broken = nan * matrix;
  std::vector<double> b = right_hand_side();
  b[3] = nan;
  EXPECT_EQ(solve(GetParam(), map_of(broken)).result.outcome, KrylovOutcome::breakdown);
  EXPECT_EQ(solve(GetParam(), map_of(matrix), map_of(broken)).result.outcome,
            KrylovOutcome::breakdown);
  EXPECT_EQ(solve(GetParam(), map_of(matrix), {}, 1e-12, 10, b).result.outcome,
            KrylovOutcome::breakdown);
}

TEST_P(Krylov, BreaksDownWhereTheResidualCanFallNoFurther) {
  // A singular matrix and a right-hand side outside its range.
  MatrixXd matrix = MatrixXd::Identity(size, size);
  matrix(0, 0) = 0.0;
  const Solve solved = solve(GetParam(), map_of(matrix));
  EXPECT_NE(solved.result.outcome, KrylovOutcome::converged);
  // What remains is that entry of the right-hand side, up to the round-off of two norms.
  EXPECT_GE(solved.result.relative_residual,
            (1.0 - 1e-14) * std::abs(right_hand_side()[0]) / b_vector().norm());
}

TEST_P(Krylov, ReportsWhatItReachedWhenTooMuchIsAsked) {
  const MatrixXd matrix = symmetric_matrix(0);
  const Solve solved = solve(GetParam(), map_of(matrix), {}, 1e-18);
  EXPECT_NE(solved.result.outcome, KrylovOutcome::converged);
  EXPECT_LT(solved.result.relative_residual, 1e-13);
  EXPECT_LT(true_residual(matrix, solved.x), 1e-13);
}

TEST_P(Krylov, LetsNoExceptionOut) {
  const VectorMap throwing = [](const double*, double*) { throw std::runtime_error("thrown"); };
  EXPECT_EQ(solve(GetParam(), throwing).result.outcome, KrylovOutcome::breakdown);
}

TEST_P(Krylov, PrintsNothing) {
  const MatrixXd matrix = symmetric_matrix(0), negative = -matrix, broken = nan * matrix;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  for (const MatrixXd* each : {&matrix, &negative, &broken}) {
    (void)solve(GetParam(), map_of(*each), map_of(negative));
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_P(Krylov, RefinesWhatTheRecursionMissed) {
  // The first products are off by 1e-4. Recursive residuals never learn of it.
  const MatrixXd matrix = symmetric_matrix(0);
  tests::Random noise(5);
  int products = 0;
  const VectorMap rough_at_first = [&](const double* v, double* result) {
    map_of(matrix)(v, result);
    if (++products > 15) return;
    for (int k = 0; k < size; ++k) result[k] *= 1.0 + 1e-4 * noise.number();
  };
  const Solve solved = solve(GetParam(), rough_at_first, {}, 1e-11, 1000);
  EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
  EXPECT_LE(true_residual(matrix, solved.x), 1.01e-11);
  // One run takes 40 iterations at most in exact arithmetic, and not many more in ours.
  EXPECT_GT(solved.result.iterations, solve(GetParam(), map_of(matrix)).result.iterations);
}

struct RoughSolve : Solve {
  int products = 0;        ///< with the matrix itself
  int rough_products = 0;  ///< with the rough matrix
};

RoughSolve solve_roughly(const MatrixXd& matrix, const VectorMap& rough, int max_iterations = 200,
                         const std::vector<double>& b = right_hand_side()) {
  RoughSolve solved;
  const VectorMap counting = [&](const double* v, double* result) {
    ++solved.products;
    map_of(matrix)(v, result);
  };
  KrylovOptions options{KrylovMethod::conjugate_gradients, 1e-12, max_iterations, size};
  options.rough_matrix = [&](const double* v, double* result) {
    ++solved.rough_products;
    rough(v, result);
  };
  solved.result = solve_krylov(size, counting, {}, b.data(), solved.x.data(), options);
  return solved;
}

TEST(ConjugateGradients, RefineWhatARoughMatrixFinds) {
  const MatrixXd matrix = symmetric_matrix(0);
  const MatrixXd rough = matrix.cast<float>().cast<double>();
  const RoughSolve solved = solve_roughly(matrix, map_of(rough));
  EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
  EXPECT_LE(true_residual(matrix, solved.x), 1.01e-12);
  // Both are differences of numbers of the size of b.
  EXPECT_NEAR(solved.result.relative_residual, true_residual(matrix, solved.x), 1e-15);
  EXPECT_LE(solved.products, 7);  // one in every two decades, and at the end
}

/// The product of a matrix and a vector in single precision.
VectorMap in_single(const MatrixXd& matrix) {
  return [&matrix](const double* v, double* result) {
    const Eigen::VectorXf single = Eigen::Map<const VectorXd>(v, size).cast<float>();
    Eigen::Map<VectorXd>(result, size) = (matrix.cast<float>() * single).cast<double>();
  };
}

TEST(ConjugateGradients, TakeNoMoreIterationsWithARoughMatrix) {
  const MatrixXd matrix = matrix_of(VectorXd::LinSpaced(size, 1.0, 10.0));
  const RoughSolve solved = solve_roughly(matrix, in_single(matrix));
  const int usual = solve(KrylovMethod::conjugate_gradients, map_of(matrix)).result.iterations;
  EXPECT_LE(solved.result.iterations, usual + 2);
  EXPECT_EQ(solved.rough_products, solved.result.iterations);
  EXPECT_LE(solved.products, 7);  // one in every two decades, and at the end
}

TEST(ConjugateGradients, GiveARoughMatrixUpWhereTheyConvergeSlowly) {
  const MatrixXd matrix = matrix_of(
      VectorXd::NullaryExpr(size, [](Eigen::Index k) { return std::pow(0.75, double(k)); }));
  const RoughSolve solved = solve_roughly(matrix, in_single(matrix), 1000);
  const int usual =
      solve(KrylovMethod::conjugate_gradients, map_of(matrix), {}, 1e-12, 1000).result.iterations;
  EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
  EXPECT_GT(usual, 60);
  EXPECT_LE(solved.rough_products, 20);
  EXPECT_LE(solved.result.iterations, 1.2 * usual);
}

TEST(ConjugateGradients, KeepARoughMatrixWhereTheResidualRisesFirst) {
  // A load along soft motions, with a little of a stiff one.
  VectorXd eigenvalues = VectorXd::LinSpaced(size, 1.0, 3.0);
  eigenvalues[0] = 1000.0;
  std::vector<double> b(size, 1.0);
  b[0] = 0.3;
  const MatrixXd matrix = eigenvalues.asDiagonal();
  int products = 0;
  double largest = 0.0;
  const VectorMap watched = [&](const double* v, double* result) {
    in_single(matrix)(v, result);
    if (++products == 1) largest = Eigen::Map<VectorXd>(result, size).norm();
  };
  const RoughSolve solved = solve_roughly(matrix, watched, 200, b);
  EXPECT_GT(largest, 20.0);  // of the first direction, the residual: of norm 1
  EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
  EXPECT_GT(solved.result.iterations, 8);
  EXPECT_EQ(solved.rough_products, solved.result.iterations);
}

TEST(ConjugateGradients, MultiplyByARoughMatrixWithinTheRangeOfSinglePrecision) {
  const MatrixXd matrix = symmetric_matrix(0);
  for (const double scale : {1e-60, 1e60}) {
    std::vector<double> b = right_hand_side();
    for (double& entry : b) entry *= scale;
    const RoughSolve solved = solve_roughly(matrix, in_single(matrix), 200, b);
    EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
    EXPECT_LE(true_residual(matrix, solved.x / scale), 1.01e-12);
    EXPECT_LE(solved.products, 7);
  }
}

TEST(ConjugateGradients, GoOnWithTheMatrixWhereARoughOneFails) {
  const MatrixXd matrix = symmetric_matrix(0);
  const MatrixXd negative = -matrix, half = 0.5 * matrix, broken = nan * matrix,
                 far = symmetric_matrix(0) + 30.0 * MatrixXd::Identity(size, size);
  for (const MatrixXd* rough : {&negative, &half, &broken, &far}) {
    const RoughSolve solved = solve_roughly(matrix, map_of(*rough));
    EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
    EXPECT_LE(true_residual(matrix, solved.x), 1.01e-12);
    EXPECT_GT(solved.products, 10);
  }
}

TEST(ConjugateGradients, TellNegativeCurvatureOfTheMatrixAlone) {
  const MatrixXd indefinite = symmetric_matrix(5), definite = symmetric_matrix(0);
  EXPECT_EQ(solve_roughly(indefinite, map_of(definite)).result.outcome,
            KrylovOutcome::negative_curvature);
  EXPECT_EQ(solve_roughly(definite, map_of(indefinite)).result.outcome, KrylovOutcome::converged);
}

TEST(ConjugateGradients, CountTheIterationsWithARoughMatrix) {
  const MatrixXd matrix = symmetric_matrix(0);
  for (const int most : {1, 5, 12}) {
    const RoughSolve solved = solve_roughly(matrix, map_of(matrix), most);
    EXPECT_EQ(solved.result.outcome, KrylovOutcome::iteration_limit);
    EXPECT_EQ(solved.result.iterations, most);
    EXPECT_LT(true_residual(matrix, solved.x), 1.0);
  }
}

TEST(Minres, SolvesIndefiniteSystems) {
  const MatrixXd matrix = symmetric_matrix(7);
  const MatrixXd scaling = VectorXd::LinSpaced(size, 0.5, 2.0).asDiagonal();
  const VectorXd expected = matrix.partialPivLu().solve(b_vector());
  for (const VectorMap& preconditioner : {VectorMap{}, map_of(scaling)}) {
    const Solve solved = solve(KrylovMethod::minres, map_of(matrix), preconditioner);
    EXPECT_EQ(solved.result.outcome, KrylovOutcome::converged);
    EXPECT_LT((solved.x - expected).norm(), 1e-10 * expected.norm());
  }
}

TEST(Gmres, SolvesWithAnUnsymmetricPreconditionerAndRestarts) {
  const MatrixXd matrix = symmetric_matrix(0);
  const MatrixXd preconditioner =
      (matrix + 0.02 * matrix.norm() / size * random_matrix(6)).inverse();
  const VectorXd expected = matrix.ldlt().solve(b_vector());
  VectorXd x(size);
  const KrylovResult result =
      solve_krylov(size, map_of(matrix), map_of(preconditioner), right_hand_side().data(), x.data(),
                   {KrylovMethod::gmres, 1e-12, 200, 4});
  EXPECT_EQ(result.outcome, KrylovOutcome::converged);
  EXPECT_GT(result.iterations, 4);
  EXPECT_LT((x - expected).norm(), 1e-10 * expected.norm());
}

TEST(ConjugateGradientsOfBelos, NameNegativeCurvature) {
  const auto outcome = [](const MatrixXd& matrix) {
    return solve(KrylovMethod::conjugate_gradients, map_of(matrix)).result.outcome;
  };
  EXPECT_EQ(outcome(symmetric_matrix(1)), KrylovOutcome::negative_curvature);
  EXPECT_EQ(outcome(-symmetric_matrix(0)), KrylovOutcome::negative_curvature);
  EXPECT_EQ(outcome(MatrixXd::Zero(size, size)), KrylovOutcome::negative_curvature);
}

TEST(ConjugateGradientsOfBelos, BreakDownWithAnIndefinitePreconditioner) {
  const MatrixXd matrix = symmetric_matrix(0);
  for (const MatrixXd& preconditioner :
       {symmetric_matrix(1), MatrixXd(-matrix), MatrixXd(MatrixXd::Zero(size, size))}) {
    const KrylovOutcome outcome =
        solve(KrylovMethod::conjugate_gradients, map_of(matrix), map_of(preconditioner))
            .result.outcome;
    EXPECT_EQ(outcome, KrylovOutcome::breakdown);
  }
}

TEST(Minres, BreaksDownWithAnIndefinitePreconditioner) {
  const MatrixXd matrix = symmetric_matrix(0), preconditioner = -matrix;
  EXPECT_EQ(solve(KrylovMethod::minres, map_of(matrix), map_of(preconditioner)).result.outcome,
            KrylovOutcome::breakdown);
}

TEST(SolveKrylov, HasNothingToDoWithoutEquations) {
  const KrylovResult result = solve_krylov(0, {}, {}, nullptr, nullptr, {});
  EXPECT_EQ(result.outcome, KrylovOutcome::converged);
  EXPECT_EQ(result.iterations, 0);
}

}  // namespace
}  // namespace peristat
