#pragma once

#include <map>
#include <string>
#include <vector>

#include "src/core/types.hpp"
#include "src/geometry/images.hpp"

namespace peristat {

/// The body in its reference configuration: points that carry a volume, and named sets of them.
struct Points {
  int dimension = 0;              ///< 1, 2 or 3
  double spacing = 0.0;           ///< lattice spacing, or mean spacing of a cloud [m]
  std::vector<double> reference;  ///< positions, count x dimension, row major [m]
  std::vector<double> volume;     ///< per point [m3]
  std::map<std::string, std::vector<Index>> sets;  ///< ascending point numbers by set name

  Images images{};  ///< of the last points; sets name none of them

  [[nodiscard]] Index count() const { return static_cast<Index>(volume.size()); }
  /// Points that stand for themselves: the first ones.
  [[nodiscard]] Index own() const {
    return count() - static_cast<Index>(images.source.size());
  }
  [[nodiscard]] bool is_image(Index point) const { return point >= own(); }
  /// The point that an image stands for; of other points themselves.
  [[nodiscard]] Index source(Index point) const {
    return is_image(point) ? images.source[std::size_t(point - own())] : point;
  }
  [[nodiscard]] const ImageKind& image_kind(Index image) const {
    return images.kinds[images.kind[std::size_t(image - own())]];
  }

  /// Reference position of a point, padded with zeros to three components.
  [[nodiscard]] Coordinates position(Index point) const {
    Coordinates at{};
    for (int c = 0; c < dimension; ++c) at[c] = reference[std::size_t(point) * dimension + c];
    return at;
  }
};

}  // namespace peristat
