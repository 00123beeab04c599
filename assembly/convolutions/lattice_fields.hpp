#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "assembly/convolutions/cut_lattice.hpp"
#include "src/neighbourhood/lattice_kernel.hpp"
#include "src/transforms/convolution.hpp"

namespace peristat {

/// Number of unordered pairs of components.
constexpr std::size_t pairs_of(int dimension) {
  return std::size_t(dimension) * std::size_t(dimension + 1) / 2;
}

/// Number of the pair (i, j) of components, in either order: xx xy xz yy yz zz.
constexpr std::size_t pair_of(int i, int j, int dimension) {
  if (i > j) std::swap(i, j);
  return std::size_t(i * dimension - i * (i - 1) / 2 + j - i);
}

/// Calls body(std::integral_constant<int, D>) for a dimension known at run time.
template <class Body>
void with_dimension(int dimension, const Body& body) {
  if (dimension == 1) body(std::integral_constant<int, 1>{});
  if (dimension == 2) body(std::integral_constant<int, 2>{});
  if (dimension == 3) body(std::integral_constant<int, 3>{});
}

/// Sums below this share of those of a whole neighbourhood are round-off of convolutions, which is
/// some 1e-15 of them: the point has no neighbours left.
inline constexpr double least_neighbourhood = 1e-10;

/// Fourier amplitudes of a kernel, one number each: real for even kernels, imaginary for odd ones.
/// Along an axis in which the kernel is symmetric or antisymmetric half of them are kept.
struct LatticeSpectrum {
  std::vector<double> amplitudes;
  Convolution::Parity parity = Convolution::Parity::even;
  /// Per axis, the factor 1 or -1 of g when this component of the step changes its sign; 0:
  /// neither.
  std::array<int, 3> mirror{};
  std::vector<double> values{};  ///< g of each step, only in a lattice with cut pairs
};

/// Common part of all operators by convolutions on a lattice: the points' sites on a padded box, an
/// integrity q of each point, numbered fields on the box as Fourier amplitudes, and sums over
/// neighbours
///
///   sum over xi of g(xi) b(x + xi),
///
/// of several fields b = q times a value at once, at the cost of one transform (convolutions
/// [g * b] of [FCBM] app. A but for the sign of odd kernels). Sites without a point have q = 0. Cut
/// pairs of points (CutLattice) are summed one by one and subtracted, since convolutions ignore
/// cracks. Results are the same bits on any number of threads.
class LatticeFields {
 public:
  using Parity = Convolution::Parity;

  /// @param box the points and their sites
  /// @param is_periodic axes with a period: points interact with their images
  /// @param steps to neighbours, one per opposite pair
  /// @throws std::logic_error for a period that is not longer than the steps, or for fields of more
  ///                          than 2^32 numbers
  LatticeFields(const CutLattice& box, const std::array<bool, 3>& is_periodic,
                std::vector<LatticeStep> steps, int threads);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] std::size_t points() const { return where_.size(); }
  [[nodiscard]] int threads() const { return convolution_.transform().threads(); }
  [[nodiscard]] const FourierTransform& transform() const { return convolution_.transform(); }

  /// @param value g of the step with this number; the opposite step has g, or -g for odd kernels
  [[nodiscard]] LatticeSpectrum spectrum(Parity parity,
                                         const std::function<double(std::size_t)>& value) const;

  void set_integrity(std::span<const double> integrity);
  [[nodiscard]] double integrity(std::size_t point) const { return integrity_[point]; }
  /// Sets q = 0 where a sum of non-negative terms over the neighbours vanishes beside that of a
  /// whole neighbourhood: such a point has no neighbours, acts on no other point, and convolutions
  /// find only round-off for it.
  template <class Sum>
  void leave_out_lonely(double whole, const Sum& sum) {
    for_points([&](std::size_t point) {
      if (sum(point) <= least_neighbourhood * whole) integrity_[point] = 0.0;
    });
  }

  /// Mean of u over the points, weighted with q.
  [[nodiscard]] std::array<double, 3> mean(std::span<const double> u) const;
  /// u without its mean: a free translation, or displacements of failed points, would cost digits
  /// of sums that should cancel.
  void take_off_mean(std::span<const double> u, std::vector<double>& result) const;

  /// Makes field number `field` from q value(point), as amplitudes. Fields are allocated on first
  /// use.
  template <class Value>
  void fill(std::size_t field, const Value& value) {
    double* const to = cleared(field);
    for_points([&](std::size_t point) { to[where_[point]] = integrity_[point] * value(point); });
    keep_beside_cuts(field);
    to_modes(field);
  }

  /// factor g(xi) b(x + xi)
  struct Product {
    const LatticeSpectrum* kernel = nullptr;
    std::size_t field = 0;
    double factor = 1.0;
  };

  /// Calls take(point, sum) with the sum of all these products over the point's neighbours.
  template <class Take>
  void find_sums(std::span<const Product> products, const Take& take) {
    gather(products, true);
    take_sums(take);
  }
  template <class Take>
  void find_sums(const LatticeSpectrum& kernel, std::size_t field, const Take& take) {
    const Product product{&kernel, field};
    find_sums(std::span(&product, 1), take);
  }

  /// The same in parts between which fields may change: `gather` adds products to the sums gathered
  /// so far, or starts new sums.
  void gather(std::span<const Product> products, bool begins);
  template <class Take>
  void take_sums(const Take& take) {
    const double* const from = sums_to_places();
    for_points([&](std::size_t point) { take(point, from[where_[point]]); });
  }

  /// Replaces each field c < dimension by the sum over c' of kernel (c, c') times field c', no
  /// longer as amplitudes. Kernels are even and numbered by pair_of.
  void mix(std::span<const LatticeSpectrum> kernels);
  /// Value of a field that `mix` has made.
  [[nodiscard]] double at(std::size_t field, std::size_t point) const {
    return fields_[field].data()[where_[point]];
  }

  /// Sums overwrite this field from now on, which then has no values of its own.
  void keep_sums_in(std::size_t field) { sum_ = field; }

  /// Sum over the points of q(x) q(x + xi), for each step.
  [[nodiscard]] std::vector<double> pairs();

  /// Calls body(point) for all points.
  template <class Body>
  void for_points(const Body& body) const {
    const auto count = static_cast<std::ptrdiff_t>(where_.size());
#pragma omp parallel for num_threads(threads()) schedule(static)
    for (std::ptrdiff_t i = 0; i < count; ++i) body(std::size_t(i));
  }

  /// Number of real transforms so far, without those of kernels.
  [[nodiscard]] std::size_t transforms() const { return transforms_; }
  /// Memory of fields and sites, and of one spectrum [bytes].
  [[nodiscard]] double bytes() const;
  [[nodiscard]] double spectrum_bytes() const { return 8.0 * double(transform().modes()); }

 private:
  static constexpr std::size_t of_its_own = std::size_t(-1);

  fftw::Buffer& buffer(std::size_t field);
  [[nodiscard]] double* cleared(std::size_t field);
  void find_cuts(const CutLattice& box);
  /// Stores a field's values at points beside cuts, before they become modes.
  void keep_beside_cuts(std::size_t field);
  /// sums += the product over the cut pairs.
  void add_cuts(const Product& product, std::vector<double>& sums) const;
  /// Subtracts sums over cut pairs from those over all neighbours.
  void take_off_cuts(std::span<const double> sums, double* from) const;
  void to_modes(std::size_t field);
  [[nodiscard]] const double* sums_to_places();
  template <int D>
  void mix(std::span<const LatticeSpectrum> kernels);

  int dimension_;
  std::vector<LatticeStep> steps_;
  Convolution convolution_;
  std::vector<std::uint32_t> where_;  // site of each point in a field
  std::vector<double> integrity_;
  std::vector<fftw::Buffer> fields_;
  fftw::Buffer own_sum_;
  std::size_t sum_ = of_its_own;
  std::size_t transforms_ = 0;

  /// One point of a cut pair, the other one and the step to it: numbers of points beside cuts, and
  /// of steps.
  struct Cut {
    std::uint32_t at = 0, neighbour = 0, step = 0;
    bool is_opposite = false;
  };
  std::vector<Cut> cuts_;
  std::vector<Index> beside_cuts_;                  // points with a neighbour that is cut off
  std::vector<std::vector<double>> values_beside_;  // of each field, at these
  std::vector<double> sums_of_cuts_;                // at these, over the cut pairs gathered so far
};

/// Steps of springs or arms.
[[nodiscard]] std::vector<LatticeStep> steps_of(const auto& neighbours) {
  std::vector<LatticeStep> steps;
  for (const auto& one : neighbours) steps.push_back(one.step);
  return steps;
}

/// Sites of the padded box that LatticeFields transforms.
[[nodiscard]] double lattice_places(const LatticeBox& box, std::span<const LatticeStep> steps);

/// total += upper bounds of sums of absolute values that convolutions have found, which may be too
/// small by round-off of the largest of them.
void add_rounded_up(std::span<const double> sums, std::span<double> total);

}  // namespace peristat
