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

/// Most laws that the bonds of a body may have: each bond keeps the number of its law in a byte.
inline constexpr std::size_t most_bond_laws = 256;

/// The laws of damage of bonds that fail in different ways: one of a few laws for each bond, with
/// stretches of its own.
class BondLaws {
 public:
  /// @param laws of the bonds, at least one; their stretches are not used
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
  [[nodiscard]] double onset_of(Offset bond) const { return onset_[std::size_t(bond)]; }
  /// Number of the law of a bond.
  [[nodiscard]] std::size_t law_of(Offset bond) const { return law_[std::size_t(bond)]; }
  [[nodiscard]] AnyBondLaw at(Offset bond) const {
    return at(bond, onset_[std::size_t(bond)], critical_[std::size_t(bond)]);
  }
  /// The law of a bond between other stretches.
  [[nodiscard]] AnyBondLaw at(Offset bond, double onset, double critical) const {
    return laws_[law_[std::size_t(bond)]].between(onset, critical);
  }

  /// Ranges of the bonds from the first on; lanes past the last bond belong to none.
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
