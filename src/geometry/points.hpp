#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Where the points of a lattice stand: (position - origin) / spacing rounds to whole numbers, also
/// in a perturbed one.
struct LatticeFrame {
  Coordinates origin{};               ///< a place of the lattice [m]
  std::vector<std::string> layers{};  ///< names of the sets of points outside the body
};

/// The body in its reference configuration: points that carry a volume, and named sets of them.
struct Points {
  int dimension = 0;              ///< 1, 2 or 3
  double spacing = 0.0;           ///< lattice spacing, or mean spacing of a cloud [m]
  std::vector<double> reference;  ///< positions, count x dimension, row major [m]
  std::vector<double> volume;     ///< per point [m3]
  std::map<std::string, std::vector<Index>> sets;  ///< ascending point numbers by set name
  std::optional<LatticeFrame> lattice{};           ///< nothing for a cloud

  [[nodiscard]] Index count() const { return static_cast<Index>(volume.size()); }

  /// Reference position of a point, padded with zeros to three components.
  [[nodiscard]] Coordinates position(Index point) const {
    Coordinates at{};
    for (int c = 0; c < dimension; ++c) at[c] = reference[std::size_t(point) * dimension + c];
    return at;
  }
};

}  // namespace peristat
