#include "src/geometry/slab.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>

#include "src/core/infinity.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/idle_shapes.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "src/geometry/numbering.hpp"
#include "src/geometry/perturbed_cells.hpp"
#include "src/geometry/perturbed_points.hpp"
#include "src/geometry/solid.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

void refuse_without_slabs(const Lattice& lattice) {
  const auto refuse = [](const char* key, const std::string& value, const std::string& what) {
    throw InputError(key, value, "is not for several ranks: " + what);
  };
  if (lattice.arrangement == Arrangement::blue_noise) {
    refuse("arrangement", "blue_noise",
           "every point depends on those placed before it; take arrangement = \"lattice\", or one "
           "rank");
  }
  if (estimate_points(lattice) < 0x1p53) return;
  refuse("spacing", number_text(lattice.spacing), "there must be fewer than 2^53 points");
}

/// Places between two planes across an axis.
struct Between {
  int axis = 0;
  double from = -infinity, to = infinity;

  /// The upper plane is excluded.
  [[nodiscard]] bool has(const Coordinates& place) const {
    return place[std::size_t(axis)] >= from && place[std::size_t(axis)] < to;
  }
  /// The slab widened by `depth` on both sides.
  [[nodiscard]] Box window(double depth) const {
    Box box = everywhere();
    box.min[std::size_t(axis)] = from - depth;
    box.max[std::size_t(axis)] = to + depth;
    return box;
  }
};

/// This rank's share of the rows of places along the direction in which numbers run slowest.
class ShareOfRows {
 public:
  ShareOfRows(const Lattice& lattice, const LocalityCells& cells, const Coordinates& low,
              const Coordinates& high, const Communicator& ranks)
      : cells_(cells) {
    const double rows = cells.of(high.data())[0] + 1.0;
    const int axis = cells.slowest();
    const double spacing = lattice.spacing.along(axis);
    first_ = std::floor(rows * ranks.rank() / ranks.count());
    last_ = std::floor(rows * (ranks.rank() + 1) / ranks.count());
    about_ = {axis, low[std::size_t(axis)] + (first_ - 0.5) * spacing,
              low[std::size_t(axis)] + (last_ - 0.5) * spacing};
  }

  /// Decides by the row's number, not by planes, which might differ from it by round-off.
  [[nodiscard]] bool has(const Coordinates& place) const {
    const double row = cells_.of(place.data())[0];
    return row >= first_ && row < last_;
  }
  [[nodiscard]] Box window(double depth) const { return about_.window(depth); }

 private:
  const LocalityCells& cells_;
  double first_ = 0.0, last_ = 0.0;
  Between about_;
};

/// This rank's share of all places, by planes that cut a length into equal parts.
Between share_of_length(int axis, double low, double high, const Communicator& ranks) {
  const auto plane = [&](int number) {
    if (number == 0) return -infinity;
    if (number == ranks.count()) return infinity;
    return low + (high - low) * number / ranks.count();
  };
  return {axis, plane(ranks.rank()), plane(ranks.rank() + 1)};
}

/// Least and largest coordinates along each axis; after `gather` those of all ranks.
struct Extent {
  Coordinates low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

  void add(const Coordinates& at) {
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], at[c]);
      high[c] = std::max(high[c], at[c]);
    }
  }
  void gather(const Communicator& ranks) {
    const std::vector<double> least = ranks.min({low.begin(), low.end()});
    const std::vector<double> largest = ranks.max({high.begin(), high.end()});
    std::copy(least.begin(), least.end(), low.begin());
    std::copy(largest.begin(), largest.end(), high.begin());
  }
};

/// Sites of a slab, and some beside it.
struct SlabSites {
  std::vector<Site> body;
  LayerSites layers;
};

/// Keeps the sites of layers that are in a slab.
template <class Slab>
LayerSites restricted(const LayerSites& layers, const Slab& slab) {
  constexpr Index nowhere = -1;
  LayerSites kept;
  std::vector<Index> number;
  for (const Site& site : layers.sites) {
    const bool is_here = slab.has(site.place);
    number.push_back(is_here ? Index(kept.sites.size()) : nowhere);
    if (is_here) kept.sites.push_back(site);
  }
  for (const std::vector<Index>& members : layers.of_layer) {
    std::vector<Index>& of_layer = kept.of_layer.emplace_back();
    for (const Index site : members) {
      if (number[std::size_t(site)] != nowhere) of_layer.push_back(number[std::size_t(site)]);
    }
  }
  kept.standing = layers.standing;
  return kept;
}

template <class Slab>
std::vector<Site> restricted(const std::vector<Site>& sites, const Slab& slab) {
  std::vector<Site> kept;
  std::copy_if(sites.begin(), sites.end(), std::back_inserter(kept),
               [&](const Site& site) { return slab.has(site.place); });
  return kept;
}

/// Sites that may be in a slab.
SlabSites sites_near(const Lattice& lattice, const OutermostOfBody& outermost, const Box& window) {
  SlabSites sites;
  sites.body = body_sites(lattice, window);
  sites.layers = layer_sites(lattice, outermost, sites.body, window);
  return sites;
}

/// Data of the whole body that every rank needs.
struct WholeLattice {
  OutermostOfBody outermost;
  Extent extent;  ///< of all places
};

/// Each rank examines a share of the body's length. Collective.
WholeLattice look_at_whole(const Lattice& lattice, const Communicator& ranks) {
  const Box box = Solid(lattice.dimension, lattice.shapes).bounds();
  int axis = 0;
  const auto length = [&](int c) { return box.max[c] - box.min[c]; };
  for (int c = 1; c < lattice.dimension; ++c) {
    if (length(c) > length(axis)) axis = c;
  }
  const Between share = share_of_length(axis, box.min[axis], box.max[axis], ranks);
  const Box window = share.window(depth_of_window(lattice));
  WholeLattice whole;
  whole.outermost =
      outermost_of_body(lattice, restricted(body_sites(lattice, window), share), ranks);
  const SlabSites sites = sites_near(lattice, whole.outermost, window);
  refuse_empty_layers(lattice, restricted(sites.layers, share), ranks);
  for (const std::vector<Site>* all : {&sites.body, &sites.layers.sites}) {
    for (const Site& site : *all) {
      if (share.has(site.place)) whole.extent.add(site.place);
    }
  }
  whole.extent.gather(ranks);
  return whole;
}

/// Points of a slab at their sites, in the order of these.
/// @param cells of the body's sites, if they are perturbed
Points points_of(const Lattice& lattice, const SlabSites& sites, CellPolygons cells) {
  Points points;
  points.dimension = lattice.dimension;
  points.spacing = lattice.spacing;
  points.angle = lattice.angle;
  // Set explicitly: a part without points has no mean volume to derive it from.
  points.cell_volume = std::pow(lattice.spacing, lattice.dimension) * lattice.cross_section;
  points.lattice.emplace();
  points.lattice->origin = frame_of(lattice).position({});
  for (const Layer& layer : lattice.layers) points.lattice->layers.push_back(layer.name);
  for (const std::vector<Site>* all : {&sites.body, &sites.layers.sites}) {
    for (const Site& site : *all) {
      points.reference.insert(points.reference.end(), site.place.begin(),
                              site.place.begin() + lattice.dimension);
      points.volume.push_back(points.cell_volume * site.share);
    }
  }
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    std::vector<Index>& set = points.sets[lattice.layers[k].name];
    for (const Index site : sites.layers.of_layer[k]) {
      set.push_back(Index(sites.body.size()) + site);
    }
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }
  if (lattice.cell_perturbation == 0.0) return points;
  points.polygons = std::move(cells);
  if (points.polygons.empty()) points.polygons.offset.push_back(0);  // there are none here
  for (std::size_t k = 0; k < sites.layers.sites.size(); ++k) {
    points.polygons.append(whole_cell(lattice));
  }
  return points;
}

/// Same as locality_order, by the extent of the whole body.
std::vector<Index> order_of(const LocalityCells& cells, const SlabSites& sites) {
  std::vector<std::pair<LocalityCells::Key, Index>> places;
  for (const std::vector<Site>* all : {&sites.body, &sites.layers.sites}) {
    for (const Site& site : *all) {
      places.emplace_back(cells.of(site.place.data()), Index(places.size()));
    }
  }
  std::sort(places.begin(), places.end());
  std::vector<Index> order;
  for (const auto& [cell, point] : places) order.push_back(point);
  return order;
}

/// Moves the sites of a slab to the centroids of their perturbed cells.
/// @param near sites of the body in a window around the slab
template <class Slab>
CellPolygons perturb_cells_of(const Lattice& lattice, const Slab& slab, std::vector<Site> near,
                              std::vector<Site>& body) {
  std::vector<bool> is_here;
  for (const Site& site : near) is_here.push_back(slab.has(site.place));
  const CellPolygons all = perturb_cells(lattice, near);
  CellPolygons cells;
  body.clear();
  for (std::size_t k = 0; k < near.size(); ++k) {
    if (!is_here[k]) continue;
    body.push_back(near[k]);
    cells.append(all.of(k));
  }
  return cells;
}

}  // namespace

Part make_slab(const Lattice& lattice, const Communicator& ranks) {
  check_lattice(lattice);
  refuse_without_slabs(lattice);
  refuse_idle_shapes(lattice);
  const WholeLattice whole = look_at_whole(lattice, ranks);
  // Numbers run slowest along the longest direction, so that slabs across it have consecutive
  // numbers.
  const LocalityCells locality(lattice.dimension, lattice.spacing, whole.extent.low,
                               whole.extent.high);
  const ShareOfRows slab(lattice, locality, whole.extent.low, whole.extent.high, ranks);
  const SlabSites near =
      sites_near(lattice, whole.outermost, slab.window(depth_of_window(lattice)));
  SlabSites sites{restricted(near.body, slab), restricted(near.layers, slab)};
  const std::vector<Index> order = order_of(locality, sites);  // before anything is perturbed
  CellPolygons cells;
  if (lattice.cell_perturbation > 0.0) {
    cells = perturb_cells_of(lattice, slab, near.body, sites.body);
  }

  Part part;
  part.points = renumbered(points_of(lattice, sites, std::move(cells)), order);
  std::vector<bool> is_body(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    is_body[k] = std::size_t(order[k]) < sites.body.size();
  }
  const GlobalIndex bodies_before = ranks.count_all(std::int64_t(sites.body.size())).before;
  perturb(lattice, is_body, bodies_before, part.points);

  part.owned = part.points.count();
  const Communicator::Counts counts = ranks.count_all(part.owned);
  part.whole = counts.all;
  for (Index i = 0; i < part.owned; ++i) part.number.push_back(counts.before + i);
  return part;
}

}  // namespace peristat
