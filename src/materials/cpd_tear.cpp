#include "src/materials/cpd_tear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include <boost/math/quadrature/gauss.hpp>

#include "src/core/coordinates.hpp"
#include "src/materials/lattice_directions.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/lattice_ball.hpp"
#include "src/neighbourhood/side_influence.hpp"

namespace peristat {
namespace {

/// A bond across the plane: relation between its stretch and the opening.
struct BondAcross {
  double length, rise;  ///< L, and its part along the normal, h > 0

  /// |xi + u n| = (1 + s) L
  [[nodiscard]] double opening_at(double stretch) const {
    const double excess = length * length * stretch * (2.0 + stretch);
    return excess / (rise + std::sqrt(rise * rise + excess));
  }
  [[nodiscard]] double stretch_at(double opening) const {
    const double excess = opening * (2.0 * rise + opening);
    return excess / (length * (length + std::sqrt(length * length + excess)));
  }
};

/// The bonds of one triangle or tetrahedron that cross the plane.
struct BondsAcross {
  int count = 0;
  std::array<BondAcross, 4> bond;

  void add(const BondAcross& one) { bond[count++] = one; }
  [[nodiscard]] double first_opening_at(double stretch) const {
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < count; ++k) least = std::min(least, bond[k].opening_at(stretch));
    return least;
  }
};

/// m/M - 1 of an area in the plane or a volume: linear in the opening.
struct LinearChange {
  double rate;
  [[nodiscard]] double at(double opening) const { return rate * opening; }
  [[nodiscard]] double slope(double) const { return rate; }
};

/// a/A - 1 of an area in space, a = |A + u d|.
struct AreaChange {
  double area, mixed, square;  ///< |A|, A.d, d.d

  [[nodiscard]] double growth(double u) const { return u * (2.0 * mixed + u * square); }
  [[nodiscard]] double current(double u) const {
    return std::sqrt(std::max(area * area + growth(u), 0.0));
  }
  [[nodiscard]] double at(double u) const { return growth(u) / (area * (area + current(u))); }
  [[nodiscard]] double slope(double u) const {
    const double a = current(u);
    return a > 0.0 ? (mixed + u * square) / (area * a) : 0.0;
  }
};

/// Change of the measure if the points whose bits are set in `moves` move along n.
AreaChange change_of(const std::array<Coordinates, 3>& at, unsigned moves, const Coordinates& n) {
  const auto step = [&](int k) { return double(moves >> k & 1U) - double(moves & 1U); };
  const Coordinates b = minus(at[1], at[0]), c = minus(at[2], at[0]);
  const Coordinates area = cross(b, c);
  const Coordinates d = plus(scaled(step(1), cross(n, c)), scaled(step(2), cross(b, n)));
  return {std::sqrt(dot(area, area)), dot(area, d), dot(d, d)};
}
LinearChange change_of(const std::array<Coordinates, 4>& at, unsigned moves, const Coordinates& n) {
  const auto step = [&](int k) { return double(moves >> k & 1U) - double(moves & 1U); };
  const Coordinates b = minus(at[1], at[0]), c = minus(at[2], at[0]), d = minus(at[3], at[0]);
  const double change =
      step(1) * dot(n, cross(c, d)) + step(2) * dot(n, cross(d, b)) + step(3) * dot(n, cross(b, c));
  return {change / dot(b, cross(c, d))};
}

/// Stretches between onset and critical stretch at which the slope of the integrity jumps.
std::vector<double> kinks_of(const CriticalStretch&) { return {}; }
std::vector<double> kinks_of(const TanhDegradation&) { return {}; }
std::vector<double> kinks_of(const ForceEnvelope& law) { return {law.peak()}; }
std::vector<double> kinks_of(const ForceTable& law) {
  std::vector<double> kinks;
  for (const ForceCurve::Knot& knot : law.curve->knots()) {
    if (knot.stretch > law.curve->onset()) kinks.push_back(knot.stretch * law.critical());
  }
  return kinks;
}
/// At small shares of the opening the stretch of a steep curve is nearly stationary: pieces shrink
/// towards the onset.
std::vector<double> kinks_of(const OpeningLaw& law) {
  if (law.curve == OpeningCurve::bilinear) return {law.stretch_at(kink_of_bilinear)};
  std::vector<double> kinks;
  for (const double share : {0.3, 0.09, 0.027, 0.008, 0.0024}) {
    kinks.push_back(law.stretch_at(share));
  }
  return kinks;
}

/// Share of the range from onset to critical that the quadrature's ten points resolve.
double share_per_step(const CriticalStretch&) { return 1.0; }
double share_per_step(const TanhDegradation& law) { return 1.0 / std::ceil(law.rate); }
double share_per_step(const ForceEnvelope& law) {
  return 1.0 / std::max(1.0, std::ceil(law.decay / 4.0));
}
double share_per_step(const ForceTable&) { return 1.0; }
double share_per_step(const OpeningLaw&) { return 1.0; }

/// int T d(e^2/2) over the opening, e the relative change of the measure.
template <class Law, class Change>
double work(const Law& law, const BondsAcross& across, const Change& change) {
  const auto until = [&](double opening) { return 0.5 * std::pow(change.at(opening), 2); };
  const double end = across.first_opening_at(law.critical());
  if (law.onset() >= law.critical()) return until(end);
  const double begin = across.first_opening_at(law.onset());
  std::vector<double> jumps = kinks_of(law), stop{begin, end};
  jumps.push_back(law.onset());
  double longest = end;
  for (int k = 0; k < across.count; ++k) {
    const BondAcross& bond = across.bond[k];
    for (const double stretch : jumps) {
      const double opening = bond.opening_at(stretch);
      if (opening > begin && opening < end) stop.push_back(opening);
    }
    const double range = bond.opening_at(law.critical()) - bond.opening_at(law.onset());
    longest = std::min(longest, range * share_per_step(law));
  }
  std::sort(stop.begin(), stop.end());
  const auto power = [&](double opening) {
    double integrity = 1.0;
    for (int k = 0; k < across.count; ++k) {
      integrity *= law.integrity(across.bond[k].stretch_at(opening));
    }
    return integrity * change.at(opening) * change.slope(opening);
  };
  double sum = until(begin);
  for (std::size_t k = 0; k + 1 < stop.size(); ++k) {
    double from = stop[k];
    while (from < stop[k + 1]) {
      // The integrity may vary like 1/s: no step more than doubles the opening.
      const double to = std::min(stop[k + 1], from + std::min(1.0000001 * longest, from));
      sum += boost::math::quadrature::gauss<double, 10>::integrate(power, from, to);
      from = to;
    }
  }
  return sum;
}

/// Sum over the places of a plane between the points of one simplex, times their widths.
template <class Law, std::size_t points>
double work_of_places(const Law& law, const std::array<Coordinates, points>& at,
                      const Coordinates& normal, bool is_plane) {
  std::array<double, points> height;
  for (std::size_t k = 0; k < points; ++k) height[k] = dot(at[k], normal);
  std::array<double, points> level = height;
  std::sort(level.begin(), level.end());
  double sum = 0.0;
  for (std::size_t place = 0; place + 1 < points; ++place) {
    const double width = level[place + 1] - level[place];
    if (width < 1e-12) continue;
    const double middle = 0.5 * (level[place] + level[place + 1]);
    unsigned above = 0;
    BondsAcross across;
    for (std::size_t a = 0; a < points; ++a) {
      if (height[a] < middle) continue;
      above |= 1U << a;
      for (std::size_t b = 0; b < points; ++b) {
        if (height[b] >= middle) continue;
        const Coordinates bond = minus(at[a], at[b]);
        across.add({std::sqrt(dot(bond, bond)), height[a] - height[b]});
      }
    }
    const auto change = change_of(at, above, normal);
    if constexpr (points == 3) {
      if (is_plane) {
        sum += width * work(law, across, LinearChange{change.mixed / (change.area * change.area)});
        continue;
      }
    }
    sum += width * work(law, across, change);
  }
  return sum;
}

}  // namespace

CpdTear::CpdTear(const Kernel& kernel, double spacing, const CpdConstants& constants)
    : dimension_(kernel.dimension), c1_(constants.c1) {
  const BulkNeighbourhood bulk =
      bulk_neighbourhood(dimension_, spacing, kernel.horizon, kernel.cross_section);
  const LatticeBall ball(dimension_, spacing, kernel.horizon);
  constexpr Coordinates here{};
  const auto in_spacings = [&](const Coordinates& arm) { return scaled(1.0 / spacing, arm); };
  for (std::size_t k = ball.arms().size() / 2; k < ball.arms().size(); ++k) {
    const Coordinates arm = in_spacings(ball.arms()[k]);
    const double length = std::sqrt(dot(arm, arm));
    bonds_.push_back({arm, length, kernel.influence_at(length * spacing)});
  }
  // w = V V1, 2 V V2 and 6 V V3, see effective_volumes.
  bond_energy_ = bulk.volume / double(bulk.neighbours) * c1_ * spacing * spacing;
  if (constants.c2 != 0.0) {
    const double weight = 2.0 * bulk.volume * bulk.volume / double(bulk.pairs);
    ball.for_each_triangle([&](const Coordinates& b, const Coordinates& c, double area) {
      const double influence = influence_of_sides(kernel, std::array{here, b, c});
      if (influence == 0.0) return;
      triangles_.push_back({{here, in_spacings(b), in_spacings(c)},
                            weight * area * constants.c2 * spacing * influence});
    });
  }
  if (constants.c3 != 0.0) {
    const double weight = 6.0 * std::pow(bulk.volume, 3) / double(bulk.triplets);
    ball.for_each_tetrahedron(
        [&](const Coordinates& b, const Coordinates& c, const Coordinates& d, double volume) {
          const double influence = influence_of_sides(kernel, std::array{here, b, c, d});
          if (influence == 0.0) return;
          tetrahedra_.push_back({{here, in_spacings(b), in_spacings(c), in_spacings(d)},
                                 weight * volume * constants.c3 * spacing * influence});
        });
  }
}

double CpdTear::of_bonds(const AnyLaw& law, const Coordinates& normal) const {
  double sum = 0.0;
  for (const Bond& bond : bonds_) {
    sum += bond.influence * bond.length * std::abs(dot(bond.arm, normal));
  }
  return bond_energy_ * sum * law.work(Harmonic{1.0}, law.critical());
}

double CpdTear::of_simplices(const AnyLaw& of, const Coordinates& normal) const {
  return std::visit(
      [&](const auto& law) {
        double sum = 0.0;
        for (const auto& [at, energy] : triangles_) {
          sum += energy * work_of_places(law, at, normal, dimension_ == 2);
        }
        for (const auto& [at, energy] : tetrahedra_) {
          sum += energy * work_of_places(law, at, normal, false);
        }
        return sum;
      },
      of.law);
}

double CpdTear::energy(const AnyLaw& law, const Coordinates& normal) const {
  const Coordinates n = unit(normal);
  return of_bonds(law, n) + of_simplices(law, n);
}

double CpdTear::quadrature_points(const AnyLaw& of) const {
  const double steps = std::visit(
      [](const auto& law) {
        constexpr double bonds = 4.0;  // across a place, each with its kinks
        const double further = std::max(1.0, double(kinks_of(law).size())) - 1.0;
        return 1.0 / share_per_step(law) + bonds * further;
      },
      of.law);
  const double places = 2.0 * double(triangles_.size()) + 3.0 * double(tetrahedra_.size());
  const double in_between = of.onset() < of.critical() ? 10.0 * (4.0 + steps) : 1.0;
  return places * in_between * (dimension_ == 2 ? 12.0 : 16.0);
}

double CpdTear::mean_crossing() const {
  double sum = 0.0;
  for (const Bond& bond : bonds_) sum += bond.influence * bond.length * bond.length;
  return bond_energy_ / c1_ * mean_of_magnitude(dimension_) * sum;
}

double CpdTear::mean_energy(const AnyLaw& law) const {
  double sum = c1_ * mean_crossing() * law.work(Harmonic{1.0}, law.critical());
  if (is_of_bonds_alone()) return sum;
  for (const auto& [normal, weight] : sector_directions(dimension_)) {
    sum += weight * of_simplices(law, normal);
  }
  return sum;
}

DirectionalSpread CpdTear::spread(const AnyLaw& law) const {
  std::vector<Coordinates> normals = sector_corners(dimension_);
  for (const auto& [normal, weight] : sector_directions(dimension_)) normals.push_back(normal);
  DirectionalSpread result{mean_energy(law), std::numeric_limits<double>::infinity(), 0.0};
  for (const Coordinates& normal : normals) {
    const double value = energy(law, normal);
    result.least = std::min(result.least, value);
    result.most = std::max(result.most, value);
  }
  return result;
}

}  // namespace peristat
