#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "src/dense/least_squares.hpp"
#include "src/dense/square_system.hpp"
#include "src/dense/symmetric_inverse.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/dense/symmetric_system.hpp"

namespace peristat {
namespace {

constexpr double round_off = 1e-13;

/// Numbers of order one, column by column.
std::vector<double> some_matrix(std::size_t rows, std::size_t columns) {
  std::mt19937_64 random(rows * 100 + columns);
  std::normal_distribution<double> numbers;
  std::vector<double> matrix(rows * columns);
  for (double& entry : matrix) entry = numbers(random);
  return matrix;
}

std::vector<double> transposed(const std::vector<double>& a, std::size_t rows) {
  const std::size_t columns = a.size() / rows;
  std::vector<double> result(a.size());
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) result[r * columns + c] = a[c * rows + r];
  }
  return result;
}

/// A B with the rows of A, column by column.
std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b,
                            std::size_t rows) {
  const std::size_t inner = a.size() / rows, columns = b.size() / inner;
  std::vector<double> result(rows * columns, 0.0);
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t k = 0; k < inner; ++k) {
      for (std::size_t r = 0; r < rows; ++r) {
        result[c * rows + r] += a[k * rows + r] * b[c * inner + k];
      }
    }
  }
  return result;
}

std::vector<double> identity(std::size_t size) {
  std::vector<double> result(size * size, 0.0);
  for (std::size_t k = 0; k < size; ++k) result[k * (size + 1)] = 1.0;
  return result;
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) a[k] -= b[k];
  return a;
}

double largest(const std::vector<double>& a) {
  double result = 0.0;
  for (const double entry : a) result = std::fmax(result, std::abs(entry));
  return result;
}

/// A^T A, whose rank is the number of rows of A.
std::vector<double> semidefinite(std::size_t size, std::size_t rank) {
  const std::vector<double> a = some_matrix(rank, size);
  return product(transposed(a, rank), a, size);
}

std::vector<double> indefinite(std::size_t size) {
  const std::vector<double> a = some_matrix(size, size), b = transposed(a, size);
  std::vector<double> result = a;
  for (std::size_t k = 0; k < result.size(); ++k) result[k] += b[k];
  return result;
}

template <class Values>
void expect_ascending(const Values& values) {
  for (std::size_t k = 1; k < values.size(); ++k) EXPECT_LE(values[k - 1], values[k]);
}

/// A V = V diag(values) and V^T V = 1.
void expect_modes(const std::vector<double>& matrix, const std::vector<double>& values,
                  const std::vector<double>& vectors) {
  const std::size_t size = values.size();
  std::vector<double> scaled = vectors;
  for (std::size_t k = 0; k < scaled.size(); ++k) scaled[k] *= values[k / size];
  const double scale = largest(matrix) * double(size);
  EXPECT_LE(largest(difference(product(matrix, vectors, size), scaled)), round_off * scale);
  EXPECT_LE(largest(difference(product(transposed(vectors, size), vectors, size), identity(size))),
            round_off * double(size));
  expect_ascending(values);
}

template <int D>
void expect_spectrum(const std::vector<double>& matrix) {
  const SymmetricSpectrum<D> found = symmetric_spectrum<D>(matrix.data());
  std::vector<double> vectors;
  for (const auto& vector : found.vectors) {
    vectors.insert(vectors.end(), vector.begin(), vector.end());
  }
  expect_modes(matrix, {found.values.begin(), found.values.end()}, vectors);
  EXPECT_EQ(symmetric_eigenvalues<D>(matrix.data()), found.values);
}

TEST(SmallDense, SpectraOfTensorsAreOfTheirEigenvectors) {
  expect_spectrum<1>({-2.0});
  expect_spectrum<2>(indefinite(2));
  expect_spectrum<3>(indefinite(3));
  expect_spectrum<2>(semidefinite(2, 1));
  expect_spectrum<3>(semidefinite(3, 1));  // with a double eigenvalue 0
  expect_spectrum<3>(identity(3));
}

TEST(SmallDense, EigenvaluesAreThoseInClosedForm) {
  // 2 and 4 in the plane of the first two axes, 3 along the third
  const std::vector<double> tensor{3, 1, 0, 1, 3, 0, 0, 0, 3};
  const auto values = symmetric_eigenvalues<3>(tensor.data());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(values[k], 2.0 + double(k), 4 * round_off);
}

TEST(SmallDense, ModesOfAnySizeAreOfTheirEigenvectors) {
  for (const std::size_t size : {1, 2, 6, 7, 40}) {
    const std::vector<double> matrix = indefinite(size);
    const SymmetricModes found = symmetric_modes(matrix, int(size));
    EXPECT_TRUE(found.is_found);
    expect_modes(matrix, found.values, found.vectors);
  }
  EXPECT_TRUE(symmetric_modes({}, 0).values.empty());
}

TEST(SmallDense, ModesOfADeficientMatrixEndWithItsRank) {
  const SymmetricModes found = symmetric_modes(semidefinite(6, 4), 6);
  EXPECT_NEAR(found.values[1], 0.0, round_off * found.values[5]);
  EXPECT_GT(found.values[2], 1e-3 * found.values[5]);
}

TEST(SmallDense, ModesOfWhatIsNotFiniteAreNotFound) {
  EXPECT_FALSE(symmetric_modes(std::vector<double>{NAN, 0.0, 0.0, 1.0}, 2).is_found);
}

TEST(SmallDense, SolutionsOfSquareSystemsHaveNoResidual) {
  for (const std::size_t size : {1, 3, 7, 40}) {
    const std::vector<double> matrix = some_matrix(size, size), side = some_matrix(size, 1);
    std::vector<double> x = side;
    solve_square(matrix, x);
    EXPECT_LE(largest(difference(product(matrix, x, size), side)),
              round_off * double(size) * (largest(x) * largest(matrix) + largest(side)));
  }
}

TEST(SmallDense, AConstraintBesideAStiffnessKeepsItsDigits) {
  const double stiffness = 1e30;  // [stiffness, -1; 1, 0] x = side
  std::vector<double> x{0.0, 3.0};
  solve_square(std::vector<double>{stiffness, 1.0, -1.0, 0.0}, x);
  EXPECT_NEAR(x[0] / 3.0, 1.0, round_off);
  EXPECT_NEAR(x[1] / (3.0 * stiffness), 1.0, round_off);
}

template <int D>
void expect_inverse(const std::vector<double>& matrix) {
  std::vector<double> inverse = matrix;
  EXPECT_NE(invert_symmetric<D>(inverse.data()), 0.0);
  EXPECT_LE(largest(difference(product(matrix, inverse, D), identity(D))),
            round_off * largest(matrix) * largest(inverse));
}

TEST(SmallDense, ATensorTimesItsInverseIsOne) {
  expect_inverse<1>({-4.0});
  expect_inverse<2>(semidefinite(2, 3));
  expect_inverse<2>(indefinite(2));
  expect_inverse<3>(semidefinite(3, 4));
  expect_inverse<3>(indefinite(3));
  expect_inverse<3>({1, 2, 3, 2, 9, 1, 3, 1, 5});  // whose rows are all moved
}

TEST(SmallDense, TheSmallestPivotTellsWhetherATensorIsPositive) {
  const auto least = [](std::vector<double> tensor) { return invert_symmetric<3>(tensor.data()); };
  EXPECT_EQ(least({3, 0, 0, 0, 2, 0, 0, 0, 7}), 2.0);
  EXPECT_GT(least(semidefinite(3, 4)), 0.0);
  EXPECT_LT(least({1, 2, 0, 2, 1, 0, 0, 0, 1}), 0.0);
  std::vector<double> flat{1, 1, 0, 1, 1, 0, 0, 0, 1};
  const std::vector<double> before = flat;
  EXPECT_EQ(invert_symmetric<3>(flat.data()), 0.0);
  EXPECT_EQ(flat, before);
}

TEST(SmallDense, SolutionsOfSymmetricSystemsHaveNoResidual) {
  for (const std::size_t size : {1, 3, 6, 40}) {
    const std::vector<double> matrix = semidefinite(size, size + 2), side = some_matrix(size, 1);
    std::vector<double> x = side;
    solve_symmetric(matrix, x);
    EXPECT_LE(largest(difference(product(matrix, x, size), side)),
              round_off * double(size) * (largest(x) * largest(matrix) + largest(side)));
  }
}

TEST(SmallDense, FactorsTellWhetherPivotsArePositive) {
  SymmetricFactors factors;
  factors.compute(std::vector<double>{4.0, 0.0, 0.0, 1.0}, 2);
  EXPECT_TRUE(factors.is_positive(0.2));
  EXPECT_FALSE(factors.is_positive(0.3));
  factors.compute(std::vector<double>{4.0, 0.0, 0.0, -1.0}, 2);
  EXPECT_FALSE(factors.is_positive(1e-12));
  factors.compute(semidefinite(4, 3), 4);
  EXPECT_FALSE(factors.is_positive(1e-12));
}

/// A^T (A X - B) = 0
void expect_least_squares(const std::vector<double>& matrix, std::size_t rows,
                          const std::vector<double>& sides, const std::vector<double>& found) {
  const std::vector<double> rest = difference(product(matrix, found, rows), sides);
  const std::vector<double> back = transposed(matrix, rows);
  EXPECT_LE(largest(product(back, rest, matrix.size() / rows)),
            100.0 * round_off * largest(matrix) * largest(sides));
}

TEST(SmallDense, LeastSquaresLeaveWhatIsNormalToTheColumns) {
  const std::vector<double> matrix = some_matrix(9, 4), sides = some_matrix(9, 3);
  const std::vector<double> found = least_squares(matrix, 9, sides);
  ASSERT_EQ(found.size(), 12U);
  expect_least_squares(matrix, 9, sides, found);
  EXPECT_GT(largest(difference(product(matrix, found, 9), sides)), 0.1);  // no exact solution
}

TEST(SmallDense, LeastSquaresOfDeficientColumnsAreTheShortest) {
  std::vector<double> matrix = some_matrix(9, 3);
  matrix.insert(matrix.end(), matrix.begin(), matrix.begin() + 9);  // the first one again
  const std::vector<double> sides = some_matrix(9, 1);
  const std::vector<double> found = least_squares(matrix, 9, sides);
  expect_least_squares(matrix, 9, sides, found);
  EXPECT_NEAR(found[0], found[3], 10 * round_off);  // no part along (1, 0, 0, -1)
  EXPECT_GT(std::abs(found[0]), 1e-3);
}

TEST(SmallDense, LeastSquaresOfFewRowsAreTheShortestSolution) {
  const std::vector<double> found =
      least_squares(std::vector<double>{3.0, 4.0}, 1, std::vector<double>{5.0});
  EXPECT_NEAR(found[0], 0.6, round_off);
  EXPECT_NEAR(found[1], 0.8, round_off);
}

TEST(SmallDense, LeastSquaresOfOneIsThePseudoInverse) {
  const std::vector<double> flat{2, 0, 0, 0, 4, 0, 0, 0, 0};
  const std::vector<double> found = least_squares(flat, 3, identity(3));
  EXPECT_LE(largest(difference(found, {0.5, 0, 0, 0, 0.25, 0, 0, 0, 0})), round_off);
}

TEST(SmallDense, CondensedRowsHaveTheSameSquares) {
  const std::vector<double> matrix = some_matrix(9, 4);
  const std::vector<double> condensed = condensed_rows(matrix, 9);
  ASSERT_EQ(condensed.size(), 16U);
  const auto squares = [](const std::vector<double>& a, std::size_t rows) {
    return product(transposed(a, rows), a, a.size() / rows);
  };
  EXPECT_LE(largest(difference(squares(condensed, 4), squares(matrix, 9))),
            round_off * largest(squares(matrix, 9)));
}

}  // namespace
}  // namespace peristat
