#pragma once

#include <vector>

#include <Eigen/Dense>

#include "tests/problems.hpp"

namespace peristat::tests {

/// The rows and columns of the free degrees of freedom, both halves.
inline Eigen::MatrixXd dense(const Tangent& tangent, const FreeDofs& free) {
  const int d = tangent.dimension;
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(tangent.dofs(), tangent.dofs());
  for (Index i = 0; i < tangent.pattern.points(); ++i) {
    for (int r = 0; r < d; ++r) {
      for (int c = 0; c < d; ++c) {
        full(i * d + r, i * d + c) = tangent.diagonal[std::size_t(i) * d * d + r * d + c];
      }
    }
    for (Offset bond = tangent.pattern.offset[i]; bond < tangent.pattern.offset[i + 1]; ++bond) {
      const Index j = tangent.pattern.partner[bond];
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

/// A tangent of a body, with some degrees of freedom prescribed.
struct System {
  BoxBody body;
  FreeDofs free;
  Tangent tangent;
  std::vector<double> b, x;

  System(const BoxSetting& box, const std::vector<char>& prescribed,
         const std::vector<double>& state)
      : body(box),
        free(prescribed, box.dimension),
        tangent(Assembler(body.points, body.model, 1)),
        b(Random(3).vector(std::size_t(free.count()))),
        x(std::size_t(free.count()), 1e300) {
    assemble(state);
  }

  void assemble(const std::vector<double>& state) {
    Assembler(body.points, body.model, 1).tangent(state, tangent);
  }

  LinearOutcome solve(LinearSolver& solver, FactorUse use = FactorUse::factorize_now) {
    LinearOutcome outcome = solver.factorize(tangent, use);
    if (outcome == LinearOutcome::solved) outcome = solver.solve(b, x, 1e-12);
    return outcome;
  }
};

/// All components of points at opposite ends, and single components of others.
inline std::vector<char> some_prescribed(const BoxBody& body) {
  const int d = body.points.dimension;
  const int last = body.points.count() - 1;
  std::vector<char> prescribed(body.dofs(), 0);
  for (int point : {0, 1, last / 2, last}) {
    for (int c = 0; c < d; ++c) prescribed[std::size_t(point) * d + c] = 1;
  }
  for (int k = 0; k < d; ++k) prescribed[std::size_t(8 + 2 * k) * d + k] = 1;
  return prescribed;
}

inline double relative_error(const System& system, const Eigen::VectorXd& expected) {
  const Eigen::VectorXd x =
      Eigen::Map<const Eigen::VectorXd>(system.x.data(), Eigen::Index(system.x.size()));
  return (x - expected).norm() / expected.norm();
}

inline Eigen::VectorXd dense_solution(const System& system) {
  return dense(system.tangent, system.free)
      .fullPivLu()
      .solve(Eigen::Map<const Eigen::VectorXd>(system.b.data(), Eigen::Index(system.b.size())));
}

}  // namespace peristat::tests
