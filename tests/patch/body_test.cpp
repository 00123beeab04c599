// What every elastic body must satisfy whatever its lattice, corrections and dimension.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using tests::BoxBody;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

struct Setting {
  int dimension;
  tests::Quadrature quadrature;
  double perturbation;
  double triangles = 0.0, tetrahedra = 0.0;  ///< stiffness, see BoxSetting
};

std::string words(const Setting& setting) {
  const auto& [dimension, quadrature, perturbation, triangles, tetrahedra] = setting;
  std::string text = std::to_string(dimension) + "D";
  if (quadrature.volume == VolumeCorrection::linear) text += "Linear";
  if (quadrature.volume == VolumeCorrection::exact) text += "Exact";
  if (quadrature.volume == VolumeCorrection::exact_centroids) text += "ExactCentroids";
  if (quadrature.surface == SurfaceCorrection::volume) text += "VolumeMethod";
  if (quadrature.surface == SurfaceCorrection::energy) text += "EnergyMethod";
  if (triangles > 0.0) text += "Triangles";
  if (tetrahedra > 0.0) text += "Tetrahedra";
  return text + (perturbation > 0.0 ? "Perturbed" : "");
}

std::string label(const ::testing::TestParamInfo<Setting>& info) { return words(info.param); }

void PrintTo(const Setting& setting, std::ostream* out) { *out << words(setting); }

std::vector<Setting> all_settings() {
  std::vector<Setting> settings;
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (auto volume : {VolumeCorrection::none, VolumeCorrection::linear}) {
      for (auto surface :
           {SurfaceCorrection::none, SurfaceCorrection::volume, SurfaceCorrection::energy}) {
        for (double perturbation : {0.0, 0.2}) {
          settings.push_back({dimension, {volume, surface}, perturbation});
        }
      }
    }
  }
  for (int dimension = 1; dimension <= 3; ++dimension) {
    settings.push_back({dimension, {VolumeCorrection::exact, SurfaceCorrection::energy}, 0.0});
    settings.push_back(
        {dimension, {VolumeCorrection::exact_centroids, SurfaceCorrection::none}, 0.0});
  }
  for (double perturbation : {0.0, 0.1}) {
    settings.push_back({2, {}, perturbation, 1.0, 0.0});
    settings.push_back({3, {}, perturbation, 1.0, 0.0});
    settings.push_back({3, {}, perturbation, 0.0, 1.0});
    settings.push_back({3, {}, perturbation, 0.5, 2.0});
  }
  return settings;
}

class ElasticBody : public ::testing::TestWithParam<Setting> {
 protected:
  static tests::BoxSetting box() {
    tests::BoxSetting result = tests::small_box(GetParam().dimension);
    result.quadrature = GetParam().quadrature;
    result.perturbation = GetParam().perturbation;
    result.triangles = GetParam().triangles;
    result.tetrahedra = GetParam().tetrahedra;
    return result;
  }

  const int d_ = GetParam().dimension;
  BoxBody body_{box()};
  Assembler assembler_{body_.points, body_.model, 2};

  void SetUp() override { ASSERT_GT(body_.model.bonds().count(), 30); }

  std::vector<double> gradient(const std::vector<double>& displacement) {
    std::vector<double> result(body_.dofs());
    EXPECT_FALSE(assembler_.gradient(displacement, result).degenerate);
    return result;
  }

  Vector3d reference(Index i) const {
    const Coordinates at = body_.points.position(i);
    return {at[0], at[1], at[2]};
  }

  /// Displacements of the map X -> matrix X + shift; components beyond the dimension are left out.
  std::vector<double> mapped(const Matrix3d& matrix, const Vector3d& shift) const {
    std::vector<double> result(body_.dofs());
    for (Index i = 0; i < body_.points.count(); ++i) {
      const Vector3d u = matrix * reference(i) + shift - reference(i);
      for (int c = 0; c < d_; ++c) result[std::size_t(i) * d_ + c] = u(c);
    }
    return result;
  }

  /// Rotations of the dimension by large angles, none in 1D.
  Matrix3d rotation(double angle) const {
    if (d_ == 1) return Matrix3d::Identity();
    const Vector3d axis = d_ == 2 ? Vector3d(0, 0, 1) : Vector3d(2, 3, 6) / 7.0;
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  }

  /// The infinitesimal rigid motions as columns: translations, and rotations about the axes.
  MatrixXd rigid_motions() const {
    const int modes = d_ * (d_ + 1) / 2;
    MatrixXd result = MatrixXd::Zero(Eigen::Index(body_.dofs()), modes);
    for (Index i = 0; i < body_.points.count(); ++i) {
      for (int c = 0; c < d_; ++c) result(i * d_ + c, c) = 1.0;
      for (int m = d_; m < modes; ++m) {
        const Vector3d axis = d_ == 2 ? Vector3d::UnitZ() : Vector3d(Vector3d::Unit(m - d_));
        const Vector3d u = axis.cross(reference(i));
        for (int c = 0; c < d_; ++c) result(i * d_ + c, m) = u(c);
      }
    }
    return result;
  }

  /// All columns of the matrix-free product.
  MatrixXd tangent(const std::vector<double>& displacement) {
    const auto dofs = Eigen::Index(body_.dofs());
    MatrixXd result(dofs, dofs);
    std::vector<double> unit(body_.dofs(), 0.0), column(body_.dofs());
    for (Eigen::Index k = 0; k < dofs; ++k) {
      unit[std::size_t(k)] = 1.0;
      assembler_.product(displacement, unit, column);
      unit[std::size_t(k)] = 0.0;
      result.col(k) = Eigen::Map<const Eigen::VectorXd>(column.data(), dofs);
    }
    return result;
  }
};

TEST_P(ElasticBody, RigidMotionLeavesNoForce) {
  const double reference = tests::largest(gradient(body_.random_state(1)));
  ASSERT_GT(reference, 0.0);
  for (double angle : {0.3, 1.7, 3.1}) {
    const Vector3d shift(0.7, -1.1, 0.4);
    const std::vector<double> moved = mapped(rotation(angle), shift);
    ASSERT_GT(tests::largest(moved), 0.1);
    // Positions of order one round off by eps, strains by eps over a bond's length of 0.1; strains
    // of the reference state are some tenths.
    EXPECT_LT(tests::largest(gradient(moved)), 300 * epsilon * reference);
    EXPECT_LT(assembler_.energy(moved).energy,
              1e-20 * assembler_.energy(body_.random_state(1)).energy);
  }
}

TEST_P(ElasticBody, EnergyIsInvariantUnderRigidMotion) {
  const std::vector<double> state = body_.random_state(2);
  std::vector<double> moved(body_.dofs());
  const Matrix3d turn = rotation(2.2);
  for (Index i = 0; i < body_.points.count(); ++i) {
    Vector3d u = Vector3d::Zero();
    for (int c = 0; c < d_; ++c) u(c) = state[std::size_t(i) * d_ + c];
    const Vector3d place = turn * (reference(i) + u) + Vector3d(0.3, 0.2, -0.5);
    for (int c = 0; c < d_; ++c) moved[std::size_t(i) * d_ + c] = place(c) - reference(i)(c);
  }
  const double energy = assembler_.energy(state).energy;
  ASSERT_GT(energy, 0.0);
  EXPECT_NEAR(assembler_.energy(moved).energy / energy, 1.0, 1e-12);
}

TEST_P(ElasticBody, ForcesAndMomentsSumToZero) {
  const std::vector<double> state = body_.random_state(3), force = gradient(state);
  Vector3d sum = Vector3d::Zero(), moment = Vector3d::Zero();
  double force_size = 0.0, moment_size = 0.0;
  for (Index i = 0; i < body_.points.count(); ++i) {
    Vector3d f = Vector3d::Zero(), x = reference(i);
    for (int c = 0; c < d_; ++c) {
      f(c) = force[std::size_t(i) * d_ + c];
      x(c) += state[std::size_t(i) * d_ + c];
    }
    sum += f;
    moment += x.cross(f);
    force_size += f.norm();
    moment_size += x.norm() * f.norm();
  }
  ASSERT_GT(force_size, 0.0);
  EXPECT_LT(sum.norm(), 100 * epsilon * force_size);
  ASSERT_GT(moment_size, 0.0);
  EXPECT_LT(moment.norm(), 100 * epsilon * moment_size);
}

TEST_P(ElasticBody, TangentIsSymmetric) {
  const MatrixXd k = tangent(body_.random_state(4));
  const double largest = k.cwiseAbs().maxCoeff();
  ASSERT_GT(largest, 0.0);
  EXPECT_LT((k - k.transpose()).cwiseAbs().maxCoeff(), 100 * epsilon * largest);
}

TEST_P(ElasticBody, TangentAtTheReferenceHasOnlyTheRigidMotionsAsNullSpace) {
  const MatrixXd k = tangent(std::vector<double>(body_.dofs(), 0.0));
  const MatrixXd rigid = rigid_motions();
  ASSERT_EQ(Eigen::FullPivLU<MatrixXd>(rigid).rank(), rigid.cols());
  EXPECT_LT((k * rigid).cwiseAbs().maxCoeff(), 100 * epsilon * k.cwiseAbs().maxCoeff());
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(k).eigenvalues();
  const double largest = eigenvalues.maxCoeff();
  ASSERT_GT(largest, 0.0);
  for (Eigen::Index m = 0; m < eigenvalues.size(); ++m) {
    if (m < rigid.cols()) {
      EXPECT_LT(std::abs(eigenvalues(m)), 1e-13 * largest);
    } else {
      EXPECT_GT(eigenvalues(m), 1e-5 * largest);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllCorrections, ElasticBody, ::testing::ValuesIn(all_settings()), label);

/// Under a homogeneous deformation the bonds of a point with all its neighbours come in pairs of
/// opposite direction and equal stretch. A surface correction breaks the pairs near surfaces; it
/// leaves those whose neighbours have all their neighbours, too.
class HomogeneousDeformation : public ElasticBody {};

TEST_P(HomogeneousDeformation, IsInEquilibriumAtInteriorPoints) {
  tests::BoxSetting setting = box();
  setting.extent = {14, 13, d_ == 3 ? 13 : 0};
  const BoxBody body(setting);
  Assembler assembler(body.points, body.model, 2);
  // Weights that depend on the points' own neighbourhoods differ up to two horizons from surfaces.
  const bool corrected =
      setting.quadrature.surface != SurfaceCorrection::none || body.simplex_term();
  // A cell's half beside the horizon belongs to the neighbourhood with the linear correction.
  const double margin = (setting.horizon_ratio + 0.5) * setting.spacing * (corrected ? 2.0 : 1.0);

  Matrix3d deformation;
  deformation << 1.12, 0.21, -0.08, -0.13, 0.93, 0.17, 0.05, -0.11, 1.07;
  std::vector<double> displacement(body.dofs()), force(body.dofs());
  for (Index i = 0; i < body.points.count(); ++i) {
    const Coordinates at = body.points.position(i);
    const Vector3d u = (deformation - Matrix3d::Identity()) * Vector3d(at[0], at[1], at[2]);
    for (int c = 0; c < d_; ++c) displacement[std::size_t(i) * d_ + c] = u(c);
  }
  ASSERT_FALSE(assembler.gradient(displacement, force).degenerate);
  const double at_surfaces = tests::largest(force);
  ASSERT_GT(at_surfaces, 0.0);
  int inside = 0, outside = 0;
  for (Index i = 0; i < body.points.count(); ++i) {
    const bool interior = tests::is_inside(body.points, i, setting, margin);
    double largest = 0.0;
    for (int c = 0; c < d_; ++c) {
      largest = std::max(largest, std::abs(force[std::size_t(i) * d_ + c]));
    }
    if (interior) {
      ++inside;
      EXPECT_LT(largest, 1e-13 * at_surfaces);
    } else {
      outside += largest > 1e-3 * at_surfaces;
    }
  }
  EXPECT_GT(inside, 0);
  EXPECT_GT(outside, 0);
}

std::vector<Setting> lattices() {
  std::vector<Setting> settings;
  for (const Setting& setting : all_settings()) {
    if (setting.perturbation == 0.0) settings.push_back(setting);
  }
  return settings;
}

INSTANTIATE_TEST_SUITE_P(AllCorrections, HomogeneousDeformation, ::testing::ValuesIn(lattices()),
                         label);

}  // namespace
}  // namespace peristat
