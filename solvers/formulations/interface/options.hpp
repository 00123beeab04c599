#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>

#include "solvers/formulations/specification/body_specification.hpp"

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
  drive,             ///< of the damage of bonds, where release is possible
  strength_surface,
  struts,
  compression,  ///< that damaged bonds still bear
  // Of a body
  volume_correction,
  horizon_shape,
  surface_correction,
  weights,
  form,
  collocation,
  interfaces,
  eigenstrains,
  contacts,  ///< of points, and with obstacles
  given_neighbours,
  horizons,  ///< of points, each its own
  convolutions,
  pressures,
  surface_loads,  ///< tractions and stresses on the surface itself, not on points below it
  images,         ///< planes of symmetry and periods
  events          ///< mode `path`: bonds' strengths say what the body loses
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

/// A setting that not all formulations take: its key and whether it differs from the default.
template <class Specification>
struct OptionOf {
  Option option;
  const char* key;
  bool (*is_given)(const Specification&);
};

using OptionOfMaterial = OptionOf<MaterialSpecification>;
inline constexpr std::array<OptionOfMaterial, 17> options_of_material{{
    {Option::plane, "plane", [](auto& m) { return m.plane != PlaneState::stress; }},
    {Option::kinematics, "kinematics", [](auto& m) { return m.kinematics != Kinematics::finite; }},
    {Option::potential, "potential", [](auto& m) { return m.potential != Harmonic::name; }},
    {Option::micromodulus, "micromodulus", [](auto& m) { return m.micromodulus.has_value(); }},
    {Option::poisson_ratio, "poisson_ratio", [](auto& m) { return m.poisson_ratio.has_value(); }},
    {Option::stabilisation, "stabilisation",
     [](auto& m) { return m.stabilisation != MaterialSpecification().stabilisation; }},
    {Option::constants, "c1", [](auto& m) { return m.c1.has_value(); }},
    {Option::constants, "c2", [](auto& m) { return m.c2 != 0.0; }},
    {Option::constants, "c3", [](auto& m) { return m.c3 != 0.0; }},
    {Option::calibration, "calibration", [](auto& m) { return m.calibration.has_value(); }},
    {Option::thermal_expansion, "thermal_expansion",
     [](auto& m) { return m.thermal_expansion.has_value(); }},
    {Option::fibre, "fibre", [](auto& m) { return m.fibre.has_value(); }},
    {Option::strength, "damage.strength", [](auto& m) { return m.damage.strength.has_value(); }},
    {Option::drive, "damage.drive", [](auto& m) { return m.damage.drive.has_value(); }},
    {Option::strength_surface, "damage.strength_surface",
     [](auto& m) { return m.damage.has_surface(); }},
    {Option::struts, "damage.struts", [](auto& m) { return m.damage.struts != StrutRemedy::keep; }},
    {Option::compression, "damage.compression",
     [](auto& m) { return m.damage.compression != Compression::lost; }},
}};

using OptionOfBody = OptionOf<BodySpecification>;
inline constexpr CollocationSpecification usual_collocation;
inline constexpr std::array<OptionOfBody, 14> options_of_body{{
    {Option::horizons, "horizon_per_size", [](auto& of) { return of.horizon_per_size != 0.0; }},
    {Option::volume_correction, "volume_correction",
     [](auto& of) { return of.volume_correction != VolumeCorrection::none; }},
    {Option::horizon_shape, "horizon_shape",
     [](auto& of) { return of.horizon_shape != HorizonShape::ball; }},
    {Option::surface_correction, "surface_correction",
     [](auto& of) { return of.surface_correction != SurfaceCorrection::none; }},
    {Option::weights, "weights", [](auto& of) { return of.weights != InteractionWeights::mean; }},
    {Option::form, "form", [](auto& of) { return of.form != SolidForm::collocation; }},
    {Option::collocation, "collocation.degree",
     [](auto& of) { return of.collocation.degree != usual_collocation.degree; }},
    {Option::collocation, "collocation.traction_form",
     [](auto& of) { return of.collocation.traction_form != usual_collocation.traction_form; }},
    {Option::collocation, "collocation.normals",
     [](auto& of) { return of.collocation.normals != usual_collocation.normals; }},
    {Option::interfaces, "interfaces", [](auto& of) { return !of.interfaces.empty(); }},
    {Option::contacts, "contacts", [](auto& of) { return !of.contacts.empty(); }},
    {Option::contacts, "obstacles", [](auto& of) { return !of.obstacles.empty(); }},
    {Option::eigenstrains, "eigenstrains", [](auto& of) { return of.eigenstrains.are_there(); }},
    {Option::convolutions, "force_operator", [](auto& of) { return of.is_convolved(); }},
}};

}  // namespace peristat
