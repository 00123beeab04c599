#include "src/geometry/images.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/geometry/image_kinds.hpp"

namespace peristat {

ImageKind relative(const ImageKind& from, const ImageKind& to) {
  ImageKind kind;
  for (std::size_t c = 0; c < 3; ++c) {
    kind.mirror[c] = from.mirror[c] * to.mirror[c];
    kind.shift[c] = from.mirror[c] * (to.shift[c] - from.shift[c]);
    kind.periods[c] = to.periods[c] - from.periods[c];
  }
  return kind;
}

bool is_same(const ImageKind& one, const ImageKind& other, double tolerance) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (one.mirror[c] != other.mirror[c]) return false;
    if (std::abs(one.shift[c] - other.shift[c]) > tolerance) return false;
  }
  return true;
}

void add_images(Points& points, const std::vector<ImageKind>& kinds, double reach_of_body) {
  const Index own = points.count();
  // A little more: the search decides which pairs are bonded.
  const double reach = 1.001 * reach_of_body;
  Coordinates least, most;
  least.fill(std::numeric_limits<double>::infinity());
  most.fill(-std::numeric_limits<double>::infinity());
  for (Index i = 0; i < own; ++i) {
    const Coordinates at = points.position(i);
    for (std::size_t c = 0; c < 3; ++c) {
      least[c] = std::min(least[c], at[c]);
      most[c] = std::max(most[c], at[c]);
    }
  }
  points.images.kinds = kinds;
  const auto add_of = [&](Index first, Index last) {
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      for (Index i = first; i < last; ++i) {
        const Coordinates at = kinds[kind].place(points.position(i));
        double squared = 0.0;
        for (std::size_t c = 0; c < std::size_t(points.dimension); ++c) {
          const double beyond = std::max({0.0, least[c] - at[c], at[c] - most[c]});
          squared += beyond * beyond;
        }
        if (squared > reach * reach) continue;
        points.images.source.push_back(i);
        points.images.kind.push_back(kind);
        points.reference.insert(points.reference.end(), at.begin(), at.begin() + points.dimension);
        points.volume.push_back(points.volume[std::size_t(i)]);
        if (!points.horizons.empty()) points.horizons.push_back(points.horizons[std::size_t(i)]);
      }
    }
  };
  const Index owned = points.owned.value_or(own);
  add_of(0, owned);
  add_of(owned, own);
}

void add_images(Points& points, const std::vector<SymmetryPlane>& planes,
                const std::vector<Period>& periods, double reach_of_body) {
  const BodyExtent body = extent_of(points, SoleRank());
  add_images(points, image_kinds(points, body, planes, periods, reach_of_body), reach_of_body);
}

void require_lattice_goes_on(const Points& lattice, const std::vector<SymmetryPlane>& planes,
                             const std::vector<Period>& periods) {
  require_lattice_goes_on(lattice, planes, periods, SoleRank());
}

Points without_images(const Points& points) {
  Points own = points;
  own.images = {points.images.kinds, {}, {}};
  own.volume.resize(std::size_t(points.own()));
  if (!own.horizons.empty()) own.horizons.resize(std::size_t(points.own()));
  own.reference.resize(std::size_t(points.own()) * std::size_t(points.dimension));
  return own;
}

}  // namespace peristat
