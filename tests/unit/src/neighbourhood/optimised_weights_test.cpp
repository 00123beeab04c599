#include "src/neighbourhood/optimised_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::Random;

/// Neighbours of the origin on a lattice of spacing 1, each shifted by up to `perturbation`.
std::vector<double> lattice_arms(int dimension, double horizon, double perturbation = 0.0,
                                 std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<double> arms;
  const int width = int(horizon) + 1, deep = dimension == 3 ? width : 0;
  std::array<double, 3> own{};
  for (double& shift : own) shift = perturbation * random.number();
  for (int x = -width; x <= width; ++x) {
    for (int y = -width; y <= width; ++y) {
      for (int z = -deep; z <= deep; ++z) {
        std::array<double, 3> arm{double(x), double(y), double(z)};
        if (x == 0 && y == 0 && z == 0) continue;
        double squared = 0.0;
        for (int c = 0; c < dimension; ++c) {
          arm[std::size_t(c)] += perturbation * random.number() - own[std::size_t(c)];
          squared += arm[std::size_t(c)] * arm[std::size_t(c)];
        }
        if (squared <= horizon * horizon * (1.0 + 1e-8))
          arms.insert(arms.end(), arm.begin(), arm.begin() + dimension);
      }
    }
  }
  return arms;
}

/// int over the ball of radius delta, in polar coordinates by the midpoint rule, which is exact for
/// trigonometric polynomials; in 3D over the height by Gauss' rule of 8 points.
double integral(int dimension, const std::array<int, 3>& a, double delta) {
  const int degree = a[0] + a[1] + a[2];
  const double radial = std::pow(delta, degree + dimension - 3) / (degree + dimension - 3);
  constexpr int steps = 64;
  const std::array<double, 4> nodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                    0.9602898564975363};
  const std::array<double, 4> parts{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                    0.1012285362903763};
  double sum = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k + 0.5) / steps;
    const double planar = std::pow(std::cos(angle), a[0]) * std::pow(std::sin(angle), a[1]);
    if (dimension == 2) sum += planar;
    for (std::size_t n = 0; n < 8 && dimension == 3; ++n) {
      const double z = (n % 2 == 0 ? 1.0 : -1.0) * nodes[n / 2];
      sum +=
          parts[n / 2] * planar * std::pow(std::sqrt(1.0 - z * z), a[0] + a[1]) * std::pow(z, a[2]);
    }
  }
  return radial * sum * 2.0 * std::numbers::pi / steps;
}

std::vector<std::array<int, 3>> exponents(int dimension, int degree) {
  std::vector<std::array<int, 3>> result;
  for (int x = 0; x <= degree; ++x) {
    for (int y = 0; x + y <= degree; ++y) {
      for (int z = 0; z <= (dimension == 3 ? degree - x - y : 0); ++z)
        if (x + y + z >= 4 - dimension) result.push_back({x, y, z});
    }
  }
  return result;
}

double kernel_monomial(int dimension, const double* arm, const std::array<int, 3>& a) {
  double product = 1.0, squared = 0.0;
  for (int c = 0; c < dimension; ++c) {
    product *= std::pow(arm[c], a[std::size_t(c)]);
    squared += arm[c] * arm[c];
  }
  return product / std::pow(squared, 1.5);
}

/// Largest error of the rule for monomials of s = xi / delta.
double error_of(int dimension, double delta, int degree, const std::vector<double>& arms,
                const std::vector<double>& weight) {
  double largest = 0.0;
  for (const auto& a : exponents(dimension, degree)) {
    double sum = 0.0;
    for (std::size_t j = 0; j < weight.size(); ++j)
      sum += weight[j] * kernel_monomial(dimension, &arms[j * std::size_t(dimension)], a);
    const double scale = std::pow(delta, a[0] + a[1] + a[2] + dimension - 3);
    largest = std::max(largest, std::abs(sum - integral(dimension, a, delta)) / scale);
  }
  return largest;
}

/// The solution of least norm by another way: singular values of B itself.
std::vector<double> least_norm(int dimension, double delta, int degree,
                               const std::vector<double>& arms) {
  const auto conditions = exponents(dimension, degree);
  const std::size_t count = arms.size() / std::size_t(dimension);
  std::vector<double> scaled = arms;
  for (double& component : scaled) component /= delta;
  Eigen::MatrixXd B(Eigen::Index(conditions.size()), Eigen::Index(count));
  Eigen::VectorXd g(Eigen::Index(conditions.size()));
  for (std::size_t k = 0; k < conditions.size(); ++k) {
    g[Eigen::Index(k)] = integral(dimension, conditions[k], 1.0);
    for (std::size_t j = 0; j < count; ++j) {
      B(Eigen::Index(k), Eigen::Index(j)) =
          kernel_monomial(dimension, &scaled[j * std::size_t(dimension)], conditions[k]);
    }
  }
  const Eigen::VectorXd omega =
      Eigen::JacobiSVD<Eigen::MatrixXd>(B, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(g) *
      std::pow(delta, dimension);
  return {omega.begin(), omega.end()};
}

struct Lists {
  std::vector<double> reference;
  std::vector<Offset> offset{0};
  std::vector<Index> neighbour;
  [[nodiscard]] NeighbourLists view() const { return {offset, neighbour, reference}; }
};

/// Points of a square or cube with all of its neighbours around it, which come after them.
Lists lists_of(int dimension, int side, double horizon, double spacing, double perturbation,
               const std::array<double, 3>& at = {}) {
  Random random(3);
  Lists lists;
  const int beyond = int(horizon) + 2, deep = dimension == 3 ? side : 1;
  Index points = 0;
  for (const bool inside : {true, false}) {
    for (int x = -beyond; x < side + beyond; ++x) {
      for (int y = -beyond; y < side + beyond; ++y) {
        for (int z = dimension == 3 ? -beyond : 0; z < (dimension == 3 ? side + beyond : 1); ++z) {
          const auto is_in = [&](int k, int end) { return k >= 0 && k < end; };
          if ((is_in(x, side) && is_in(y, side) && is_in(z, deep)) != inside) continue;
          const std::array<int, 3> cell{x, y, z};
          for (std::size_t c = 0; c < std::size_t(dimension); ++c)
            lists.reference.push_back(at[c] + spacing * (cell[c] + perturbation * random.number()));
          points += inside;
        }
      }
    }
  }
  const auto all = Index(lists.reference.size() / std::size_t(dimension));
  for (Index i = 0; i < points; ++i) {
    for (Index j = 0; j < all; ++j) {
      double squared = 0.0;
      for (int c = 0; c < dimension; ++c)
        squared += std::pow(lists.reference[std::size_t(j * dimension + c)] -
                                lists.reference[std::size_t(i * dimension + c)],
                            2);
      if (j != i && squared <= std::pow(horizon * spacing * (1.0 + 1e-8), 2))
        lists.neighbour.push_back(j);
    }
    lists.offset.push_back(Offset(lists.neighbour.size()));
  }
  return lists;
}

std::vector<double> arms_of(const Lists& lists, int dimension, std::size_t point) {
  std::vector<double> arms;
  for (auto k = lists.offset[point]; k < lists.offset[point + 1]; ++k) {
    const auto j = std::size_t(lists.neighbour[std::size_t(k)]);
    for (std::size_t c = 0; c < std::size_t(dimension); ++c)
      arms.push_back(lists.reference[j * std::size_t(dimension) + c] -
                     lists.reference[point * std::size_t(dimension) + c]);
  }
  return arms;
}

std::string message_of(const auto& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OptimisedWeights, OfASquareLatticeAreThoseThatAreKnown) {
  struct Known {
    double horizon;
    int x, y;
    double weight;
  };
  for (const Known& known : {Known{3.0, 1, 0, 1.9018542425}, Known{3.0, 1, 1, 1.4355103103},
                             Known{3.0, 2, 0, 0.9327693982}, Known{3.0, 2, 1, 0.9293206459},
                             Known{3.0, 2, 2, 0.8409601239}, Known{3.0, 3, 0, 0.6016710176},
                             Known{3.5, 1, 0, 1.6631568915}, Known{3.5, 1, 1, 1.5074490738},
                             Known{3.5, 2, 0, 0.9196920912}, Known{3.5, 2, 1, 1.1422083780},
                             Known{3.5, 2, 2, 1.3131596297}, Known{3.5, 3, 0, 0.7110321114},
                             Known{3.5, 3, 1, 0.9264710961}}) {
    for (const double spacing : {1.0, 1e-9, 1e6}) {
      std::vector<double> arms = lattice_arms(2, known.horizon);
      for (double& component : arms) component *= spacing;
      const auto weight = optimised_weights(2, known.horizon * spacing, 5, arms);
      int seen = 0;
      for (std::size_t j = 0; j < weight.size(); ++j) {
        const double x = std::abs(arms[2 * j] / spacing), y = std::abs(arms[2 * j + 1] / spacing);
        const double low = std::min(x, y), high = std::max(x, y);
        if (std::abs(high - known.x) > 1e-9 || std::abs(low - known.y) > 1e-9) continue;
        EXPECT_NEAR(weight[j] / (spacing * spacing), known.weight, 6e-11);
        ++seen;
      }
      EXPECT_EQ(seen, known.x == known.y || known.y == 0 ? 4 : 8);
    }
  }
}

TEST(OptimisedWeights, SumToMoreThanTheBall) {
  const auto weight = optimised_weights(2, 3.5, 5, lattice_arms(2, 3.5));
  EXPECT_NEAR(std::accumulate(weight.begin(), weight.end(), 0.0), 41.007, 5e-4);
}

TEST(OptimisedWeights, AreExactAndOfLeastNorm) {
  struct Setting {
    int dimension, degree;
    double horizon, perturbation;
  };
  for (const Setting& of :
       {Setting{2, 5, 3.0, 0.2}, Setting{2, 5, 4.0, 0.2}, Setting{2, 4, 3.0, 0.2},
        Setting{2, 6, 4.0, 0.2}, Setting{2, 8, 6.0, 0.1}, Setting{2, 5, 2.5, 0.0},
        Setting{3, 5, 3.0, 0.0}, Setting{3, 5, 3.0, 0.2}, Setting{3, 4, 3.0, 0.2},
        Setting{3, 5, 4.0, 0.2}, Setting{3, 5, 2.5, 0.0}}) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      SCOPED_TRACE(testing::Message() << of.dimension << "D, degree " << of.degree << ", horizon "
                                      << of.horizon << " +- " << of.perturbation);
      const auto arms = lattice_arms(of.dimension, of.horizon, of.perturbation, seed);
      const auto weight = optimised_weights(of.dimension, of.horizon, of.degree, arms);
      EXPECT_LE(error_of(of.dimension, of.horizon, of.degree, arms, weight), 2e-12);
      const auto expected = least_norm(of.dimension, of.horizon, of.degree, arms);
      EXPECT_LE(tests::distance(weight, expected), 1e-9 * tests::norm(expected));
    }
  }
}

TEST(OptimisedWeights, OfFewNeighboursAreExactToALowerDegree) {
  // Sixteen of the twenty within 2.5 spacings, off their places: too few for 18 conditions.
  auto arms = lattice_arms(2, 2.5, 0.05);
  arms.resize(2 * 16);
  const auto weight = optimised_weights(2, 2.5, 5, arms);
  EXPECT_LE(error_of(2, 2.5, 4, arms, weight), 1e-11);
  EXPECT_GT(error_of(2, 2.5, 5, arms, weight), 1e-3);
  const auto expected = least_norm(2, 2.5, 4, arms);
  EXPECT_LE(tests::distance(weight, expected), 1e-9 * tests::norm(expected));
}

TEST(OptimisedWeights, OfTooFewNeighboursAreRefused) {
  auto arms = lattice_arms(2, 2.5, 0.05);
  arms.resize(2 * 11);
  const std::string message = message_of([&] { (void)optimised_weights(2, 2.5, 5, arms); });
  EXPECT_NE(message.find("horizon = 2.5"), std::string::npos) << message;
  EXPECT_NE(message.find("11 neighbours"), std::string::npos) << message;
  EXPECT_NE(message.find("12 conditions"), std::string::npos) << message;
  EXPECT_THROW((void)optimised_weights(2, 2.5, 5, std::vector<double>{}), InputError);
}

TEST(OptimisedWeights, OfAHalfBallShowByTheirSigns) {
  Lists lists;
  lists.reference = {0.0, 0.0};
  const auto arms = lattice_arms(2, 3.5);
  for (std::size_t j = 0; j < arms.size() / 2; ++j) {
    if (arms[2 * j] <= 0.0) continue;
    lists.reference.insert(lists.reference.end(), {arms[2 * j], arms[2 * j + 1]});
    lists.neighbour.push_back(Index(lists.reference.size() / 2 - 1));
  }
  lists.offset.push_back(Offset(lists.neighbour.size()));
  const auto half = optimised_weights(2, 3.5, 5, lists.view(), 1);
  EXPECT_EQ(half.lowered, 1);
  EXPECT_LT(half.lowest, -1.0);
}

TEST(OptimisedWeights, OfPointsAtOnePlaceOrNowhereAreRefused) {
  auto arms = lattice_arms(2, 3.5);
  arms[4] = arms[5] = 0.0;
  EXPECT_THROW((void)optimised_weights(2, 3.5, 5, arms), InputError);
  arms[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)optimised_weights(2, 3.5, 5, arms), InputError);
}

TEST(OptimisedWeights, RefuseWhatIsNotAllowed) {
  const auto arms = lattice_arms(2, 3.5);
  EXPECT_THROW((void)optimised_weights(1, 3.5, 5, arms), InputError);
  EXPECT_THROW((void)optimised_weights(2, 0.0, 5, arms), InputError);
  for (const int degree : {3, 9}) {
    const std::string message = message_of([&] { (void)optimised_weights(2, 3.5, degree, arms); });
    EXPECT_NE(message.find("degree = " + std::to_string(degree)), std::string::npos) << message;
  }
}

TEST(OptimisedWeights, AreMirroredWithTheirArms) {
  for (const int dimension : {2, 3}) {
    const auto arms = lattice_arms(dimension, 3.5, 0.2);
    auto mirrored = arms;
    for (std::size_t k = 0; k < arms.size(); k += std::size_t(dimension)) mirrored[k] = -arms[k];
    const auto a = optimised_weights(dimension, 3.5, 5, arms);
    const auto b = optimised_weights(dimension, 3.5, 5, mirrored);
    EXPECT_LE(tests::distance(a, b), 1e-11 * tests::norm(a));
  }
}

TEST(OptimisedWeights, OfManyPointsAreThoseOfEach) {
  for (const int dimension : {2, 3}) {
    const Lists lists = lists_of(dimension, dimension == 2 ? 8 : 4, 3.0, 1.0, 0.2);
    const auto all = optimised_weights(dimension, 3.0, 5, lists.view(), 2);
    const std::size_t points = lists.offset.size() - 1;
    EXPECT_EQ(all.solves, Index(points));
    EXPECT_EQ(all.lowered, 0);
    EXPECT_GT(all.largest_residual, 0.0);
    EXPECT_LE(all.largest_residual, exactness_tolerance);
    for (std::size_t i = 0; i < points; ++i) {
      const auto expected = optimised_weights(dimension, 3.0, 5, arms_of(lists, dimension, i));
      const std::vector<double> found(all.weight.begin() + lists.offset[i],
                                      all.weight.begin() + lists.offset[i + 1]);
      EXPECT_LE(tests::distance(found, expected), 1e-10 * tests::norm(expected));
    }
  }
}

TEST(OptimisedWeights, OfALatticeAreSolvedForOnce) {
  struct Setting {
    double spacing;
    std::array<double, 3> at;
  };
  for (const Setting& of :
       {Setting{1.0, {}}, Setting{1e-9, {}}, Setting{1e6, {}}, Setting{0.1, {3.7, -11.3, 0}}}) {
    const Lists lists = lists_of(2, 30, 3.5, of.spacing, 0.0, of.at);
    const auto all = optimised_weights(2, 3.5 * of.spacing, 5, lists.view(), 2);
    EXPECT_EQ(all.solves, 1);
    EXPECT_EQ(all.negative, 0);
    const double area = of.spacing * of.spacing;
    EXPECT_NEAR(all.lowest / area, 0.7110321114, 1e-9);
    for (std::size_t i = 0; i + 1 < lists.offset.size(); ++i) {
      const auto arms = arms_of(lists, 2, i);
      const std::vector<double> found(all.weight.begin() + lists.offset[i],
                                      all.weight.begin() + lists.offset[i + 1]);
      ASSERT_LE(error_of(2, 3.5 * of.spacing, 5, arms, found), 1e-11);
    }
  }
}

TEST(OptimisedWeights, OfALatticeFarAwayAreThoseAtTheOrigin) {
  const Lists lists = lists_of(2, 6, 3.5, 1e-3, 0.0, {1e4, -3e4, 0});
  const auto all = optimised_weights(2, 3.5e-3, 5, lists.view(), 1);
  // Positions carry 4e-12 m of round-off, 4e-9 spacings.
  EXPECT_NEAR(all.lowest * 1e6, 0.7110321114, 1e-6);
  EXPECT_LE(all.largest_residual, exactness_tolerance);
}

TEST(OptimisedWeights, AreTheSameForAnyNumberOfThreads) {
  for (const double perturbation : {0.0, 0.2}) {
    const Lists lists = lists_of(2, 36, 3.0, 1.0, perturbation);
    const auto one = optimised_weights(2, 3.0, 5, lists.view(), 1);
    for (const int threads : {2, 3, 7}) {
      const auto more = optimised_weights(2, 3.0, 5, lists.view(), threads);
      EXPECT_EQ(more.weight, one.weight);
      EXPECT_EQ(more.largest_residual, one.largest_residual);
      EXPECT_EQ(more.negative, one.negative);
      EXPECT_EQ(more.lowest, one.lowest);
      EXPECT_EQ(more.solves, one.solves);
    }
  }
}

TEST(OptimisedWeights, CountTheNegativeOnes) {
  const Lists lists = lists_of(2, 30, 3.0, 0.5, 0.3);
  const auto all = optimised_weights(2, 1.5, 5, lists.view(), 2);
  const auto negative =
      std::count_if(all.weight.begin(), all.weight.end(), [](double w) { return w < 0.0; });
  EXPECT_GT(negative, 0);
  EXPECT_EQ(all.negative, negative);
  EXPECT_EQ(all.lowest, *std::min_element(all.weight.begin(), all.weight.end()));
}

TEST(OptimisedWeights, TellHowManyPointsAreExactToALowerDegree) {
  Lists lists = lists_of(2, 3, 2.5, 1.0, 0.05);
  // The last point keeps sixteen of its neighbours.
  const auto kept = std::size_t(lists.offset[8] + 16);
  lists.neighbour.resize(kept);
  lists.offset[9] = Offset(kept);
  const auto all = optimised_weights(2, 2.5, 5, lists.view(), 1);
  EXPECT_EQ(all.lowered, 1);
}

TEST(OptimisedWeights, NameTheFirstPointThatHasNone) {
  Lists lists = lists_of(2, 30, 3.0, 1.0, 0.0, {0.25, 0.0, 0.0});
  // Points 700 and 800, in parts of different threads, lose all neighbours but three.
  for (const std::size_t point : {700u, 800u}) {
    const auto begin = lists.neighbour.begin() + lists.offset[point];
    const auto end = lists.neighbour.begin() + lists.offset[point + 1];
    const Offset lost = lists.offset[point + 1] - lists.offset[point] - 3;
    lists.neighbour.erase(begin + 3, end);
    for (std::size_t k = point + 1; k < lists.offset.size(); ++k) lists.offset[k] -= lost;
  }
  for (const int threads : {1, 2}) {
    const std::string message =
        message_of([&] { (void)optimised_weights(2, 3.0, 5, lists.view(), threads); });
    EXPECT_NE(message.find("the point at (23.25, 10) has 3 neighbours"), std::string::npos)
        << message;
  }
}

}  // namespace
}  // namespace peristat
