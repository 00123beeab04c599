#include "assembly/convolutions/green_bonds.hpp"

#include <algorithm>
#include <cmath>

#include "assembly/convolutions/linear_bonds.hpp"
#include "src/core/dual.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {
namespace {

using Parity = LatticeFields::Parity;
using Product = LatticeFields::Product;

std::vector<LatticeStep> steps_of(std::span<const LatticeSpring> springs) {
  std::vector<LatticeStep> steps;
  for (const LatticeSpring& spring : springs) steps.push_back(spring.step);
  return steps;
}

/// s
double size_of(const LatticeSpring& spring) {
  const Coordinates& arm = spring.arm;
  return spring.stiffness / (arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]);
}

/// Numbers of the fields, q times
///   u_i | u_i u_j | u^2 u_i | u^4.
template <int D>
struct Fields {
  static constexpr std::size_t squares = D, cubes = squares + pairs_of(D), quartic = cubes + D;
};

/// Positions of a point's sums over neighbours, with a = s xi,
///   q' (k n n . u' + a . u' u' + a u'^2 / 2 + s u'^2 u' / 2) | A_ij = q' a_j u'_i | S_i = q' s
///   u'_i | T_ij = q' s u'_i u'_j.
template <int D>
struct Sums {
  static constexpr std::size_t arms = D, sizes = arms + D * D, squares = sizes + D,
                               count = squares + pairs_of(D);
};

/// Positions of a point's sums of kernels alone: q' k n n | q' a | q' s.
template <int D>
struct Constants {
  static constexpr std::size_t arms = pairs_of(D), size = arms + D, count = size + 1;
};

/// Number to store in a field: itself, or its rate.
double part(double number) { return number; }
double part(const Dual& number) { return number.rate; }

/// f / q of a point, from u, its sums and its constants.
template <int D, class Real, class Sum>
Vector<D, Real> force_of(const Vector<D, Real>& u, const Sum& sum, const double* constants) {
  using At = Sums<D>;
  const auto T = [&](int i, int j) { return sum(At::squares + pair_of(i, j, D)); };
  const auto A = [&](int i, int j) { return sum(At::arms + std::size_t(i * D + j)); };
  Real arms = 0.0, squares = 0.0, products = 0.0, along = 0.0;
  for (int j = 0; j < D; ++j) {
    arms += A(j, j);
    squares += T(j, j);
    products += u[j] * sum(At::sizes + std::size_t(j));
    along += u[j] * Real(constants[Constants<D>::arms + std::size_t(j)]);
  }
  const Real size = constants[Constants<D>::size], half = 0.5, half_length = half * dot<D>(u, u);
  const Real by_u = along - arms - half * squares + products - half_length * size;
  Vector<D, Real> force;
  for (int i = 0; i < D; ++i) {
    const auto at = std::size_t(i);
    const Real arm = constants[Constants<D>::arms + at];
    force[at] = sum(at) + u[at] * by_u + half_length * (arm + sum(At::sizes + at));
    for (int j = 0; j < D; ++j) {
      const Real bonds = constants[pair_of(i, j, D)];
      force[at] -= u[std::size_t(j)] * (bonds + A(i, j) + A(j, i) + T(i, j));
    }
  }
  return force;
}

/// Sum of q' s g^2 without the part that depends on u' alone.
template <int D>
double squares_of(const Vector<D, double>& u, const double* sum, const double* constants) {
  using At = Sums<D>;
  const double length = dot<D>(u, u);
  double linear = 0.0, arms = 0.0, squares = 0.0, by_length = 0.0;
  for (int i = 0; i < D; ++i) {
    const auto at = std::size_t(i);
    linear += u[at] * sum[at];
    arms += sum[At::arms + at * D + at];
    squares += sum[At::squares + pair_of(i, i, D)];
    by_length -= u[at] * (constants[Constants<D>::arms + at] + sum[At::sizes + at]);
  }
  by_length += arms + 0.5 * squares + 0.25 * length * constants[Constants<D>::size];
  double result = length * by_length - 2.0 * linear;
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) {
      const std::size_t pair = pair_of(i, j, D);
      result += u[std::size_t(i)] * u[std::size_t(j)] *
                (constants[pair] + 2.0 * sum[At::arms + std::size_t(i * D + j)] +
                 sum[At::squares + pair]);
    }
  }
  return result;
}

/// With y = xi + eta: sums of q' s y y, and of q' s g.
template <int D>
struct Blocks {
  Matrix<D, double> squares;
  double pull = 0.0;
};

template <int D>
Blocks<D> blocks_of(const Vector<D, double>& u, const double* sum, const double* constants) {
  using At = Sums<D>;
  const double size = constants[Constants<D>::size];
  const auto arm_with = [&](std::size_t j, std::size_t i) {  // sum q' s xi_j eta_i
    return sum[At::arms + i * D + j] - u[i] * constants[Constants<D>::arms + j];
  };
  const auto square = [&](std::size_t i, std::size_t j) {  // sum q' s eta_i eta_j
    return sum[At::squares + pair_of(int(i), int(j), D)] - u[i] * sum[At::sizes + j] -
           u[j] * sum[At::sizes + i] + u[i] * u[j] * size;
  };
  Blocks<D> found;
  for (std::size_t i = 0; i < D; ++i) {
    found.pull += arm_with(i, i) + 0.5 * square(i, i);
    for (std::size_t j = 0; j < D; ++j) {
      found.squares[i][j] =
          constants[pair_of(int(i), int(j), D)] + arm_with(i, j) + arm_with(j, i) + square(i, j);
    }
  }
  return found;
}

template <int D>
Vector<D, double> vector_at(const std::vector<double>& field, std::size_t point) {
  Vector<D, double> at;
  for (std::size_t c = 0; c < D; ++c) at[c] = field[point * D + c];
  return at;
}

}  // namespace

GreenBonds::GreenBonds(const CutLattice& box, const std::array<bool, 3>& is_periodic,
                       std::span<const LatticeSpring> springs, int threads)
    : springs_(springs.begin(), springs.end()),
      fields_(box, is_periodic, steps_of(springs), threads),
      turns_(box, is_periodic, springs) {
  kernels_ = make_kernels(false, [](const LatticeSpring&) { return 1.0; });
  for (const LatticeSpring& spring : springs_) whole_size_ += 2.0 * size_of(spring);
  set_integrity(std::vector<double>(box.place.size(), 1.0));
}

/// The kernels times a factor of each spring, which is odd if it changes its sign with the step.
template <class Factor>
GreenBonds::Kernels GreenBonds::make_kernels(bool is_odd, const Factor& factor) const {
  const auto spectrum = [&](bool turns, const auto& value) {
    return fields_.spectrum(turns == is_odd ? Parity::even : Parity::odd, [&](std::size_t s) {
      return value(springs_[s]) * factor(springs_[s]);
    });
  };
  Kernels kernels;
  for (int i = 0; i < fields_.dimension(); ++i) {
    kernels.arm.push_back(
        spectrum(true, [i](const LatticeSpring& of) { return size_of(of) * of.arm[i]; }));
    for (int j = i; j < fields_.dimension(); ++j) {
      kernels.square.push_back(spectrum(false, [i, j](const LatticeSpring& of) {
        return of.stiffness * of.direction[i] * of.direction[j];
      }));
    }
  }
  kernels.size = spectrum(false, size_of);
  return kernels;
}

void GreenBonds::set_integrity(std::span<const double> integrity) {
  fields_.set_integrity(integrity);
  state_.clear();
  with_dimension(fields_.dimension(), [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    using At = Constants<D>;
    find_constants<D>(kernels_, constants_);
    fields_.leave_out_lonely(whole_size_,
                             [&](std::size_t i) { return constants_[i * At::count + At::size]; });
  });
}

template <int D>
void GreenBonds::find_constants(const Kernels& kernels, std::vector<double>& constants) {
  using At = Constants<D>;
  constants.resize(fields_.points() * At::count);
  const auto take_to = [&](std::size_t at) {
    return [&constants, at](std::size_t i, double sum) { constants[i * At::count + at] = sum; };
  };
  fields_.fill(0, [](std::size_t) { return 1.0; });
  for (std::size_t p = 0; p < pairs_of(D); ++p) {
    fields_.find_sums(kernels.square[p], 0, take_to(p));
  }
  for (std::size_t c = 0; c < D; ++c) fields_.find_sums(kernels.arm[c], 0, take_to(At::arms + c));
  fields_.find_sums(kernels.size, 0, take_to(At::size));
  fields_.leave_out_lonely(whole_size_,
                           [&](std::size_t i) { return constants_[i * At::count + At::size]; });
}

/// @param get (point) u, or u with its rate: sums are then rates
template <int D, class Get>
void GreenBonds::find_sums(const Kernels& kernels, const Get& get, std::vector<double>& sums) {
  using In = Fields<D>;
  using To = Sums<D>;
  sums.resize(fields_.points() * To::count);
  const auto take_to = [&](std::size_t at) {
    return [&sums, at](std::size_t i, double sum) { sums[i * To::count + at] = sum; };
  };
  for (std::size_t i = 0; i < D; ++i) {
    fields_.fill(i, [&](std::size_t x) { return part(get(x)[i]); });
    fields_.fill(In::cubes + i, [&](std::size_t x) {
      const auto u = get(x);
      return part(dot<D>(u, u) * u[i]);
    });
    fields_.find_sums(kernels.size, i, take_to(To::sizes + i));
    for (std::size_t j = 0; j < D; ++j) {
      fields_.find_sums(kernels.arm[j], i, take_to(To::arms + i * D + j));
    }
    for (std::size_t j = i; j < D; ++j) {
      const std::size_t pair = pair_of(int(i), int(j), D);
      fields_.fill(In::squares + pair, [&](std::size_t x) {
        const auto u = get(x);
        return part(u[i] * u[j]);
      });
      fields_.find_sums(kernels.size, In::squares + pair, take_to(To::squares + pair));
    }
  }
  for (std::size_t i = 0; i < D; ++i) {
    std::vector<Product> products{{&kernels.size, In::cubes + i, 0.5}};
    for (std::size_t j = 0; j < D; ++j) {
      const std::size_t pair = pair_of(int(i), int(j), D);
      products.push_back({&kernels.square[pair], j});
      products.push_back({&kernels.arm[j], In::squares + pair});
      products.push_back({&kernels.arm[i], In::squares + pair_of(int(j), int(j), D), 0.5});
    }
    fields_.find_sums(products, take_to(i));
  }
}

void GreenBonds::take_off_motion(std::span<const double> displacement, LatticeTurn& turn,
                                 std::vector<double>& u) const {
  fields_.take_off_mean(displacement, u);
  turn = turns_.find(fields_, u);
  if (turn.is_one) return;
  std::vector<double> turned = u;
  turns_.take_off(turn, turned);
  fields_.take_off_mean(turned, u);
}

/// Finds the sums of u.
void GreenBonds::take_up(std::span<const double> displacement) {
  state_.assign(displacement.begin(), displacement.end());
  take_off_motion(displacement, turn_, displacement_);
  with_dimension(fields_.dimension(), [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    find_sums<D>(
        kernels_, [&](std::size_t x) { return vector_at<D>(displacement_, x); }, sums_);
  });
}

template <int D>
void GreenBonds::add_up(std::span<double> force) const {
  fields_.for_points([&](std::size_t i) {
    const double* const sums = &sums_[i * Sums<D>::count];
    const Vector<D, double> found = force_of<D>(
        vector_at<D>(displacement_, i), [&](std::size_t k) { return sums[k]; },
        &constants_[i * Constants<D>::count]);
    for (std::size_t c = 0; c < D; ++c) force[i * D + c] = fields_.integrity(i) * found[c];
  });
}

void GreenBonds::find_forces(std::span<const double> displacement, std::span<double> force) {
  take_up(displacement);
  with_dimension(fields_.dimension(),
                 [&](auto dimension) { add_up<decltype(dimension)::value>(force); });
  turn_.put_on(fields_.dimension(), force);
}

void GreenBonds::find_forces_and_energies(std::span<const double> displacement,
                                          std::span<double> force, std::span<double> energy) {
  find_forces(displacement, force);
  with_dimension(fields_.dimension(),
                 [&](auto dimension) { find_energies<decltype(dimension)::value>(energy); });
}

/// Uses the fields that the sums of the same displacements have left.
template <int D>
void GreenBonds::find_energies(std::span<double> energy) {
  using In = Fields<D>;
  fields_.fill(In::quartic, [&](std::size_t i) {
    const Vector<D, double> u = vector_at<D>(displacement_, i);
    return dot<D>(u, u) * dot<D>(u, u);
  });
  std::vector<Product> products{{&kernels_.size, In::quartic, 0.25}};
  for (int i = 0; i < D; ++i) {
    products.push_back({&kernels_.arm[std::size_t(i)], In::cubes + std::size_t(i)});
    for (int j = i; j < D; ++j) {
      const std::size_t pair = pair_of(i, j, D);
      products.push_back({&kernels_.square[pair], In::squares + pair, i == j ? 1.0 : 2.0});
    }
  }
  fields_.find_sums(products, [&](std::size_t i, double sum) {
    const double rest = squares_of<D>(vector_at<D>(displacement_, i), &sums_[i * Sums<D>::count],
                                      &constants_[i * Constants<D>::count]);
    energy[i] = 0.25 * fields_.integrity(i) * (sum + rest);
  });
}

void GreenBonds::multiply(std::span<const double> displacement, std::span<const double> v,
                          std::span<double> product) {
  if (!std::ranges::equal(displacement, state_)) take_up(displacement);
  fields_.take_off_mean(v, direction_);
  turn_.take_off(fields_.dimension(), direction_);
  with_dimension(fields_.dimension(),
                 [&](auto dimension) { find_rates<decltype(dimension)::value>(product); });
  turn_.put_on(fields_.dimension(), product);
}

template <int D>
void GreenBonds::find_rates(std::span<double> product) {
  const auto get = [&](std::size_t i) {
    Vector<D, Dual> at;
    for (std::size_t c = 0; c < D; ++c) {
      at[c] = {displacement_[i * D + c], direction_[i * D + c]};
    }
    return at;
  };
  find_sums<D>(kernels_, get, rates_);
  fields_.for_points([&](std::size_t i) {
    const double *const sums = &sums_[i * Sums<D>::count], *const rates =
                                                               &rates_[i * Sums<D>::count];
    const Vector<D, Dual> found = force_of<D>(
        get(i), [&](std::size_t k) { return Dual(sums[k], rates[k]); },
        &constants_[i * Constants<D>::count]);
    for (std::size_t c = 0; c < D; ++c) {
      product[i * D + c] = -fields_.integrity(i) * found[c].rate;
    }
  });
}

void GreenBonds::outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                                 std::span<double> row_sums) {
  take_up(displacement);  // energies need its fields
  std::vector<double> bounds(row_sums.size());
  with_dimension(fields_.dimension(),
                 [&](auto dimension) { outline<decltype(dimension)::value>(diagonal, bounds); });
  add_rounded_up(bounds, row_sums);
}

/// With y = xi + eta, K has blocks -q q' s (y y + g) of bonds, and minus their sums on its
/// diagonal. For a row Cauchy's inequality gives better bounds than each component's sum of
/// squares: sum q' s |y_r y_c| is at most the root of the product of the sums of y_r^2 and y_c^2,
/// and sum q' s |g| at most that of sum q' s and sum q' s g^2.
template <int D>
void GreenBonds::outline(std::span<double> diagonal, std::span<double> row_sums) {
  std::vector<double> energy(fields_.points());
  find_energies<D>(energy);
  fields_.for_points([&](std::size_t i) {
    const double q = fields_.integrity(i);
    if (q == 0.0) return;
    const double* const constants = &constants_[i * Constants<D>::count];
    const auto [squares, pull] =
        blocks_of<D>(vector_at<D>(displacement_, i), &sums_[i * Sums<D>::count], constants);
    const double of_pulls =
        std::sqrt(std::max(constants[Constants<D>::size] * 4.0 * energy[i] / q, 0.0));
    Matrix<D, double> block = squares;
    Vector<D, double> rows;
    for (std::size_t r = 0; r < D; ++r) {
      block[r][r] += pull;
      rows[r] = of_pulls;
      for (std::size_t c = 0; c < D; ++c) {
        rows[r] += std::abs(block[r][c]) + std::sqrt(std::max(squares[r][r] * squares[c][c], 0.0));
      }
    }
    turn_.bound<D>(rows);
    turn_.put_on<D>(block);
    for (std::size_t r = 0; r < D; ++r) {
      row_sums[i * D + r] = q * rows[r];
      for (std::size_t c = 0; c < D; ++c) diagonal[(i * D + r) * D + c] += q * block[r][c];
    }
  });
}

void GreenBonds::add_virials(std::span<const double> displacement, std::span<double> virials) {
  std::vector<double> u;  // displacement_ stays at the state that is known
  LatticeTurn turn;
  take_off_motion(displacement, turn, u);
  with_dimension(fields_.dimension(), [&](auto dimension) {
    add_virials<decltype(dimension)::value>(u, turn, virials);
  });
}

/// q / 2 sum q' s g (xi + eta) xi per point: forces with kernels times a component of xi.
template <int D>
void GreenBonds::add_virials(const std::vector<double>& u, const LatticeTurn& turn,
                             std::span<double> virials) {
  std::vector<double> constants, sums;
  for (std::size_t c = 0; c < D; ++c) {
    const Kernels kernels = make_kernels(true, [c](const LatticeSpring& of) { return of.arm[c]; });
    find_constants<D>(kernels, constants);
    find_sums<D>(
        kernels, [&](std::size_t x) { return vector_at<D>(u, x); }, sums);
    fields_.for_points([&](std::size_t i) {
      const double* const of_point = &sums[i * Sums<D>::count];
      Vector<D, double> found = force_of<D>(
          vector_at<D>(u, i), [&](std::size_t k) { return of_point[k]; },
          &constants[i * Constants<D>::count]);
      turn.put_on(D, found);
      for (std::size_t a = 0; a < D; ++a) {
        virials[(i * D + a) * D + c] += 0.5 * fields_.integrity(i) * found[a];
      }
    });
  }
}

double GreenBonds::expected_bytes(const LatticeBox& box, std::span<const LatticeSpring> springs) {
  const double d = box.dimension, pairs = d * (d + 1.0) / 2.0;
  // Per site: fields, their sum, kernels on half of the modes. Per point: site and integrity, three
  // displacements and the position, sums and rates, sums of kernels alone.
  return 8.0 * lattice_places(box, steps_of(springs)) *
             (2.0 * d + pairs + 2.0 + 0.5 * (pairs + d + 1.0)) +
         8.0 * double(box.place.size()) *
             (2.0 + 4.0 * d + 2.0 * (2.0 * d + d * d + pairs) + pairs + d + 1.0);
}

double GreenBonds::bytes() const {
  double numbers = 0.0;
  for (const std::vector<double>* kept :
       {&constants_, &state_, &displacement_, &direction_, &sums_, &rates_}) {
    numbers += double(kept->size());
  }
  const auto spectra = double(kernels_.square.size() + kernels_.arm.size() + 1);
  return 8.0 * numbers + fields_.bytes() + turns_.bytes() + spectra * fields_.spectrum_bytes();
}

}  // namespace peristat
