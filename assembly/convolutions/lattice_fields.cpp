#include "assembly/convolutions/lattice_fields.hpp"

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

/// The box with room for what the steps reach.
std::array<ConvolutionAxis, 3> axes_of(const LatticeBox& box,
                                       const std::array<bool, 3>& is_periodic,
                                       std::span<const LatticeStep> steps) {
  std::array<ConvolutionAxis, 3> axes;
  for (std::size_t a = 0; a < 3; ++a) {
    axes[a].count = box.extent[a];
    axes[a].is_periodic = is_periodic[a];
    for (const LatticeStep& step : steps) {
      axes[a].reach = std::max(axes[a].reach, Index(std::abs(step[a])));
    }
    if (is_periodic[a] && axes[a].reach >= axes[a].count) {
      throw std::logic_error("a period must be longer than bonds: points would see themselves");
    }
  }
  return as_last(axes, box.dimension);
}

/// to := the sum of products in modes from `first` to `last`.
void add_products(std::span<const LatticeFields::Product> products,
                  const std::vector<fftw::Buffer>& fields, std::ptrdiff_t first,
                  std::ptrdiff_t last, double* to) {
  std::fill(to + 2 * first, to + 2 * last, 0.0);
  for (const LatticeFields::Product& product : products) {
    const double* const c = product.kernel->amplitudes.data();
    const double* const from = fields[product.field].data();
    if (product.kernel->parity == Convolution::Parity::even) {
      for (std::ptrdiff_t k = first; k < last; ++k) {
        const double by = product.factor * c[k];
        to[2 * k] += by * from[2 * k];
        to[2 * k + 1] += by * from[2 * k + 1];
      }
    } else {
      // Times i, and minus since odd kernels of x' - x are minus those of x - x'.
      for (std::ptrdiff_t k = first; k < last; ++k) {
        const double by = product.factor * c[k];
        to[2 * k] += by * from[2 * k + 1];
        to[2 * k + 1] -= by * from[2 * k];
      }
    }
  }
}

}  // namespace

LatticeFields::LatticeFields(const LatticeBox& box, const std::array<bool, 3>& is_periodic,
                             std::vector<LatticeStep> steps, int threads)
    : dimension_(box.dimension),
      steps_(std::move(steps)),
      convolution_(axes_of(box, is_periodic, steps_), threads),
      integrity_(box.place.size(), 1.0),
      sum_(transform().make_field()) {
  where_.reserve(box.place.size());
  for (const Index place : box.place) {
    const std::array<Index, 3> at = as_last(box.numbers(place), dimension_);
    where_.push_back(transform().at(at[0], at[1], at[2]));
  }
}

LatticeSpectrum LatticeFields::spectrum(Parity parity,
                                        const std::function<double(std::size_t)>& value) const {
  std::vector<KernelValue> kernel;
  kernel.reserve(steps_.size());
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    kernel.push_back({as_last(steps_[s], dimension_), value(s)});
  }
  return {convolution_.amplitudes(kernel, parity), parity};
}

void LatticeFields::set_integrity(std::span<const double> integrity) {
  integrity_.assign(integrity.begin(), integrity.end());
}

void LatticeFields::take_off_mean(std::span<const double> u, std::vector<double>& result) const {
  const auto d = std::size_t(dimension_);
  std::array<double, 3> mean{};
  double weight = 0.0;
  for (std::size_t point = 0; point < points(); ++point) {
    const double q = integrity_[point];
    weight += q;
    for (std::size_t c = 0; c < d; ++c) mean[c] += q * u[point * d + c];
  }
  for (double& of_component : mean) of_component = weight > 0.0 ? of_component / weight : 0.0;
  result.resize(u.size());
  for (std::size_t k = 0; k < u.size(); ++k) result[k] = u[k] - mean[k % d];
}

double* LatticeFields::cleared(std::size_t field) {
  while (fields_.size() <= field) fields_.push_back(transform().make_field());
  const std::span<double> values = fields_[field].values();
  const auto count = static_cast<std::ptrdiff_t>(values.size());
#pragma omp parallel for num_threads(threads()) schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) values[std::size_t(k)] = 0.0;
  return values.data();
}

void LatticeFields::to_modes(std::size_t field) {
  transform().to_modes(fields_[field]);
  ++transforms_;
}

void LatticeFields::multiply(std::span<const Product> products) {
  // Pieces that stay in cache while all products are added.
  constexpr std::ptrdiff_t piece = 512;
  const auto modes = static_cast<std::ptrdiff_t>(transform().modes());
  double* const to = sum_.data();
#pragma omp parallel for num_threads(threads()) schedule(static)
  for (std::ptrdiff_t first = 0; first < modes; first += piece) {
    add_products(products, fields_, first, std::min(first + piece, modes), to);
  }
  transform().to_places(sum_);
  ++transforms_;
}

double LatticeFields::bytes() const {
  return 16.0 * double(transform().modes()) * double(fields_.size() + 1) + 16.0 * double(points());
}

void add_rounded_up(std::span<const double> sums, std::span<double> total) {
  if (sums.empty()) return;
  const double margin = 1e-13 * *std::max_element(sums.begin(), sums.end());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    total[k] += std::max(sums[k], 0.0) * (1.0 + 1e-10) + margin;
  }
}

}  // namespace peristat
