#include "assembly/convolutions/lattice_fields.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <stdexcept>

namespace peristat {
namespace {

/// Moves the lattice's axes to the last axes of the box: real values of a row run along the last
/// one.
template <class T>
std::array<T, 3> as_last(const std::array<T, 3>& of_lattice, int dimension) {
  std::array<T, 3> result{};
  std::copy_n(of_lattice.begin(), dimension, result.end() - dimension);
  return result;
}

/// Axes of the box with the reach of the steps.
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

/// Factor 1 or -1 of a kernel, of which half of the steps are given, when it is mirrored along an
/// axis; 0: neither. A kernel of zeros returns 1.
/// @param opposite factor of the value when the step is reversed
int mirrored_sign(const std::map<std::array<int, 3>, double>& kernel, std::size_t axis,
                  double opposite) {
  bool is_same = true, is_opposite = true;
  for (const auto& [step, value] : kernel) {
    std::array<int, 3> turned = step;
    turned[axis] = -turned[axis];
    auto found = kernel.find(turned);
    double sign = 1.0;
    if (found == kernel.end()) {
      for (int& component : turned) component = -component;
      found = kernel.find(turned);
      sign = opposite;
    }
    if (found == kernel.end()) return 0;
    is_same = is_same && sign * found->second == value;
    is_opposite = is_opposite && sign * found->second == -value;
  }
  return is_same ? 1 : is_opposite ? -1 : 0;
}

Index half_of(Index count) { return count / 2 + 1; }

/// Rows of amplitudes of a box that a spectrum stores.
class KeptRows {
 public:
  KeptRows(const LatticeSpectrum& of, const FourierTransform& transform)
      : size_(transform.size()), mirror_(of.mirror), row_modes_(transform.row_modes()) {}

  [[nodiscard]] Index count(std::size_t axis) const {
    return mirror_[axis] == 0 ? size_[axis] : half_of(size_[axis]);
  }
  [[nodiscard]] std::size_t modes() const {
    return std::size_t(count(0)) * std::size_t(count(1)) * std::size_t(row_modes_);
  }
  [[nodiscard]] std::size_t start(Index i, Index j) const {
    return (std::size_t(i) * std::size_t(count(1)) + std::size_t(j)) * std::size_t(row_modes_);
  }
  /// Where the amplitudes of a row of the box are stored, and their sign.
  struct Row {
    std::size_t start = 0;
    double sign = 1.0;
  };
  [[nodiscard]] Row row(std::ptrdiff_t number) const {
    std::array<Index, 2> at{Index(number / size_[1]), Index(number % size_[1])};
    double sign = 1.0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (at[axis] < count(axis)) continue;
      at[axis] = size_[axis] - at[axis];
      sign *= mirror_[axis];
    }
    return {start(at[0], at[1]), sign};
  }

 private:
  std::array<Index, 3> size_;
  std::array<int, 3> mirror_;
  Index row_modes_;
};

/// to += the product, for one row of modes.
void add_product(const LatticeFields::Product& product, const double* c, double factor,
                 const double* from, std::ptrdiff_t modes, double* to) {
  if (product.kernel->parity == Convolution::Parity::even) {
    for (std::ptrdiff_t k = 0; k < modes; ++k) {
      const double by = factor * c[k];
      to[2 * k] += by * from[2 * k];
      to[2 * k + 1] += by * from[2 * k + 1];
    }
  } else {
    // Times i, and minus since odd kernels of x' - x are minus those of x - x'.
    for (std::ptrdiff_t k = 0; k < modes; ++k) {
      const double by = factor * c[k];
      to[2 * k] += by * from[2 * k + 1];
      to[2 * k + 1] -= by * from[2 * k];
    }
  }
}

/// field_i := sum_j C_ij field_j in a row of modes.
template <int D>
void mix_row(const std::array<const double*, pairs_of(D)>& amplitudes,
             const std::array<double, pairs_of(D)>& signs, const std::array<double*, D>& field,
             std::ptrdiff_t modes) {
  for (std::ptrdiff_t k = 0; k < modes; ++k) {
    double real[D] = {}, imaginary[D] = {};
    std::size_t pair = 0;
    for (int i = 0; i < D; ++i) {
      for (int j = i; j < D; ++j, ++pair) {
        const double c = signs[pair] * amplitudes[pair][k];
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

LatticeFields::LatticeFields(const CutLattice& box, const std::array<bool, 3>& is_periodic,
                             std::vector<LatticeStep> steps, int threads)
    : dimension_(box.dimension),
      steps_(std::move(steps)),
      convolution_(axes_of(box, is_periodic, steps_), threads),
      integrity_(box.place.size(), 1.0) {
  if (2 * transform().modes() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::logic_error("a box of more than 2^32 places");
  }
  where_.reserve(box.place.size());
  for (const Index place : box.place) {
    const std::array<Index, 3> at = as_last(box.numbers(place), dimension_);
    where_.push_back(std::uint32_t(transform().at(at[0], at[1], at[2])));
  }
  find_cuts(box);
}

void LatticeFields::find_cuts(const CutLattice& box) {
  for (const auto& pair : box.cut) {
    beside_cuts_.insert(beside_cuts_.end(), pair.begin(), pair.end());
  }
  std::ranges::sort(beside_cuts_);
  const auto repeated = std::ranges::unique(beside_cuts_);
  beside_cuts_.erase(repeated.begin(), repeated.end());
  std::map<LatticeStep, std::uint32_t> number;
  for (std::size_t s = 0; s < steps_.size(); ++s) number[steps_[s]] = std::uint32_t(s);
  const auto beside = [&](Index point) {
    return std::uint32_t(std::ranges::lower_bound(beside_cuts_, point) - beside_cuts_.begin());
  };
  for (const auto& [i, j] : box.cut) {
    const std::array<Index, 3> here = box.numbers(box.place[std::size_t(i)]),
                               there = box.numbers(box.place[std::size_t(j)]);
    LatticeStep step{}, opposite{};
    for (std::size_t c = 0; c < 3; ++c) {
      step[c] = there[c] - here[c];
      opposite[c] = -step[c];
    }
    const auto along = number.find(step), against = number.find(opposite);
    if (along != number.end()) {
      cuts_.push_back({beside(i), beside(j), along->second, false});
      cuts_.push_back({beside(j), beside(i), along->second, true});
    } else if (against != number.end()) {
      cuts_.push_back({beside(i), beside(j), against->second, true});
      cuts_.push_back({beside(j), beside(i), against->second, false});
    } else {
      throw std::logic_error("a pair is cut that sees nothing of each other");
    }
  }
}

void LatticeFields::keep_beside_cuts(std::size_t field) {
  if (beside_cuts_.empty()) return;
  values_beside_.resize(std::max(values_beside_.size(), field + 1));
  std::vector<double>& kept = values_beside_[field];
  kept.clear();
  for (const Index point : beside_cuts_) {
    kept.push_back(fields_[field].data()[where_[std::size_t(point)]]);
  }
}

void LatticeFields::add_cuts(const Product& product, std::vector<double>& sums) const {
  const double opposite = product.kernel->parity == Parity::even ? 1.0 : -1.0;
  const std::vector<double>& values = values_beside_[product.field];
  for (const Cut& cut : cuts_) {
    const double of_step = product.kernel->values[cut.step];
    sums[cut.at] +=
        product.factor * (cut.is_opposite ? opposite * of_step : of_step) * values[cut.neighbour];
  }
}

void LatticeFields::take_off_cuts(std::span<const double> sums, double* from) const {
  for (std::size_t k = 0; k < beside_cuts_.size(); ++k) {
    from[where_[std::size_t(beside_cuts_[k])]] -= sums[k];
  }
}

LatticeSpectrum LatticeFields::spectrum(Parity parity,
                                        const std::function<double(std::size_t)>& value) const {
  std::vector<KernelValue> kernel;
  std::map<std::array<int, 3>, double> values;
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    kernel.push_back({as_last(steps_[s], dimension_), value(s)});
    values[kernel.back().step] = kernel.back().value;
  }
  LatticeSpectrum result{convolution_.amplitudes(kernel, parity), parity, {}, {}};
  for (std::size_t s = 0; !cuts_.empty() && s < steps_.size(); ++s) {
    result.values.push_back(value(s));
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    result.mirror[axis] = mirrored_sign(values, axis, parity == Parity::even ? 1.0 : -1.0);
  }
  const KeptRows kept(result, transform());
  std::vector<double> amplitudes;
  amplitudes.reserve(kept.modes());
  for (Index i = 0; i < kept.count(0); ++i) {
    for (Index j = 0; j < kept.count(1); ++j) {
      const auto from = result.amplitudes.begin() +
                        (std::ptrdiff_t(i) * transform().size()[1] + j) * transform().row_modes();
      amplitudes.insert(amplitudes.end(), from, from + transform().row_modes());
    }
  }
  result.amplitudes = std::move(amplitudes);
  return result;
}

void LatticeFields::set_integrity(std::span<const double> integrity) {
  integrity_.assign(integrity.begin(), integrity.end());
}

std::array<double, 3> LatticeFields::mean(std::span<const double> u) const {
  const auto d = std::size_t(dimension_);
  std::array<double, 3> mean{};
  double weight = 0.0;
  for (std::size_t point = 0; point < points(); ++point) {
    const double q = integrity_[point];
    weight += q;
    for (std::size_t c = 0; c < d; ++c) mean[c] += q * u[point * d + c];
  }
  for (double& of_component : mean) of_component = weight > 0.0 ? of_component / weight : 0.0;
  return mean;
}

void LatticeFields::take_off_mean(std::span<const double> u, std::vector<double>& result) const {
  const std::array<double, 3> mean = this->mean(u);
  result.resize(u.size());
  for (std::size_t k = 0; k < u.size(); ++k) result[k] = u[k] - mean[k % std::size_t(dimension_)];
}

fftw::Buffer& LatticeFields::buffer(std::size_t field) {
  if (field != of_its_own) fields_.resize(std::max(fields_.size(), field + 1));
  fftw::Buffer& result = field == of_its_own ? own_sum_ : fields_[field];
  if (result.values().empty()) result = transform().make_field();
  return result;
}

double* LatticeFields::cleared(std::size_t field) {
  const std::span<double> values = buffer(field).values();
  const auto count = static_cast<std::ptrdiff_t>(values.size());
#pragma omp parallel for num_threads(threads()) schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) values[std::size_t(k)] = 0.0;
  return values.data();
}

void LatticeFields::to_modes(std::size_t field) {
  transform().to_modes(fields_[field]);
  ++transforms_;
}

void LatticeFields::gather(std::span<const Product> products, bool begins) {
  const auto modes = std::ptrdiff_t(transform().row_modes()),
             rows = std::ptrdiff_t(transform().rows());
  double* const to = buffer(sum_).data();
  if (begins) sums_of_cuts_.assign(beside_cuts_.size(), 0.0);
  for (std::size_t p = 0; !cuts_.empty() && p < products.size(); ++p) {
    add_cuts(products[p], sums_of_cuts_);
  }
  std::vector<KeptRows> kept;
  for (const Product& product : products) kept.emplace_back(*product.kernel, transform());
#pragma omp parallel for num_threads(threads()) schedule(static)
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    // A row stays in cache while all products are added.
    double* const start = to + 2 * row * modes;
    if (begins) std::fill(start, start + 2 * modes, 0.0);
    for (std::size_t p = 0; p < products.size(); ++p) {
      const KeptRows::Row at = kept[p].row(row);
      add_product(products[p], products[p].kernel->amplitudes.data() + at.start,
                  products[p].factor * at.sign, fields_[products[p].field].data() + 2 * row * modes,
                  modes, start);
    }
  }
}

const double* LatticeFields::sums_to_places() {
  transform().to_places(buffer(sum_));
  ++transforms_;
  take_off_cuts(sums_of_cuts_, buffer(sum_).data());
  return buffer(sum_).data();
}

void LatticeFields::mix(std::span<const LatticeSpectrum> kernels) {
  with_dimension(dimension_, [&](auto dimension) { mix<dimension>(kernels); });
}

template <int D>
void LatticeFields::mix(std::span<const LatticeSpectrum> kernels) {
  const auto modes = std::ptrdiff_t(transform().row_modes()),
             rows = std::ptrdiff_t(transform().rows());
  std::vector<KeptRows> kept;
  for (const LatticeSpectrum& kernel : kernels) kept.emplace_back(kernel, transform());
#pragma omp parallel for num_threads(threads()) schedule(static)
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    std::array<const double*, pairs_of(D)> amplitudes;
    std::array<double, pairs_of(D)> signs;
    std::array<double*, D> field;
    for (std::size_t p = 0; p < pairs_of(D); ++p) {
      const KeptRows::Row at = kept[p].row(row);
      amplitudes[p] = kernels[p].amplitudes.data() + at.start;
      signs[p] = at.sign;
    }
    for (std::size_t c = 0; c < D; ++c) field[c] = fields_[c].data() + 2 * row * modes;
    mix_row<D>(amplitudes, signs, field, modes);
  }
  for (std::size_t c = 0; c < D; ++c) transform().to_places(fields_[c]);
  transforms_ += D;
  for (int i = 0; i < D && !cuts_.empty(); ++i) {
    std::vector<double> of_cuts(beside_cuts_.size(), 0.0);
    for (int j = 0; j < D; ++j) {
      add_cuts({&kernels[pair_of(i, j, D)], std::size_t(j)}, of_cuts);
    }
    take_off_cuts(of_cuts, fields_[std::size_t(i)].data());
  }
}

std::vector<double> LatticeFields::pairs() {
  fill(0, [](std::size_t) { return 1.0; });
  double* const field = fields_[0].data();
  for (std::size_t k = 0; k < transform().modes(); ++k) {
    double* const mode = field + 2 * k;
    mode[0] = (mode[0] * mode[0] + mode[1] * mode[1]) / double(transform().places());
    mode[1] = 0.0;
  }
  transform().to_places(fields_[0]);
  ++transforms_;
  std::vector<double> found;
  const std::array<Index, 3>& size = transform().size();
  for (const LatticeStep& along : steps_) {
    const std::array<int, 3> step = as_last(along, dimension_);
    std::array<Index, 3> at;
    for (std::size_t a = 0; a < 3; ++a) at[a] = (step[a] % size[a] + size[a]) % size[a];
    found.push_back(field[transform().at(at[0], at[1], at[2])]);
  }
  return found;
}

double LatticeFields::bytes() const {
  double numbers = double(own_sum_.values().size());
  for (const fftw::Buffer& field : fields_) numbers += double(field.values().size());
  return 8.0 * numbers + 12.0 * double(points());
}

double lattice_places(const LatticeBox& box, std::span<const LatticeStep> steps) {
  const std::array<ConvolutionAxis, 3> axes = axes_of(box, {}, steps);
  double places = 1.0;
  for (std::size_t a = 0; a < 3; ++a) places *= double(axes[a].size(a == 2));
  return places;
}

void add_rounded_up(std::span<const double> sums, std::span<double> total) {
  if (sums.empty()) return;
  const double margin = 1e-13 * *std::max_element(sums.begin(), sums.end());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    total[k] += std::max(sums[k], 0.0) * (1.0 + 1e-10) + margin;
  }
}

}  // namespace peristat
