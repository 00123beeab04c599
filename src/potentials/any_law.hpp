#pragma once

#include <variant>

#include "src/potentials/critical_stretch.hpp"
#include "src/potentials/force_envelope.hpp"
#include "src/potentials/harmonic.hpp"
#include "src/potentials/tanh_degradation.hpp"

namespace peristat {

/// One of the laws of damage, chosen where it is evaluated: for bonds that fail in different ways.
/// See Degraded for what its members mean.
struct AnyLaw {
  std::variant<CriticalStretch, TanhDegradation, ForceEnvelope> law;

  [[nodiscard]] double onset() const {
    return std::visit([](const auto& one) { return one.onset(); }, law);
  }
  [[nodiscard]] double critical() const {
    return std::visit([](const auto& one) { return one.critical(); }, law);
  }
  [[nodiscard]] double integrity(double s) const {
    return std::visit([s](const auto& one) { return one.integrity(s); }, law);
  }
  [[nodiscard]] double slope(double s) const {
    return std::visit([s](const auto& one) { return one.slope(s); }, law);
  }
  [[nodiscard]] double work(const Harmonic& whole, double s) const {
    return std::visit([&](const auto& one) { return one.work(whole, s); }, law);
  }
  /// The same law between other stretches.
  [[nodiscard]] AnyLaw between(double onset, double critical) const {
    return std::visit([&](const auto& one) { return AnyLaw{one.between(onset, critical)}; }, law);
  }
};

}  // namespace peristat
