#include "src/neighbourhood/optimised_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Cholesky>

#include "src/core/input_error.hpp"
#include "src/core/lanes.hpp"
#include "src/core/number_text.hpp"
#include "src/dense/symmetric_spectrum.hpp"

namespace peristat {
namespace {

using Exponents = std::array<int, 3>;

/// Fraction of the largest eigenvalue (or pivot) of B B^T below which one counts as zero.
constexpr double least_eigenvalue = 1e-11;

/// int s^a / |s|^3 ds over the unit ball.
double integral(int dimension, const Exponents& a) {
  double product = 2.0;
  int degree = 0;
  for (int c = 0; c < dimension; ++c) {
    if (a[std::size_t(c)] % 2 == 1) return 0.0;
    product *= std::tgamma(0.5 * (a[std::size_t(c)] + 1));
    degree += a[std::size_t(c)];
  }
  return product / std::tgamma(0.5 * (degree + dimension)) / (degree + dimension - 3);
}

/// Monomials in ascending degree, each a product of an earlier one with a coordinate.
struct Monomials {
  std::vector<Exponents> exponents{{0, 0, 0}};
  std::vector<std::size_t> factor{0}, axis{0};  // not of the first

  Monomials(int dimension, int degree) {
    std::size_t first = 0;
    for (int n = 1; n <= degree; ++n) {
      const std::size_t last = exponents.size();
      for (std::size_t k = first; k < last; ++k) {
        for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
          Exponents a = exponents[k];
          // Axes ascend, so that each product comes once.
          if (std::any_of(a.begin() + std::ptrdiff_t(c) + 1, a.end(), [](int e) { return e > 0; }))
            continue;
          ++a[c];
          exponents.push_back(a);
          factor.push_back(k);
          axis.push_back(c);
        }
      }
      first = last;
    }
  }

  [[nodiscard]] std::size_t size() const { return exponents.size(); }

  /// Completes the monomials of a place, all of them times the first one, which is given.
  void fill(const std::array<Lanes, 3>& s, std::vector<Lanes>& of_place) const {
    for (std::size_t k = 1; k < size(); ++k) of_place[k] = of_place[factor[k]] * s[axis[k]];
  }
};

/// Solver for the weights of one point after another, for one degree.
class WeightSolver {
 public:
  WeightSolver(int dimension, int degree)
      : dimension_(std::size_t(dimension)),
        conditions_(dimension, degree),
        moments_(dimension, 2 * degree),
        values_(conditions_.size()),
        powers_(moments_.size()),
        sums_(moments_.size()) {
    while (sum(conditions_.exponents[first_]) < 4 - dimension) ++first_;
    std::map<Exponents, std::size_t> number;
    for (std::size_t k = 0; k < moments_.size(); ++k) number[moments_.exponents[k]] = k;
    const std::size_t count = conditions_.size() - first_;
    goal_.resize(std::ptrdiff_t(count));
    normal_.resize(goal_.size(), goal_.size());
    for (std::size_t a = 0; a < count; ++a) {
      const Exponents& of_a = conditions_.exponents[first_ + a];
      goal_[std::ptrdiff_t(a)] = integral(dimension, of_a);
      for (std::size_t b = 0; b <= a; ++b) {
        Exponents product = of_a;
        for (std::size_t c = 0; c < 3; ++c) product[c] += conditions_.exponents[first_ + b][c];
        moment_of_.push_back(number.at(product));
      }
    }
  }

  [[nodiscard]] std::size_t conditions() const { return conditions_.size() - first_; }

  /// @param arms count x dimension, in horizons
  /// @param weight in horizon^dimension
  /// @return max |B omega - g|
  double solve(std::span<const double> arms, std::span<double> weight) {
    take(arms);
    build_normal_matrix();
    double residual = std::numeric_limits<double>::infinity();
    factors_.compute(normal_);
    if (factors_.info() == Eigen::Success && has_large_pivots()) {
      residual = refine(weight, [&](const Eigen::VectorXd& r) { return factors_.solve(r); });
    }
    if (!(residual <= exactness_tolerance)) residual = solve_by_eigenvalues(weight);
    return residual;
  }

 private:
  static int sum(const Exponents& a) { return a[0] + a[1] + a[2]; }

  /// Stores arms in lanes; lanes beyond the last arm have no effect.
  void take(std::span<const double> arms) {
    count_ = arms.size() / dimension_;
    const std::size_t lanes = (count_ + lane_count - 1) / lane_count;
    arms_.assign(lanes, {});
    kernel_.assign(lanes, Lanes(0.0));
    for (std::size_t j = 0; j < count_; ++j) {
      double squared = 0.0;
      for (std::size_t c = 0; c < dimension_; ++c) {
        const double s = arms[j * dimension_ + c];
        arms_[j / lane_count][c].set(int(j % lane_count), s);
        squared += s * s;
      }
      kernel_[j / lane_count].set(int(j % lane_count), 1.0 / (squared * std::sqrt(squared)));
    }
  }

  /// Builds the lower half of B B^T, whose entries are moments sum_j s_j^(a+b) / |s_j|^6: there are
  /// far fewer moments than entries.
  void build_normal_matrix() {
    std::fill(sums_.begin(), sums_.end(), Lanes(0.0));
    for (std::size_t l = 0; l < arms_.size(); ++l) {
      powers_[0] = kernel_[l] * kernel_[l];
      moments_.fill(arms_[l], powers_);
      for (std::size_t k = 0; k < sums_.size(); ++k) sums_[k] += powers_[k];
    }
    const std::size_t* moment = moment_of_.data();
    for (std::ptrdiff_t a = 0; a < goal_.size(); ++a)
      for (std::ptrdiff_t b = 0; b <= a; ++b) normal_(a, b) = peristat::sum(sums_[*moment++]);
  }

  [[nodiscard]] bool has_large_pivots() const {
    const auto pivots = factors_.matrixLLT().diagonal().array().square();
    return pivots.minCoeff() > least_eigenvalue * pivots.maxCoeff();
  }

  /// Sets omega = B^T y, with y refined up to twice by inverse(g - B omega), to the last digits.
  template <class Inverse>
  double refine(std::span<double> weight, const Inverse& inverse) {
    Eigen::VectorXd y = inverse(goal_);
    double residual = evaluate(y, weight);
    constexpr double enough = 1e-14;
    for (int times = 0; times < 2 && residual > enough && std::isfinite(residual); ++times) {
      const Eigen::VectorXd better = y + inverse(missing_);
      std::vector<double> before(weight.begin(), weight.end());
      const double with_better = evaluate(better, weight);
      if (!(with_better < residual)) {
        std::copy(before.begin(), before.end(), weight.begin());
        break;
      }
      residual = with_better;
      y = better;
    }
    return residual;
  }

  double solve_by_eigenvalues(std::span<double> weight) {
    const Eigen::Index size = normal_.rows();
    const SymmetricModes modes =
        symmetric_modes({normal_.data(), std::size_t(normal_.size())}, int(size));
    if (!modes.is_found) return std::numeric_limits<double>::infinity();
    const Eigen::Map<const Eigen::VectorXd> values(modes.values.data(), size);
    const double least = least_eigenvalue * values.maxCoeff();
    const Eigen::VectorXd inverses =
        values.unaryExpr([&](double value) { return value > least ? 1.0 / value : 0.0; });
    const Eigen::Map<const Eigen::MatrixXd> vectors(modes.vectors.data(), size, size);
    return refine(weight, [&](const Eigen::VectorXd& r) -> Eigen::VectorXd {
      return vectors * inverses.cwiseProduct(vectors.transpose() * r);
    });
  }

  /// Sets omega = B^T y and missing_ = g - B omega.
  /// @return the largest entry of missing_
  double evaluate(const Eigen::VectorXd& y, std::span<double> weight) {
    std::fill_n(sums_.begin(), conditions_.size(), Lanes(0.0));
    for (std::size_t l = 0; l < arms_.size(); ++l) {
      values_[0] = kernel_[l];
      conditions_.fill(arms_[l], values_);
      Lanes omega = 0.0;
      for (std::size_t k = first_; k < values_.size(); ++k)
        omega += y[std::ptrdiff_t(k - first_)] * values_[k];
      for (std::size_t k = first_; k < values_.size(); ++k) sums_[k] += omega * values_[k];
      for (std::size_t j = l * lane_count; j < std::min(count_, (l + 1) * lane_count); ++j)
        weight[j] = omega[int(j % lane_count)];
    }
    missing_ = goal_;
    for (std::size_t k = first_; k < values_.size(); ++k)
      missing_[std::ptrdiff_t(k - first_)] -= peristat::sum(sums_[k]);
    return missing_.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  }

  std::size_t dimension_;
  Monomials conditions_, moments_;
  std::size_t first_ = 0;  // number of the first condition among all monomials
  Eigen::VectorXd goal_, missing_;
  Eigen::MatrixXd normal_;
  std::vector<std::size_t> moment_of_;  // by entry of the lower half
  // Initialised: members that Eigen leaves undefined without a matrix must not be copied.
  Eigen::LLT<Eigen::MatrixXd> factors_{Eigen::MatrixXd::Identity(1, 1)};

  std::size_t count_ = 0;  // number of arms
  std::vector<std::array<Lanes, 3>> arms_;
  std::vector<Lanes> kernel_;  // 1/|s|^3
  std::vector<Lanes> values_, powers_, sums_;
};

/// Solver with the highest degree that the neighbours allow.
class LoweringSolver {
 public:
  struct Result {
    double residual;
    bool is_lowered;
  };

  LoweringSolver(int dimension, int degree) {
    for (int lower = degree; lower >= least_exact_degree; --lower)
      solvers_.emplace_back(dimension, lower);
  }

  /// Returns nothing if no weights are exact.
  std::optional<Result> solve(std::span<const double> arms, std::span<double> weight) {
    if (arms.empty()) return std::nullopt;
    for (WeightSolver& solver : solvers_) {
      const double residual = solver.solve(arms, weight);
      if (residual <= exactness_tolerance) return Result{residual, &solver != &solvers_.front()};
    }
    return std::nullopt;
  }

  [[nodiscard]] std::size_t fewest_conditions() const { return solvers_.back().conditions(); }

 private:
  std::vector<WeightSolver> solvers_;
};

void check(int dimension, double horizon, int degree) {
  if (dimension != 2 && dimension != 3) {
    throw InputError("dimension", std::to_string(dimension),
                     "optimised weights are for dimensions 2 and 3");
  }
  if (!(std::isfinite(horizon) && horizon > 0.0))
    throw InputError("horizon", number_text(horizon), "must be positive and finite");
  if (degree < least_exact_degree || degree > most_exact_degree) {
    throw InputError("degree", std::to_string(degree),
                     "must be from " + std::to_string(least_exact_degree) + " to " +
                         std::to_string(most_exact_degree));
  }
}

[[noreturn]] void refuse(double horizon, std::size_t neighbours, std::size_t conditions,
                         const std::string& which) {
  throw InputError("horizon", number_text(horizon),
                   which + std::to_string(neighbours) +
                       " neighbours, for which no weights are exact to degree " +
                       std::to_string(least_exact_degree) + " (" + std::to_string(conditions) +
                       " conditions); take a larger horizon in spacings, points all around, or a "
                       "smaller perturbation");
}

/// Arms with a known solution, in an order that depends on them alone.
struct KnownArms {
  std::vector<double> arms, weight;
  LoweringSolver::Result result;
};

/// Arms of one point in horizons, ordered by position, so that points of a lattice that number
/// their neighbours differently agree.
class OrderedArms {
 public:
  OrderedArms(int dimension, double horizon, const NeighbourLists& lists)
      : dimension_(std::size_t(dimension)), horizon_(horizon), lists_(lists) {}

  void take(std::size_t point) {
    const auto begin = std::size_t(lists_.offset[point]);
    const auto count = std::size_t(lists_.offset[point + 1]) - begin;
    places_.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto j = std::size_t(lists_.neighbour[begin + k]);
      Place& place = places_[k];
      place = {{}, {}, k};
      for (std::size_t c = 0; c < dimension_; ++c) {
        const double arm =
            lists_.reference[j * dimension_ + c] - lists_.reference[point * dimension_ + c];
        place.arm[c] = arm / horizon_;
        // Coarser than round-off, finer than distances between places of a body.
        place.rounded[c] = std::round(place.arm[c] * 0x1p36);
      }
    }
    std::sort(places_.begin(), places_.end(),
              [](const Place& a, const Place& b) { return a.rounded < b.rounded; });
    arms_.resize(count * dimension_);
    for (std::size_t k = 0; k < count; ++k)
      std::copy_n(places_[k].arm.begin(), dimension_, &arms_[k * dimension_]);
  }

  [[nodiscard]] const std::vector<double>& arms() const { return arms_; }
  [[nodiscard]] std::size_t count() const { return places_.size(); }
  /// Number of the k-th arm in the caller's order.
  [[nodiscard]] std::size_t number(std::size_t k) const { return places_[k].number; }

  [[nodiscard]] bool are(const KnownArms& known) const {
    constexpr double round_off = 1e-12;
    return std::equal(arms_.begin(), arms_.end(), known.arms.begin(), known.arms.end(),
                      [](double a, double b) { return std::abs(a - b) <= round_off; });
  }

 private:
  struct Place {
    std::array<double, 3> rounded, arm;
    std::size_t number;
  };
  std::size_t dimension_;
  double horizon_;
  const NeighbourLists& lists_;
  std::vector<Place> places_;
  std::vector<double> arms_;
};

/// Points that are worked on together. Their number does not depend on the number of threads, so
/// that the solutions that are shared do not, either.
constexpr std::size_t points_per_part = 512;
/// Most solutions that a part keeps to share; a lattice has one.
constexpr std::size_t most_known = 4;

struct Part {
  double largest_residual = 0.0, lowest = std::numeric_limits<double>::infinity();
  Index negative = 0, lowered = 0, solves = 0;
  std::size_t failed = std::numeric_limits<std::size_t>::max();
};

class Batch {
 public:
  Batch(int dimension, double horizon, int degree, const NeighbourLists& lists,
        std::vector<double>& weight)
      : ordered_(dimension, horizon, lists),
        solver_(dimension, degree),
        offset_(lists.offset),
        is_asked_(lists.is_asked),
        volume_(std::pow(horizon, dimension)),
        weight_(weight) {}

  /// Finds the weights of some points, with the solutions that are known of others.
  Part run(std::size_t first, std::size_t last, std::vector<KnownArms>& known) {
    Part part;
    for (std::size_t point = first; point < last; ++point) {
      if (!is_asked_.empty() && !is_asked_[point]) continue;
      ordered_.take(point);
      const auto found = std::find_if(known.begin(), known.end(),
                                      [&](const KnownArms& one) { return ordered_.are(one); });
      if (found != known.end()) {
        write(point, *found, part);
        continue;
      }
      if (!solve_own()) {
        part.failed = point;
        return part;
      }
      ++part.solves;
      write(point, own_, part);
      if (known.size() < most_known) known.push_back(own_);
    }
    return part;
  }

  [[nodiscard]] std::size_t fewest_conditions() const { return solver_.fewest_conditions(); }

 private:
  bool solve_own() {
    own_.arms = ordered_.arms();
    own_.weight.resize(ordered_.count());
    const auto result = solver_.solve(own_.arms, own_.weight);
    if (result) own_.result = *result;
    return result.has_value();
  }

  void write(std::size_t point, const KnownArms& solution, Part& part) {
    const auto begin = std::size_t(offset_[point]);
    for (std::size_t k = 0; k < ordered_.count(); ++k) {
      const double omega = volume_ * solution.weight[k];
      weight_[begin + ordered_.number(k)] = omega;
      part.negative += omega < 0.0;
      part.lowest = std::min(part.lowest, omega);
    }
    part.lowered += solution.result.is_lowered;
    part.largest_residual = std::max(part.largest_residual, solution.result.residual);
  }

  OrderedArms ordered_;
  LoweringSolver solver_;
  std::span<const Offset> offset_;
  std::span<const char> is_asked_;
  double volume_;
  std::vector<double>& weight_;
  KnownArms own_;
};

}  // namespace

std::vector<double> optimised_weights(int dimension, double horizon, int degree,
                                      std::span<const double> arms) {
  check(dimension, horizon, degree);
  LoweringSolver solver(dimension, degree);
  std::vector<double> scaled(arms.begin(), arms.end());
  for (double& component : scaled) component /= horizon;
  std::vector<double> weight(arms.size() / std::size_t(dimension));
  if (!solver.solve(scaled, weight))
    refuse(horizon, weight.size(), solver.fewest_conditions(), "a point has ");
  for (double& omega : weight) omega *= std::pow(horizon, dimension);
  return weight;
}

OptimisedWeights optimised_weights(int dimension, double horizon, int degree,
                                   const NeighbourLists& neighbours, int threads) {
  check(dimension, horizon, degree);
  OptimisedWeights result;
  result.weight.resize(neighbours.neighbour.size());
  const std::size_t points = neighbours.offset.empty() ? 0 : neighbours.offset.size() - 1;
  if (points == 0) return result;
  const auto parts = std::ptrdiff_t((points + points_per_part - 1) / points_per_part);
  std::vector<Part> of_part(std::size_t(parts) + 1);
  Batch first(dimension, horizon, degree, neighbours, result.weight);
  std::vector<KnownArms> shared;  // solution of the first point, known to all
  of_part.back() = first.run(0, 1, shared);
#pragma omp parallel num_threads(threads)
  {
    Batch batch(dimension, horizon, degree, neighbours, result.weight);
#pragma omp for schedule(dynamic)
    for (std::ptrdiff_t part = 0; part < parts; ++part) {
      const std::size_t begin = std::size_t(part) * points_per_part;
      std::vector<KnownArms> known = shared;
      of_part[std::size_t(part)] = batch.run(std::max<std::size_t>(begin, 1),
                                             std::min(begin + points_per_part, points), known);
    }
  }
  std::size_t failed = points;
  result.lowest = std::numeric_limits<double>::infinity();
  for (const Part& part : of_part) {
    failed = std::min(failed, part.failed);
    result.largest_residual = std::max(result.largest_residual, part.largest_residual);
    result.lowest = std::min(result.lowest, part.lowest);
    result.negative += part.negative;
    result.lowered += part.lowered;
    result.solves += part.solves;
  }
  if (failed < points) {
    std::string which = "the point at (";
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
      which += (c == 0 ? "" : ", ") +
               number_text(neighbours.reference[failed * std::size_t(dimension) + c]);
    }
    refuse(horizon, std::size_t(neighbours.offset[failed + 1] - neighbours.offset[failed]),
           first.fewest_conditions(), which + ") has ");
  }
  return result;
}

}  // namespace peristat
