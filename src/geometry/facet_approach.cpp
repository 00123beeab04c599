#include "src/geometry/facet_approach.hpp"

#include <algorithm>
#include <limits>

namespace peristat {
namespace {

/// Weights of the place of a segment that is nearest to the origin.
std::array<double, 2> nearest_on_segment(const Coordinates& a, const Coordinates& b) {
  const Coordinates along = minus(b, a);
  const double squared = dot(along, along);
  const double share = squared > 0.0 ? std::clamp(-dot(a, along) / squared, 0.0, 1.0) : 0.0;
  return {1.0 - share, share};
}

/// The same of a triangle: the foot of the perpendicular if it is inside, otherwise the nearest
/// place of the sides.
CornerWeights nearest_on_triangle(const std::array<Coordinates, 3>& corner) {
  const Coordinates ab = minus(corner[1], corner[0]), ac = minus(corner[2], corner[0]);
  const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac);
  const double of_b = -dot(corner[0], ab), of_c = -dot(corner[0], ac);
  const double determinant = bb * cc - bc * bc;
  const double v = cc * of_b - bc * of_c, w = bb * of_c - bc * of_b;
  if (determinant > 0.0 && v > 0.0 && w > 0.0 && v + w < determinant) {
    return {1.0 - (v + w) / determinant, v / determinant, w / determinant};
  }
  CornerWeights nearest{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first < 3; ++first) {
    const std::size_t second = (first + 1) % 3;
    const auto [one, other] = nearest_on_segment(corner[first], corner[second]);
    const Coordinates place = plus(scaled(one, corner[first]), scaled(other, corner[second]));
    const double squared = dot(place, place);
    if (squared >= least) continue;
    least = squared;
    nearest = {};
    nearest[first] = one;
    nearest[second] = other;
  }
  return nearest;
}

CornerWeights nearest_place(const FacetArms& arms) {
  if (arms.corners == 1) return {1.0, 0.0, 0.0};
  if (arms.corners == 2) {
    const auto [one, other] = nearest_on_segment(arms.present(0), arms.present(1));
    return {one, other, 0.0};
  }
  return nearest_on_triangle({arms.present(0), arms.present(1), arms.present(2)});
}

/// Sum of the corners' vectors by their weights, with the other sign: from the place to the point.
Coordinates back(const CornerWeights& weight, const std::array<Coordinates, 3>& of) {
  Coordinates sum{};
  for (std::size_t k = 0; k < 3; ++k) sum = minus(sum, scaled(weight[k], of[k]));
  return sum;
}

}  // namespace

double facet_distance(const FacetArms& arms) {
  const CornerWeights weight = nearest_place(arms);
  return length(plus(back(weight, arms.reference), back(weight, arms.moved)));
}

FacetApproach approach(const FacetArms& arms, double touching) {
  FacetApproach found;
  found.weight = nearest_place(arms);
  const Coordinates rest = back(found.weight, arms.reference),
                    moved = back(found.weight, arms.moved);
  const Coordinates arm = plus(rest, moved);
  found.distance = length(arm);
  // By the change of the squared distance: the gap of a light contact would drown in round-off.
  const double change = dot(moved, plus(scaled(2.0, rest), moved));
  const double excess = touching * touching - dot(rest, rest);
  found.overlap = (excess - change) / (touching + found.distance);
  // The place, and with it the square of its arm, is another one in each state.
  found.round_off =
      std::numeric_limits<double>::epsilon() * (std::abs(change) / touching + touching);
  found.normal = found.distance > 0.0 ? scaled(1.0 / found.distance, arm) : Coordinates{1, 0, 0};
  return found;
}

namespace {

/// Corners between which the nearest place moves if the point moves. Where the point stands above a
/// corner or a side, as on lattices that have not slid, it is taken to be a hair beside it, on the
/// same side for all parts of a surface: each has one of two second derivatives there, and their
/// sum must be that of one side.
std::array<bool, 3> free_corners(const FacetArms& arms) {
  constexpr double hair = 1e-9;
  constexpr Coordinates aside{0.6, 0.48, 0.64};
  double longest = 0.0;
  for (int k = 0; k < arms.corners; ++k) longest = std::max(longest, length(arms.present(k)));
  FacetArms seen = arms;
  for (Coordinates& corner : seen.moved) corner = minus(corner, scaled(hair * longest, aside));
  const CornerWeights weight = nearest_place(seen);
  return {weight[0] > 0.0, weight[1] > 0.0, weight[2] > 0.0};
}

}  // namespace

DistanceDerivatives derivatives(const FacetArms& arms, const FacetApproach& at, int dimension) {
  DistanceDerivatives found;
  const auto d = std::size_t(dimension);
  const std::size_t places = 1 + std::size_t(arms.corners);
  // C of a place: 1 for the point, -beta_k for a corner.
  const auto share = [&](std::size_t place) { return place == 0 ? 1.0 : -at.weight[place - 1]; };
  for (std::size_t p = 0; p < places; ++p) {
    for (std::size_t c = 0; c < d; ++c) found.first[p * d + c] = share(p) * at.normal[c];
  }
  for (std::size_t p = 0; p < places; ++p) {
    for (std::size_t q = 0; q < places; ++q) {
      for (std::size_t c = 0; c < d; ++c) {
        found.second[p * d + c][q * d + c] += share(p) * share(q);
      }
    }
  }
  // Tangents from the first free corner to the others.
  const std::array<bool, 3> is_free = free_corners(arms);
  std::array<std::size_t, 3> active{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < std::size_t(arms.corners); ++k) {
    if (is_free[k]) active[count++] = k;
  }
  std::array<Coordinates, 2> tangent{};
  std::array<std::array<double, DistanceDerivatives::most>, 2> g{};
  const std::size_t tangents = count - 1;
  for (std::size_t m = 0; m < tangents; ++m) {
    tangent[m] = minus(arms.present(int(active[m + 1])), arms.present(int(active[0])));
    for (std::size_t p = 0; p < places; ++p) {
      for (std::size_t c = 0; c < d; ++c) g[m][p * d + c] = share(p) * tangent[m][c];
    }
    for (std::size_t c = 0; c < d; ++c) {
      g[m][(active[m + 1] + 1) * d + c] += at.distance * at.normal[c];
      g[m][(active[0] + 1) * d + c] -= at.distance * at.normal[c];
    }
  }
  std::array<std::array<double, 2>, 2> inverse{};
  if (tangents == 1) {
    inverse[0][0] = 1.0 / dot(tangent[0], tangent[0]);
  } else if (tangents == 2) {
    const double aa = dot(tangent[0], tangent[0]), ab = dot(tangent[0], tangent[1]),
                 bb = dot(tangent[1], tangent[1]);
    const double determinant = aa * bb - ab * ab;
    inverse = {{{bb / determinant, -ab / determinant}, {-ab / determinant, aa / determinant}}};
  }
  const std::size_t numbers = places * d;
  for (std::size_t r = 0; r < numbers; ++r) {
    for (std::size_t c = 0; c < numbers; ++c) {
      double entry = found.second[r][c] - found.first[r] * found.first[c];
      for (std::size_t m = 0; m < tangents; ++m) {
        for (std::size_t n = 0; n < tangents; ++n) entry -= g[m][r] * inverse[m][n] * g[n][c];
      }
      found.second[r][c] = at.distance > 0.0 ? entry / at.distance : 0.0;
    }
  }
  return found;
}

}  // namespace peristat
