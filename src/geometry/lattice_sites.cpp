#include "src/geometry/lattice_sites.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/cell_piece.hpp"

namespace peristat {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_cut(const Lattice& lattice) { return lattice.volumes == CellVolumes::fractional; }

/// How far cells may stand beside the box around a region, see LatticeFrame::for_each_cell.
double beside(const Lattice& lattice) { return is_cut(lattice) ? 0.5 : grid_tolerance; }

/// Whether layers are what stands in front of flat faces, not copies of the outermost plane.
bool has_faces(const Lattice& lattice, const LatticeFrame& frame) {
  return is_cut(lattice) || frame.is_turned();
}

/// Depth of a layer [m].
double depth_of(const LatticeFrame& frame, const Layer& layer) {
  const Spacing& spacing = frame.spacing();
  return layer.thickness * (frame.is_turned() ? double(spacing) : spacing.along(layer.side.axis));
}

std::string key_of(std::size_t layer, const char* key) {
  return "layers[" + std::to_string(layer) + "]." + key;
}

/// What the region has of the lattice's cells, in ascending order of these; `near` gives a region
/// that is the same within a distance of a place.
template <class Shape, class Near>
std::vector<Site> pieces(const LatticeFrame& frame, const Shape& region, const Near& near) {
  std::vector<Site> sites;
  const double reach = frame.half_diagonal() * (1.0 + grid_tolerance);
  frame.for_each_cell(region.bounds(), 0.5, [&](const Cell& cell) {
    const Coordinates place = frame.position(cell);
    const auto nearby = near(region, place, reach);
    if (!nearby.may_end_near(place, reach)) {
      if (nearby.contains(place)) sites.push_back({cell, place, 1.0, place});
      return;
    }
    const CellPiece piece = piece_of(frame, cell, nearby);
    if (piece.share > 0.0) sites.push_back({cell, place, piece.share, piece.centroid});
  });
  return sites;
}

/// Gives what is smaller than smallest_share to the larger pieces in the cells beside it. One that
/// has none beside it stays.
void merge_small(int dimension, std::vector<Site>& sites) {
  std::map<Cell, std::size_t> of_cell;
  for (std::size_t k = 0; k < sites.size(); ++k) of_cell[sites[k].cell] = k;
  const std::vector<Site> before = sites;
  const auto is_small = [&](std::size_t k) { return before[k].share < smallest_share; };
  std::vector<bool> is_gone(sites.size(), false);
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (!is_small(k)) continue;
    std::vector<std::size_t> heirs;
    double of_heirs = 0.0;
    for (int c = 0; c < dimension; ++c) {
      for (const int sign : {-1, 1}) {
        Cell cell = before[k].cell;
        cell[c] += sign;
        const auto found = of_cell.find(cell);
        if (found == of_cell.end() || is_small(found->second)) continue;
        heirs.push_back(found->second);
        of_heirs += before[found->second].share;
      }
    }
    for (const std::size_t heir : heirs) {
      const double part = before[k].share * before[heir].share / of_heirs;
      sites[heir].share += part;
    }
    is_gone[k] = !heirs.empty();
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (!is_gone[k]) sites[kept++] = sites[k];
  sites.resize(kept);
}

/// Sites of whole cells in front of the body, before `where`.
std::vector<Site> copies_of_outermost_plane(const LatticeFrame& frame,
                                            const std::vector<Site>& body, const Layer& layer) {
  const auto [axis, sign] = layer.side;
  std::int64_t outermost = sign * body.front().cell[axis];
  for (const Site& site : body) outermost = std::max(outermost, sign * site.cell[axis]);
  std::vector<Site> sites;
  for (const Site& site : body) {
    Cell cell = site.cell;
    if (sign * cell[axis] != outermost) continue;
    for (int shift = 1; shift <= layer.thickness; ++shift) {
      cell[axis] += sign;
      sites.push_back({cell, frame.position(cell), 1.0, frame.position(cell)});
    }
  }
  return sites;
}

/// What stands in front of the flat faces that layers are on, side by side.
class Faces {
 public:
  Faces(const Lattice& lattice, const LatticeFrame& frame, const std::vector<Site>& body)
      : frame_(frame), solid_(lattice.dimension, lattice.shapes), is_cut_(is_cut(lattice)) {
    std::vector<Coordinates> places;
    for (const Site& site : body) places.push_back(site.centroid);
    for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
      const Layer& layer = lattice.layers[k];
      const auto is_on_it = [&](const Face& face) { return face.side == layer.side; };
      if (std::any_of(faces_.begin(), faces_.end(), is_on_it)) continue;
      const auto height = outermost_face(solid_, layer.side, places, frame.spacing());
      if (!height) {
        throw InputError(key_of(k, "side"),
                         "xyz"[layer.side.axis] + std::string(layer.side.sign > 0 ? "+" : "-"),
                         "the body has no flat face out there; a layer on a turned lattice or "
                         "with fractional volumes needs one");
      }
      add(layer.side, *height, deepest(lattice, layer.side));
    }
  }

  /// Moves sites that share a cell with the body's or with those of other faces, and these, to the
  /// centroids of their parts.
  void part_from(std::vector<Site>& body) {
    std::map<Cell, std::vector<Site*>> of_cell;
    for (Face& face : faces_)
      for (Site& site : face.sites) of_cell[site.cell].push_back(&site);
    for (Site& site : body) {
      const auto found = of_cell.find(site.cell);
      if (found != of_cell.end()) found->second.push_back(&site);
    }
    for (const auto& [cell, sites] : of_cell) {
      if (sites.size() == 1 || !is_cut_) continue;
      for (Site* site : sites) site->place = site->centroid;
    }
  }

  /// Sites of a layer, before `where`.
  [[nodiscard]] std::vector<Site> of(const Layer& layer) const {
    const Face& face = *std::find_if(faces_.begin(), faces_.end(),
                                     [&](const Face& one) { return one.side == layer.side; });
    std::vector<Site> sites;
    const double depth = depth_of(frame_, layer) * (1.0 + grid_tolerance);
    for (const Site& site : face.sites)
      if (face.front->height(site.centroid) <= depth) sites.push_back(site);
    return sites;
  }

 private:
  struct Face {
    Side side;
    std::unique_ptr<FrontOfFace> front;
    std::vector<Site> sites;
  };

  [[nodiscard]] double deepest(const Lattice& lattice, const Side& side) const {
    double depth = 0.0;
    for (const Layer& layer : lattice.layers)
      if (layer.side == side) depth = std::max(depth, depth_of(frame_, layer));
    return depth;
  }

  void add(const Side& side, double height, double depth) {
    std::vector<const FrontOfFace*> others;
    if (is_cut_)
      for (const Face& face : faces_) others.push_back(face.front.get());
    Face face{side,
              std::make_unique<FrontOfFace>(solid_, side, height, depth, frame_.spacing(), others),
              {}};
    const FrontOfFace& front = *face.front;
    if (is_cut_) {
      face.sites = pieces(
          frame_, front, [](const FrontOfFace& all, auto&, double) -> auto& { return all; });
      merge_small(frame_.dimension(), face.sites);
    } else {
      frame_.for_each_cell(front.bounds(), grid_tolerance, [&](const Cell& cell) {
        const Coordinates place = frame_.position(cell);
        if (front.contains(place)) face.sites.push_back({cell, place, 1.0, place});
      });
    }
    faces_.push_back(std::move(face));
  }

  const LatticeFrame& frame_;
  Solid solid_;
  bool is_cut_;
  std::vector<Face> faces_;
};

/// Keeps the sites where the layer's expression is not zero.
void keep_where(const Lattice& lattice, std::size_t number, std::vector<Site>& sites) {
  const Layer& layer = lattice.layers[number];
  if (layer.where.empty()) return;
  const std::string key = key_of(number, "where");
  try {
    const Expression where(layer.where, lattice.dimension, lattice.spacing);
    std::erase_if(sites, [&](const Site& site) { return where(site.place) == 0.0; });
  } catch (const InputError& error) {
    throw InputError(key, error.value(), error.allowed());
  }
}

/// Numbers the sites of layers, those that several share once.
class SharedSites {
 public:
  explicit SharedSites(bool is_cut) : is_cut_(is_cut) {}

  void add(const Layer& layer, const std::vector<Site>& sites) {
    std::vector<Index>& members = found.of_layer.emplace_back();
    const int side = is_cut_ ? 2 * layer.side.axis + (layer.side.sign > 0 ? 1 : 0) : 0;
    for (const Site& site : sites) {
      const auto [entry, is_new] = known_.try_emplace({side, site.cell}, Index(found.sites.size()));
      if (is_new) found.sites.push_back(site);
      members.push_back(entry->second);
    }
    std::sort(members.begin(), members.end());
  }

  LayerSites found;

 private:
  bool is_cut_;
  // With whole cells, layers of different sides may share a site; cut cells are of one side.
  std::map<std::pair<int, Cell>, Index> known_;
};

}  // namespace

LatticeFrame frame_of(const Lattice& lattice) {
  const double offset = lattice.origin == LatticeOrigin::cell_centres ? 0.5 : 0.0;
  Coordinates anchor{};
  for (const ShapeStep& step : lattice.shapes) {
    if (step.action != ShapeStep::Action::add) continue;
    anchor = bounds(step.shape).min;  // lower corner of the first added shape's box
    break;
  }
  return {lattice.dimension, anchor, offset, lattice.spacing, lattice.angle};
}

double most_sites(const Lattice& lattice) {
  const LatticeFrame frame = frame_of(lattice);
  const Box box = Solid(lattice.dimension, lattice.shapes).bounds();
  const double body = frame.most_places(box, beside(lattice));
  const std::array<double, 3> counts = frame.counts(box, beside(lattice));
  double all = body;
  for (const Layer& layer : lattice.layers) {
    const int axis = layer.side.axis;
    double places = std::max(0, layer.thickness);
    for (int c = 0; c < 3; ++c) places *= c == axis ? 1.0 : counts[c];
    if (has_faces(lattice, frame) && axis >= 0 && axis < lattice.dimension) {
      Box front = box;
      front.max[axis] = front.min[axis] + depth_of(frame, layer);
      places = frame.most_places(front, 0.5);
    }
    all += body > 0 ? places : 0.0;
  }
  return all >= 0 ? all : infinity;  // infinite times zero is not a number
}

std::vector<Site> body_sites(const Lattice& lattice) {
  const LatticeFrame frame = frame_of(lattice);
  const Solid solid(lattice.dimension, lattice.shapes);
  std::vector<Site> sites;
  if (is_cut(lattice)) {
    sites = pieces(frame, solid, [](const Solid& all, const Coordinates& place, double reach) {
      return all.near(place, reach);
    });
    merge_small(lattice.dimension, sites);
    return sites;
  }
  frame.for_each_cell(solid.bounds(), grid_tolerance, [&](const Cell& cell) {
    const Coordinates place = frame.position(cell);
    if (solid.contains(place)) sites.push_back({cell, place, 1.0, place});
  });
  return sites;
}

LayerSites layer_sites(const Lattice& lattice, std::vector<Site>& body) {
  const LatticeFrame frame = frame_of(lattice);
  std::optional<Faces> faces;
  if (has_faces(lattice, frame)) faces.emplace(lattice, frame, body);
  if (faces) faces->part_from(body);
  SharedSites shared(is_cut(lattice));
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    const Layer& layer = lattice.layers[k];
    std::vector<Site> sites =
        faces ? faces->of(layer) : copies_of_outermost_plane(frame, body, layer);
    if (sites.empty()) {
      throw InputError(key_of(k, "thickness"), std::to_string(layer.thickness),
                       "no lattice point stands in the layer");
    }
    keep_where(lattice, k, sites);
    if (sites.empty()) refuse_empty_layer(lattice, k);
    shared.add(layer, sites);
  }
  return std::move(shared.found);
}

LatticeRows rows_of_body(const Lattice& lattice, int axis) {
  const LatticeFrame::Range range =
      frame_of(lattice).range_of(Solid(lattice.dimension, lattice.shapes).bounds(), grid_tolerance);
  const auto first = std::int64_t(range.first[axis]);
  return {axis, first, first + std::int64_t(range.count[axis])};
}

std::vector<Site> body_sites(const Lattice& lattice, const LatticeRows& rows) {
  const LatticeFrame frame = frame_of(lattice);
  const Solid solid(lattice.dimension, lattice.shapes);
  Cell first{}, last{};
  for (int axis = 0; axis < 3; ++axis) {
    const LatticeRows all = rows_of_body(lattice, axis);
    first[axis] = axis == rows.axis ? std::max(all.first, rows.first) : all.first;
    last[axis] = axis == rows.axis ? std::min(all.last, rows.last) : all.last;
  }
  std::vector<Site> sites;
  Cell cell{};
  for (cell[0] = first[0]; cell[0] < last[0]; ++cell[0]) {
    for (cell[1] = first[1]; cell[1] < last[1]; ++cell[1]) {
      for (cell[2] = first[2]; cell[2] < last[2]; ++cell[2]) {
        const Coordinates place = frame.position(cell);
        if (solid.contains(place)) sites.push_back({cell, place, 1.0, place});
      }
    }
  }
  return sites;
}

LayerSites layer_sites(const Lattice& lattice, const LatticeRows& rows,
                       const std::vector<Site>& body, const Cell& low, const Cell& high) {
  const LatticeFrame frame = frame_of(lattice);
  SharedSites shared(false);
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    const Layer& layer = lattice.layers[k];
    const auto [axis, sign] = layer.side;
    const std::int64_t outermost = sign > 0 ? high[axis] : low[axis];
    // A plane across the rows' axis is another rank's, perhaps; it is found again.
    std::vector<Site> plane;
    if (axis == rows.axis) {
      plane = body_sites(lattice, {axis, outermost, outermost + 1});
    } else {
      std::copy_if(body.begin(), body.end(), std::back_inserter(plane),
                   [&, on = axis](const Site& site) { return site.cell[on] == outermost; });
    }
    std::vector<Site> sites;
    if (!plane.empty()) sites = copies_of_outermost_plane(frame, plane, layer);
    std::erase_if(sites, [&](const Site& site) {
      return site.cell[rows.axis] < rows.first || site.cell[rows.axis] >= rows.last;
    });
    keep_where(lattice, k, sites);
    shared.add(layer, sites);
  }
  return std::move(shared.found);
}

void refuse_empty_layer(const Lattice& lattice, std::size_t number) {
  throw InputError(key_of(number, "where"), '"' + lattice.layers[number].where + '"',
                   "selects no point of the layer");
}

}  // namespace peristat
