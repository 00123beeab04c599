#include "src/potentials/force_envelope.hpp"

#include <algorithm>
#include <cmath>

namespace peristat {
namespace {

/// g, the remaining fraction of the peak force.
double left(double x, double decay) {
  return decay == 0.0 ? 1.0 - x : std::expm1(decay * (1.0 - x)) / std::expm1(decay);
}

double slope_of_left(double x, double decay) {
  return decay == 0.0 ? -1.0 : -decay * std::exp(decay * (1.0 - x)) / std::expm1(decay);
}

/// int_0^x g
double area_of_left(double x, double decay) {
  if (decay == 0.0) return x * (1.0 - 0.5 * x);
  return (-std::expm1(-decay * x) / decay - x * std::exp(-decay)) / -std::expm1(-decay);
}

}  // namespace

double ForceEnvelope::share_of_fall(double s) const {
  return (s - peak()) / (critical_stretch - peak());
}

double ForceEnvelope::force(double s) const {
  if (s <= onset_stretch) return s;
  if (s <= peak()) return onset_stretch + hardening * (s - onset_stretch);
  return peak_force() * left(share_of_fall(s), decay);
}

double ForceEnvelope::integrity(double s) const {
  if (s <= onset_stretch) return 1.0;
  if (s >= critical_stretch) return 0.0;
  return force(s) / s;
}

double ForceEnvelope::slope(double s) const {
  if (s <= onset_stretch || s >= critical_stretch) return 0.0;
  const double of_force = s <= peak() ? hardening
                                      : peak_force() * slope_of_left(share_of_fall(s), decay) /
                                            (critical_stretch - peak());
  return (of_force - integrity(s)) / s;
}

double ForceEnvelope::work(const Harmonic&, double s) const {
  if (s <= onset_stretch) return 0.5 * s * s;
  const double rising = std::min(s, peak());
  const double up_to_peak = 0.5 * onset_stretch * onset_stretch +
                            0.5 * (onset_stretch + force(rising)) * (rising - onset_stretch);
  if (s <= peak()) return up_to_peak;
  const double end = std::min(share_of_fall(s), 1.0);
  return up_to_peak + peak_force() * (critical_stretch - peak()) * area_of_left(end, decay);
}

}  // namespace peristat
