// Statements that hold for every measure, written once.
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/lanes.hpp"
#include "src/measures/area.hpp"
#include "src/measures/length.hpp"
#include "src/measures/volume.hpp"
#include "tests/bodies.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// What a measure gives, with all arms (relative vectors) one after another as its argument.
template <class At, int D, class Real>
struct Flat {
  static constexpr int arms = At::arms, size = arms * D;

  At of;
  Real current = of.current, relative_change = of.relative_change;

  static Arms<arms, D, Real> apart(const Vector<size, Real>& together) {
    Arms<arms, D, Real> result;
    for (int k = 0; k < size; ++k) result[k / D][k % D] = together[k];
    return result;
  }
  static Vector<size, Real> together(const Arms<arms, D, Real>& apart) {
    Vector<size, Real> result;
    for (int k = 0; k < size; ++k) result[k] = apart[k / D][k % D];
    return result;
  }

  [[nodiscard]] Vector<size, Real> gradient() const { return together(of.gradient); }
  [[nodiscard]] Vector<size, Real> hessian_times(const Vector<size, Real>& v) const {
    return together(of.hessian_times(apart(v)));
  }
  [[nodiscard]] Matrix<size, Real> hessian() const {
    Matrix<size, Real> result;
    add_blocks(result, std::make_integer_sequence<int, arms * arms>{});
    return result;
  }

 private:
  template <int... K>
  void add_blocks(Matrix<size, Real>& to, std::integer_sequence<int, K...>) const {
    (add_block<K / arms, K % arms>(to), ...);
  }
  template <int P, int Q>
  void add_block(Matrix<size, Real>& to) const {
    Matrix<D, Real> block;
    for (auto& row : block) row.fill(Real(0.0));
    // In two parts: a factor counts.
    of.template add_hessian<P, Q>(Real(0.25), block);
    of.template add_hessian<P, Q>(Real(0.75), block);
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) {
        // On the diagonal only the upper half is there.
        to[P * D + r][Q * D + c] = P == Q && c < r ? block[c][r] : block[r][c];
      }
    }
  }
};

/// A measure in a dimension.
template <class M, int D>
struct MeasureIn {
  static constexpr int dimension = D, size = M::arms * D, arms = M::arms;

  template <class Real>
  static auto at(const Real& inverse_reference, const Vector<size, Real>& arms_together,
                 const Vector<size, Real>& relative_displacement) {
    using F = Flat<typename M::template At<D, Real>, D, Real>;
    return F{M::template at<D, Real>(inverse_reference, F::apart(arms_together),
                                     F::apart(relative_displacement))};
  }
  /// At the reference, which is where the arms are.
  template <class Real>
  static auto at_rest(const Vector<size, Real>& arms_together) {
    Vector<size, Real> nothing;
    nothing.fill(Real(0.0));
    return at(Real(1.0), arms_together, nothing);
  }
};

template <class Case>
class Measure : public ::testing::Test {
 protected:
  using Arms = Vector<Case::size, double>;

  tests::Random random_{11};

  /// Arms of length about one that no direction is special for.
  Arms arms() {
    Arms result;
    for (double& entry : result) entry = (random_.number() < 0.0 ? -1.0 : 1.0) * 0.7;
    for (double& entry : result) entry += 0.3 * random_.number();
    return result;
  }

  Arms small_vector(double scale) {
    Arms result;
    for (double& entry : result) entry = scale * random_.number();
    return result;
  }

  /// How much round-off of the arms' products may grow: the product of their lengths over the
  /// measure, 1 for a length.
  static double condition(const Arms& arms) {
    double product = 1.0;
    for (int arm = 0; arm < Case::arms; ++arm) {
      double squared = 0.0;
      for (int c = 0; c < Case::dimension; ++c) {
        squared += arms[arm * Case::dimension + c] * arms[arm * Case::dimension + c];
      }
      product *= std::sqrt(squared);
    }
    return product / std::abs(reference(arms));
  }

  /// Reference value of arms.
  static double reference(const Arms& arms) { return Case::at_rest(arms).current; }
};

using Lengths = ::testing::Types<MeasureIn<Length, 1>, MeasureIn<Length, 2>, MeasureIn<Length, 3>>;
using Measures = ::testing::Types<MeasureIn<Length, 1>, MeasureIn<Length, 2>, MeasureIn<Length, 3>,
                                  MeasureIn<Area, 2>, MeasureIn<Area, 3>, MeasureIn<Volume, 3>>;
TYPED_TEST_SUITE(Measure, Measures);

template <int Size>
std::vector<double> listed(const Vector<Size, double>& vector) {
  return {vector.begin(), vector.end()};
}

TYPED_TEST(Measure, GradientIsDerivativeOfValue) {
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto arms = this->arms(), along = this->small_vector(1.0);
    const auto value = [&](double t) {
      const auto moved = plus<TypeParam::size>(arms, scaled<TypeParam::size>(t, along));
      return std::vector<double>{TypeParam::at_rest(moved).current};
    };
    const auto measure = TypeParam::at_rest(arms);
    EXPECT_TRUE(
        tests::is_derivative(value, {dot<TypeParam::size>(measure.gradient(), along)}, 1e-3));
  }
}

TYPED_TEST(Measure, HessianIsDerivativeOfGradient) {
  constexpr int size = TypeParam::size;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto arms = this->arms(), along = this->small_vector(1.0);
    // With a multiple of the arms added, so that no derivative is zero, not even in 1D.
    const auto gradient = [&](double t) {
      const auto moved = plus<size>(arms, scaled<size>(t, along));
      const auto measure = TypeParam::at_rest(moved);
      return listed<size>(plus<size>(measure.gradient(), moved));
    };
    const auto hessian = TypeParam::at_rest(arms).hessian();
    std::vector<double> derivative = listed<size>(along);
    for (int r = 0; r < size; ++r) {
      for (int c = 0; c < size; ++c) derivative[r] += hessian[r][c] * along[c];
    }
    EXPECT_TRUE(tests::is_derivative(gradient, derivative, 1e-3));
  }
}

TYPED_TEST(Measure, HessianTimesIsHessianTimesVector) {
  constexpr int size = TypeParam::size;
  const auto arms = this->arms(), v = this->small_vector(1.0);
  const auto measure = TypeParam::at_rest(arms);
  const auto hessian = measure.hessian();
  const auto product = measure.hessian_times(v);
  for (int r = 0; r < size; ++r) {
    double expected = 0.0;
    for (int c = 0; c < size; ++c) {
      expected += hessian[r][c] * v[c];
      EXPECT_NEAR(hessian[r][c], hessian[c][r], 4 * epsilon * std::abs(hessian[r][c]));
    }
    // Entries of order one but for the condition, a handful of terms.
    EXPECT_NEAR(product[r], expected, 8 * epsilon * this->condition(arms));
  }
}

/// Rotation about an oblique axis (2D: about z; 1D: none).
template <int D>
Matrix<D, double> rotation() {
  Matrix<D, double> result{};
  if constexpr (D == 1) {
    result[0][0] = 1.0;
  } else {
    const double cosine = std::cos(2.1), sine = std::sin(2.1);
    if constexpr (D == 2) {
      result = {{{cosine, -sine}, {sine, cosine}}};
    } else {
      const Vector<3, double> axis{2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0};
      const Matrix<3, double> cross{
          {{0.0, -axis[2], axis[1]}, {axis[2], 0.0, -axis[0]}, {-axis[1], axis[0], 0.0}}};
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          result[r][c] =
              (r == c ? cosine : 0.0) + (1.0 - cosine) * axis[r] * axis[c] + sine * cross[r][c];
        }
      }
    }
  }
  return result;
}

template <int D, int Size>
Vector<Size, double> rotated(const Vector<Size, double>& arms) {
  const Matrix<D, double> q = rotation<D>();
  Vector<Size, double> result{};
  for (int arm = 0; arm < Size; arm += D) {
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) result[arm + r] += q[r][c] * arms[arm + c];
    }
  }
  return result;
}

// A translation leaves relative vectors as they are; what is left of a rigid motion is its
// rotation.
TYPED_TEST(Measure, IsInvariantUnderRigidMotion) {
  constexpr int size = TypeParam::size, dimension = TypeParam::dimension;
  const auto arms = this->arms();
  const double inverse_reference = 1.0 / this->reference(arms);
  const auto stretched = plus<size>(arms, this->small_vector(0.3));
  const auto before = TypeParam::at(inverse_reference, arms, minus<size>(stretched, arms));
  const auto turned = rotated<dimension, size>(stretched);
  const auto after = TypeParam::at(inverse_reference, arms, minus<size>(turned, arms));
  ASSERT_GT(std::abs(before.relative_change), 1e-3);
  const double tolerance = 16 * epsilon * this->condition(stretched);
  EXPECT_NEAR(after.current, before.current, tolerance * std::abs(before.current));
  EXPECT_NEAR(after.relative_change, before.relative_change,
              tolerance * (1.0 + std::abs(before.relative_change)) * this->condition(arms));
  const auto gradient = rotated<dimension, size>(before.gradient());
  for (int c = 0; c < size; ++c) EXPECT_NEAR(after.gradient()[c], gradient[c], tolerance);

  const auto rigid =
      TypeParam::at(inverse_reference, arms, minus<size>(rotated<dimension, size>(arms), arms));
  EXPECT_NEAR(rigid.relative_change, 0.0, 16 * epsilon * this->condition(arms));
}

TYPED_TEST(Measure, RelativeChangeHasNoCancellation) {
  constexpr int size = TypeParam::size;
  using Long = long double;
  const Long long_epsilon = std::numeric_limits<Long>::epsilon();
  ASSERT_LT(long_epsilon, 1e-3L * epsilon);
  for (double strain = 1e-4; strain > 0.5e-14; strain *= 0.1) {
    const auto arms = this->arms();
    typename TestFixture::Arms displacement;  // stretches every component: a change of first order
    for (int c = 0; c < size; ++c) {
      displacement[c] = strain * (1.0 + 0.5 * this->random_.number()) * arms[c];
    }
    Vector<size, Long> long_arms, long_displacement;
    for (int c = 0; c < size; ++c) {
      long_arms[c] = arms[c];
      long_displacement[c] = displacement[c];
    }
    const Long reference = TypeParam::at_rest(long_arms).current;
    const auto exact = TypeParam::at(1 / reference, long_arms, long_displacement);
    // The difference of the two measures, as far as long double carries it, says the same.
    EXPECT_NEAR(double((exact.current / reference - 1) / exact.relative_change), 1.0,
                double(16 * long_epsilon / strain) * this->condition(arms));

    const auto measure = TypeParam::at(double(1 / reference), arms, displacement);
    EXPECT_NEAR(double(measure.relative_change / exact.relative_change), 1.0,
                8 * epsilon * this->condition(arms))
        << "strain " << strain;
  }
}

TYPED_TEST(Measure, LanesAgreeWithDoublesLaneByLane) {
  constexpr int size = TypeParam::size;
  typename TestFixture::Arms arms[lane_count], displacement[lane_count], v[lane_count];
  double inverse_reference[lane_count];
  for (int l = 0; l < lane_count; ++l) {
    arms[l] = this->arms();
    displacement[l] = this->small_vector(0.3);
    v[l] = this->small_vector(1.0);
    inverse_reference[l] = 1.0 / this->reference(arms[l]);
  }
  const auto lanes_of = [](const auto& vectors) {
    Vector<size, Lanes> result;
    for (int c = 0; c < size; ++c) result[c] = Lanes([&](int l) { return vectors[l][c]; });
    return result;
  };
  const Lanes lanes_inverse([&](int l) { return inverse_reference[l]; });
  const auto lanes = TypeParam::at(lanes_inverse, lanes_of(arms), lanes_of(displacement));
  const auto hessian = lanes.hessian();
  const auto product = lanes.hessian_times(lanes_of(v));
  // The compiler may contract products and sums differently in both: some round-offs of numbers of
  // order one.
  for (int l = 0; l < lane_count; ++l) {
    const double worst = this->condition(arms[l]);
    const double tolerance = 8 * epsilon * worst * worst;
    const auto single = TypeParam::at(inverse_reference[l], arms[l], displacement[l]);
    EXPECT_NEAR(lanes.current[l], single.current, tolerance);
    EXPECT_NEAR(lanes.relative_change[l], single.relative_change, tolerance);
    for (int r = 0; r < size; ++r) {
      EXPECT_NEAR(lanes.gradient()[r][l], single.gradient()[r], tolerance);
      EXPECT_NEAR(product[r][l], single.hessian_times(v[l])[r], tolerance);
      for (int c = 0; c < size; ++c) {
        EXPECT_NEAR(hessian[r][c][l], single.hessian()[r][c], tolerance);
      }
    }
  }
}

template <class Case>
class LengthMeasure : public Measure<Case> {};
TYPED_TEST_SUITE(LengthMeasure, Lengths);

TYPED_TEST(LengthMeasure, FromCurrentAgreesWithFromDisplacement) {
  constexpr int size = TypeParam::size, dimension = TypeParam::dimension;
  const auto arms = this->arms(), displacement = this->small_vector(0.3);
  const double inverse_reference = 1.0 / this->reference(arms);
  const auto a = TypeParam::at(inverse_reference, arms, displacement);
  const auto b =
      Length::from_current<dimension, double>(inverse_reference, {plus<size>(arms, displacement)});
  EXPECT_EQ(a.current, b.current);
  EXPECT_NEAR(a.relative_change, b.relative_change, 8 * epsilon);
  for (int c = 0; c < dimension; ++c) EXPECT_NEAR(a.gradient()[c], b.gradient[0][c], 8 * epsilon);
}

TYPED_TEST(LengthMeasure, IsTheEuclideanNorm) {
  const auto arms = this->arms();
  double squared = 0.0;
  for (double entry : arms) squared += entry * entry;
  EXPECT_NEAR(TypeParam::at_rest(arms).current, std::sqrt(squared), 4 * epsilon);
}

TYPED_TEST(LengthMeasure, DegenerateLengthIsNotFinite) {
  constexpr int size = TypeParam::size;
  const auto arms = this->arms();
  const double inverse_reference = 1.0 / this->reference(arms);
  const auto collapsed = TypeParam::at(inverse_reference, arms, scaled<size>(-1.0, arms));
  EXPECT_EQ(collapsed.current, 0.0);
  for (double entry : collapsed.gradient()) EXPECT_FALSE(std::isfinite(entry));
  for (const auto& row : collapsed.hessian()) {
    for (double entry : row) EXPECT_FALSE(std::isfinite(entry));
  }
}

TEST(AreaMeasure, IsTheShoelaceFormulaInThePlane) {
  // Corners (0, 0), (3, 1), (1, 2): twice the area is 3 * 2 - 1 * 1 = 5.
  const Vector<4, double> arms{3.0, 1.0, 1.0, 2.0}, other_way{1.0, 2.0, 3.0, 1.0};
  EXPECT_EQ((MeasureIn<Area, 2>::at_rest(arms).current), 5.0);
  EXPECT_EQ((MeasureIn<Area, 2>::at_rest(other_way).current), -5.0);
}

TEST(AreaMeasure, IsThatOfHeronsFormulaInSpace) {
  const Vector<3, double> b{0.3, -1.1, 0.4}, c{0.9, 0.2, -0.6}, bc = minus<3>(b, c);
  const double u = std::sqrt(dot<3>(b, b)), v = std::sqrt(dot<3>(c, c)),
               w = std::sqrt(dot<3>(bc, bc)), half = 0.5 * (u + v + w);
  const double triangle = std::sqrt(half * (half - u) * (half - v) * (half - w));
  const double area =
      MeasureIn<Area, 3>::at_rest(Vector<6, double>{b[0], b[1], b[2], c[0], c[1], c[2]}).current;
  EXPECT_NEAR(area / (2.0 * triangle), 1.0, 32 * epsilon);  // Heron's differences lose a digit
}

TEST(AreaMeasure, OfCollinearArmsInSpaceIsNotFinite) {
  const Vector<6, double> arms{1.0, 0.0, 0.0, 0.0, 1.0, 0.0}, fold{0.0, 0.0, 0.0, 2.0, -1.0, 0.0};
  const auto collapsed = MeasureIn<Area, 3>::at(1.0, arms, fold);
  EXPECT_EQ(collapsed.current, 0.0);
  EXPECT_FALSE(std::isfinite(collapsed.gradient()[2]));
}

TEST(AreaMeasure, IsSmoothThroughZeroInThePlaneAndResistsTurningOver) {
  const Vector<4, double> arms{1.0, 0.0, 0.0, 1.0};
  const auto flat = MeasureIn<Area, 2>::at(1.0, arms, Vector<4, double>{0.0, 0.0, 1.0, -1.0});
  EXPECT_EQ(flat.current, 0.0);
  EXPECT_EQ(flat.relative_change, -1.0);
  for (double entry : flat.gradient()) EXPECT_TRUE(std::isfinite(entry));
  const auto turned = MeasureIn<Area, 2>::at(1.0, arms, Vector<4, double>{-2.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(turned.relative_change, -2.0);
}

TEST(VolumeMeasure, IsTheDeterminantAndResistsInversion) {
  const Vector<9, double> arms{2.0, 0.0, 0.0, 0.5, 3.0, 0.0, 0.25, 0.75, 4.0};
  EXPECT_EQ((MeasureIn<Volume, 3>::at_rest(arms).current), 24.0);
  Vector<9, double> mirror{};
  mirror[0] = -4.0;
  const auto inverted = MeasureIn<Volume, 3>::at(1.0 / 24.0, arms, mirror);
  EXPECT_EQ(inverted.current, -24.0);
  EXPECT_NEAR(inverted.relative_change, -2.0, 4 * epsilon);
}

}  // namespace
}  // namespace peristat
