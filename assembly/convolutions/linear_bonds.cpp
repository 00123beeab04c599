#include "assembly/convolutions/linear_bonds.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {
namespace {

using Parity = LatticeFields::Parity;

/// Row a of P, times a vector.
template <int D>
double row_times(const double* pairs, int a, const std::array<double, D>& u) {
  double sum = 0.0;
  for (int b = 0; b < D; ++b) sum += pairs[pair_of(a, b, D)] * u[std::size_t(b)];
  return sum;
}

template <int D>
std::array<double, D> difference(const double* u, const std::array<double, 3>& mean) {
  std::array<double, D> result;
  for (std::size_t c = 0; c < D; ++c) result[c] = u[c] - mean[c];
  return result;
}

LatticeStencil stencil_of(LatticeFields& fields, std::span<const LatticeSpring> springs) {
  const std::vector<double> pairs = fields.pairs();
  LatticeStencil found;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    StencilEntry entry{springs[s].step, {}};
    for (std::size_t c = 0; c < std::size_t(fields.dimension()); ++c) {
      const double n = springs[s].direction[c];
      entry.sum[c] = pairs[s] * springs[s].stiffness * n * n;
    }
    found.push_back(entry);
  }
  return found;
}

}  // namespace

LinearBonds::LinearBonds(const CutLattice& box, const std::array<bool, 3>& is_periodic,
                         std::span<const LatticeSpring> springs, int threads)
    : springs_(springs.begin(), springs.end()),
      fields_(box, is_periodic, steps_of(springs), threads) {
  for (int i = 0; i < box.dimension; ++i) {
    for (int j = i; j < box.dimension; ++j) {
      square_.push_back(fields_.spectrum(Parity::even, [&](std::size_t s) {
        return springs_[s].stiffness * springs_[s].direction[i] * springs_[s].direction[j];
      }));
    }
  }
  // Sums may overwrite the last field of displacements, which is not needed once these are mixed.
  fields_.keep_sums_in(std::size_t(std::max(box.dimension - 1, 1)));
  set_integrity(std::vector<double>(box.place.size(), 1.0));
}

void LinearBonds::set_integrity(std::span<const double> integrity) {
  fields_.set_integrity(integrity);
  const std::size_t pairs = square_.size();
  sums_.resize(fields_.points() * pairs);
  fields_.fill(0, [](std::size_t) { return 1.0; });
  for (std::size_t p = 0; p < pairs; ++p) {
    fields_.find_sums(square_[p], 0,
                      [&](std::size_t i, double sum) { sums_[i * pairs + p] = sum; });
  }
}

/// sign * q (v - P u)
template <int D>
void LinearBonds::find_forces(std::span<const double> displacement, double sign,
                              std::span<double> force) {
  const std::array<double, 3> mean = fields_.mean(displacement);
  for (std::size_t c = 0; c < D; ++c) {
    fields_.fill(c, [&](std::size_t i) { return displacement[i * D + c] - mean[c]; });
  }
  fields_.mix(square_);
  fields_.for_points([&](std::size_t i) {
    const auto u = difference<D>(&displacement[i * D], mean);
    const double* const sum = &sums_[i * pairs_of(D)];
    for (std::size_t a = 0; a < D; ++a) {
      const double from_here = row_times<D>(sum, int(a), u);
      force[i * D + a] = sign * fields_.integrity(i) * (fields_.at(a, i) - from_here);
    }
  });
}

/// Uses the forces f of the same displacements, since q u.v = u.f + q u.P u:
/// w = (q [C_ij * q u_i u_j] - q u.P u) / 4 - u.f / 2.
template <int D>
void LinearBonds::find_energies(std::span<const double> displacement, std::span<const double> force,
                                std::span<double> energy) {
  const std::array<double, 3> mean = fields_.mean(displacement);
  for (int a = 0; a < D; ++a) {
    for (int b = a; b < D; ++b) {
      fields_.fill(0, [&](std::size_t i) {
        const auto u = difference<D>(&displacement[i * D], mean);
        return u[std::size_t(a)] * u[std::size_t(b)];
      });
      const LatticeFields::Product product{&square_[pair_of(a, b, D)], 0, a == b ? 1.0 : 2.0};
      fields_.gather(std::span(&product, 1), a == 0 && b == 0);
    }
  }
  fields_.take_sums([&](std::size_t i, double squares) {
    const auto u = difference<D>(&displacement[i * D], mean);
    double work = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      squares -= u[a] * row_times<D>(&sums_[i * pairs_of(D)], int(a), u);
      work += u[a] * force[i * D + a];
    }
    energy[i] = 0.25 * fields_.integrity(i) * squares - 0.5 * work;
  });
}

void LinearBonds::find_forces(std::span<const double> displacement, std::span<double> force) {
  with_dimension(fields_.dimension(),
                 [&](auto dimension) { find_forces<dimension>(displacement, 1.0, force); });
}

void LinearBonds::find_forces_and_energies(std::span<const double> displacement,
                                           std::span<double> force, std::span<double> energy) {
  with_dimension(fields_.dimension(), [&](auto dimension) {
    find_forces<dimension>(displacement, 1.0, force);
    find_energies<dimension>(displacement, force, energy);
  });
}

void LinearBonds::multiply(std::span<const double> /*displacement*/, std::span<const double> v,
                           std::span<double> product) {
  with_dimension(fields_.dimension(),
                 [&](auto dimension) { find_forces<dimension>(v, -1.0, product); });
}

void LinearBonds::outline_tangent(std::span<const double> /*displacement*/,
                                  std::span<double> diagonal, std::span<double> row_sums) {
  const int d = fields_.dimension();
  const auto size = std::size_t(d);
  for (std::size_t i = 0; i < fields_.points(); ++i) {
    const double* const sum = &sums_[i * square_.size()];
    double trace = 0.0;
    for (int a = 0; a < d; ++a) trace += sum[pair_of(a, a, d)];
    for (int a = 0; a < d; ++a) {
      double& row = row_sums[i * size + std::size_t(a)];
      row += 0.5 * fields_.integrity(i) * (trace + double(d) * sum[pair_of(a, a, d)]);
      for (int b = 0; b < d; ++b) {
        const double entry = fields_.integrity(i) * sum[pair_of(a, b, d)];
        diagonal[(i * size + std::size_t(a)) * size + std::size_t(b)] += entry;
        row += std::abs(entry);
      }
    }
  }
}

LatticeStencil LinearBonds::stencil() { return stencil_of(fields_, springs_); }

/// q sum_j q_j K_abc (u_j - u_i)_b with the odd kernel K_abc(xi) = k n_a n_b xi_c / 2, which is
/// symmetric in its components.
void LinearBonds::add_virials(std::span<const double> displacement, std::span<double> virials) {
  const std::array<double, 3> mean = fields_.mean(displacement);
  const int d = fields_.dimension();
  const auto size = std::size_t(d);
  const auto add = [&](int a, int b, int c, bool is_own) {
    const LatticeSpectrum kernel = fields_.spectrum(Parity::odd, [&](std::size_t s) {
      const LatticeSpring& of = springs_[s];
      return 0.5 * of.stiffness * of.direction[a] * of.direction[b] * of.arm[c];
    });
    fields_.find_sums(kernel, 0, [&](std::size_t i, double sum) {
      const double u = displacement[i * size + std::size_t(b)] - mean[std::size_t(b)];
      sum *= fields_.integrity(i) * (is_own ? -u : 1.0);
      virials[(i * size + std::size_t(a)) * size + std::size_t(c)] += sum;
      if (a != c) virials[(i * size + std::size_t(c)) * size + std::size_t(a)] += sum;
    });
  };
  for (int b = 0; b <= d; ++b) {
    const bool is_own = b == d;
    fields_.fill(0, [&](std::size_t i) {
      const auto of = std::size_t(b);
      return is_own ? 1.0 : displacement[i * size + of] - mean[of];
    });
    for (int a = 0; a < d; ++a) {
      for (int c = a; c < d; ++c) {
        for (int own = 0; is_own && own < d; ++own) add(a, own, c, true);
        if (!is_own) add(a, b, c, false);
      }
    }
  }
}

LatticeStencil lattice_stencil(const LatticeBox& box, std::span<const LatticeSpring> springs,
                               std::span<const double> integrity, int threads) {
  LatticeFields fields(box, {}, steps_of(springs), threads);
  fields.set_integrity(integrity);
  return stencil_of(fields, springs);
}

double convolved_bytes(const LatticeBox& box, std::span<const LatticeSpring> springs) {
  const std::vector<LatticeStep> steps = steps_of(springs);
  const double d = box.dimension, pairs = d * (d + 1.0) / 2.0;
  // On turned lattices kernels of two components are not their own mirror images.
  const bool is_turned = std::ranges::any_of(springs, [&](const LatticeSpring& spring) {
    bool is_off = false;
    for (std::size_t c = 0; c < std::size_t(box.dimension); ++c) {
      is_off = is_off || (spring.step[c] == 0 && spring.direction[c] != 0.0);
    }
    return is_off;
  });
  const double kept = is_turned ? 0.5 : std::pow(0.5, d);
  // Per site: fields by component, and the amplitudes that are kept. Per point: site, integrity and
  // sums.
  return 8.0 * lattice_places(box, steps) * (std::max(d, 2.0) + kept * pairs) +
         double(box.place.size()) * (12.0 + 8.0 * pairs);
}

std::vector<std::vector<double>> lattice_sums(const CutLattice& box,
                                              std::span<const LatticeSpring> springs,
                                              std::span<const std::vector<double>> kernels,
                                              std::span<const double> field, int threads) {
  LatticeFields fields(box, {}, steps_of(springs), threads);
  fields.set_integrity(field);
  fields.fill(0, [](std::size_t) { return 1.0; });
  std::vector<std::vector<double>> sums;
  for (const std::vector<double>& kernel : kernels) {
    const LatticeSpectrum amplitudes =
        fields.spectrum(Parity::even, [&](std::size_t s) { return kernel[s]; });
    std::vector<double>& of_kernel = sums.emplace_back(box.place.size());
    fields.find_sums(amplitudes, 0, [&](std::size_t i, double sum) { of_kernel[i] = sum; });
  }
  return sums;
}

}  // namespace peristat
