#pragma once

#include <string_view>

namespace peristat {

/// How the states of a load path are found: which driver of the table in drivers.cpp. Those that
/// others ask for have a constant.
struct Mode {
  std::string_view name;

  friend bool operator==(const Mode&, const Mode&) = default;

  static const Mode newton;      ///< implicitly throughout
  static const Mode relaxation;  ///< by dynamic relaxation throughout
  static const Mode adaptive;    ///< implicitly while no damage grows, by relaxation while it does
};

inline constexpr Mode Mode::newton{"newton"};
inline constexpr Mode Mode::relaxation{"relaxation"};
inline constexpr Mode Mode::adaptive{"adaptive"};

}  // namespace peristat
