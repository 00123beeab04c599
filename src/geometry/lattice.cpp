#include "src/geometry/lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <random>

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/numbering.hpp"

namespace peristat {
namespace {

/// Place on the lattice, counted in spacings from the anchor; zero beyond the dimension.
using Cell = std::array<std::int64_t, 3>;

/// Part of a spacing by which a lattice place may miss the box around the shapes.
constexpr double grid_tolerance = 1e-9;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double most_points = std::numeric_limits<Index>::max();

/// The lattice places in the box around all added shapes.
struct Grid {
  Coordinates anchor{};  ///< lower corner of the first added shape's box [m]
  double offset = 0.0;   ///< of the places from the anchor, in spacings
  std::array<double, 3> first{},
      count{1, 1, 1};  ///< per direction; double, so that nothing overflows
};

Grid make_grid(const Lattice& lattice) {
  Grid grid;
  grid.offset = lattice.origin == LatticeOrigin::cell_centres ? 0.5 : 0.0;
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  bool anchored = false;
  for (const ShapeStep& step : lattice.shapes) {
    if (step.action != ShapeStep::Action::add) continue;
    const Box added = bounds(step.shape);
    if (!anchored) grid.anchor = added.min;
    anchored = true;
    for (int c = 0; c < lattice.dimension; ++c) {
      box.min[c] = std::min(box.min[c], added.min[c]);
      box.max[c] = std::max(box.max[c], added.max[c]);
    }
  }
  for (int c = 0; c < lattice.dimension; ++c) {
    const double low = (box.min[c] - grid.anchor[c]) / lattice.spacing - grid.offset;
    const double high = (box.max[c] - grid.anchor[c]) / lattice.spacing - grid.offset;
    const bool usable = lattice.spacing > 0 && std::isfinite(low) && std::isfinite(high);
    grid.first[c] = std::ceil(low - grid_tolerance);
    grid.count[c] = std::max(0.0, std::floor(high + grid_tolerance) - grid.first[c] + 1);
    if (!usable) grid.count[c] = infinity;
  }
  return grid;
}

double largest_number_of_points(const Lattice& lattice, const Grid& grid) {
  const double body = grid.count[0] * grid.count[1] * grid.count[2];
  double all = body;
  for (const Layer& layer : lattice.layers) {
    double plane = 1.0;
    for (int c = 0; c < 3; ++c) plane *= c == layer.side.axis ? 1.0 : grid.count[c];
    all += body > 0 ? plane * std::max(0, layer.thickness) : 0.0;
  }
  return all >= 0 ? all : infinity;  // infinite times zero is not a number
}

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
    std::string allowed = "allowed are x-, x+";
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
  const double points = largest_number_of_points(lattice, make_grid(lattice));
  if (points < most_points) return;
  throw InputError("spacing", number_text(lattice.spacing),
                   "up to " + number_text(points) + " points, but there must be fewer than " +
                       number_text(most_points));
}

/// Position of a lattice place [m]; the origin is met exactly, so that sets may be split there.
Coordinates position(const Lattice& lattice, const Grid& grid, const Cell& cell) {
  Coordinates place{};
  for (int c = 0; c < lattice.dimension; ++c) {
    place[c] = grid.anchor[c] + (double(cell[c]) + grid.offset) * lattice.spacing;
    if (std::abs(place[c]) < grid_tolerance * lattice.spacing) place[c] = 0.0;
  }
  return place;
}

bool in_body(const Lattice& lattice, const Coordinates& place) {
  bool inside = false;
  for (const ShapeStep& step : lattice.shapes) {
    const bool adds = step.action == ShapeStep::Action::add;
    if (inside != adds && contains(step.shape, place)) inside = adds;
  }
  return inside;
}

std::vector<Cell> body_cells(const Lattice& lattice, const Grid& grid) {
  std::vector<Cell> cells;
  Cell first{}, end{};
  for (int c = 0; c < 3; ++c) {
    first[c] = std::int64_t(grid.first[c]);
    end[c] = first[c] + std::int64_t(grid.count[c]);
  }
  Cell cell;
  for (cell[0] = first[0]; cell[0] < end[0]; ++cell[0]) {
    for (cell[1] = first[1]; cell[1] < end[1]; ++cell[1]) {
      for (cell[2] = first[2]; cell[2] < end[2]; ++cell[2]) {
        if (in_body(lattice, position(lattice, grid, cell))) cells.push_back(cell);
      }
    }
  }
  return cells;
}

/// Lattice places of a layer in front of the body, before `where`.
std::vector<Cell> layer_cells(const std::vector<Cell>& body, const Layer& layer) {
  const auto [axis, sign] = layer.side;
  std::int64_t outermost = sign * body.front()[axis];
  for (const Cell& cell : body) outermost = std::max(outermost, sign * cell[axis]);
  std::vector<Cell> cells;
  for (const Cell& cell : body) {
    if (sign * cell[axis] != outermost) continue;
    for (int shift = 1; shift <= layer.thickness; ++shift) {
      cells.push_back(cell);
      cells.back()[axis] += sign * shift;
    }
  }
  return cells;
}

/// Keeps the lattice places where the layer's expression is not zero.
void keep_where(const Lattice& lattice, const Grid& grid, const Layer& layer,
                const std::string& key, std::vector<Cell>& cells) {
  if (layer.where.empty()) return;
  try {
    const Expression where(layer.where, lattice.dimension, lattice.spacing);
    std::erase_if(cells,
                  [&](const Cell& cell) { return where(position(lattice, grid, cell)) == 0.0; });
  } catch (const InputError& error) {
    throw InputError(key, error.value(), error.allowed());
  }
  if (cells.empty())
    throw InputError(key, '"' + layer.where + '"', "selects no point of the layer");
}

/// Shifts the points marked as the body's, in their order. The generator's integers are mapped
/// here, because the standard leaves the mapping of its distributions to each library.
void perturb(const Lattice& lattice, const std::vector<bool>& is_body, Points& points) {
  if (lattice.perturbation == 0.0) return;
  std::mt19937_64 generator(lattice.seed);
  for (std::size_t k = 0; k < points.reference.size(); ++k) {
    if (!is_body[k / lattice.dimension]) continue;
    const double from_zero_to_one = double(generator() >> 11) * 0x1p-53;
    points.reference[k] += lattice.perturbation * lattice.spacing * (2.0 * from_zero_to_one - 1.0);
  }
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
  if (!is_positive(lattice.spacing)) {
    refuse("spacing", lattice.spacing, "must be positive and finite");
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
  if (lattice.shapes.empty()) {
    throw InputError("shapes", "", "a lattice needs at least one added shape");
  }
  for (std::size_t k = 0; k < lattice.shapes.size(); ++k) check_shape_step(lattice, k);
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) check_layer(lattice, k);
}

double estimate_points(const Lattice& lattice) {
  if (lattice.dimension < 1 || lattice.dimension > 3) return infinity;
  return largest_number_of_points(lattice, make_grid(lattice));
}

Points make_points(const Lattice& lattice) {
  check_lattice(lattice);
  require_numbers(lattice);
  const Grid grid = make_grid(lattice);
  const std::vector<Cell> body = body_cells(lattice, grid);
  if (body.empty()) {
    throw InputError(
        "shapes", "",
        "no lattice point lies in the body; spacing = " + number_text(lattice.spacing));
  }

  Points points;
  points.dimension = lattice.dimension;
  points.spacing = lattice.spacing;
  points.lattice.emplace();
  for (int c = 0; c < lattice.dimension; ++c) {
    points.lattice->origin[c] = grid.anchor[c] + grid.offset * lattice.spacing;
  }
  for (const Layer& layer : lattice.layers) points.lattice->layers.push_back(layer.name);
  std::vector<Cell> outside;
  std::map<Cell, Index> layer_points;
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    const Layer& layer = lattice.layers[k];
    std::vector<Cell> cells = layer_cells(body, layer);
    keep_where(lattice, grid, layer, element("layers", k) + ".where", cells);
    std::vector<Index>& set = points.sets[layer.name];
    for (const Cell& cell : cells) {
      const Index next = Index(body.size() + outside.size());
      const auto [entry, is_new] = layer_points.try_emplace(cell, next);
      if (is_new) outside.push_back(cell);
      set.push_back(entry->second);
    }
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }

  for (const std::vector<Cell>& cells : {std::cref(body), std::cref(outside)}) {
    for (const Cell& cell : cells) {
      const Coordinates place = position(lattice, grid, cell);
      points.reference.insert(points.reference.end(), place.begin(),
                              place.begin() + lattice.dimension);
    }
  }
  points.volume.assign(body.size() + outside.size(),
                       std::pow(lattice.spacing, lattice.dimension) * lattice.cross_section);

  const std::vector<Index> order =
      locality_order(lattice.dimension, lattice.spacing, points.reference);
  points = renumbered(points, order);
  std::vector<bool> is_body(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) is_body[k] = std::size_t(order[k]) < body.size();
  perturb(lattice, is_body, points);
  return points;
}

}  // namespace peristat
