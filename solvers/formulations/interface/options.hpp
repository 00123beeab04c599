#pragma once

#include <cstdint>
#include <initializer_list>

namespace peristat {

/// Settings that only some formulations take.
enum class Option {
  // Of a material
  plane,
  kinematics,
  potential,
  micromodulus,
  poisson_ratio,
  stabilisation,
  constants,  ///< c1, c2 and c3
  calibration,
  thermal_expansion,
  fibre,
  strength,
  softening,         ///< laws of damage by which bonds soften
  critical_stretch,  ///< the law by which bonds break at once
  energy_density,    ///< the law by which points fail
  // Of a body
  volume_correction,
  horizon_shape,
  surface_correction,
  weights,
  form,
  collocation,
  interfaces,
  eigenstrains,
  given_neighbours,
  convolutions,
  pressures,
  surface_loads,  ///< tractions and stresses on the surface itself, not on points below it
  images,         ///< planes of symmetry and periods
  events          ///< mode `path`: a body loses just what its bonds lose
};

/// A set of options.
class OptionSet {
 public:
  constexpr OptionSet(std::initializer_list<Option> options) {
    for (const Option option : options) bits_ |= bit(option);
  }
  [[nodiscard]] constexpr bool has(Option option) const { return (bits_ & bit(option)) != 0; }

  [[nodiscard]] constexpr OptionSet with(OptionSet others) const {
    others.bits_ |= bits_;
    return others;
  }
  [[nodiscard]] constexpr OptionSet without(OptionSet others) const {
    others.bits_ = bits_ & ~others.bits_;
    return others;
  }

 private:
  [[nodiscard]] static constexpr std::uint64_t bit(Option option) {
    return std::uint64_t(1) << static_cast<int>(option);
  }
  std::uint64_t bits_ = 0;
};

}  // namespace peristat
