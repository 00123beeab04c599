#include "assembly/convolutions/linear_solid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "src/parallel/collectives.hpp"

namespace peristat {
namespace {

using Parity = LatticeFields::Parity;
using Product = LatticeFields::Product;

double squared(const Coordinates& xi) { return xi[0] * xi[0] + xi[1] * xi[1] + xi[2] * xi[2]; }

/// |xi_x| + |xi_y| + |xi_z|
double taxi(const Coordinates& xi) { return std::abs(xi[0]) + std::abs(xi[1]) + std::abs(xi[2]); }

/// Row i of a symmetric matrix that is stored by pairs, times a vector.
template <int D>
double row_times(const double* pairs, int i, const double* u) {
  double sum = 0.0;
  for (int j = 0; j < D; ++j) sum += pairs[pair_of(i, j, D)] * u[j];
  return sum;
}

}  // namespace

LinearSolid::LinearSolid(const CutLattice& box, const std::array<bool, 3>& is_periodic,
                         std::vector<LatticeArm> arms, const Setting& setting, int threads)
    : arms_(std::move(arms)),
      setting_(setting),
      fields_(box, is_periodic, steps_of(arms_), threads) {
  const int d = box.dimension;
  if (d < 2) throw std::logic_error("states are of dimension 2 or 3");
  const auto& [lambda, mu] = setting.constants;
  dilatational_ = setting.volume * d * (lambda - mu);
  deviatoric_ = setting.volume * d * (d + 2) * mu;
  moment_ = fields_.spectrum(Parity::even,
                             [&](std::size_t s) { return arms_[s].share * squared(arms_[s].xi); });
  std::ranges::fill(moment_.values, 0.0);  // a pre-crack does not change M
  for (const LatticeArm& arm : arms_) whole_moment_ += 2.0 * arm.share * squared(arm.xi);
  for (int i = 0; i < d; ++i) {
    arm_.push_back(fields_.spectrum(
        Parity::odd, [&](std::size_t s) { return arms_[s].share * arms_[s].xi[i]; }));
    for (int j = i; j < d; ++j) {
      square_.push_back(fields_.spectrum(Parity::even, [&](std::size_t s) {
        const Coordinates& xi = arms_[s].xi;
        return arms_[s].share * xi[i] * xi[j] / squared(xi);
      }));
    }
  }
  set_integrity(std::vector<double>(box.place.size(), 1.0));
}

void LinearSolid::set_integrity(std::span<const double> integrity) {
  fields_.set_integrity(integrity);
  if (fields_.dimension() == 2) renew_sums<2>();
  if (fields_.dimension() == 3) renew_sums<3>();
}

template <int D>
void LinearSolid::renew_sums() {
  constexpr std::size_t pairs = pairs_of(D);
  const std::size_t points = fields_.points();
  inverse_moment_.resize(points);
  arms_left_.resize(points * D);
  squares_left_.resize(points * pairs);
  weighted_squares_.resize(points * pairs);
  fields_.fill(0, [](std::size_t) { return 1.0; });
  fields_.find_sums(moment_, 0, [&](std::size_t i, double sum) {
    const bool is_lonely = sum <= least_neighbourhood * whole_moment_;
    inverse_moment_[i] = is_lonely ? 0.0 : 1.0 / sum;
  });
  fields_.leave_out_lonely(0.0, [&](std::size_t i) { return inverse_moment_[i]; });
  for (std::size_t i = setting_.own; i < points; ++i) inverse_moment_[i] = 0.0;
  for (std::size_t c = 0; c < D; ++c) {
    fields_.find_sums(arm_[c], 0, [&](std::size_t i, double sum) { arms_left_[i * D + c] = sum; });
  }
  fields_.fill(1, [&](std::size_t i) { return inverse_moment_[i]; });
  for (std::size_t p = 0; p < pairs; ++p) {
    fields_.find_sums(square_[p], 0,
                      [&](std::size_t i, double sum) { squares_left_[i * pairs + p] = sum; });
    fields_.find_sums(square_[p], 1,
                      [&](std::size_t i, double sum) { weighted_squares_[i * pairs + p] = sum; });
  }
}

/// Finds theta, and leaves the displacements in fields 0 ... D - 1.
template <int D>
void LinearSolid::find_dilatations() {
  dilatation_.resize(fields_.points());
  std::array<Product, D> products;
  for (std::size_t c = 0; c < D; ++c) {
    fields_.fill(c, [&](std::size_t i) { return displacement_[i * D + c]; });
    products[c] = {&arm_[c], c};
  }
  fields_.find_sums(products, [&](std::size_t i, double sum) {
    for (std::size_t c = 0; c < D; ++c) sum -= displacement_[i * D + c] * arms_left_[i * D + c];
    dilatation_[i] = D * inverse_moment_[i] * sum;
  });
}

/// Finds the sums of q' kappa n n . u' alone, if asked for, and those of all other neighbour terms.
template <int D>
void LinearSolid::find_pulls(bool alone) {
  pulls_.resize(fields_.points() * D);
  weighted_pulls_.resize(fields_.points() * D);
  std::array<Product, D + 1> products;
  const auto take_squares = [&](int c, std::size_t field, double factor) {
    for (int j = 0; j < D; ++j) {
      products[std::size_t(j)] = {&square_[pair_of(c, j, D)], field + std::size_t(j), factor};
    }
  };
  for (int c = 0; c < D && alone; ++c) {
    take_squares(c, 0, 1.0);
    fields_.find_sums(std::span(products).first(D),
                      [&](std::size_t i, double sum) { pulls_[i * D + std::size_t(c)] = sum; });
  }
  for (std::size_t c = 0; c < D && !is_printed(); ++c) {
    fields_.fill(D + c,
                 [&](std::size_t i) { return displacement_[i * D + c] * inverse_moment_[i]; });
  }
  fields_.fill(2 * D, [&](std::size_t i) { return dilatation_[i] * inverse_moment_beside(i); });
  for (int c = 0; c < D; ++c) {
    take_squares(c, is_printed() ? 0 : D, is_printed() ? 2.0 * deviatoric_ : deviatoric_);
    products[D] = {&arm_[std::size_t(c)], 2 * D, dilatational_};
    fields_.find_sums(products, [&](std::size_t i, double sum) {
      weighted_pulls_[i * D + std::size_t(c)] = sum;
    });
  }
}

template <int D>
void LinearSolid::add_up(std::span<double> force) const {
  constexpr std::size_t pairs = pairs_of(D);
  const bool printed = is_printed();
  fields_.for_points([&](std::size_t i) {
    const double* const u = &displacement_[i * D];
    for (int c = 0; c < D; ++c) {
      const std::size_t k = i * D + std::size_t(c);
      const double here = row_times<D>(&squares_left_[i * pairs], c, u);
      const double dilating = dilatational_ * dilatation_[i] * arms_left_[k];
      const double by_moment = dilating + (printed ? weighted_pulls_[k] - 2.0 * deviatoric_ * here
                                                   : deviatoric_ * (pulls_[k] - here));
      force[k] = inverse_moment_[i] * by_moment;
      if (!printed) {
        const double weighted = row_times<D>(&weighted_squares_[i * pairs], c, u);
        force[k] += weighted_pulls_[k] - deviatoric_ * weighted;
      }
      force[k] *= fields_.integrity(i);
    }
  });
}

void LinearSolid::find_forces(std::span<const double> displacement, std::span<double> force,
                              bool alone) {
  fields_.take_off_mean(displacement, displacement_);
  with_dimension(fields_.dimension(), [&](auto dimension) {
    constexpr int D = dimension;
    if constexpr (D > 1) {
      find_dilatations<D>();
      find_pulls<D>(alone);
      add_up<D>(force);
    }
  });
}

void LinearSolid::find_forces(std::span<const double> displacement, std::span<double> force) {
  find_forces(displacement, force, !is_printed());
}

void LinearSolid::find_forces_and_energies(std::span<const double> displacement,
                                           std::span<double> force, std::span<double> energy) {
  find_forces(displacement, force, true);
  if (fields_.dimension() == 2) find_energies<2>(energy);
  if (fields_.dimension() == 3) find_energies<3>(energy);
}

/// Uses the forces of the same displacements, and sums of q' kappa n n . u' alone.
template <int D>
void LinearSolid::find_energies(std::span<double> energy) {
  constexpr std::size_t pairs = pairs_of(D);
  std::array<Product, pairs> products;
  for (int a = 0; a < D; ++a) {
    for (int b = a; b < D; ++b) {
      const std::size_t pair = pair_of(a, b, D), field = D + pair;
      fields_.fill(field, [&](std::size_t i) {
        return displacement_[i * D + std::size_t(a)] * displacement_[i * D + std::size_t(b)];
      });
      products[pair] = {&square_[pair], field, a == b ? 1.0 : 2.0};
    }
  }
  fields_.find_sums(products, [&](std::size_t i, double sum) {
    const double* const u = &displacement_[i * D];
    for (int c = 0; c < D; ++c) {
      const double here = row_times<D>(&squares_left_[i * pairs], c, u);
      sum += u[c] * (here - 2.0 * pulls_[i * D + std::size_t(c)]);
    }
    const double dilating = dilatational_ / D * dilatation_[i] * dilatation_[i];
    energy[i] = 0.5 * fields_.integrity(i) * (dilating + deviatoric_ * inverse_moment_[i] * sum);
  });
}

void LinearSolid::multiply(std::span<const double> /*displacement*/, std::span<const double> v,
                           std::span<double> product) {
  find_forces(v, product);
  for (double& entry : product) entry = -entry;
}

void LinearSolid::outline_tangent(std::span<const double> /*displacement*/,
                                  std::span<double> diagonal, std::span<double> row_sums) {
  std::vector<double> bounds(row_sums.size());
  if (fields_.dimension() == 2) {
    outline_blocks<2>(diagonal);
    bound_rows<2>(bounds);
  } else {
    outline_blocks<3>(diagonal);
    bound_rows<3>(bounds);
  }
  add_rounded_up(bounds, row_sums);
}

/// With g = dtheta/du of the point itself, -(d / M) sum q' kappa xi, and g' = d q kappa xi / M' of
/// each neighbour's theta',
///
///   K = q V (lambda - mu) g g + sum q' V (lambda - mu) g' g' + q sum q' (b + b') V kappa n n,
///
/// in form `printed` with 1 / M of the point itself in the place of one 1 / M'.
template <int D>
void LinearSolid::outline_blocks(std::span<double> diagonal) {
  constexpr std::size_t pairs = pairs_of(D);
  fields_.fill(0, [&](std::size_t i) { return inverse_moment_[i] * inverse_moment_beside(i); });
  for (int a = 0; a < D; ++a) {
    for (int b = a; b < D; ++b) {
      const std::size_t pair = pair_of(a, b, D);
      const LatticeSpectrum kernel = fields_.spectrum(Parity::even, [&](std::size_t s) {
        const LatticeArm& arm = arms_[s];
        return arm.share * arm.share * arm.xi[a] * arm.xi[b];
      });
      fields_.find_sums(kernel, 0, [&](std::size_t i, double sum) {
        const double q = fields_.integrity(i), by_moment = inverse_moment_[i];
        const double arms = arms_left_[i * D + std::size_t(a)] * arms_left_[i * D + std::size_t(b)];
        const double squares = by_moment * squares_left_[i * pairs + pair];
        const double others = is_printed() ? squares : weighted_squares_[i * pairs + pair];
        const double dilating =
            by_moment * by_moment * arms + q * sum * (is_printed() ? by_moment : 1.0);
        const double entry = q * (D * dilatational_ * dilating + deviatoric_ * (squares + others));
        diagonal[(i * D + std::size_t(a)) * D + std::size_t(b)] += entry;
        if (a != b) diagonal[(i * D + std::size_t(b)) * D + std::size_t(a)] += entry;
      });
    }
  }
}

/// A dilatation adds |g_row| times the sum of all its |g| to a row; a bond adds |n_row| (|n_x| +
/// |n_y| + |n_z|) twice.
template <int D>
void LinearSolid::bound_rows(std::span<double> row_sums) {
  std::vector<double> reach(fields_.points());  // sums of |g| without d / M
  fields_.fill(0, [](std::size_t) { return 1.0; });
  const LatticeSpectrum lengths = fields_.spectrum(
      Parity::even, [&](std::size_t s) { return arms_[s].share * taxi(arms_[s].xi); });
  fields_.find_sums(lengths, 0, [&](std::size_t i, double sum) {
    for (std::size_t c = 0; c < D; ++c) sum += std::abs(arms_left_[i * D + c]);
    reach[i] = inverse_moment_[i] * sum;
  });
  const double dilatational = D * std::abs(dilatational_);
  fields_.fill(1, [&](std::size_t i) { return inverse_moment_[i]; });
  fields_.fill(2, [&](std::size_t i) { return reach[i] * inverse_moment_beside(i); });
  for (std::size_t c = 0; c < D; ++c) {
    const LatticeSpectrum along = fields_.spectrum(
        Parity::even, [&](std::size_t s) { return arms_[s].share * std::abs(arms_[s].xi[c]); });
    const LatticeSpectrum bonds = fields_.spectrum(Parity::even, [&](std::size_t s) {
      const Coordinates& xi = arms_[s].xi;
      return arms_[s].share * std::abs(xi[c]) * taxi(xi) / squared(xi);
    });
    const std::array<Product, 2> weighted{Product{&along, 2, dilatational},
                                          Product{&bonds, 1, 2.0 * deviatoric_}};
    const auto count = is_printed() ? 1U : 2U;
    fields_.find_sums(std::span(weighted).first(count), [&](std::size_t i, double sum) {
      row_sums[i * D + c] = sum * (is_printed() ? inverse_moment_[i] : 1.0);
    });
    const double here = is_printed() ? 4.0 * deviatoric_ : 2.0 * deviatoric_;
    fields_.find_sums(bonds, 0, [&](std::size_t i, double sum) {
      const double own = dilatational * reach[i] * std::abs(arms_left_[i * D + c]);
      double& row = row_sums[i * D + c];
      row = fields_.integrity(i) * (row + inverse_moment_[i] * (own + here * sum));
    });
  }
}

void LinearSolid::add_virials(std::span<const double> displacement, std::span<double> virials) {
  fields_.take_off_mean(displacement, displacement_);
  if (fields_.dimension() == 2) add_virials<2>(virials);
  if (fields_.dimension() == 3) add_virials<3>(virials);
}

/// q V / M sum q' kappa (d (lambda - mu) theta xi xi + d (d + 2) mu (n . eta) n xi) per point.
template <int D>
void LinearSolid::add_virials(std::span<double> virials) {
  find_dilatations<D>();
  fields_.fill(D, [](std::size_t) { return 1.0; });
  for (int a = 0; a < D; ++a) {
    for (int c = a; c < D; ++c) {
      const auto add = [&](std::size_t i, double sum) {
        sum *= fields_.integrity(i) * inverse_moment_[i];
        virials[(i * D + std::size_t(a)) * D + std::size_t(c)] += sum;
        if (a != c) virials[(i * D + std::size_t(c)) * D + std::size_t(a)] += sum;
      };
      const LatticeSpectrum shape = fields_.spectrum(Parity::even, [&](std::size_t s) {
        return arms_[s].share * arms_[s].xi[a] * arms_[s].xi[c];
      });
      fields_.find_sums(shape, D, [&](std::size_t i, double sum) {
        add(i, dilatational_ * dilatation_[i] * sum);
      });
      for (std::size_t b = 0; b < D; ++b) {
        const LatticeSpectrum cubic = fields_.spectrum(Parity::odd, [&](std::size_t s) {
          const Coordinates& xi = arms_[s].xi;
          return deviatoric_ * arms_[s].share * xi[a] * xi[b] * xi[c] / squared(xi);
        });
        fields_.find_sums(cubic, b, add);
        fields_.find_sums(
            cubic, D, [&](std::size_t i, double sum) { add(i, -displacement_[i * D + b] * sum); });
      }
    }
  }
}

double LinearSolid::bytes() const {
  double numbers = 0.0;
  for (const std::vector<double>* kept :
       {&inverse_moment_, &arms_left_, &squares_left_, &weighted_squares_, &displacement_,
        &dilatation_, &pulls_, &weighted_pulls_}) {
    numbers += double(kept->size());
  }
  const auto spectra = double(1 + arm_.size() + square_.size());
  return 8.0 * numbers + fields_.bytes() + spectra * fields_.spectrum_bytes();
}

double convolved_bytes(const LatticeBox& box, std::span<const LatticeArm> arms) {
  const double d = box.dimension, pairs = 0.5 * d * (d + 1.0);
  // Per site: fields of forces or of energies, that of sums, and all kernels at half of the modes,
  // as on turned lattices. Per point: 1 / M, theta, sums of arms, displacements and both pulls,
  // sums of squares with and without 1 / M, site and integrity.
  const double fields = std::max(2.0 * d + 1.0, d + pairs) + 1.0;
  return 8.0 * lattice_places(box, steps_of(arms)) * (fields + 0.5 * (1.0 + d + pairs)) +
         double(box.place.size()) * (8.0 * (2.0 + 4.0 * d + 2.0 * pairs) + 12.0);
}

}  // namespace peristat
