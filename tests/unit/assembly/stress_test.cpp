#include "assembly/stress.hpp"

#include <limits>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;

/// Sums of some 1e3 terms in another order, of stretches near 0.1.
constexpr double round_off = 1e4 * std::numeric_limits<double>::epsilon();

/// Perturbed bodies of every dimension, with triangles and tetrahedra.
std::vector<tests::BoxSetting> uneven_boxes() {
  std::vector<tests::BoxSetting> boxes;
  for (const auto& [dimension, triangles, tetrahedra] :
       {std::tuple{1, 0.0, 0.0}, std::tuple{2, 0.0, 0.0}, std::tuple{3, 0.0, 0.0},
        std::tuple{2, 1.0, 0.0}, std::tuple{3, 1.0, 0.0}, std::tuple{3, 0.5, 2.0}}) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.perturbation = 0.2;
    box.triangles = triangles;
    box.tetrahedra = tetrahedra;
    boxes.push_back(box);
  }
  return boxes;
}

TEST(Stress, VirialsAddUpToThoseOfTheForces) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    const std::size_t d = std::size_t(body.points.dimension);
    const std::vector<double> state = body.random_state(3);
    std::vector<double> virials[2];
    for (const int threads : {1, 2}) {
      Assembler assembler(body.points, body.model, threads);
      std::vector<double> gradient(body.dofs());
      ASSERT_FALSE(assembler.gradient(state, gradient).degenerate);
      std::vector<double>& found = virials[threads - 1];
      found.assign(body.dofs() * d, 1.0);  // is overwritten
      assembler.virials(state, found);
      std::vector<double> sum(d * d), acting(d * d);
      for (std::size_t i = 0; i < body.points.volume.size(); ++i) {
        for (std::size_t r = 0; r < d; ++r) {
          for (std::size_t c = 0; c < d; ++c) {
            sum[r * d + c] += found[(i * d + r) * d + c];
            acting[r * d + c] += gradient[i * d + r] * body.points.reference[i * d + c];
          }
        }
      }
      ASSERT_GT(tests::largest(acting), 0.0);
      EXPECT_LT(tests::distance(sum, acting), round_off * tests::norm(acting));
    }
    EXPECT_LT(tests::distance(virials[0], virials[1]), round_off * tests::norm(virials[0]));
  }
}

TEST(Stress, AHomogeneousDeformationIsFoundAtEveryPointWithASymmetricStressInTheMean) {
  const double F[3][3] = {{1.05, 0.02, -0.03}, {-0.04, 0.93, 0.01}, {0.02, 0.05, 1.02}};
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    const std::size_t d = std::size_t(body.points.dimension);
    std::vector<double> displacement(body.dofs());
    for (std::size_t i = 0; i < body.points.volume.size(); ++i) {
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          displacement[i * d + r] +=
              (F[r][c] - (r == c ? 1.0 : 0.0)) * body.points.reference[i * d + c];
        }
      }
    }
    Assembler assembler(body.points, body.model, 2);
    const Stress stress = find_stress(assembler, displacement, {0.0});
    for (std::size_t k = 0; k < stress.deformation_gradient.size(); ++k) {
      const std::size_t r = k / d % d, c = k % d;
      EXPECT_NEAR(stress.deformation_gradient[k], F[r][c], round_off);
      const double mirrored = stress.cauchy[k - r * d - c + c * d + r];
      EXPECT_NEAR(stress.cauchy[k], mirrored, round_off * tests::largest(stress.cauchy));
    }
  }
}

TEST(Stress, PointsWithoutADeformationGradientAreToldSo) {
  tests::BoxSetting box = tests::small_box(1);
  const BoxBody body(box);
  Model loose(Bonds{std::vector<Offset>(body.points.volume.size() + 1), {}, {}});
  loose.add(body.model.terms().front());
  Assembler assembler(body.points, loose, 1);
  const Stress stress = find_stress(assembler, body.random_state(4), {0.0});
  for (std::size_t i = 0; i < stress.von_mises.size(); ++i) {
    EXPECT_FALSE(stress.is_determined[i]);
    EXPECT_EQ(stress.deformation_gradient[i], 1.0);
    EXPECT_EQ(stress.cauchy[i], 0.0);
    EXPECT_NE(stress.first_piola[i], 0.0);
  }
}

}  // namespace
}  // namespace peristat
