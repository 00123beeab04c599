#include "solvers/motion/stable_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "src/core/counter_random.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/parallel/index_map.hpp"
#include "src/parallel/sums.hpp"

namespace peristat {
namespace {

/// Lanczos' method ends where its largest Ritz value has risen by less than this share over the
/// last iterations. It then lacks less than a hundredth: the error at the end of a band of
/// frequencies falls with the inverse square of the iterations.
constexpr double settled_share = 1e-4;
constexpr std::size_t look_back = 5, least_iterations = 20, most_iterations = 120;
constexpr double margin = 1.01;

/// The power method comes to within some hundredths.
constexpr int power_iterations = 200;
constexpr double power_margin = 1.05;

using Vector = std::vector<double>;

/// Largest eigenvalue of the symmetric block of a point, scaled by masses.
double largest_of_block(const double* block, const double* mass, const char* is_free, int d) {
  std::array<std::array<double, 3>, 3> a{};
  for (int r = 0; r < d; ++r) {
    for (int c = 0; c < d; ++c) {
      if (!is_free[r] || !is_free[c]) continue;
      a[r][c] = block[r * d + c] / std::sqrt(mass[r] * mass[c]);
    }
  }
  // Jacobi's rotations: three by three needs a few sweeps.
  for (int sweep = 0; sweep < 12; ++sweep) {
    for (int p = 0; p < d; ++p) {
      for (int q = p + 1; q < d; ++q) {
        if (a[p][q] == 0.0) continue;
        const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(1.0, theta));
        const double c = 1.0 / std::hypot(1.0, t), s = t * c;
        for (int k = 0; k < d; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < d; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
        }
      }
    }
  }
  double largest = 0.0;
  for (int c = 0; c < d; ++c) largest = std::max(largest, a[c][c]);
  return largest;
}

/// Numbers and sums of a body's points.
struct Shared {
  Shared(const IndexMap& of, int dimension) : index_map(of), sums(of, dimension) {}

  const IndexMap& index_map;
  Sums sums;
};

/// Largest eigenvalue of a point's diagonal block over its free components, scaled by masses.
double stiffness_of_point(const TangentOperator& tangent, const FreeDofs& free,
                          std::span<const double> mass, Index point) {
  const auto d = std::size_t(tangent.dimension), first = std::size_t(point) * d;
  std::array<char, 3> is_free{};
  for (std::size_t c = 0; c < d; ++c) is_free[c] = free.equation[first + c] != FreeDofs::none;
  return largest_of_block(&tangent.diagonal[first * d], &mass[first], is_free.data(),
                          tangent.dimension);
}

double stiffest(const TangentOperator& tangent, const FreeDofs& free, std::span<const double> mass,
                const Sums& sums) {
  double largest = 0.0;  // ghosts have no equation, and so no stiffness
  for (Index i = 0; i < tangent.pattern.points(); ++i) {
    largest = std::max(largest, stiffness_of_point(tangent, free, mass, i));
  }
  return sums.largest_of_all(largest);
}

/// Lowest number in the whole body of the points that are as stiff as the stiffest, up to
/// round-off: this depends on the number of ranks and must not decide.
GlobalIndex first_stiffest(const TangentOperator& tangent, const FreeDofs& free,
                           std::span<const double> mass, double largest, const Shared& of) {
  constexpr double as_stiff = 1e-9, beyond_all = 1e300;
  const auto d = std::size_t(tangent.dimension);
  const auto own = Index(of.sums.own(std::size_t(tangent.pattern.points()) * d) / d);
  double number = beyond_all;
  for (Index i = 0; i < own && number == beyond_all; ++i) {
    const double stiffness = stiffness_of_point(tangent, free, mass, i);
    if (stiffness >= (1.0 - as_stiff) * largest) number = double(of.index_map.number_of(i));
  }
  return GlobalIndex(-of.sums.largest_of_all(-number));
}

/// Largest eigenvalue of a symmetric tridiagonal matrix, by bisection on the signs of its pivots.
double largest_eigenvalue(const Vector& diagonal, const Vector& beside) {
  double high = 0.0;
  for (std::size_t k = 0; k < diagonal.size(); ++k) {
    high = std::max(high, std::abs(diagonal[k]) + (k > 0 ? beside[k - 1] : 0.0) +
                              (k + 1 < diagonal.size() ? beside[k] : 0.0));
  }
  const auto is_above_all = [&](double value) {
    double pivot = 1.0;
    for (std::size_t k = 0; k < diagonal.size(); ++k) {
      pivot = value - diagonal[k] - (k > 0 ? beside[k - 1] * beside[k - 1] / pivot : 0.0);
      if (!(pivot > 0.0)) return false;
    }
    return true;
  };
  double low = 0.0;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (is_above_all(middle) ? high : low) = middle;
  }
  return high;
}

/// The product of M^-1/2 K M^-1/2 on the free degrees of freedom.
class ScaledProduct {
 public:
  ScaledProduct(const TangentOperator& tangent, const FreeDofs& free, std::span<const double> mass)
      : tangent_(tangent), scale_(mass.size(), 0.0), scaled_(mass.size()) {
    for (const Index dof : free.dof) scale_[dof] = 1.0 / std::sqrt(mass[dof]);
  }

  void operator()(const Vector& v, Vector& product) {
    for (std::size_t k = 0; k < v.size(); ++k) scaled_[k] = scale_[k] * v[k];
    tangent_.multiply(scaled_, product);
    for (std::size_t k = 0; k < v.size(); ++k) product[k] *= scale_[k];
  }

 private:
  const TangentOperator& tangent_;
  Vector scale_, scaled_;
};

/// Random start vector, and as much again at the stiffest point, so that a frequency that lives
/// there alone is not overlooked.
Vector start_vector(const FreeDofs& free, GlobalIndex stiffest, int dimension, const Shared& of) {
  constexpr std::uint64_t seed = 20;
  Vector start(free.equation.size(), 0.0);
  const auto number_of = [&](Index dof) {
    const bool is_of_point = std::size_t(dof) < of.sums.own(start.size());
    if (!is_of_point) return GlobalIndex(dof);
    return of.index_map.number_of(dof / dimension) * dimension + dof % dimension;
  };
  for (const Index dof : free.dof) {
    start[dof] = 2.0 * open_unit(random_bits(seed, std::uint64_t(number_of(dof)))) - 1.0;
  }
  const double length = of.sums.norm(start);
  for (const Index dof : free.dof) {
    if (number_of(dof) / dimension == stiffest) start[dof] += std::copysign(length, start[dof]);
  }
  const double whole = of.sums.norm(start);
  for (double& entry : start) entry /= whole;
  return start;
}

/// Largest Ritz value, which approaches the eigenvalue from below.
double lanczos(ScaledProduct& product, Vector at, const Sums& sums) {
  Vector before(at.size(), 0.0), next(at.size());
  Vector diagonal, beside, found;
  for (std::size_t k = 0; k < most_iterations; ++k) {
    product(at, next);
    diagonal.push_back(sums.dot(at, next));
    add_scaled(next, -diagonal.back(), at);
    if (k > 0) add_scaled(next, -beside.back(), before);
    found.push_back(largest_eigenvalue(diagonal, beside));
    const double left = sums.norm(next);
    if (!(left > 1e-12 * found.back())) break;
    if (k >= least_iterations &&
        found.back() - found[k - look_back] <= settled_share * found.back()) {
      break;
    }
    beside.push_back(left);
    before.swap(at);
    at.swap(next);
    for (double& entry : at) entry /= left;
  }
  return found.back();
}

/// Largest growth of a vector, from below: the power method needs no symmetry, but is slow.
double power(ScaledProduct& product, Vector at, const Sums& sums) {
  Vector next(at.size());
  double largest = 0.0;
  for (int k = 0; k < power_iterations; ++k) {
    product(at, next);
    const double length = sums.norm(next);
    if (!(length > 0.0)) break;
    if (2 * k >= power_iterations) largest = std::max(largest, length);
    at.swap(next);
    for (double& entry : at) entry /= length;
  }
  return largest;
}

/// Rounds up to 20 bits: Lanczos' method amplifies round-off, which depends on the number of ranks,
/// and the step must not depend on it.
double rounded_up(double value) {
  constexpr int bits = 20;
  int exponent = 0;
  const double share = std::frexp(value, &exponent);
  return std::ldexp(std::ceil(std::ldexp(share, bits)), exponent - bits);
}

double bound_of(const TangentOperator& tangent, const FreeDofs& free, std::span<const double> mass,
                int most_points, double largest, const Sums& of_body) {
  if (most_points > 0) return most_points * largest;
  Vector sums(mass.size());
  tangent.absolute_row_sums(sums);
  double bound = 0.0;
  for (const Index dof : free.dof) bound = std::max(bound, sums[dof] / mass[dof]);
  return of_body.largest_of_all(bound);
}

}  // namespace

double Stiffness::stable_step() const {
  return eigenvalue > 0.0 ? 2.0 / std::sqrt(eigenvalue) : std::numeric_limits<double>::infinity();
}

double projection_for_stiffness(const Energy& energy) {
  return energy.tangent_kind() == TangentKind::products ? 0.0 : 1.0;
}

Stiffness bound_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                          std::span<const double> mass, int most_points,
                          const IndexMap& index_map) {
  const Shared of(index_map, tangent.dimension);
  const double largest = stiffest(tangent, free, mass, of.sums);
  const double bound = bound_of(tangent, free, mass, most_points, largest, of.sums);
  return {bound, bound};
}

Stiffness find_stiffness(const TangentOperator& tangent, const FreeDofs& free,
                         std::span<const double> mass, int most_points, const IndexMap& index_map) {
  const Shared of(index_map, tangent.dimension);
  const double largest = stiffest(tangent, free, mass, of.sums);
  const double bound = bound_of(tangent, free, mass, most_points, largest, of.sums);
  const double equations = of.sums.of_all(double(free.dof.size()));
  if (!(bound > 0.0) || equations == 0.0) return {bound, bound};
  ScaledProduct product(tangent, free, mass);
  Vector start =
      start_vector(free, first_stiffest(tangent, free, mass, largest, of), tangent.dimension, of);
  const double found = tangent.is_symmetric()
                           ? margin * lanczos(product, std::move(start), of.sums)
                           : power_margin * power(product, std::move(start), of.sums);
  return {bound, std::min(bound, rounded_up(found))};
}

}  // namespace peristat
