#include "src/materials/quadrature.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/gather_images.hpp"
#include "src/geometry/point_sizes.hpp"
#include "src/geometry/squared_distance.hpp"
#include "src/neighbourhood/lattice_kernel.hpp"
#include "src/neighbourhood/polygon_kernel.hpp"
#include "src/neighbourhood/search.hpp"

namespace peristat {
namespace {

/// Vector from a point to another along the lattice's axes [m].
Coordinates arm_along_lattice(const Points& points, Index i, Index j) {
  const Coordinates from = points.position(i), to = points.position(j);
  Coordinates arm{};
  for (std::size_t c = 0; c < 3; ++c) arm[c] = to[c] - from[c];
  if (points.angle != 0.0) {
    const double angle = points.angle * std::numbers::pi / 180.0;
    const double cosine = std::cos(angle), sine = std::sin(angle);
    arm = {cosine * arm[0] + sine * arm[1], cosine * arm[1] - sine * arm[0], arm[2]};
  }
  return arm;
}

/// Vector between two points in steps along the lattice's axes, not rounded.
Coordinates spacings_between(const Points& points, Index i, Index j) {
  Coordinates arm = arm_along_lattice(points, i, j);
  for (int c = 0; c < 3; ++c) arm[std::size_t(c)] /= points.spacing.along(c);
  return arm;
}

LatticeStep step_between(const Points& points, Index i, Index j) {
  const Coordinates steps = spacings_between(points, i, j);
  LatticeStep rounded{};
  for (std::size_t c = 0; c < 3; ++c) rounded[c] = int(std::lround(steps[c]));
  return rounded;
}

/// Refuses points that are neither the middles of a lattice's whole cells nor those of polygons.
void require_whole_cells(const Points& points) {
  constexpr double round_off = 1e-6;  // of a spacing, far beyond what places lose
  const auto refuse = [](const std::string& what) {
    throw InputError("volume_correction", "exact",
                     "needs the whole cells of a regular lattice, or polygons, whose parts within "
                     "the horizon it computes: " +
                         what);
  };
  if (!points.lattice && points.cell_volume > 0.0) {
    refuse(points.dimension == 3 ? "Voronoi cells are polyhedra in 3D; give \"linear\" or \"none\""
                                 : "the body's boundary cuts Voronoi cells to shapes that are not "
                                   "convex polygons; give \"linear\" or \"none\"");
  }
  if (!points.lattice) refuse("points of a file have no cells; give \"linear\" or \"none\"");
  const double whole = points.cross_section() * std::pow(points.spacing, points.dimension);
  for (Index i = 0; i < points.count(); ++i) {
    const Coordinates steps = spacings_between(points, 0, i);
    for (const double along : steps) {
      if (std::abs(along - std::round(along)) <= round_off) continue;
      refuse("the point at " + place_text(points.position(i), points.dimension) +
             " m is not at a lattice site; give a perturbation of 0, or \"linear\"");
    }
    if (std::abs(points.volume[std::size_t(i)] / whole - 1.0) <= round_off) continue;
    refuse("the point at " + place_text(points.position(i), points.dimension) +
           " m has only a part of its cell; give volumes = \"cells\", or \"linear\"");
  }
}

/// Squares of a bond's direction cosines, n_a^2.
std::array<double, 3> squared_direction(const Points& points, const Bonds& bonds, Index i,
                                        Offset bond) {
  std::array<double, 3> result{};
  const Coordinates from = points.position(i), to = points.position(bonds.partner(i, bond));
  for (int a = 0; a < points.dimension; ++a) {
    const double n = (to[a] - from[a]) * bonds.inverse_length(bond);
    result[a] = n * n;
  }
  return result;
}

template <class Visit>
void for_each_bond(const Bonds& bonds, const Visit& visit) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) visit(i, bond);
  }
}

/// The bonds of given neighbours, in their order.
Bonds given_bonds(const Points& points) {
  Bonds bonds;
  bonds.offset.assign(points.volume.size() + 1, 0);
  std::vector<Index> upper;
  for (const NeighbourShares& pair : points.neighbours) {
    ++bonds.offset[std::size_t(pair.i) + 1];
    upper.push_back(pair.j);
    const double squared = squared_distance(points.reference, points.dimension, pair.i, pair.j);
    bonds.kind.push_back({1.0 / std::sqrt(squared), 0.0});
  }
  for (std::size_t i = 1; i < bonds.offset.size(); ++i) bonds.offset[i] += bonds.offset[i - 1];
  bonds.partner = Partners(bonds.offset, upper);
  return bonds;
}

Bonds find_bonds(const Points& points, const Kernel& kernel, int threads) {
  if (!points.neighbours.empty()) return given_bonds(points);
  if (points.horizons.empty()) return search_bonds(points, search_radius(points, kernel), threads);
  return search_bonds(points, search_radii(points, kernel), threads);
}

/// Factors that the kernel gives the bonds of a body.
class BondShares {
 public:
  BondShares(const Points& points, const Kernel& kernel) : points_(points), kernel_(kernel) {
    if (!kernel.has_exact_shares()) return;
    if (!points.polygons.empty()) {
      polygons_.emplace(points, kernel);
      return;
    }
    require_whole_cells(points);
    lattice_.emplace(kernel, points.spacing);
  }

  /// Mean share of each other's volume that the points of a bond count, times the influence.
  [[nodiscard]] double operator()(Index i, Index j, double length) const {
    if (lattice_) return lattice_->factor(step_between(points_, i, j));
    if (polygons_) return polygons_->factor(i, j, length);
    if (!points_.horizons.empty()) return 0.5 * (directed(i, j, length) + directed(j, i, length));
    if (kernel_.shape == HorizonShape::ball) {
      return mean_share(i, j, length) * kernel_.influence_at(length);
    }
    const double norm = norm_between(points_, i, j, kernel_.shape);
    return kernel_.partial_volume(norm, points_.spacing) * kernel_.influence_at(norm);
  }

  /// Share of the volume of j that i counts within its own horizon, times influence and kappa_i:
  /// that of the kernel's horizon at lengths scaled by delta / delta_i.
  [[nodiscard]] double directed(Index i, Index j, double length) const {
    const double scale = kernel_.horizon / points_.horizons[std::size_t(i)];
    const double size = size_of_point(points_, j, kernel_.cross_section);
    const double share = kernel_.partial_volume(scale * length, scale * size);
    if (share == 0.0) return 0.0;
    return std::pow(scale, kernel_.dimension + 1) * share * kernel_.influence_at(scale * length);
  }

 private:
  [[nodiscard]] double mean_share(Index i, Index j, double length) const {
    if (!points_.neighbours.empty()) {
      const auto given =
          std::lower_bound(points_.neighbours.begin(), points_.neighbours.end(), std::pair(i, j),
                           [](const NeighbourShares& pair, const auto& ends) {
                             return std::pair(pair.i, pair.j) < ends;
                           });
      return 0.5 * (given->of_j + given->of_i);
    }
    if (kernel_.volume_correction == VolumeCorrection::none) return 1.0;
    const double size_i = size_of_point(points_, i, kernel_.cross_section);
    const double size_j = size_of_point(points_, j, kernel_.cross_section);
    return 0.5 * (kernel_.partial_volume(length, size_i) + kernel_.partial_volume(length, size_j));
  }

  const Points& points_;
  const Kernel& kernel_;
  std::optional<LatticeKernel> lattice_;
  std::optional<PolygonKernel> polygons_;
};

void weigh_volumes(Bonds& bonds, const Points& points, const Kernel& kernel) {
  const BondShares share(points, kernel);
  bonds.set_weights([&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    return share(i, j, bonds.length(bond)) * points.volume[i] * points.volume[j];
  });
}

/// Takes half of a bond's weight away per end that is an image: across a plane it has a twin.
void share_with_images(Bonds& bonds, const Points& points) {
  if (points.own() == points.count()) return;
  bonds.set_weights([&](Index i, Offset bond) {
    const int own = int(!points.is_image(i)) + int(!points.is_image(bonds.partner(i, bond)));
    return 0.5 * own * bonds.weight(bond);
  });
}

void apply_volume_method(Bonds& bonds, const Points& points, const Kernel& kernel) {
  std::vector<double> neighbourhood(points.volume.size(), 0.0);
  for_each_bond(bonds, [&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    neighbourhood[i] += bonds.weight(bond) / points.volume[i];
    neighbourhood[j] += bonds.weight(bond) / points.volume[j];
  });
  gather_images(points, neighbourhood);
  const std::vector<double> whole = whole_volumes(points, kernel);
  const double bulk = whole.empty() ? 1.0 : whole.front();
  for (std::size_t i = 0; i < whole.size(); ++i) neighbourhood[i] *= bulk / whole[i];
  bonds.set_weights([&](Index i, Offset bond) {
    const double both = neighbourhood[i] + neighbourhood[bonds.partner(i, bond)];
    return bonds.weight(bond) * 2.0 * bulk / both;
  });
}

/// Ratio of the discrete to the classical energy density of every point, per axis, under a confined
/// unit strain along the axis: a bond stores w c L s^2 / 2 with s = n_a^2, half at each of its
/// points.
std::vector<std::array<double, 3>> confined_energy_ratio(const Points& points, const Bonds& bonds,
                                                         const BondSetting& setting) {
  const double classical = confined_energy_per_modulus(setting);
  const double factor = 0.25 * micromodulus(1.0, setting) / classical;
  std::vector<std::array<double, 3>> ratio(points.volume.size(), {0.0, 0.0, 0.0});
  for_each_bond(bonds, [&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    const std::array<double, 3> squared = squared_direction(points, bonds, i, bond);
    for (int a = 0; a < points.dimension; ++a) {
      const double energy =
          factor * bonds.weight(bond) * bonds.length(bond) * squared[a] * squared[a];
      ratio[i][a] += energy / points.volume[i];
      ratio[j][a] += energy / points.volume[j];
    }
  });
  gather_images(points, ratio, [](auto& sum, const auto& more) {
    for (std::size_t a = 0; a < sum.size(); ++a) sum[a] += more[a];
  });
  return ratio;
}

void apply_energy_method(Bonds& bonds, const Points& points, const BondSetting& setting) {
  std::vector<std::array<double, 3>> factor = confined_energy_ratio(points, bonds, setting);
  for (auto& of_point : factor) {
    // An axis along which no bond of the point stretches has no energy to correct.
    for (double& axis : of_point) axis = axis > 0.0 ? 1.0 / axis : 1.0;
  }
  bonds.set_weights([&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    const std::array<double, 3> squared = squared_direction(points, bonds, i, bond);
    double sum = 0.0;
    for (int a = 0; a < points.dimension; ++a) {
      const double mean = 0.5 * (factor[i][a] + factor[j][a]);
      sum += squared[a] / (mean * mean);
    }
    return bonds.weight(bond) / std::sqrt(sum);
  });
}

}  // namespace

std::vector<double> search_radii(const Points& points, const Kernel& kernel) {
  const std::vector<double>& horizons = points.horizons;
  if (kernel.volume_correction == VolumeCorrection::none) return horizons;
  // Half the size of the largest point with the same or a smaller horizon is half that of either
  // end at least.
  std::vector<Index> ascending(horizons.size());
  std::iota(ascending.begin(), ascending.end(), Index(0));
  std::sort(ascending.begin(), ascending.end(),
            [&](Index a, Index b) { return horizons[std::size_t(a)] < horizons[std::size_t(b)]; });
  std::vector<double> radii(horizons.size());
  double largest = 0.0;
  for (std::size_t first = 0, last = 0; first < ascending.size(); first = last) {
    const double horizon = horizons[std::size_t(ascending[first])];
    for (; last < ascending.size() && horizons[std::size_t(ascending[last])] == horizon; ++last) {
      largest = std::max(largest, size_of_point(points, ascending[last], kernel.cross_section));
    }
    for (std::size_t k = first; k < last; ++k) {
      radii[std::size_t(ascending[k])] = horizon + 0.5 * largest;
    }
  }
  return radii;
}

double search_radius(const Points& points, const Kernel& kernel) {
  if (kernel.has_exact_shares()) {
    return points.polygons.empty() ? kernel.search_radius(points.spacing)
                                   : PolygonKernel(points, kernel).search_radius();
  }
  double largest = 0.0;
  for (Index i = 0; i < points.count(); ++i) {
    largest = std::max(largest, size_of_point(points, i, kernel.cross_section));
  }
  return kernel.search_radius(largest);
}

double norm_between(const Points& points, Index i, Index j, HorizonShape shape) {
  return norm_of(shape, arm_along_lattice(points, i, j));
}

void drop_weightless(Bonds& bonds) {
  bonds.remove_if([&](Index, Offset bond) { return bonds.weight(bond) == 0.0; });
}

Bonds make_bonds(const Points& points, SurfaceCorrection surface, const BondSetting& setting,
                 int threads) {
  Bonds bonds = find_bonds(points, setting, threads);
  weigh_volumes(bonds, points, setting);
  if (setting.may_be_weightless() || !points.horizons.empty()) drop_weightless(bonds);
  share_with_images(bonds, points);
  if (surface == SurfaceCorrection::volume) {
    apply_volume_method(bonds, points, setting);
  } else if (surface == SurfaceCorrection::energy) {
    apply_energy_method(bonds, points, setting);
  }
  return bonds;
}

std::vector<double> seen_volumes(const Points& points, const Bonds& bonds, const Kernel& kernel,
                                 std::span<const char> broken) {
  const BondShares share_of(points, kernel);
  std::vector<double> seen(points.volume.size(), 0.0);
  for_each_bond(bonds, [&](Index i, Offset bond) {
    if (!broken.empty() && broken[std::size_t(bond)]) return;
    const Index j = bonds.partner(i, bond);
    // A bond across a plane of symmetry has a twin, as in share_with_images.
    const int own = int(!points.is_image(i)) + int(!points.is_image(j));
    if (own == 0) return;
    const double share = 0.5 * own * share_of(i, j, bonds.length(bond));
    seen[std::size_t(i)] += share * points.volume[std::size_t(j)];
    seen[std::size_t(j)] += share * points.volume[std::size_t(i)];
  });
  gather_images(points, seen);
  return seen;
}

std::vector<double> whole_volumes(const Points& points, const Kernel& kernel) {
  // A cloud of points uses a lattice of its mean spacing.
  if (points.horizons.empty()) {
    return std::vector(points.volume.size(), kernel.lattice_moment(0, points.spacing));
  }
  std::vector<double> whole;
  double spacing = 0.0, moment = 0.0;
  for (Index i = 0; i < points.count(); ++i) {
    const double scale = kernel.horizon / points.horizons[std::size_t(i)];
    const double scaled = scale * size_of_point(points, i, kernel.cross_section);
    if (!(std::abs(scaled - spacing) <= horizon_tolerance * spacing)) {  // mostly one ratio for all
      spacing = scaled;
      moment = kernel.lattice_moment(0, spacing);
    }
    whole.push_back(scale * moment);
  }
  return whole;
}

std::vector<double> fineness_of_bonds(const Points& points, const Bonds& bonds,
                                      const Kernel& kernel) {
  if (points.horizons.empty()) return {};
  const BondShares share(points, kernel);
  std::vector<double> fineness(std::size_t(bonds.count()), 1.0);
  for_each_bond(bonds, [&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    const double of_i = share.directed(i, j, bonds.length(bond));
    const double of_j = share.directed(j, i, bonds.length(bond));
    const double both = of_i * kernel.horizon / points.horizons[std::size_t(i)] +
                        of_j * kernel.horizon / points.horizons[std::size_t(j)];
    fineness[std::size_t(bond)] = both / (of_i + of_j);
  });
  return fineness;
}

double confined_energy_error(const Points& points, const Bonds& bonds, const BondSetting& setting) {
  double error = 0.0;
  for (const auto& ratio : confined_energy_ratio(points, bonds, setting)) {
    for (int a = 0; a < points.dimension; ++a) error = std::max(error, std::abs(ratio[a] - 1.0));
  }
  return error;
}

}  // namespace peristat
