#pragma once

#include <cmath>
#include <variant>

#include "src/potentials/critical_stretch.hpp"
#include "src/potentials/force_envelope.hpp"
#include "src/potentials/force_table.hpp"
#include "src/potentials/harmonic.hpp"
#include "src/potentials/opening_law.hpp"
#include "src/potentials/saw_tooth.hpp"
#include "src/potentials/stepwise_law.hpp"
#include "src/potentials/tanh_degradation.hpp"

namespace peristat {

/// One of several laws of damage, chosen when it is evaluated: for bonds that fail in different
/// ways. See Degraded for the meaning of its members.
template <class... Laws>
struct OneLawOf {
  std::variant<Laws...> law;

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
  /// True if stiffness is lost in drops alone, between which a bond is elastic.
  [[nodiscard]] bool falls_by_steps() const {
    return std::visit([]<class Law>(const Law&) { return StepwiseLaw<Law>; }, law);
  }
  /// Strength after a drop, for a law that falls by steps; else the critical stretch.
  [[nodiscard]] double borne_after(double strength) const {
    return std::visit(
        [&]<class Law>(const Law& one) {
          if constexpr (StepwiseLaw<Law>) return one.borne_after(strength);
          return one.critical();
        },
        law);
  }
  [[nodiscard]] double work(const Harmonic& whole, double s) const {
    return std::visit([&](const auto& one) { return one.work(whole, s); }, law);
  }
  /// Largest onset with which the law can take a work: that of a brittle bond, unless the law says
  /// less.
  [[nodiscard]] double largest_onset(double of_work) const {
    return std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.largest_onset(of_work); }) return one.largest_onset(of_work);
          return std::sqrt(2.0 * of_work);
        },
        law);
  }
  /// The same law between other stretches.
  [[nodiscard]] OneLawOf between(double onset, double critical) const {
    return std::visit([&](const auto& one) { return OneLawOf{one.between(onset, critical)}; }, law);
  }
};

/// The laws that a material may have.
using AnyLaw = OneLawOf<CriticalStretch, TanhDegradation, ForceEnvelope, ForceTable, OpeningLaw>;

/// Law of a bond: one of these, or the saw-tooth of one.
using AnyBondLaw =
    OneLawOf<CriticalStretch, TanhDegradation, ForceEnvelope, ForceTable, OpeningLaw, SawTooth>;

[[nodiscard]] inline AnyBondLaw bond_law(const AnyLaw& law) {
  return std::visit([](const auto& one) { return AnyBondLaw{one}; }, law.law);
}

}  // namespace peristat
