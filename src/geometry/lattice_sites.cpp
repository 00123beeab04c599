#include "src/geometry/lattice_sites.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/cell_piece.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/geometry/outermost_face.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

bool is_cut(const Lattice& lattice) { return lattice.volumes == CellVolumes::fractional; }

/// Distance beside the box around a region within which cells may lie, see
/// LatticeFrame::for_each_cell.
double beside(const Lattice& lattice) { return is_cut(lattice) ? 0.5 : grid_tolerance; }

/// True if layers are the space in front of flat faces, not copies of the outermost plane.
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

/// Calls visit(cell) as LatticeFrame::for_each_cell does, for the intersection of two boxes.
template <class Visit>
void for_each_cell(const LatticeFrame& frame, Box box, const Box& window, double beside_it,
                   const Visit& visit) {
  for (std::size_t c = 0; c < 3; ++c) {
    box.min[c] = std::max(box.min[c], window.min[c]);
    box.max[c] = std::min(box.max[c], window.max[c]);
    if (box.min[c] > box.max[c]) return;
  }
  frame.for_each_cell(box, beside_it, visit);
}

/// Pieces of the lattice's cells in the region, in ascending order of the cells; `near` gives a
/// region that is the same within a distance of a place.
template <class Shape, class Near>
std::vector<Site> pieces(const LatticeFrame& frame, const Shape& region, const Box& window,
                         const Near& near) {
  std::vector<Site> sites;
  const double reach = frame.half_diagonal() * (1.0 + grid_tolerance);
  for_each_cell(frame, region.bounds(), window, 0.5, [&](const Cell& cell) {
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

/// Gives pieces below smallest_share to the larger pieces in adjacent cells. One without such
/// neighbours stays.
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

/// Sites of whole cells of the body.
std::vector<Site> whole_sites(const Lattice& lattice, const Box& window) {
  const LatticeFrame frame = frame_of(lattice);
  const Solid solid(lattice.dimension, lattice.shapes);
  std::vector<Site> sites;
  for_each_cell(frame, solid.bounds(), window, grid_tolerance, [&](const Cell& cell) {
    const Coordinates place = frame.position(cell);
    if (solid.contains(place)) sites.push_back({cell, place, 1.0, place});
  });
  return sites;
}

/// Sites of whole cells in front of the body, before `where`.
std::vector<Site> copies_of_outermost_plane(const Lattice& lattice, const LatticeFrame& frame,
                                            const OutermostOfBody& outermost, const Layer& layer,
                                            const Box& window) {
  const auto [axis, sign] = layer.side;
  const std::int64_t row = (sign > 0 ? outermost.high : outermost.low)[axis];
  // The plane may lie outside the window in which its copies are wanted, so it is found again.
  constexpr double beside_plane = 0.25;  // in spacings
  Box plane = window;
  Cell of_plane{};
  of_plane[axis] = row;
  const double at = frame.position(of_plane)[axis];
  plane.min[axis] = at - beside_plane * frame.spacing().along(axis);
  plane.max[axis] = at + beside_plane * frame.spacing().along(axis);
  std::vector<Site> sites;
  for (const Site& site : whole_sites(lattice, plane)) {
    Cell cell = site.cell;
    if (cell[axis] != row) continue;
    for (int shift = 1; shift <= layer.thickness; ++shift) {
      cell[axis] += sign;
      sites.push_back({cell, frame.position(cell), 1.0, frame.position(cell)});
    }
  }
  return sites;
}

/// Sites in front of the flat faces that layers are on, side by side.
class Faces {
 public:
  Faces(const Lattice& lattice, const LatticeFrame& frame, const OutermostOfBody& outermost,
        const Box& window)
      : frame_(frame),
        solid_(lattice.dimension, lattice.shapes),
        window_(window),
        is_cut_(is_cut(lattice)) {
    for (const auto& [side, height] : outermost.faces) add(side, height, deepest(lattice, side));
  }

  /// Moves sites that share a cell with the body or with other faces, together with the other sites
  /// of the cell, to the centroids of their parts.
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
          frame_, front, window_,
          [](const FrontOfFace& all, auto&, double) -> auto& { return all; });
      merge_small(frame_.dimension(), face.sites);
    } else {
      for_each_cell(frame_, front.bounds(), window_, grid_tolerance, [&](const Cell& cell) {
        const Coordinates place = frame_.position(cell);
        if (front.contains(place)) face.sites.push_back({cell, place, 1.0, place});
      });
    }
    faces_.push_back(std::move(face));
  }

  const LatticeFrame& frame_;
  Solid solid_;
  Box window_;
  bool is_cut_;
  std::vector<Face> faces_;
};

/// Keeps the sites where the layer's expression is not zero.
void keep_where(const Lattice& lattice, std::size_t number, std::vector<Site>& sites) {
  const Layer& layer = lattice.layers[number];
  if (layer.where.empty()) return;
  const std::string key = key_of(number, "where");
  try {
    const Expression where = expression_of(layer.where, lattice);
    std::vector<Coordinates> places;
    for (const Site& site : sites) places.push_back(site.place);
    const std::vector<double> values = where.at(places);
    std::size_t site_number = 0;
    std::erase_if(sites, [&](const Site&) { return values[site_number++] == 0.0; });
  } catch (const InputError& error) {
    throw InputError(key, error.value(), error.allowed());
  }
}

/// Numbers the sites of layers; a site that several layers share gets one number.
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

Box everywhere() { return {{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}; }

double depth_of_window(const Lattice& lattice) {
  // Small parts of cells go to neighbours in proportion to these neighbours' shares: two cells
  // away. Cells extend around their places, and places move to centroids.
  constexpr double cells = 4.0;
  return cells * lattice.spacing.largest();
}

std::vector<Site> body_sites(const Lattice& lattice, const Box& window) {
  if (!is_cut(lattice)) return whole_sites(lattice, window);
  const Solid solid(lattice.dimension, lattice.shapes);
  std::vector<Site> sites = pieces(frame_of(lattice), solid, window,
                                   [](const Solid& all, const Coordinates& place, double reach) {
                                     return all.near(place, reach);
                                   });
  merge_small(lattice.dimension, sites);
  return sites;
}

OutermostOfBody outermost_of_body(const Lattice& lattice, const std::vector<Site>& body,
                                  const Communicator& ranks) {
  std::vector<double> least(6, infinity);  // of cells along each axis, and of -cells
  for (const Site& site : body) {
    for (std::size_t c = 0; c < 3; ++c) {
      least[c] = std::min(least[c], double(site.cell[c]));
      least[c + 3] = std::min(least[c + 3], -double(site.cell[c]));
    }
  }
  least = ranks.min(least);
  if (least[0] == infinity) {
    throw InputError(
        "shapes", "",
        "no lattice point lies in the body; spacing = " + number_text(lattice.spacing));
  }
  OutermostOfBody outermost;
  for (std::size_t c = 0; c < 3; ++c) {
    outermost.low[c] = std::int64_t(least[c]);
    outermost.high[c] = std::int64_t(-least[c + 3]);
  }
  const LatticeFrame frame = frame_of(lattice);
  if (!has_faces(lattice, frame)) return outermost;
  const Solid solid(lattice.dimension, lattice.shapes);
  std::vector<Coordinates> places;
  for (const Site& site : body) places.push_back(site.centroid);
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    const Side& side = lattice.layers[k].side;
    const bool is_known = std::any_of(outermost.faces.begin(), outermost.faces.end(),
                                      [&](const auto& face) { return face.first == side; });
    if (is_known) continue;
    const auto height = outermost_face(solid, side, places, frame.spacing(), ranks);
    if (!height) {
      throw InputError(key_of(k, "side"), "xyz"[side.axis] + std::string(side.sign > 0 ? "+" : "-"),
                       "the body has no flat outermost face there; a layer on a turned lattice or "
                       "with fractional volumes needs one");
    }
    outermost.faces.emplace_back(side, *height);
  }
  return outermost;
}

LayerSites layer_sites(const Lattice& lattice, const OutermostOfBody& outermost,
                       std::vector<Site>& body, const Box& window) {
  const LatticeFrame frame = frame_of(lattice);
  std::optional<Faces> faces;
  if (has_faces(lattice, frame)) faces.emplace(lattice, frame, outermost, window);
  if (faces) faces->part_from(body);
  SharedSites shared(is_cut(lattice));
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    const Layer& layer = lattice.layers[k];
    std::vector<Site> sites =
        faces ? faces->of(layer)
              : copies_of_outermost_plane(lattice, frame, outermost, layer, window);
    shared.found.standing.push_back(double(sites.size()));
    keep_where(lattice, k, sites);
    shared.add(layer, sites);
  }
  return std::move(shared.found);
}

void refuse_empty_layers(const Lattice& lattice, const LayerSites& layers,
                         const Communicator& ranks) {
  std::vector<double> counts = layers.standing;
  for (const auto& members : layers.of_layer) counts.push_back(double(members.size()));
  counts = ranks.sum(counts);
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    if (counts[k] == 0.0) {
      throw InputError(key_of(k, "thickness"), std::to_string(lattice.layers[k].thickness),
                       "no lattice point lies in the layer");
    }
    if (counts[lattice.layers.size() + k] == 0.0) {
      throw InputError(key_of(k, "where"), '"' + lattice.layers[k].where + '"',
                       "selects no point of the layer");
    }
  }
}

}  // namespace peristat
