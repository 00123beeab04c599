#pragma once

#include <string_view>

namespace peristat {

/// Method by which the states of a load path are found: name of a driver in the table in
/// drivers.cpp. Modes that are referred to elsewhere have a constant.
struct Mode {
  std::string_view name;

  friend bool operator==(const Mode&, const Mode&) = default;

  static const Mode newton;      ///< implicitly throughout
  static const Mode relaxation;  ///< by relaxation throughout
  static const Mode adaptive;    ///< implicitly while no damage grows, by relaxation while it does
  static const Mode arc_length;  ///< implicitly along the path itself, with fixed integrities
  static const Mode path;        ///< from one failure event to the next
  static const Mode dynamics;    ///< the motion in time
  static const Mode fatigue;     ///< cycles of the load, from one worn bond to the next
};

inline constexpr Mode Mode::newton{"newton"};
inline constexpr Mode Mode::relaxation{"relaxation"};
inline constexpr Mode Mode::adaptive{"adaptive"};
inline constexpr Mode Mode::arc_length{"arc_length"};
inline constexpr Mode Mode::path{"path"};
inline constexpr Mode Mode::dynamics{"dynamics"};
inline constexpr Mode Mode::fatigue{"fatigue"};

}  // namespace peristat
