#include "assembly/operators/constrained_product.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "assembly/operators/convolved_tangent.hpp"

namespace peristat {

ConstrainedProduct::ConstrainedProduct(std::unique_ptr<TangentOperator> whole, const Points& points,
                                       const Constraints& constraints)
    : TangentOperator(
          BlockPattern::of_rows(std::vector<Offset>(std::size_t(constraints.rows()) + 1, 0), {}),
          points.dimension, whole->threads()),
      whole_(std::move(whole)),
      points_(points),
      constraints_(constraints),
      reference_(points.reference),
      no_force_(constraints.dofs(), 0.0) {
  for (const Coordinates& handle : constraints.handles()) {
    reference_.insert(reference_.end(), handle.begin(), handle.begin() + dimension);
  }
  reference = reference_;
}

std::vector<double> ConstrainedProduct::positions() const {
  std::vector<double> at = reference_;
  for (std::size_t k = 0; k < displacement_.size(); ++k) at[k] += displacement_[k];
  return at;
}

/// Blocks of a point and of its images add up; those between them, in bodies thinner than the
/// horizon, are left out.
void ConstrainedProduct::linearise(Energy& energy, const StateView& at, double projection) {
  whole_->linearise(energy, at, projection);
  displacement_.assign(at.displacement.begin(), at.displacement.end());
  std::ranges::fill(diagonal, 0.0);
  const auto d = std::size_t(dimension);
  for (Index i = 0; i < points_.count(); ++i) {
    const double* const block = &whole_->diagonal[std::size_t(i) * d * d];
    for (const Dependence& on : constraints_.dependences(i, at.displacement)) {
      double* const to = &diagonal[std::size_t(on.master) * d * d];
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          // Images are mirrored and shifted, component by component.
          to[r * d + c] += on.block[r][r] * block[r * d + c] * on.block[c][c];
        }
      }
    }
  }
}

void ConstrainedProduct::multiply(std::span<const double> v, std::span<double> result) const {
  moved_.assign(v.begin(), v.end());
  constraints_.extend(displacement_, moved_);
  whole_->multiply(moved_, result);
  constraints_.fold(displacement_, no_force_, result);
  const std::vector<char>& follows = constraints_.dependent();
  for (std::size_t k = 0; k < follows.size(); ++k) {
    if (follows[k]) result[k] = 0.0;
  }
}

void ConstrainedProduct::for_each_row(const RowVisitor&) const {
  throw std::logic_error("a tangent by convolutions has no rows to visit");
}

void ConstrainedProduct::absolute_row_sums(std::span<double> sums) const {
  std::ranges::fill(sums, 0.0);
  whole_->absolute_row_sums(sums.first(points_.reference.size()));
  const auto d = std::size_t(dimension);
  // An image moves by its source's share and by those of the jumps.
  const auto jumps = [&](Index image) {
    double sum = 0.0;
    for (const int periods : points_.image_kind(image).periods) sum += std::abs(periods);
    return sum;
  };
  double most = 1.0;
  for (Index image = points_.own(); image < points_.count(); ++image) {
    most = std::max(most, 1.0 + jumps(image));
  }
  for (Index image = points_.own(); image < points_.count(); ++image) {
    const auto source = std::size_t(points_.source(image));
    const std::array<int, 3>& periods = points_.image_kind(image).periods;
    for (std::size_t c = 0; c < d; ++c) {
      const double sum = std::exchange(sums[std::size_t(image) * d + c], 0.0);
      sums[source * d + c] += sum;
      for (int axis = 0; axis < dimension; ++axis) {
        const int times = std::abs(periods[std::size_t(axis)]);
        if (times == 0) continue;
        sums[std::size_t(constraints_.period_handle(axis)) * d + c] += times * sum;
      }
    }
  }
  for (double& sum : sums) sum *= most;
}

std::unique_ptr<TangentOperator> make_convolved_tangent(Energy& energy,
                                                        const Constraints& constraints) {
  auto whole = std::make_unique<ConvolvedTangent>(energy);
  if (constraints.none()) return whole;
  return std::make_unique<ConstrainedProduct>(std::move(whole), energy.points(), constraints);
}

}  // namespace peristat
