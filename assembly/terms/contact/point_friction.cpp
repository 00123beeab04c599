#include "assembly/terms/contact/point_friction.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace peristat {
namespace {

/// The slip of a contact; null: it has none.
const Slip* old_slip(const Slips& slips, std::size_t contact) {
  const auto found = std::ranges::lower_bound(slips, contact, {}, &Slip::contact);
  return found == slips.end() || found->contact != contact ? nullptr : &*found;
}

}  // namespace

Coordinates PointFriction::relative(Index point, const std::vector<Slip::Partner>& partners,
                                    std::span<const double> displacement) const {
  Coordinates step{};
  for (std::size_t c = 0; c < dimension_; ++c) {
    step[c] = displacement[std::size_t(point) * dimension_ + c];
    for (const auto& [partner, share] : partners) {
      step[c] -= share * displacement[std::size_t(partner) * dimension_ + c];
    }
  }
  return step;
}

Slip PointFriction::slip_of(const Press& press, const Slip* old,
                            std::span<const double> displacement,
                            std::span<const double> at_start) const {
  Slip now{press.contact,  press.force,    press.normal,   {}, {}, press.point,
           press.partners, press.friction, press.stiffness};
  if (!old) {
    now.start = relative(press.point, press.partners, at_start);
    return now;
  }
  now.elastic = old->elastic;
  const Coordinates so_far = minus(relative(old->point, old->partners, displacement), old->start);
  now.start = minus(relative(press.point, press.partners, displacement), so_far);
  return now;
}

PointFriction::Committed PointFriction::committed(const Slips& before,
                                                  const std::vector<Press>& presses,
                                                  std::span<const double> displacement) const {
  Committed result;
  Slips kept, fresh;
  for (const Slip& slip : before) {
    if (!(slip.normal_force > 0.0)) {  // nothing is left of a contact that has opened
      result.dissipated += 0.5 * slip.stiffness * dot(slip.elastic, slip.elastic);
      continue;
    }
    const Coordinates y = slipped(slip, displacement);
    const double size = length(y), bearable = slip.friction * slip.normal_force / slip.stiffness;
    const double share = size > bearable ? bearable / size : 1.0;
    result.dissipated += slip.stiffness * bearable * std::max(0.0, size - bearable);
    kept.push_back(slip);
    kept.back().elastic = scaled(share, y);
    kept.back().start = relative(slip.point, slip.partners, displacement);
  }
  for (const Press& press : presses) {
    if (old_slip(kept, press.contact)) continue;
    fresh.push_back(slip_of(press, nullptr, displacement, displacement));
  }
  std::ranges::merge(kept, fresh, std::back_inserter(result.slips), {}, &Slip::contact,
                     &Slip::contact);
  return result;
}

Slips PointFriction::stuck(const Slips& before, const std::vector<Press>& presses,
                           std::span<const double> displacement) const {
  Slips slips;
  for (const Press& press : presses) {
    slips.push_back(slip_of(press, old_slip(before, press.contact), displacement, displacement));
    slips.back().normal_force = std::numeric_limits<double>::infinity();
  }
  return slips;
}

PointFriction::Lagged PointFriction::lagged(const Slips& before, const std::vector<Press>& presses,
                                            std::span<const double> displacement,
                                            std::span<const double> at_start) const {
  Lagged result;
  Slips pressed, opened;
  for (const Press& press : presses) {
    const Slip* const old = old_slip(before, press.contact);
    pressed.push_back(slip_of(press, old, displacement, at_start));
    result.change =
        std::max(result.change, std::abs(press.force - (old ? old->normal_force : 0.0)));
    result.largest = std::max(result.largest, press.force);
  }
  for (const Slip& slip : before) {  // one that has opened may close again within the step
    if (old_slip(pressed, slip.contact)) continue;
    result.change = std::max(result.change, slip.normal_force);
    opened.push_back(slip);
    opened.back().normal_force = 0.0;
  }
  std::ranges::merge(pressed, opened, std::back_inserter(result.slips), {}, &Slip::contact,
                     &Slip::contact);
  return result;
}

}  // namespace peristat
