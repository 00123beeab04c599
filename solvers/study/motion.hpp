#pragma once

#include "solvers/body/body.hpp"
#include "solvers/motion/motion_setting.hpp"

namespace peristat {

/// Density per point, without images [kg/m3].
/// @throws InputError ("material.density", …) for a material without one
[[nodiscard]] std::vector<double> densities_of(const Body& body);

/// Masses of a body's points, density times volume, and the initial state of its motion.
/// @throws InputError as densities_of and make_initial_state do; ("initial") for a state that
///         stretches a bond to more than a hundred times its length; ("rigid_sets", "rollers",
///         "linear", "periods") for constraints whose masses are not those of points
[[nodiscard]] MotionSetting make_motion_setting(const Body& body);

}  // namespace peristat
