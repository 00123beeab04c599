#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "src/core/lanes.hpp"
#include "src/core/types.hpp"
#include "src/potentials/any_law.hpp"

namespace peristat {

/// Stretches between which bonds lose their stiffness: one number for all, or a lane for each.
template <class Real>
struct DamageRange {
  Real onset, critical;
};

/// Laws that the bonds of a body may be of: each keeps a byte of which.
inline constexpr std::size_t most_bond_laws = 256;

/// The laws of damage of bonds that fail in different ways: a law of a few, and stretches of each
/// bond's own.
class BondLaws {
 public:
  /// @param laws that bonds are of, at least one; their stretches don't matter
  BondLaws(std::vector<AnyBondLaw> laws, std::size_t bonds)
      : laws_(std::move(laws)),
        onset_(bonds + lane_count, 1.0),  // kernels read a batch of lanes
        critical_(onset_),
        law_(onset_.size(), 0) {}

  void set(Offset bond, std::size_t law, double onset, double critical) {
    law_[std::size_t(bond)] = static_cast<std::uint8_t>(law);
    onset_[std::size_t(bond)] = onset;
    critical_[std::size_t(bond)] = critical;
  }

  [[nodiscard]] Offset bonds() const { return Offset(law_.size()) - lane_count; }
  /// Which of the laws a bond is of.
  [[nodiscard]] std::size_t law_of(Offset bond) const { return law_[std::size_t(bond)]; }
  [[nodiscard]] AnyBondLaw at(Offset bond) const {
    const auto b = std::size_t(bond);
    return laws_[law_[b]].between(onset_[b], critical_[b]);
  }

  /// Of the bonds from the first on; those past the last are of no bond.
  [[nodiscard]] DamageRange<Lanes> ranges(Offset first) const {
    const auto lanes_at = [first](const std::vector<double>& of) {
      return Lanes(of.data() + first);
    };
    return {lanes_at(onset_), lanes_at(critical_)};
  }

  [[nodiscard]] double bytes() const {
    return double(law_.size()) * (2 * sizeof(double) + sizeof(std::uint8_t));
  }

 private:
  std::vector<AnyBondLaw> laws_;
  std::vector<double> onset_, critical_;
  std::vector<std::uint8_t> law_;
};

}  // namespace peristat
