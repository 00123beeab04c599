// The printed collocation form of continuum-kinematics-inspired peridynamics ([CPD] eqs. 53, 58,
// 61), for comparison only: every point uses its own effective volume V_n, also for interactions
// whose other points have another one. Far from surfaces this is the derivative of our energy; near
// them it is the derivative of none.
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;

/// A unique interaction by brute force: its points, and the reference value of its measure.
template <class Measure>
struct Interaction {
  std::array<Index, Measure::arms + 1> points;
  double reference;
};

template <class Measure>
class Collocation {
 public:
  static constexpr int arms = Measure::arms;

  explicit Collocation(const BoxBody& body) : body_(body) {
    std::array<Index, arms + 1> points{};
    collect(points, 0, 0);
    std::vector<double> count(body.points.volume.size(), 0.0);
    for (const auto& interaction : interactions_) {
      for (Index point : interaction.points) count[point] += 1.0;
    }
    const BulkNeighbourhood bulk =
        bulk_neighbourhood(3, body.points.spacing, body.setting.horizon, 1.0);
    const std::vector<std::int32_t> neighbours = neighbour_counts(body.model.bonds());
    constexpr double orders = arms == 2 ? 2.0 : 6.0;
    for (std::size_t a = 0; a < count.size(); ++a) {
      const double v_h = bulk.volume * neighbours[a] / double(bulk.neighbours);
      // k V^a V_n^a: what stands before dpsi/dx^a.
      factor_.push_back(count[a] > 0.0 ? orders * body.points.volume[a] * std::pow(v_h, arms) /
                                             (orders * count[a])
                                       : 0.0);
    }
  }

  [[nodiscard]] std::size_t count() const { return interactions_.size(); }

  /// Point volume times the printed residual, for C = 1 [N].
  [[nodiscard]] std::vector<double> force(const std::vector<double>& displacement) const {
    std::vector<double> result(displacement.size(), 0.0);
    for (const auto& interaction : interactions_) {
      Arms<arms, 3, double> current;
      for (int p = 0; p < arms; ++p) {
        for (int c = 0; c < 3; ++c) {
          current[p][c] = place(interaction.points[p + 1], c, displacement) -
                          place(interaction.points[0], c, displacement);
        }
      }
      const auto measure =
          Measure::template at<3, double>(1.0 / interaction.reference, current, {});
      const double change = measure.current / interaction.reference - 1.0;
      const double sign = interaction.reference < 0.0 ? -1.0 : 1.0;
      Vector<3, double> of_first{};
      for (int p = 0; p < arms; ++p) {
        const Index point = interaction.points[p + 1];
        for (int c = 0; c < 3; ++c) {
          const double slope = sign * change * measure.gradient[p][c];
          result[std::size_t(point) * 3 + c] -= factor_[point] * slope;
          of_first[c] += slope;
        }
      }
      const Index first = interaction.points[0];
      for (int c = 0; c < 3; ++c)
        result[std::size_t(first) * 3 + c] += factor_[first] * of_first[c];
    }
    return result;
  }

  [[nodiscard]] const std::vector<double>& factors() const { return factor_; }

 private:
  [[nodiscard]] double place(Index point, int c, const std::vector<double>& displacement) const {
    return body_.points.reference[std::size_t(point) * 3 + c] +
           displacement[std::size_t(point) * 3 + c];
  }

  void collect(std::array<Index, arms + 1>& points, int filled, Index from) {
    if (filled == arms + 1) {
      const std::vector<double> rest(body_.dofs(), 0.0);
      Arms<arms, 3, double> reference;
      for (int p = 0; p < arms; ++p) {
        for (int c = 0; c < 3; ++c) {
          reference[p][c] = place(points[p + 1], c, rest) - place(points[0], c, rest);
        }
      }
      const double value = Measure::template value<3, double>(reference);
      if (std::abs(value) > flat_measure * std::pow(body_.points.spacing, arms)) {
        interactions_.push_back({points, value});
      }
      return;
    }
    for (Index next = from; next < body_.points.count(); ++next) {
      bool near = true;
      for (int p = 0; p < filled; ++p) {
        near &= tests::reference_distance(body_.points, points[p], next) <= body_.setting.horizon;
      }
      if (!near) continue;
      points[filled] = next;
      collect(points, filled + 1, next + 1);
    }
  }

  const BoxBody& body_;
  std::vector<Interaction<Measure>> interactions_;
  std::vector<double> factor_;
};

template <class Measure>
tests::BoxSetting setting(std::array<int, 3> extent) {
  tests::BoxSetting box = tests::small_box(3);
  box.extent = extent;
  (Measure::arms == 2 ? box.triangles : box.tetrahedra) = 1.0;
  return box;
}

/// Our force of triangles or tetrahedra alone, for C = 1.
template <class Measure>
std::vector<double> our_force(const BoxBody& body, const tests::BoxSetting& box,
                              const std::vector<double>& state) {
  tests::BoxSetting bonds = box;
  bonds.triangles = bonds.tetrahedra = 0.0;
  const BoxBody bonds_alone(bonds);
  std::vector<double> all(body.dofs()), of_bonds(body.dofs());
  EXPECT_FALSE(Assembler(body.points, body.model, 1).gradient(state, all).degenerate);
  EXPECT_FALSE(Assembler(body.points, bonds_alone.model, 1).gradient(state, of_bonds).degenerate);
  double modulus = 0.0;
  if constexpr (Measure::arms == 2) {
    modulus = std::get<Harmonic>(body.simplex_term()->triangles()->potential).modulus;
  } else {
    modulus = std::get<Harmonic>(body.simplex_term()->tetrahedra()->potential).modulus;
  }
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = -(all[k] - of_bonds[k]) / modulus;
  return all;
}

template <class Measure>
class CollocationForm : public ::testing::Test {};
using Measures = ::testing::Types<Area, Volume>;
TYPED_TEST_SUITE(CollocationForm, Measures);

TYPED_TEST(CollocationForm, IsOursWhereAllPointsHaveTheSameEffectiveVolume) {
  const tests::BoxSetting box = setting<TypeParam>({2, 2, 2});  // every point is a corner
  const BoxBody body(box);
  const Collocation<TypeParam> collocation(body);
  for (double factor : collocation.factors()) EXPECT_EQ(factor, collocation.factors()[0]);
  const std::vector<double> state = body.random_state(1);
  const std::vector<double> theirs = collocation.force(state),
                            ours = our_force<TypeParam>(body, box, state);
  ASSERT_GT(tests::norm(ours), 0.0);
  EXPECT_LT(tests::distance(theirs, ours), 1e-12 * tests::norm(ours));
}

TYPED_TEST(CollocationForm, NearSurfacesIsUnsymmetricAndOutOfBalanceAndOursIsNot) {
  const tests::BoxSetting box = setting<TypeParam>({5, 4, 3});
  const BoxBody body(box);
  const Collocation<TypeParam> collocation(body);
  ASSERT_GT(collocation.count(), 100u);
  const auto asymmetry = [&](const auto& force) {
    const auto size = Eigen::Index(body.dofs());
    Eigen::MatrixXd k(size, size);
    const double step = 1e-5 * body.points.spacing;
    std::vector<double> state = body.random_state(2);
    for (Eigen::Index column = 0; column < size; ++column) {
      double& dof = state[std::size_t(column)];
      const double middle = dof;
      dof = middle + step;
      const std::vector<double> ahead = force(state);
      dof = middle - step;
      const std::vector<double> behind = force(state);
      dof = middle;
      for (Eigen::Index row = 0; row < size; ++row) {
        k(row, column) = (ahead[std::size_t(row)] - behind[std::size_t(row)]) / (2.0 * step);
      }
    }
    return (k - k.transpose()).cwiseAbs().maxCoeff() / k.cwiseAbs().maxCoeff();
  };
  const auto imbalance = [&](const std::vector<double>& force) {
    Vector<3, double> sum{};
    double size = 0.0;
    for (std::size_t k = 0; k < force.size(); ++k) {
      sum[k % 3] += force[k];
      size += std::abs(force[k]);
    }
    return std::sqrt(dot<3>(sum, sum)) / size;
  };
  const auto theirs = [&](const std::vector<double>& state) { return collocation.force(state); };
  const auto ours = [&](const std::vector<double>& state) {
    return our_force<TypeParam>(body, box, state);
  };
  const double their_asymmetry = asymmetry(theirs);
  EXPECT_GT(their_asymmetry, 1e-2);
  EXPECT_LT(their_asymmetry, 0.5);
  EXPECT_GT(imbalance(theirs(body.random_state(2))), 1e-3);
  EXPECT_LT(asymmetry(ours), 1e-6);  // of the finite differences: steps of 1e-5
  EXPECT_LT(imbalance(ours(body.random_state(2))), 1e-13);
}

}  // namespace
}  // namespace peristat
