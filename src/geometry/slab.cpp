#include "src/geometry/slab.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "src/geometry/numbering.hpp"
#include "src/geometry/perturbed_points.hpp"

namespace peristat {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void require_rows(const Lattice& lattice) {
  const auto refuse = [](const char* key, const std::string& value, const std::string& what) {
    throw InputError(key, value, "is not for several ranks yet: " + what);
  };
  if (lattice.arrangement == Arrangement::blue_noise) {
    refuse("arrangement", "blue_noise", "take arrangement = \"lattice\", or one rank");
  }
  if (lattice.angle != 0.0) {
    refuse("angle", number_text(lattice.angle), "take an angle of 0, or one rank");
  }
  if (lattice.volumes == CellVolumes::fractional) {
    refuse("volumes", "fractional", "take volumes = \"cells\", or one rank");
  }
  if (lattice.cell_perturbation > 0.0) {
    refuse("cell_perturbation", number_text(lattice.cell_perturbation),
           "take a cell_perturbation of 0, or one rank");
  }
  if (estimate_points(lattice) < 0x1p53) return;
  refuse("spacing", number_text(lattice.spacing), "there must be fewer than 2^53 points");
}

/// A rank's share of rows, as equal as whole rows can be.
LatticeRows share_of(const LatticeRows& all, const Communicator& ranks) {
  const std::int64_t count = all.last - all.first;
  const auto begin = [&](std::int64_t rank) { return all.first + count * rank / ranks.count(); };
  return {all.axis, begin(ranks.rank()), begin(ranks.rank() + 1)};
}

/// Least and largest of what all ranks have, along each axis.
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

Cell cell_of(const Coordinates& at) {
  return {std::int64_t(at[0]), std::int64_t(at[1]), std::int64_t(at[2])};
}

/// Cells that the body reaches; each rank looks at a share of them.
Extent extent_of_body(const Lattice& lattice, const Communicator& ranks) {
  int longest = 0;
  const auto rows = [&](int axis) { return rows_of_body(lattice, axis); };
  for (int axis = 1; axis < lattice.dimension; ++axis) {
    const LatticeRows one = rows(axis), best = rows(longest);
    if (one.last - one.first > best.last - best.first) longest = axis;
  }
  Extent extent;
  LatticeRows mine = share_of(rows(longest), ranks);
  for (const std::int64_t last = mine.last; mine.first < last; ++mine.first) {
    mine.last = mine.first + 1;  // a row at a time: only its extent is kept
    for (const Site& site : body_sites(lattice, mine)) {
      extent.add({double(site.cell[0]), double(site.cell[1]), double(site.cell[2])});
    }
  }
  extent.gather(ranks);
  if (extent.low[0] > extent.high[0]) {
    throw InputError(
        "shapes", "",
        "no lattice point lies in the body; spacing = " + number_text(lattice.spacing));
  }
  return extent;
}

/// Sites of a slab.
struct SlabSites {
  std::vector<Site> body;
  LayerSites layers;
};

SlabSites sites_of(const Lattice& lattice, const Communicator& ranks, const Extent& cells,
                   int axis) {
  const Cell low = cell_of(cells.low), high = cell_of(cells.high);
  LatticeRows all{axis, low[axis], high[axis] + 1};
  for (const Layer& layer : lattice.layers) {
    if (layer.side.axis != axis) continue;
    if (layer.side.sign < 0) all.first = std::min(all.first, low[axis] - layer.thickness);
    if (layer.side.sign > 0) all.last = std::max(all.last, high[axis] + 1 + layer.thickness);
  }
  const LatticeRows mine = share_of(all, ranks);
  SlabSites sites;
  sites.body = body_sites(lattice, mine);
  sites.layers = layer_sites(lattice, mine, sites.body, low, high);
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    const auto members = std::int64_t(sites.layers.of_layer[k].size());
    if (ranks.count_all(members).all == 0) refuse_empty_layer(lattice, k);
  }
  return sites;
}

Extent extent_of(const SlabSites& sites, const Communicator& ranks) {
  Extent extent;
  for (const Site& site : sites.body) extent.add(site.place);
  for (const Site& site : sites.layers.sites) extent.add(site.place);
  extent.gather(ranks);
  return extent;
}

Points points_of(const Lattice& lattice, const SlabSites& sites) {
  Points points;
  points.dimension = lattice.dimension;
  points.spacing = lattice.spacing;
  // Said, because a part has no mean volume to tell it by where it has no point.
  points.cell_volume = std::pow(lattice.spacing, lattice.dimension) * lattice.cross_section;
  points.lattice.emplace();
  points.lattice->origin = frame_of(lattice).position({});
  for (const Layer& layer : lattice.layers) points.lattice->layers.push_back(layer.name);
  for (const std::vector<Site>* all : {&sites.body, &sites.layers.sites}) {
    for (const Site& site : *all) {
      points.reference.insert(points.reference.end(), site.place.begin(),
                              site.place.begin() + lattice.dimension);
      points.volume.push_back(points.cell_volume);
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
  return points;
}

/// As locality_order, by the extent of the whole body.
std::vector<Index> order_of(const LocalityCells& cells, const Points& points) {
  std::vector<std::pair<LocalityCells::Key, Index>> places;
  for (Index i = 0; i < points.count(); ++i) {
    places.emplace_back(cells.of(&points.reference[std::size_t(i) * points.dimension]), i);
  }
  std::sort(places.begin(), places.end());
  std::vector<Index> order;
  for (const auto& [cell, point] : places) order.push_back(point);
  return order;
}

}  // namespace

Part make_slab(const Lattice& lattice, const Communicator& ranks) {
  check_lattice(lattice);
  require_rows(lattice);
  const Extent cells = extent_of_body(lattice, ranks);
  // Numbers run slowest along the longest direction: slabs across it have numbers that follow one
  // another. Which one that is layers may change, and where they stand only sites tell.
  int axis = 0;
  for (int c = 1; c < lattice.dimension; ++c) {
    if (cells.high[c] - cells.low[c] > cells.high[axis] - cells.low[axis]) axis = c;
  }
  SlabSites sites = sites_of(lattice, ranks, cells, axis);
  const Extent extent = extent_of(sites, ranks);
  const LocalityCells locality(lattice.dimension, lattice.spacing, extent.low, extent.high);
  if (locality.slowest() != axis) {
    axis = locality.slowest();
    sites = sites_of(lattice, ranks, cells, axis);
  }

  Part part;
  const Points unsorted = points_of(lattice, sites);
  const std::vector<Index> order = order_of(locality, unsorted);
  part.points = renumbered(unsorted, order);
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
