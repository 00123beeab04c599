#include "assembly/assembler.hpp"

#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::distance;
using tests::dot;
using tests::norm;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Bodies of every dimension without symmetry: perturbed points, with corrections and without, with
/// triangles and tetrahedra.
std::vector<tests::BoxSetting> uneven_boxes() {
  std::vector<tests::BoxSetting> boxes;
  for (const auto& [dimension, triangles, tetrahedra, stored] :
       {std::tuple{2, 1.0, 0.0, false}, std::tuple{3, 1.0, 0.0, true},
        std::tuple{3, 0.0, 1.0, false}, std::tuple{3, 0.5, 2.0, true}}) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.perturbation = 0.2;
    box.triangles = triangles;
    box.tetrahedra = tetrahedra;
    box.stored = stored;
    boxes.push_back(box);
  }
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const Quadrature& quadrature :
         {Quadrature{}, Quadrature{VolumeCorrection::linear, SurfaceCorrection::volume},
          Quadrature{VolumeCorrection::linear, SurfaceCorrection::energy}}) {
      tests::BoxSetting box = tests::small_box(dimension);
      box.quadrature = quadrature;
      box.perturbation = 0.2;
      boxes.push_back(box);
    }
  }
  return boxes;
}

std::vector<double> moved(const std::vector<double>& from, double t,
                          const std::vector<double>& along) {
  std::vector<double> result = from;
  for (std::size_t k = 0; k < result.size(); ++k) result[k] += t * along[k];
  return result;
}

TEST(Assembler, GradientIsDerivativeOfEnergy) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(1);
    const std::vector<double> along = tests::Random(2).vector(body.dofs(), body.points.spacing);
    std::vector<double> gradient(body.dofs());
    ASSERT_FALSE(assembler.gradient(state, gradient).degenerate);
    const auto energy = [&](double t) {
      return std::vector<double>{assembler.energy(moved(state, t, along)).energy};
    };
    EXPECT_TRUE(tests::is_derivative(energy, {dot(gradient, along)}, 1e-3)) << box.dimension << "D";
  }
}

TEST(Assembler, ProductIsDerivativeOfGradient) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(1);
    const std::vector<double> along = tests::Random(2).vector(body.dofs(), body.points.spacing);
    std::vector<double> product(body.dofs());
    assembler.product(state, along, product);
    const auto gradient = [&](double t) {
      std::vector<double> result(body.dofs());
      EXPECT_FALSE(assembler.gradient(moved(state, t, along), result).degenerate);
      return result;
    };
    ASSERT_GT(norm(gradient(0.0)), 0.0);
    EXPECT_TRUE(tests::is_derivative(gradient, product, 1e-3)) << box.dimension << "D";
  }
}

TEST(Assembler, TangentIsDerivativeOfGradientInEveryColumn) {
  for (tests::BoxSetting box : uneven_boxes()) {
    const int dimension = box.dimension;
    box.extent = {4, 3, 3};
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 1);
    const std::vector<double> state = body.random_state(3);
    Tangent tangent(Pattern(body.model.bonds), dimension);
    assembler.tangent(state, tangent);
    for (std::size_t dof = 0; dof < body.dofs(); ++dof) {
      std::vector<double> unit(body.dofs(), 0.0), column(body.dofs());
      unit[dof] = body.points.spacing;
      tangent.multiply(unit, column);
      const auto gradient = [&](double t) {
        std::vector<double> result(body.dofs());
        (void)assembler.gradient(moved(state, t, unit), result);
        return result;
      };
      // Nearly flat tetrahedra bend on a smaller scale than bonds.
      EXPECT_TRUE(tests::is_derivative(gradient, column, 5e-4)) << dimension << "D, column " << dof;
    }
  }
}

TEST(Assembler, StoredTangentAndMatrixFreeProductAgree) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(4);
    Tangent tangent(Pattern(body.model.bonds), box.dimension);
    tangent.diagonal.assign(tangent.diagonal.size(), 1e300);  // every entry is overwritten
    tangent.off_diagonal.assign(tangent.off_diagonal.size(), 1e300);
    assembler.tangent(state, tangent);
    const std::vector<double> v = tests::Random(5).vector(body.dofs());
    std::vector<double> stored(body.dofs()), free(body.dofs());
    tangent.multiply(v, stored);
    assembler.product(state, v, free);
    ASSERT_GT(norm(stored), 0.0);
    EXPECT_LE(distance(stored, free), 1e-13 * norm(stored)) << box.dimension << "D";
  }
}

TEST(Assembler, EnergyIsTheDoubleSumOverOrderedPairs) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.perturbation = 0.2;
    Points points = tests::box_points(box);
    tests::Random random(6);
    for (double& volume : points.volume) volume *= 1.0 + 0.5 * random.number();
    const BoxBody body(points, box);
    const std::vector<double> state = body.random_state(7);
    const double modulus = micromodulus(box.youngs_modulus, body.setting);
    // W_i = 1/2 sum_j (c s^2 L / 2) V_j, E = sum_i W_i V_i
    double energy = 0.0;
    std::vector<double> of_point(points.volume.size(), 0.0);
    double most = -1.0;
    for (Index i = 0; i < points.count(); ++i) {
      for (Index j = 0; j < points.count(); ++j) {
        const double reference = tests::reference_distance(points, i, j);
        if (i == j || reference > body.setting.horizon) continue;
        double squared = 0.0;
        for (int c = 0; c < dimension; ++c) {
          const auto at = [&](Index p) {
            return points.position(p)[c] + state[std::size_t(p) * dimension + c];
          };
          squared += (at(j) - at(i)) * (at(j) - at(i));
        }
        const double stretch = std::sqrt(squared) / reference - 1.0;
        most = std::max(most, stretch);
        of_point[i] +=
            0.25 * modulus * stretch * stretch * reference * points.volume[j] * points.volume[i];
      }
      energy += of_point[i];
    }
    Assembler assembler(body.points, body.model, 2);
    const Stored stored = assembler.energy(state);
    ASSERT_GT(energy, 0.0);
    EXPECT_FALSE(stored.degenerate);
    EXPECT_NEAR(stored.energy / energy, 1.0, 1e-13);
    std::vector<double> energies(points.volume.size());
    EXPECT_NEAR(assembler.point_energies(state, energies), most, 1e-14);
    EXPECT_LE(distance(energies, of_point), 1e-13 * norm(of_point));
  }
}

/// Everything that an assembler gives, one after another.
std::vector<double> everything(const BoxBody& body, int threads) {
  Assembler assembler(body.points, body.model, threads);
  EXPECT_EQ(assembler.threads(), threads);
  const std::vector<double> state = body.random_state(8);
  const std::vector<double> v = tests::Random(9).vector(body.dofs());
  std::vector<double> gradient(body.dofs()), product(body.dofs()),
      energies(body.points.volume.size());
  Tangent tangent(Pattern(body.model.bonds), body.points.dimension);
  std::vector<double> all{assembler.gradient(state, gradient).energy};
  assembler.product(state, v, product);
  assembler.tangent(state, tangent);
  all.push_back(assembler.point_energies(state, energies));
  for (const auto* part :
       {&gradient, &product, &energies, &tangent.diagonal, &tangent.off_diagonal}) {
    all.insert(all.end(), part->begin(), part->end());
  }
  return all;
}

TEST(Assembler, GivesTheSameForAnyNumberOfThreadsUpToRoundOff) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    const std::vector<double> one = everything(body, 1);
    ASSERT_GT(norm(one), 0.0);
    const double scale = tests::largest(one);
    for (int threads : {2, 3, 5}) {
      const std::vector<double> several = everything(body, threads);
      ASSERT_EQ(several.size(), one.size());
      for (std::size_t k = 0; k < one.size(); ++k) {
        // Sums of some ten terms in another order.
        ASSERT_NEAR(several[k], one[k], 32 * epsilon * scale) << threads << " threads, " << k;
      }
    }
  }
}

TEST(Assembler, IsReproducibleToTheLastBitForAGivenNumberOfThreads) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    for (int threads : {1, 2, 3, 5}) {
      const std::vector<double> first = everything(body, threads);
      for (int repeat = 0; repeat < 3; ++repeat) EXPECT_EQ(everything(body, threads), first);
    }
  }
}

TEST(Assembler, TakesMoreThreadsThanRows) {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {2, 1, 0};
  const BoxBody body(box);
  const std::vector<double> one = everything(body, 1);
  ASSERT_EQ(body.model.bonds.count(), 1);
  EXPECT_EQ(everything(body, 7), one);
}

TEST(Assembler, EnergyAndGradientTellTheSameEnergy) {
  const BoxBody body(tests::small_box(3));
  Assembler assembler(body.points, body.model, 2);
  std::vector<double> gradient(body.dofs(), 1e300);
  const Stored both = assembler.gradient(body.random_state(1), gradient);
  EXPECT_EQ(assembler.energy(body.random_state(1)).energy, both.energy);
  EXPECT_LT(tests::largest(gradient), 1e300);  // overwritten, not added to
}

TEST(Assembler, ReportsDegenerateStates) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const BoxBody body(tests::small_box(dimension));
    for (int threads : {1, 3}) {
      Assembler assembler(body.points, body.model, threads);
      std::vector<double> gradient(body.dofs()), state(body.dofs(), 0.0);
      EXPECT_FALSE(assembler.gradient(state, gradient).degenerate);
      // One point driven onto a neighbour: the current vector is the difference of equal numbers.
      const Index i = body.points.count() / 2;
      const Index j = body.model.bonds.partner[body.model.bonds.offset[i]];
      for (int c = 0; c < dimension; ++c) {
        state[std::size_t(i) * dimension + c] =
            body.points.position(j)[c] - body.points.position(i)[c];
      }
      EXPECT_TRUE(assembler.gradient(state, gradient).degenerate);
      EXPECT_TRUE(assembler.energy(state).degenerate);
      for (double wrong : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e200}) {
        std::vector<double> broken(body.dofs(), 0.0);
        broken[body.dofs() / 2] = wrong;
        EXPECT_TRUE(assembler.gradient(broken, gradient).degenerate) << wrong;
      }
    }
  }
}

}  // namespace
}  // namespace peristat
