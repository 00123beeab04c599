#include "src/transforms/trigonometric_transform.hpp"

#include <numbers>
#include <stdexcept>

#include <fftw3.h>

#include "src/transforms/fftw.hpp"

namespace peristat {
namespace {

struct Kinds {
  fftw_r2r_kind to_modes, to_places;
};

Kinds kinds_of(const TransformAxis& axis) {
  if (axis.below == axis.above) {
    return axis.below == RowEnd::free ? Kinds{FFTW_REDFT10, FFTW_REDFT01}
                                      : Kinds{FFTW_RODFT10, FFTW_RODFT01};
  }
  return axis.below == RowEnd::free ? Kinds{FFTW_REDFT11, FFTW_REDFT11}
                                    : Kinds{FFTW_RODFT11, FFTW_RODFT11};
}

}  // namespace

double TransformAxis::wave_number(Index mode) const {
  const double shift = below != above ? 0.5 : below == RowEnd::held ? 1.0 : 0.0;
  return std::numbers::pi * (double(mode) + shift) / double(count);
}

struct TrigonometricTransform::Plans {
  fftw::Buffer values;
  fftw::Plan to_modes, to_places;
};

TrigonometricTransform::TrigonometricTransform(std::span<const TransformAxis> axes, int threads)
    : axes_(axes.begin(), axes.end()), plans_(std::make_unique<Plans>()) {
  std::vector<int> extent;
  std::vector<fftw_r2r_kind> to_modes, to_places;
  for (const TransformAxis& axis : axes_) {
    if (axis.count < 1) throw std::logic_error("a transform of no places");
    extent.push_back(axis.count);
    const Kinds kinds = kinds_of(axis);
    to_modes.push_back(kinds.to_modes);
    to_places.push_back(kinds.to_places);
    count_ *= std::size_t(axis.count);
  }
  plans_->values = fftw::Buffer(count_);
  double* const data = plans_->values.data();
  const fftw::Planner planner(threads);
  // Estimated plans: measured ones differ from run to run, and with them the last bits.
  const auto plan = [&](const std::vector<fftw_r2r_kind>& kinds) {
    return fftw::Plan(
        fftw_plan_r2r(int(extent.size()), extent.data(), data, data, kinds.data(), FFTW_ESTIMATE));
  };
  plans_->to_modes = plan(to_modes);
  plans_->to_places = plan(to_places);
}

TrigonometricTransform::~TrigonometricTransform() = default;
TrigonometricTransform::TrigonometricTransform(TrigonometricTransform&&) noexcept = default;
TrigonometricTransform& TrigonometricTransform::operator=(TrigonometricTransform&&) noexcept =
    default;

std::span<double> TrigonometricTransform::values() { return plans_->values.values(); }

void TrigonometricTransform::to_modes() { plans_->to_modes.execute(); }
void TrigonometricTransform::to_places() { plans_->to_places.execute(); }

double TrigonometricTransform::factor() const {
  double factor = 1.0;
  for (const TransformAxis& axis : axes_) factor *= 2.0 * double(axis.count);
  return factor;
}

}  // namespace peristat
