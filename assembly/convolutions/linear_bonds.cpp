#include "assembly/convolutions/linear_bonds.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace peristat {
namespace {

/// The lattice's axes as the last ones of the box: the last one has the real values of a row.
template <class T>
std::array<T, 3> as_last(const std::array<T, 3>& of_lattice, int dimension) {
  std::array<T, 3> result{};
  std::copy_n(of_lattice.begin(), dimension, result.end() - dimension);
  return result;
}

/// The box with room for what the springs reach.
std::array<ConvolutionAxis, 3> axes_of(const LatticeBox& box,
                                       const std::array<bool, 3>& is_periodic,
                                       std::span<const LatticeSpring> springs) {
  std::array<ConvolutionAxis, 3> axes;
  for (std::size_t a = 0; a < 3; ++a) {
    axes[a].count = box.extent[a];
    axes[a].is_periodic = is_periodic[a];
    for (const LatticeSpring& spring : springs) {
      axes[a].reach = std::max(axes[a].reach, Index(std::abs(spring.step[a])));
    }
    if (is_periodic[a] && axes[a].reach >= axes[a].count) {
      throw std::logic_error("a period must be longer than bonds: points would see themselves");
    }
  }
  return as_last(axes, box.dimension);
}

/// A point's place in a field.
std::vector<std::size_t> places_of(const LatticeBox& box, const FourierTransform& transform) {
  std::vector<std::size_t> where;
  where.reserve(box.place.size());
  for (const Index place : box.place) {
    const std::array<Index, 3> at = as_last(box.numbers(place), box.dimension);
    where.push_back(transform.at(at[0], at[1], at[2]));
  }
  return where;
}

/// field_j := sum_i C_ij field_i, mode by mode.
template <int D>
void multiply_modes(const std::vector<std::vector<double>>& amplitudes,
                    std::vector<fftw::Buffer>& fields, std::size_t modes, int threads) {
  std::array<double*, D> field;
  for (std::size_t c = 0; c < D; ++c) field[c] = fields[c].data();
  const auto count = static_cast<std::ptrdiff_t>(modes);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    double real[D] = {}, imaginary[D] = {};
    std::size_t pair = 0;
    for (int i = 0; i < D; ++i) {
      for (int j = i; j < D; ++j, ++pair) {
        const double c = amplitudes[pair][std::size_t(k)];
        real[i] += c * field[j][2 * k];
        imaginary[i] += c * field[j][2 * k + 1];
        if (i == j) continue;
        real[j] += c * field[i][2 * k];
        imaginary[j] += c * field[i][2 * k + 1];
      }
    }
    for (int i = 0; i < D; ++i) {
      field[i][2 * k] = real[i];
      field[i][2 * k + 1] = imaginary[i];
    }
  }
}

/// By the numbers of pairs, a convolution of q with itself.
LatticeStencil stencil_of(const FourierTransform& transform, const std::vector<std::size_t>& where,
                          std::span<const double> integrity, std::span<const LatticeSpring> springs,
                          int dimension) {
  fftw::Buffer field = transform.make_field();
  for (std::size_t i = 0; i < where.size(); ++i) field.data()[where[i]] = integrity[i];
  transform.to_modes(field);
  for (std::size_t k = 0; k < transform.modes(); ++k) {
    double* const mode = field.data() + 2 * k;
    mode[0] = (mode[0] * mode[0] + mode[1] * mode[1]) / double(transform.places());
    mode[1] = 0.0;
  }
  transform.to_places(field);
  LatticeStencil found;
  const std::array<Index, 3>& size = transform.size();
  for (const LatticeSpring& spring : springs) {
    const std::array<int, 3> step = as_last(spring.step, dimension);
    std::array<Index, 3> at;
    for (std::size_t a = 0; a < 3; ++a) at[a] = (step[a] % size[a] + size[a]) % size[a];
    const double pairs = field.data()[transform.at(at[0], at[1], at[2])];
    StencilEntry entry{spring.step, {}};
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
      entry.sum[c] = pairs * spring.stiffness * spring.direction[c] * spring.direction[c];
    }
    found.push_back(entry);
  }
  return found;
}

}  // namespace

LinearBonds::LinearBonds(const LatticeBox& box, const std::array<bool, 3>& is_periodic,
                         std::span<const LatticeSpring> springs, int threads)
    : dimension_(box.dimension),
      points_(static_cast<std::ptrdiff_t>(box.place.size())),
      springs_(springs.begin(), springs.end()),
      convolution_(axes_of(box, is_periodic, springs), threads) {
  const FourierTransform& transform = convolution_.transform();
  where_ = places_of(box, transform);
  std::vector<KernelValue> kernel;
  for (const LatticeSpring& spring : springs)
    kernel.push_back({as_last(spring.step, dimension_), 0.0});
  for (int i = 0; i < dimension_; ++i) {
    for (int j = i; j < dimension_; ++j) {
      for (std::size_t s = 0; s < springs.size(); ++s) {
        kernel[s].value = springs[s].stiffness * springs[s].direction[i] * springs[s].direction[j];
      }
      amplitudes_.push_back(convolution_.amplitudes(kernel, Convolution::Parity::even));
    }
  }
  for (int c = 0; c < dimension_; ++c) fields_.push_back(transform.make_field());
  set_integrity(std::vector<double>(box.place.size(), 1.0));
}

std::size_t LinearBonds::pair(int i, int j) const {
  if (i > j) std::swap(i, j);
  return std::size_t(i * dimension_ - i * (i - 1) / 2 + j - i);
}

void LinearBonds::clear(fftw::Buffer& field) const {
  const std::span<double> values = field.values();
  const auto count = static_cast<std::ptrdiff_t>(values.size());
#pragma omp parallel for num_threads(convolution_.transform().threads()) schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) values[std::size_t(k)] = 0.0;
}

void LinearBonds::set_integrity(std::span<const double> integrity) {
  integrity_.assign(integrity.begin(), integrity.end());
  sums_.resize(std::size_t(points_) * pairs());
  const FourierTransform& transform = convolution_.transform();
  fftw::Buffer modes = transform.make_field();
  for (std::size_t i = 0; i < where_.size(); ++i) modes.data()[where_[i]] = integrity_[i];
  transform.to_modes(modes);
  fftw::Buffer& field = fields_.front();
  for (std::size_t p = 0; p < pairs(); ++p) {
    for (std::size_t k = 0; k < transform.modes(); ++k) {
      field.data()[2 * k] = amplitudes_[p][k] * modes.data()[2 * k];
      field.data()[2 * k + 1] = amplitudes_[p][k] * modes.data()[2 * k + 1];
    }
    transform.to_places(field);
    for (std::size_t i = 0; i < where_.size(); ++i) {
      sums_[i * pairs() + p] = field.data()[where_[i]];
    }
  }
}

void LinearBonds::take_up(std::span<const double> displacement) {
  const auto d = std::size_t(dimension_);
  std::array<double, 3> mean{};
  for (std::size_t k = 0; k < displacement.size(); ++k) mean[k % d] += displacement[k];
  for (double& of_component : mean) of_component /= double(points_);
  displacement_.resize(displacement.size());
  for (std::size_t k = 0; k < displacement.size(); ++k) {
    displacement_[k] = displacement[k] - mean[k % d];
  }
}

/// fields_ become v.
void LinearBonds::convolve_displacements() {
  const FourierTransform& transform = convolution_.transform();
  const auto d = std::size_t(dimension_);
  for (std::size_t c = 0; c < d; ++c) {
    clear(fields_[c]);
    double* const field = fields_[c].data();
#pragma omp parallel for num_threads(transform.threads()) schedule(static)
    for (std::ptrdiff_t i = 0; i < points_; ++i) {
      const auto point = std::size_t(i);
      field[where_[point]] = integrity_[point] * displacement_[point * d + c];
    }
    transform.to_modes(fields_[c]);
  }
  if (d == 1) multiply_modes<1>(amplitudes_, fields_, transform.modes(), transform.threads());
  if (d == 2) multiply_modes<2>(amplitudes_, fields_, transform.modes(), transform.threads());
  if (d == 3) multiply_modes<3>(amplitudes_, fields_, transform.modes(), transform.threads());
  for (fftw::Buffer& field : fields_) transform.to_places(field);
}

/// squares_[1] becomes [C_ij * q u_i u_j].
void LinearBonds::convolve_squares() {
  const FourierTransform& transform = convolution_.transform();
  const auto d = std::size_t(dimension_);
  for (fftw::Buffer& field : squares_) {
    if (field.values().empty()) field = transform.make_field();
  }
  double *const field = squares_[0].data(), *const sum = squares_[1].data();
  clear(squares_[1]);
  for (int a = 0; a < dimension_; ++a) {
    for (int b = a; b < dimension_; ++b) {
      clear(squares_[0]);
#pragma omp parallel for num_threads(transform.threads()) schedule(static)
      for (std::ptrdiff_t i = 0; i < points_; ++i) {
        const auto point = std::size_t(i);
        const double* const u = &displacement_[point * d];
        field[where_[point]] = integrity_[point] * u[a] * u[b];
      }
      transform.to_modes(squares_[0]);
      const std::vector<double>& of_pair = amplitudes_[pair(a, b)];
      const double times = a == b ? 1.0 : 2.0;
      const auto modes = static_cast<std::ptrdiff_t>(of_pair.size());
#pragma omp parallel for num_threads(transform.threads()) schedule(static)
      for (std::ptrdiff_t k = 0; k < modes; ++k) {
        const double c = times * of_pair[std::size_t(k)];
        sum[2 * k] += c * field[2 * k];
        sum[2 * k + 1] += c * field[2 * k + 1];
      }
    }
  }
  transform.to_places(squares_[1]);
}

void LinearBonds::find_forces(std::span<const double> displacement, std::span<double> force) {
  take_up(displacement);
  convolve_displacements();
  const auto d = std::size_t(dimension_);
#pragma omp parallel for num_threads(convolution_.transform().threads()) schedule(static)
  for (std::ptrdiff_t i = 0; i < points_; ++i) {
    const auto point = std::size_t(i);
    const double* const u = &displacement_[point * d];
    const double* const sum = &sums_[point * pairs()];
    for (int a = 0; a < dimension_; ++a) {
      double from_here = 0.0;
      for (int b = 0; b < dimension_; ++b) from_here += sum[pair(a, b)] * u[b];
      const double v = fields_[std::size_t(a)].data()[where_[point]];
      force[point * d + std::size_t(a)] = integrity_[point] * (v - from_here);
    }
  }
}

void LinearBonds::find_forces_and_energies(std::span<const double> displacement,
                                           std::span<double> force, std::span<double> energy) {
  find_forces(displacement, force);
  convolve_squares();
  const auto d = std::size_t(dimension_);
#pragma omp parallel for num_threads(convolution_.transform().threads()) schedule(static)
  for (std::ptrdiff_t i = 0; i < points_; ++i) {
    const auto point = std::size_t(i);
    const double* const u = &displacement_[point * d];
    const double* const sum = &sums_[point * pairs()];
    double w = squares_[1].data()[where_[point]];
    for (int a = 0; a < dimension_; ++a) {
      w -= 2.0 * u[a] * fields_[std::size_t(a)].data()[where_[point]];
      for (int b = 0; b < dimension_; ++b) w += sum[pair(a, b)] * u[a] * u[b];
    }
    energy[point] = 0.25 * integrity_[point] * w;
  }
}

void LinearBonds::multiply(std::span<const double> /*displacement*/, std::span<const double> v,
                           std::span<double> product) {
  find_forces(v, product);
  for (double& entry : product) entry = -entry;
}

void LinearBonds::outline_tangent(std::span<const double> /*displacement*/,
                                  std::span<double> diagonal, std::span<double> row_sums) {
  const auto d = std::size_t(dimension_);
  for (std::size_t i = 0; i < std::size_t(points_); ++i) {
    const double* const sum = &sums_[i * pairs()];
    double trace = 0.0;
    for (int a = 0; a < dimension_; ++a) trace += sum[pair(a, a)];
    for (int a = 0; a < dimension_; ++a) {
      double& row = row_sums[i * d + std::size_t(a)];
      row += 0.5 * integrity_[i] * (trace + double(d) * sum[pair(a, a)]);
      for (int b = 0; b < dimension_; ++b) {
        const double entry = integrity_[i] * sum[pair(a, b)];
        diagonal[(i * d + std::size_t(a)) * d + std::size_t(b)] += entry;
        row += std::abs(entry);
      }
    }
  }
}

LatticeStencil LinearBonds::stencil() {
  return stencil_of(convolution_.transform(), where_, integrity_, springs_, dimension_);
}

LatticeStencil lattice_stencil(const LatticeBox& box, std::span<const LatticeSpring> springs,
                               std::span<const double> integrity, int threads) {
  const Convolution convolution(axes_of(box, {}, springs), threads);
  const FourierTransform& transform = convolution.transform();
  return stencil_of(transform, places_of(box, transform), integrity, springs, box.dimension);
}

double padded_places(const LatticeBox& box, std::span<const LatticeSpring> springs) {
  double places = 1.0;
  const std::array<ConvolutionAxis, 3> axes = axes_of(box, {}, springs);
  for (std::size_t a = 0; a < 3; ++a) places *= double(axes[a].size(a == 2));
  return places;
}

double convolved_bytes(const LatticeBox& box, std::span<const LatticeSpring> springs) {
  const double places = padded_places(box, springs);
  const double d = box.dimension, pairs = d * (d + 1.0) / 2.0;
  // Of a place fields by component and two for energies, and amplitudes of half of the modes; of a
  // point where it is, its integrity, sums and displacement.
  return 8.0 * places * (d + 2.0 + 0.5 * pairs) +
         8.0 * double(box.place.size()) * (2.0 + pairs + d);
}

void LinearBonds::add_virials(std::span<const double> displacement, std::span<double> virials) {
  const FourierTransform& transform = convolution_.transform();
  const auto d = std::size_t(dimension_);
  take_up(displacement);
  std::vector<fftw::Buffer> modes;  // of q, and of q u_b
  for (std::size_t b = 0; b <= d; ++b) {
    modes.push_back(transform.make_field());
    for (std::size_t i = 0; i < where_.size(); ++i) {
      const double moved = b == d ? 1.0 : displacement_[i * d + b];
      modes.back().data()[where_[i]] = integrity_[i] * moved;
    }
    transform.to_modes(modes.back());
  }
  fftw::Buffer field = transform.make_field();
  // sum_j q_j K (u_j - u_i)_b with the odd kernel K(xi) = k n_a n_b xi_c / 2, of which a
  // convolution sees the opposite steps.
  const auto add = [&](std::span<const double> amplitudes, std::size_t b, std::size_t entry) {
    for (const bool is_own : {false, true}) {
      const double* const from = modes[is_own ? d : b].data();
      for (std::size_t k = 0; k < transform.modes(); ++k) {
        field.data()[2 * k] = -amplitudes[k] * from[2 * k + 1];
        field.data()[2 * k + 1] = amplitudes[k] * from[2 * k];
      }
      transform.to_places(field);
      for (std::size_t i = 0; i < where_.size(); ++i) {
        const double own = is_own ? -displacement_[i * d + b] : 1.0;
        virials[i * d * d + entry] -= integrity_[i] * own * field.data()[where_[i]];
      }
    }
  };
  std::vector<KernelValue> kernel(springs_.size());
  for (std::size_t a = 0; a < d; ++a) {
    for (std::size_t c = 0; c < d; ++c) {
      for (std::size_t b = 0; b < d; ++b) {
        for (std::size_t s = 0; s < springs_.size(); ++s) {
          const LatticeSpring& of = springs_[s];
          kernel[s] = {as_last(of.step, dimension_),
                       0.5 * of.stiffness * of.direction[a] * of.direction[b] * of.arm[c]};
        }
        add(convolution_.amplitudes(kernel, Convolution::Parity::odd), b, a * d + c);
      }
    }
  }
}

std::vector<double> lattice_sums(const LatticeBox& box, std::span<const LatticeSpring> springs,
                                 std::span<const double> kernel, std::span<const double> field,
                                 int threads) {
  const Convolution convolution(axes_of(box, {}, springs), threads);
  const FourierTransform& transform = convolution.transform();
  std::vector<KernelValue> values;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    values.push_back({as_last(springs[s].step, box.dimension), kernel[s]});
  }
  const std::vector<double> amplitudes = convolution.amplitudes(values, Convolution::Parity::even);
  fftw::Buffer modes = transform.make_field();
  const std::vector<std::size_t> where = places_of(box, transform);
  for (std::size_t i = 0; i < where.size(); ++i) modes.data()[where[i]] = field[i];
  transform.to_modes(modes);
  for (std::size_t k = 0; k < transform.modes(); ++k) {
    modes.data()[2 * k] *= amplitudes[k];
    modes.data()[2 * k + 1] *= amplitudes[k];
  }
  transform.to_places(modes);
  std::vector<double> sums;
  for (const std::size_t place : where) sums.push_back(modes.data()[place]);
  return sums;
}

}  // namespace peristat
