#include "src/geometry/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/blue_noise.hpp"
#include "src/geometry/idle_shapes.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "src/geometry/numbering.hpp"
#include "src/geometry/perturbed_cells.hpp"
#include "src/geometry/perturbed_points.hpp"

namespace peristat {
namespace {

constexpr double most_points = std::numeric_limits<Index>::max();
constexpr double finest_share = 64.0;  // lattice spacing over that of a refinement, at most

std::string element(const char* list, std::size_t number) {
  return std::string(list) + "[" + std::to_string(number) + "]";
}

void check_shape_step(const Lattice& lattice, std::size_t number) {
  const ShapeStep& step = lattice.shapes[number];
  const bool adds = step.action == ShapeStep::Action::add;
  const std::string table = element("shapes", number);
  if (number == 0 && !adds) {
    throw InputError(table + ".action", "", "the first shape must be added");
  }
  check_shape(step.shape, lattice.dimension, table, table + ".action");
  const bool is_image = std::holds_alternative<PixelImage>(step.shape);
  const bool is_measured = has_smooth_sides(step.shape) || (is_image && lattice.angle == 0.0);
  if (lattice.volumes == CellVolumes::fractional && !is_measured) {
    throw InputError(table + ".action", "",
                     is_image ? "parts of cells are measured along pixels only: with volumes = "
                                "\"fractional\" angle must be 0"
                              : "parts of cells in a surface of triangles are not measured; leave "
                                "volumes out");
  }
  if (lattice.arrangement == Arrangement::blue_noise && !has_smooth_sides(step.shape)) {
    throw InputError(
        table + ".action", "",
        "points of blue noise need shapes with smooth sides, not an image or a surface "
        "of triangles");
  }
  const Box box = bounds(step.shape);
  for (int c = 0; c < lattice.dimension && adds; ++c) {
    if (std::isfinite(box.min[c]) && std::isfinite(box.max[c])) continue;
    throw InputError(
        table + ".action", "",
        std::string("an added shape must be bounded, but this one is infinite in ") + "xyz"[c]);
  }
}

void check_layer(const Lattice& lattice, std::size_t number) {
  const Layer& layer = lattice.layers[number];
  const std::string table = element("layers", number);
  if (layer.name.empty()) throw InputError(table + ".name", "\"\"", "a layer needs a name");
  const int axis = layer.side.axis, sign = layer.side.sign;
  if (axis < 0 || axis >= lattice.dimension || (sign != 1 && sign != -1)) {
    std::string allowed = "must be one of x-, x+";
    if (lattice.dimension > 1) allowed += ", y-, y+";
    if (lattice.dimension > 2) allowed += ", z-, z+";
    const bool exists = axis >= 0 && axis < 3;
    throw InputError(table + ".side", exists ? "xyz"[axis] + std::string(sign < 0 ? "-" : "+") : "",
                     allowed);
  }
  if (layer.thickness < 1) {
    throw InputError(table + ".thickness", std::to_string(layer.thickness),
                     "must be at least 1 spacing");
  }
}

/// Refuses more points than can be numbered.
void require_numbers(const Lattice& lattice) {
  const double points = estimate_points(lattice);
  if (points < most_points) return;
  throw InputError("spacing", number_text(lattice.spacing),
                   "up to " + number_text(points) + " points, but there must be fewer than " +
                       number_text(most_points));
}

void check_refinement(const Lattice& lattice, std::size_t number) {
  const Refinement& region = lattice.refinements[number];
  const std::string table = element("refinements", number);
  check_shape(region.shape, lattice.dimension, table, table + ".shape");
  if (!has_smooth_sides(region.shape)) {
    throw InputError(table + ".shape", "",
                     "must have smooth sides; an image or a surface of triangles is no region of "
                     "finer points");
  }
  const double most = lattice.spacing, least = most / finest_share;
  if (!(region.spacing >= least && region.spacing < most)) {
    throw InputError(table + ".spacing", number_text(region.spacing),
                     "must be below lattice.spacing, " + number_text(most) + " m, and at least 1/" +
                         number_text(finest_share) + " of it");
  }
  if (!(region.growth >= 0.01 && region.growth <= 0.5)) {
    throw InputError(table + ".growth", number_text(region.growth), "must be from 0.01 to 0.5");
  }
}

/// Refuses settings that have a meaning on a lattice alone.
void check_blue_noise(const Lattice& lattice) {
  const auto require = [](bool fits, const std::string& allowed) {
    if (!fits) throw InputError("arrangement", "blue_noise", allowed);
  };
  require(lattice.dimension > 1, "is for dimensions 2 and 3; in 1D there is cell_perturbation");
  require(lattice.spacing.is_square(), "needs one spacing");
  require(lattice.angle == 0.0, "has no axes, so it takes no angle");
  require(lattice.origin == LatticeOrigin::cell_centres,
          "has no points at corners; leave origin out");
  require(lattice.volumes == CellVolumes::whole,
          "cuts cells at the body's boundary in any case; leave volumes out");
  require(lattice.perturbation == 0.0 && lattice.cell_perturbation == 0.0,
          "is already random; perturbation and cell_perturbation must be 0");
  require(lattice.layers.empty(),
          "has no planes of points for layers to continue; make the body larger and hold a set of "
          "its points");
  if (lattice.lloyd_steps < 0) {
    throw InputError("lloyd_steps", std::to_string(lattice.lloyd_steps), "must not be negative");
  }
  for (std::size_t k = 0; k < lattice.refinements.size(); ++k) check_refinement(lattice, k);
}

}  // namespace

void check_lattice(const Lattice& lattice) {
  const auto refuse = [](const char* key, double value, const std::string& allowed) {
    throw InputError(key, number_text(value), allowed);
  };
  const auto is_positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (lattice.dimension < 1 || lattice.dimension > 3) {
    refuse("dimension", lattice.dimension, "must be 1, 2 or 3");
  }
  for (int c = 0; c < lattice.dimension; ++c) {
    if (is_positive(lattice.spacing.along(c))) continue;
    refuse("spacing", lattice.spacing.along(c), "must be positive and finite");
  }
  if (!(std::abs(lattice.angle) <= 360.0)) {
    refuse("angle", lattice.angle, "must be from -360 to 360");
  }
  if (lattice.dimension == 1 && lattice.angle != 0.0) {
    refuse("angle", lattice.angle, "is for dimensions 2 and 3");
  }
  if (!is_positive(lattice.cross_section)) {
    refuse("cross_section", lattice.cross_section, "must be positive and finite");
  }
  if (!is_positive(std::pow(lattice.spacing, lattice.dimension) * lattice.cross_section)) {
    refuse("spacing", lattice.spacing, "the volume of a point is zero or infinite");
  }
  if (!(lattice.perturbation >= 0.0 && lattice.perturbation < 0.5)) {
    refuse("perturbation", lattice.perturbation, "must be at least 0 and below 0.5");
  }
  if (!(lattice.cell_perturbation >= 0.0 && lattice.cell_perturbation < 0.25)) {
    refuse("cell_perturbation", lattice.cell_perturbation,
           "must be at least 0 and below 0.25, where cells stay convex");
  }
  if (lattice.cell_perturbation > 0.0) {
    const auto require = [&](bool fits, const std::string& allowed) {
      if (!fits) refuse("cell_perturbation", lattice.cell_perturbation, allowed);
    };
    require(lattice.dimension < 3,
            "is for dimensions 1 and 2: in 3D cells would have curved faces");
    require(lattice.perturbation == 0.0, "moves points with their cells; perturbation must be 0");
    require(lattice.volumes == CellVolumes::whole, "is for volumes = \"cells\"");
  }
  if (lattice.shapes.empty()) {
    throw InputError("shapes", "", "a lattice needs at least one added shape");
  }
  for (std::size_t k = 0; k < lattice.shapes.size(); ++k) check_shape_step(lattice, k);
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) check_layer(lattice, k);
  if (lattice.arrangement == Arrangement::blue_noise) return check_blue_noise(lattice);
  if (!lattice.refinements.empty())
    throw InputError("refinements", "",
                     "is for points = \"blue_noise\": a lattice has one spacing");
}

double estimate_points(const Lattice& lattice) {
  if (lattice.dimension < 1 || lattice.dimension > 3)
    return std::numeric_limits<double>::infinity();
  double finer = 0.0;
  if (!lattice.refinements.empty()) {
    finer = SpacingField(lattice.dimension, lattice.spacing, lattice.refinements)
                .most_points(Solid(lattice.dimension, lattice.shapes).bounds());
  }
  return most_sites(lattice) + finer;
}

Points make_points(const Lattice& lattice) {
  check_lattice(lattice);
  require_numbers(lattice);
  refuse_idle_shapes(lattice);
  if (lattice.arrangement == Arrangement::blue_noise) return make_blue_noise_points(lattice);
  std::vector<Site> body = body_sites(lattice);
  const SoleRank alone;
  const LayerSites outside = layer_sites(lattice, outermost_of_body(lattice, body, alone), body);
  refuse_empty_layers(lattice, outside, alone);

  Points points;
  points.dimension = lattice.dimension;
  points.spacing = lattice.spacing;
  points.angle = lattice.angle;
  points.lattice.emplace();
  points.lattice->origin = frame_of(lattice).position({});
  for (const Layer& layer : lattice.layers) points.lattice->layers.push_back(layer.name);
  const double cell_volume = std::pow(lattice.spacing, lattice.dimension) * lattice.cross_section;
  if (lattice.volumes == CellVolumes::fractional || lattice.cell_perturbation > 0.0) {
    points.cell_volume = cell_volume;
  }
  for (const std::vector<Site>& sites : {std::cref(body), std::cref(outside.sites)}) {
    for (const Site& site : sites) {
      points.reference.insert(points.reference.end(), site.place.begin(),
                              site.place.begin() + lattice.dimension);
      points.volume.push_back(cell_volume * site.share);
    }
  }
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    std::vector<Index>& set = points.sets[lattice.layers[k].name];
    for (const Index site : outside.of_layer[k]) set.push_back(Index(body.size()) + site);
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }

  const std::vector<Index> order =
      locality_order(lattice.dimension, lattice.spacing, points.reference);
  points = renumbered(points, order);
  const CellPolygons cells = perturb_cells(lattice, body);
  for (std::size_t k = 0; k < order.size() && !cells.empty(); ++k) {
    const auto site = std::size_t(order[k]);
    const bool is_of_body = site < body.size();
    points.polygons.append(is_of_body ? cells.of(site) : whole_cell(lattice));
    if (!is_of_body) continue;
    points.volume[k] = cell_volume * body[site].share;
    std::copy_n(body[site].place.begin(), lattice.dimension,
                points.reference.begin() + std::ptrdiff_t(k) * lattice.dimension);
  }
  std::vector<bool> is_body(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) is_body[k] = std::size_t(order[k]) < body.size();
  perturb(lattice, is_body, 0, points);
  return points;
}

}  // namespace peristat
