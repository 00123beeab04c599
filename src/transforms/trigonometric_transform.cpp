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
  int threads = 1;
  std::vector<fftw::AxisPass> to_modes, to_places;  // by axis

  void execute(const std::vector<fftw::AxisPass>& passes) const {
    for (const fftw::AxisPass& pass : passes) {
      pass.execute(threads, [data = values.data()](void* plan, std::size_t element) {
        fftw_execute_r2r(static_cast<fftw_plan>(plan), data + element, data + element);
      });
    }
  }
};

TrigonometricTransform::TrigonometricTransform(std::span<const TransformAxis> axes, int threads)
    : axes_(axes.begin(), axes.end()), plans_(std::make_unique<Plans>()) {
  for (const TransformAxis& axis : axes_) {
    if (axis.count < 1) throw std::logic_error("a transform of no places");
    count_ *= std::size_t(axis.count);
  }
  plans_->values = fftw::Buffer(count_);
  plans_->threads = threads;
  fftw::Lines lines{1, 1, static_cast<Index>(count_)};
  for (const TransformAxis& axis : axes_) {
    lines.count = axis.count;
    lines.inner /= axis.count;
    const auto pass = [&](fftw_r2r_kind kind) {
      return fftw::AxisPass(lines, [&](int many, int stride, int distance) -> void* {
        double* const data = plans_->values.data();
        // Lines may begin at any address.
        return fftw_plan_many_r2r(1, &axis.count, many, data, nullptr, stride, distance, data,
                                  nullptr, stride, distance, &kind, FFTW_ESTIMATE | FFTW_UNALIGNED);
      });
    };
    const Kinds kinds = kinds_of(axis);
    plans_->to_modes.push_back(pass(kinds.to_modes));
    plans_->to_places.push_back(pass(kinds.to_places));
    lines.outer *= axis.count;
  }
}

TrigonometricTransform::~TrigonometricTransform() = default;
TrigonometricTransform::TrigonometricTransform(TrigonometricTransform&&) noexcept = default;
TrigonometricTransform& TrigonometricTransform::operator=(TrigonometricTransform&&) noexcept =
    default;

std::span<double> TrigonometricTransform::values() { return plans_->values.values(); }

void TrigonometricTransform::to_modes() { plans_->execute(plans_->to_modes); }
void TrigonometricTransform::to_places() { plans_->execute(plans_->to_places); }

double TrigonometricTransform::factor() const {
  double factor = 1.0;
  for (const TransformAxis& axis : axes_) factor *= 2.0 * double(axis.count);
  return factor;
}

}  // namespace peristat
