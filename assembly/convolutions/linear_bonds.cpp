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

}  // namespace

LinearBonds::LinearBonds(const LatticeBox& box, const std::array<bool, 3>& is_periodic,
                         std::span<const LatticeSpring> springs, int threads)
    : dimension_(box.dimension),
      points_(static_cast<std::ptrdiff_t>(box.place.size())),
      convolution_(axes_of(box, is_periodic, springs), threads) {
  const FourierTransform& transform = convolution_.transform();
  where_.reserve(box.place.size());
  for (const Index place : box.place) {
    const std::array<Index, 3> at = as_last(box.numbers(place), dimension_);
    where_.push_back(transform.at(at[0], at[1], at[2]));
  }
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

void LinearBonds::multiply(std::span<const double> v, std::span<double> product) {
  find_forces(v, product);
  for (double& entry : product) entry = -entry;
}

std::vector<double> LinearBonds::diagonal() const {
  std::vector<double> blocks;
  blocks.reserve(std::size_t(points_) * std::size_t(dimension_) * std::size_t(dimension_));
  for (std::size_t i = 0; i < std::size_t(points_); ++i) {
    for (int a = 0; a < dimension_; ++a) {
      for (int b = 0; b < dimension_; ++b) {
        blocks.push_back(integrity_[i] * sums_[i * pairs() + pair(a, b)]);
      }
    }
  }
  return blocks;
}

}  // namespace peristat
