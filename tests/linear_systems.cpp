#include "tests/linear_systems.hpp"

#include <Eigen/Dense>

namespace peristat::tests {
namespace {

/// The rows and columns of the free degrees of freedom, both halves.
Eigen::MatrixXd dense(const Tangent& tangent, const FreeDofs& free) {
  const int d = tangent.dimension;
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(tangent.dofs(), tangent.dofs());
  for (Index i = 0; i < tangent.pattern.points(); ++i) {
    for (int r = 0; r < d; ++r) {
      for (int c = 0; c < d; ++c) {
        full(i * d + r, i * d + c) = tangent.diagonal[std::size_t(i) * d * d + r * d + c];
      }
    }
    for (Offset bond = tangent.pattern.offset[i]; bond < tangent.pattern.offset[i + 1]; ++bond) {
      const Index j = tangent.pattern.partner(i, bond);
      for (int r = 0; r < d; ++r) {
        for (int c = 0; c < d; ++c) {
          const double entry = tangent.entry(bond, r, c);
          full(i * d + r, j * d + c) = full(j * d + c, i * d + r) = entry;
        }
      }
    }
  }
  return full(free.dof, free.dof);
}

}  // namespace

std::vector<double> dense_eigenvalues(const System& system) {
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(system.tangent, system.free))
          .eigenvalues();
  return {values.begin(), values.end()};
}

double solution_error(const System& system) {
  const auto size = Eigen::Index(system.x.size());
  const Eigen::VectorXd expected =
      dense(system.tangent, system.free)
          .fullPivLu()
          .solve(Eigen::Map<const Eigen::VectorXd>(system.b.data(), size));
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(system.x.data(), size);
  return (x - expected).norm() / expected.norm();
}

}  // namespace peristat::tests
