#include "src/potentials/force_table.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {

ForceCurve::ForceCurve(std::span<const double> stretches, std::span<const double> forces) {
  const double last = stretches.back();
  Knot from{};
  bool is_elastic = true;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    Knot knot{stretches[k] / last, forces[k] / last, 0.0};
    is_elastic = is_elastic &&
                 std::abs(knot.force - knot.stretch) <= round_off_of_elastic_pairs * knot.stretch;
    if (is_elastic) knot.force = onset_ = knot.stretch;
    knot.work = from.work + 0.5 * (from.force + knot.force) * (knot.stretch - from.stretch);
    knots_.push_back(knot);
    from = knot;
  }
}

double ForceCurve::largest_force() const {
  return std::ranges::max(knots_, {}, &Knot::force).force;
}

const ForceCurve::Knot& ForceCurve::beyond(double stretch) const {
  return *std::ranges::upper_bound(knots_.begin(), knots_.end() - 1, stretch, {}, &Knot::stretch);
}

ForceCurve::Knot ForceCurve::before(const Knot& knot) const {
  return &knot == knots_.data() ? Knot{} : *(&knot - 1);
}

namespace {

/// The force at a stretch below the last one, in units of that, and its slope.
struct OnCurve {
  double force, slope, work;

  OnCurve(const ForceCurve& curve, double stretch) {
    const ForceCurve::Knot& to = curve.beyond(stretch);
    const ForceCurve::Knot from = curve.before(to);
    slope = (to.force - from.force) / (to.stretch - from.stretch);
    force = from.force + slope * (stretch - from.stretch);
    work = from.work + 0.5 * (from.force + force) * (stretch - from.stretch);
  }
};

}  // namespace

double ForceTable::integrity(double s) const {
  const double stretch = s / critical_stretch;
  if (stretch <= curve->onset()) return 1.0;
  if (s >= critical_stretch) return 0.0;
  return OnCurve(*curve, stretch).force / stretch;
}

double ForceTable::slope(double s) const {
  const double stretch = s / critical_stretch;
  if (stretch <= curve->onset() || s >= critical_stretch) return 0.0;
  const OnCurve at(*curve, stretch);
  return (at.slope - at.force / stretch) / s;
}

double ForceTable::work(const Harmonic&, double s) const {
  const double stretch = s / critical_stretch;
  if (stretch <= curve->onset()) return 0.5 * s * s;
  const double of_curve =
      s >= critical_stretch ? curve->knots().back().work : OnCurve(*curve, stretch).work;
  return critical_stretch * critical_stretch * of_curve;
}

}  // namespace peristat
