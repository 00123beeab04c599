#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/operators/matrix_free_tangent.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/make_index_map.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "solvers/ranks/part_tangent.hpp"
#include "src/geometry/slab.hpp"
#include "src/parallel/index_map.hpp"
#include "tests/bodies.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {

inline constexpr double youngs_modulus = 3.0;  // [Pa]

inline BondPotential law_of(const BondSetting& setting) {
  return Harmonic{micromodulus(youngs_modulus, setting)};
}

/// The whole body, as a single rank has it.
struct Whole {
  Whole(const RanksBody& body, SurfaceCorrection surface)
      : points(make_points(body.lattice)),
        model(make_bonds(points, surface, body.setting(), 1), law_of(body.setting())),
        assembler(points, model, 1) {}

  Points points;
  Model model;
  Assembler assembler;
};

/// This rank's part of the body.
struct OnRanks {
  OnRanks(const RanksBody& body, SurfaceCorrection surface)
      : part(make_part(body, surface)),
        model(make_bonds(part, surface, body.setting(), all_ranks(), 1), law_of(body.setting())),
        index_map(make_index_map(part, all_ranks())),
        energy(part.points, model, 1, index_map),
        matrix_free(energy),
        stored(energy) {}

  /// Matrix-free and stored tangent.
  [[nodiscard]] std::vector<TangentOperator*> tangents() { return {&matrix_free, &stored}; }

  static Part make_part(const RanksBody& body, SurfaceCorrection surface) {
    Part slab = make_slab(body.lattice, all_ranks());
    const double reach = reach_of_bonds(slab.points, surface, body.setting(), all_ranks());
    return distribute(std::move(slab), body.setting().horizon, reach, all_ranks(), 1);
  }

  /// Returns the whole body's values at the points of this part, ghosts included.
  [[nodiscard]] std::vector<double> of_part(const std::vector<double>& whole) const {
    const auto d = std::size_t(part.points.dimension);
    std::vector<double> result;
    for (const GlobalIndex number : part.number) {
      const auto first = whole.begin() + std::ptrdiff_t(std::size_t(number) * d);
      result.insert(result.end(), first, first + std::ptrdiff_t(d));
    }
    return result;
  }
  [[nodiscard]] std::vector<double> without_ghosts(std::vector<double> values) const {
    values.resize(std::size_t(part.owned) * std::size_t(part.points.dimension));
    return values;
  }

  Part part;
  Model model;
  IndexMap index_map;
  Assembler energy;
  PartTangent<MatrixFreeTangent> matrix_free;
  PartTangent<Tangent> stored;
};

/// Expects this rank's values at its owned points to agree with those of the whole body.
inline void expect_near(const OnRanks& ranks, const std::vector<double>& mine,
                        const std::vector<double>& whole, double tolerance) {
  const std::vector<double> here = ranks.without_ghosts(mine);
  const std::vector<double> expected = ranks.without_ghosts(ranks.of_part(whole));
  const double scale = largest(whole);
  EXPECT_GT(scale, 0.0);
  for (std::size_t k = 0; k < here.size(); ++k) {
    EXPECT_NEAR(here[k], expected[k], tolerance * scale);
  }
}

/// Flags and displacements that hold both ends along the last axis and displace the upper one.
struct Pulled {
  /// @param depth of the held ends [spacings]
  Pulled(const Points& points, double low, double high, double depth = 3.0) {
    const auto d = std::size_t(points.dimension);
    flags.assign(points.reference.size(), 0);
    displacement.assign(points.reference.size(), 0.0);
    depth *= points.spacing;
    for (std::size_t k = 0; k < points.reference.size(); k += d) {
      const double at = points.reference[k + d - 1];
      if (at > low + depth && at < high - depth) continue;
      std::fill_n(flags.begin() + std::ptrdiff_t(k), d, char(1));
      if (at >= high - depth) displacement[k + d - 1] = 0.01 * (high - low);
    }
  }
  std::vector<char> flags;
  std::vector<double> displacement;
};

struct Solved {
  LinearOutcome outcome = LinearOutcome::inaccurate;
  int iterations = 0;
  std::vector<double> displacement;
};

/// Solves K d = -K u for prescribed displacements u, and returns u + d.
inline Solved solve(const TangentOperator& tangent, const std::vector<char>& no_equation,
                    const std::vector<double>& prescribed,
                    std::unique_ptr<Preconditioner> preconditioner, const Communicator& ranks,
                    KrylovMethod method = KrylovMethod::conjugate_gradients) {
  const FreeDofs free(no_equation, tangent.dimension);
  IterativeSolver solver(method, std::move(preconditioner), 2000, KrylovOptions{}.restart, ranks);
  EXPECT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
  EXPECT_EQ(solver.factorize(tangent, FactorUse::factorize_now), LinearOutcome::solved);
  std::vector<double> forces(prescribed.size()), b(std::size_t(free.count())), x(b.size());
  tangent.multiply(prescribed, forces);
  free.restrict_to_free(forces, b);
  for (double& entry : b) entry = -entry;
  Solved solved;
  solved.outcome = solver.solve(b, x, 1e-12);
  solved.iterations = solver.last_iterations();
  solved.displacement = prescribed;
  for (std::size_t e = 0; e < x.size(); ++e) {
    solved.displacement[std::size_t(free.dof[e])] += x[e];
  }
  return solved;
}

}  // namespace peristat::tests
