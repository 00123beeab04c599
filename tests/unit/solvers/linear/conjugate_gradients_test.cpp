#include "solvers/linear/conjugate_gradients.hpp"

#include <limits>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int size = 30;

LinearMap map_of(const MatrixXd& matrix) {
  return [&matrix](std::span<const double> v, std::span<double> result) {
    const auto n = Eigen::Index(v.size());
    Eigen::Map<VectorXd>(result.data(), n) = matrix * Eigen::Map<const VectorXd>(v.data(), n);
  };
}

MatrixXd random_matrix(std::uint64_t seed) {
  const std::vector<double> numbers = tests::Random(seed).vector(size * size);
  return Eigen::Map<const MatrixXd>(numbers.data(), size, size);
}

struct System {
  MatrixXd matrix, identity = MatrixXd::Identity(size, size);
  std::vector<double> b = tests::Random(1).vector(size), x = std::vector<double>(size, 7.0);

  System() {
    const MatrixXd root = random_matrix(2);
    matrix = root * root.transpose() + identity;
  }
};

TEST(ConjugateGradients, AgreeWithADenseSolve) {
  System system;
  const VectorXd expected =
      system.matrix.ldlt().solve(Eigen::Map<const VectorXd>(system.b.data(), size));
  for (const MatrixXd& preconditioner :
       {system.identity, MatrixXd(system.matrix.diagonal().cwiseInverse().asDiagonal())}) {
    ConjugateGradients gradients;
    const GradientsResult result = gradients.solve(map_of(system.matrix), map_of(preconditioner),
                                                   system.b, system.x, 1e-13, 10 * size);
    EXPECT_EQ(result.outcome, GradientsOutcome::converged);
    EXPECT_GT(result.iterations, 5);
    const VectorXd x = Eigen::Map<const VectorXd>(system.x.data(), size);
    // 1e-13 in the residual, times a condition number below 100.
    EXPECT_LT((x - expected).norm(), 1e-11 * expected.norm());
  }
}

TEST(ConjugateGradients, NeedOneIterationWithTheInverse) {
  System system;
  const MatrixXd inverse = system.matrix.inverse();
  ConjugateGradients gradients;
  const GradientsResult result =
      gradients.solve(map_of(system.matrix), map_of(inverse), system.b, system.x, 1e-12, 10);
  EXPECT_EQ(result.outcome, GradientsOutcome::converged);
  EXPECT_EQ(result.iterations, 1);
}

TEST(ConjugateGradients, ReportNegativeCurvature) {
  System system;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(system.matrix);
  const MatrixXd indefinite =
      system.matrix - 0.5 * (eigen.eigenvalues()(0) + eigen.eigenvalues()(1)) * system.identity;
  ConjugateGradients gradients;
  const auto solve = [&](const MatrixXd& matrix) {
    return gradients
        .solve(map_of(matrix), map_of(system.identity), system.b, system.x, 1e-12, 10 * size)
        .outcome;
  };
  EXPECT_EQ(solve(indefinite), GradientsOutcome::negative_curvature);
  EXPECT_EQ(solve(-system.matrix), GradientsOutcome::negative_curvature);
  EXPECT_EQ(solve(MatrixXd::Zero(size, size)), GradientsOutcome::negative_curvature);
}

TEST(ConjugateGradients, GiveZeroForAZeroRightHandSide) {
  System system;
  system.b.assign(size, 0.0);
  ConjugateGradients gradients;
  const GradientsResult result = gradients.solve(map_of(system.matrix), map_of(system.identity),
                                                 system.b, system.x, 1e-12, 10);
  EXPECT_EQ(result.outcome, GradientsOutcome::converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(system.x, std::vector<double>(size, 0.0));
}

TEST(ConjugateGradients, ReportTheLimitAndValuesThatAreNotFinite) {
  System system;
  ConjugateGradients gradients;
  const GradientsResult limited =
      gradients.solve(map_of(system.matrix), map_of(system.identity), system.b, system.x, 1e-12, 3);
  EXPECT_EQ(limited.outcome, GradientsOutcome::iteration_limit);
  EXPECT_EQ(limited.iterations, 3);
  const MatrixXd broken = std::numeric_limits<double>::quiet_NaN() * MatrixXd::Ones(size, size);
  EXPECT_EQ(gradients.solve(map_of(broken), map_of(system.identity), system.b, system.x, 1e-12, 10)
                .outcome,
            GradientsOutcome::not_finite);
}

}  // namespace
}  // namespace peristat
