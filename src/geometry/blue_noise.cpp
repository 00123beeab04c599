#include "src/geometry/blue_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "src/core/counter_random.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/convex_cell.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "src/geometry/numbering.hpp"
#include "src/geometry/voronoi.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Places by the cell of a grid that they lie in; a cell is as large as the largest distance
/// searched.
class Grid {
 public:
  Grid(int dimension, const Box& box, double cell) : dimension_(dimension), low_(box.min) {
    std::size_t cells = 1;
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
      extent_[c] = std::size_t(std::max(1.0, std::ceil((box.max[c] - box.min[c]) / cell)));
      cells *= extent_[c];
    }
    cell_ = cell;
    last_.assign(cells, none);
  }

  void add(const Coordinates& place) {
    const std::size_t at = flat(cell_of(place));
    before_.push_back(last_[at]);
    last_[at] = Index(places_.size());
    places_.push_back(place);
  }

  /// @param distance at most the size of a cell
  [[nodiscard]] bool has_within(double distance, const Coordinates& place) const {
    const std::array<std::size_t, 3> centre = cell_of(place);
    std::array<std::size_t, 3> from{}, to{};
    for (std::size_t c = 0; c < 3; ++c) {
      from[c] = centre[c] - std::min<std::size_t>(centre[c], 1);
      to[c] = std::min(centre[c] + 1, extent_[c] - 1);
    }
    for (std::size_t x = from[0]; x <= to[0]; ++x) {
      for (std::size_t y = from[1]; y <= to[1]; ++y) {
        for (std::size_t z = from[2]; z <= to[2]; ++z) {
          for (Index k = last_[flat({x, y, z})]; k != none; k = before_[std::size_t(k)]) {
            const Coordinates arm = minus<3>(places_[std::size_t(k)], place);
            if (dot<3>(arm, arm) < distance * distance) return true;
          }
        }
      }
    }
    return false;
  }

  [[nodiscard]] const std::vector<Coordinates>& places() const { return places_; }

 private:
  static constexpr Index none = -1;

  [[nodiscard]] std::array<std::size_t, 3> cell_of(const Coordinates& place) const {
    std::array<std::size_t, 3> cell{};
    for (std::size_t c = 0; c < std::size_t(dimension_); ++c)
      cell[c] = std::min(std::size_t((place[c] - low_[c]) / cell_), extent_[c] - 1);
    return cell;
  }
  [[nodiscard]] std::size_t flat(const std::array<std::size_t, 3>& cell) const {
    return (cell[0] * extent_[1] + cell[1]) * extent_[2] + cell[2];
  }

  int dimension_;
  Coordinates low_;
  double cell_ = 0.0;
  std::array<std::size_t, 3> extent_{1, 1, 1};
  std::vector<Index> last_, before_;  // last place per cell; per place the one before
  std::vector<Coordinates> places_;
};

/// Area or volume of the body, in cells of the lattice.
double cells_in_body(const Lattice& lattice) {
  Lattice cut = lattice;
  cut.volumes = CellVolumes::fractional;
  double sum = 0.0;
  for (const Site& site : body_sites(cut)) sum += site.share;
  return sum;
}

struct Parts {
  std::vector<PartInBody> of_place;
  /// Polygons of whole cells in 2D, relative to their centroids.
  std::vector<std::vector<std::array<double, 2>>> polygon;
};

std::vector<std::array<double, 2>> polygon_of(const ConvexCell& cell) {
  const Coordinates from = minus<3>(cell.place, cell.centroid);
  std::vector<std::array<double, 2>> polygon;
  for (const Coordinates& corner : cell.corners)
    polygon.push_back({from[0] + corner[0], from[1] + corner[1]});
  return polygon;
}

/// Parts of the places' Voronoi cells that lie in the body.
Parts parts_of(const Lattice& lattice, const Solid& body, const std::vector<Coordinates>& places,
               Accuracy accuracy) {
  Parts parts{std::vector<PartInBody>(places.size()), {}};
  const bool has_polygons = lattice.dimension == 2 && accuracy == Accuracy::fine;
  if (has_polygons) parts.polygon.resize(places.size());
  for_each_voronoi_cell(lattice.dimension, body.bounds(), lattice.spacing, places,
                        [&](std::size_t number, const ConvexCell& cell) {
                          PartInBody& part = parts.of_place[number];
                          part = part_in_body(cell, body, accuracy);
                          if (has_polygons && part.is_whole)
                            parts.polygon[number] = polygon_of(cell);
                          if (!body.contains(part.centroid)) part.centroid = places[number];
                        });
  return parts;
}

}  // namespace

std::vector<Coordinates> poisson_disk_places(const Solid& body, std::size_t count, double spacing,
                                             std::uint64_t seed) {
  const Box box = body.bounds();
  Grid grid(body.dimension(), box, spacing);
  double distance = spacing;
  const double shrink = 1.0 - 0.01 / double(count);
  for (std::uint64_t dart = 0; grid.places().size() < count; ++dart) {
    const std::uint64_t bits = random_bits(seed, dart);
    Coordinates place{};
    for (std::size_t c = 0; c < std::size_t(body.dimension()); ++c)
      place[c] = box.min[c] + (box.max[c] - box.min[c]) * open_unit(random_bits(bits, c));
    if (!body.contains(place)) continue;
    if (grid.has_within(distance, place)) {
      distance *= shrink;
    } else {
      grid.add(place);
    }
  }
  return grid.places();
}

Points make_blue_noise_points(const Lattice& lattice) {
  const Solid body(lattice.dimension, lattice.shapes);
  const double cells = std::round(cells_in_body(lattice));
  if (cells < 1.0) {
    throw InputError(
        "shapes", "",
        "the body is smaller than half a cell; spacing = " + number_text(lattice.spacing));
  }
  std::vector<Coordinates> places =
      poisson_disk_places(body, std::size_t(cells), lattice.spacing, lattice.seed);
  for (int step = 0; step < lattice.lloyd_steps; ++step) {
    const Parts parts = parts_of(lattice, body, places, Accuracy::rough);
    for (std::size_t k = 0; k < places.size(); ++k) places[k] = parts.of_place[k].centroid;
  }
  const Parts parts = parts_of(lattice, body, places, Accuracy::fine);

  Points points;
  points.dimension = lattice.dimension;
  points.spacing = lattice.spacing;
  points.cell_volume = std::pow(lattice.spacing, lattice.dimension) * lattice.cross_section;
  for (const PartInBody& part : parts.of_place) {
    points.reference.insert(points.reference.end(), part.centroid.begin(),
                            part.centroid.begin() + lattice.dimension);
    points.volume.push_back(part.volume * lattice.cross_section);
  }
  const bool are_polygons =
      lattice.dimension == 2 && std::ranges::all_of(parts.of_place, &PartInBody::is_whole);
  for (std::size_t k = 0; are_polygons && k < parts.polygon.size(); ++k)
    points.polygons.append(parts.polygon[k]);
  return renumbered(points, locality_order(points.dimension, points.spacing, points.reference));
}

}  // namespace peristat
