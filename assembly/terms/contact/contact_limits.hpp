#pragma once

namespace peristat {

/// Depth over the largest from which a contact counts as touching: rest is at 0 to round-off.
inline constexpr double touching_depth = -1e-9;

/// A step ends at the first of these: this share of the largest depth, and this share of the time
/// until a contact gets there.
inline constexpr double most_depth_of_step = 0.9, most_time_of_step = 0.9;

/// Later than the end of any step, which is at 1.
inline constexpr double never = 2.0;

}  // namespace peristat
