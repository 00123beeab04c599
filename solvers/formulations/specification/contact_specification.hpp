#pragma once

#include <string>

namespace peristat {

/// What touches: points alone, or surfaces as faces.
enum class ContactShape { points, faces };

/// Contact of points that no whole bond joins, see PairContactTerm and FaceContactTerm.
struct ContactSpecification {
  std::string set{};   ///< whose points touch; empty: all
  std::string with{};  ///< another set, that they touch; empty: one another
  ContactShape shape = ContactShape::points;
  double friction = 0.0;              ///< mu
  double tangential_stiffness = 0.5;  ///< beta, of a contact that sticks over its stiffness
  double distance = 0.0;   ///< d_c, gap at which two points touch [m]; 0: the mean of their sizes
  double stiffness = 1.0;  ///< alpha, over that of the bar between two points
  double depth = 0.25;     ///< a, largest depth over the distance of contact
  double reach = 0.0;      ///< from the body up to which points have images [m]; 0: the horizon
  double softness = 1e-4;  ///< e0, strain of the gap over which the stiffness sets in
};

}  // namespace peristat
