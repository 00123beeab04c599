#include "src/geometry/blue_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/convex_cell.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "src/geometry/numbering.hpp"
#include "src/geometry/poisson_disk.hpp"
#include "src/geometry/spacing_field.hpp"
#include "src/geometry/voronoi.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Parts of the body's box at which places are aimed, with the number of points that belong there.
class Targets {
 public:
  Targets(const Lattice& lattice, const SpacingField& field, const Solid& body)
      : field_(field), body_(body), dimension_(lattice.dimension) {
    Lattice cut = lattice;
    cut.volumes = CellVolumes::fractional;
    const double edge = lattice.spacing;
    for (const Site& site : body_sites(cut)) {
      if (field.is_even()) {
        count_ += site.share;
      } else {
        add(site.place, edge, site.share);
      }
    }
    if (field.is_even()) targets_ = {{body.bounds(), 1.0}};
  }

  [[nodiscard]] double count() const { return count_; }
  [[nodiscard]] const std::vector<Target>& list() const { return targets_; }

 private:
  /// Adds a cell, or its parts if it is larger than the spacing there. Of parts of a cell that the
  /// boundary cuts, those with their centres in the body count.
  void add(const Coordinates& centre, double edge, double share) {
    const double spacing = field_.at(centre);
    if (edge > 1.01 * spacing) {
      for (int part = 0; part < 1 << dimension_; ++part) {
        Coordinates at = centre;
        for (std::size_t c = 0; c < std::size_t(dimension_); ++c)
          at[c] += (part >> c & 1) != 0 ? 0.25 * edge : -0.25 * edge;
        if (share >= 1.0 || body_.contains(at)) add(at, 0.5 * edge, 1.0);
      }
      return;
    }
    Target target{{centre, centre}, share * std::pow(edge / spacing, dimension_)};
    for (std::size_t c = 0; c < std::size_t(dimension_); ++c) {
      target.box.min[c] -= 0.5 * edge;
      target.box.max[c] += 0.5 * edge;
    }
    count_ += target.count;
    targets_.push_back(target);
  }

  const SpacingField& field_;
  const Solid& body_;
  int dimension_;
  std::vector<Target> targets_;
  double count_ = 0.0;
};

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

/// Refuses a region that makes no point finer.
void refuse_idle_regions(const std::vector<Refinement>& regions, const SpacingField& field,
                         const std::vector<Target>& targets) {
  std::vector<bool> acts(regions.size(), false);
  for (const Target& target : targets) {
    const auto region = field.region_at(scaled<3>(0.5, plus<3>(target.box.min, target.box.max)));
    if (region) acts[*region] = true;
  }
  for (std::size_t k = 0; k < regions.size(); ++k) {
    if (acts[k]) continue;
    throw InputError("refinements[" + std::to_string(k) + "].shape", "",
                     "has no effect: it is outside the body, or other regions are finer there");
  }
}

/// Moves a place to the centroid of its cell under a density h^-(d + 2), with which a centroidal
/// Voronoi diagram has cells of the size h (Du, Faber and Gunzburger 1999): to first order the
/// centroid of the even cell, moved by -(d + 2) grad h V^(2/d) / (12 h).
Coordinates lloyd_step(const PartInBody& part, const Solid& body, const SpacingField& field) {
  if (field.is_even()) return part.centroid;
  const double d = body.dimension(), h = field.at(part.centroid);
  const double factor = -(d + 2.0) * std::pow(part.volume, 2.0 / d) / (12.0 * h);
  const Coordinates moved =
      plus<3>(part.centroid, scaled<3>(factor, field.gradient(part.centroid)));
  return body.contains(moved) ? moved : part.centroid;
}

}  // namespace

Points make_blue_noise_points(const Lattice& lattice) {
  const Solid body(lattice.dimension, lattice.shapes);
  const SpacingField field(lattice.dimension, lattice.spacing, lattice.refinements);
  const Targets targets(lattice, field, body);
  const double count = std::round(targets.count());
  if (count < 1.0) {
    throw InputError(
        "shapes", "",
        "the body is smaller than half a cell; spacing = " + number_text(lattice.spacing));
  }
  refuse_idle_regions(lattice.refinements, field, targets.list());
  std::vector<Coordinates> places =
      poisson_disk_places(body, std::size_t(count), field, targets.list(), lattice.seed);
  for (int step = 0; step < lattice.lloyd_steps; ++step) {
    const Parts parts = parts_of(lattice, body, places, Accuracy::rough);
    for (std::size_t k = 0; k < places.size(); ++k)
      places[k] = lloyd_step(parts.of_place[k], body, field);
  }
  const Parts parts = parts_of(lattice, body, places, Accuracy::fine);

  Points points;
  points.dimension = lattice.dimension;
  double volume = 0.0;
  for (const PartInBody& part : parts.of_place) {
    points.reference.insert(points.reference.end(), part.centroid.begin(),
                            part.centroid.begin() + lattice.dimension);
    points.volume.push_back(part.volume * lattice.cross_section);
    volume += part.volume;
  }
  points.spacing = lattice.spacing;
  if (!field.is_even()) points.spacing = std::pow(volume / count, 1.0 / lattice.dimension);
  points.cell_volume = std::pow(points.spacing, lattice.dimension) * lattice.cross_section;
  const bool are_polygons =
      lattice.dimension == 2 && std::ranges::all_of(parts.of_place, &PartInBody::is_whole);
  for (std::size_t k = 0; are_polygons && k < parts.polygon.size(); ++k)
    points.polygons.append(parts.polygon[k]);
  return renumbered(points, locality_order(points.dimension, points.spacing, points.reference));
}

}  // namespace peristat
