#include "src/geometry/polyhedron_in_body.hpp"

#include <algorithm>
#include <cmath>

#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

using Triangle = std::array<Coordinates, 3>;

/// Mean over a triangle of int s^2 ds and p int s^3 ds.
using Means = std::array<double, 4>;

/// Radon's rule, exact for polynomials of degree 5: the centroid, and three places each on two
/// circles.
struct Place {
  std::array<double, 3> barycentric;
  double weight;
};

std::array<Place, 7> radon() {
  const double root = std::sqrt(15.0);
  std::array<Place, 7> places{};
  places[0] = {{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}, 0.225};
  for (std::size_t ring = 0; ring < 2; ++ring) {
    const double sign = ring == 0 ? 1.0 : -1.0;
    const double near = (6.0 - sign * root) / 21.0, weight = (155.0 - sign * root) / 1200.0;
    for (std::size_t k = 0; k < 3; ++k) {
      Place& place = places[1 + 3 * ring + k];
      place.barycentric = {near, near, near};
      place.barycentric[k] = 1.0 - 2.0 * near;
      place.weight = weight;
    }
  }
  return places;
}

class Rays {
 public:
  Rays(const Coordinates& place, const Solid& body, double least_change, int most_depth)
      : place_(place), body_(body), least_change_(least_change), most_depth_(most_depth) {}

  /// @param factor 3 V of the pyramid on the triangle
  [[nodiscard]] Means integral(const Triangle& on, double factor) {
    return quartered(on, factor, estimate(on, factor), 0);
  }

 private:
  static constexpr int least_depth = 1;

  [[nodiscard]] Means estimate(const Triangle& on, double factor) {
    static const std::array<Place, 7> rule = radon();
    Means sum{};
    for (const Place& at : rule) {
      Coordinates arm{};
      for (std::size_t k = 0; k < 3; ++k) arm = plus<3>(arm, scaled<3>(at.barycentric[k], on[k]));
      const Means ray = along(arm);
      for (std::size_t k = 0; k < 4; ++k) sum[k] += factor * at.weight * ray[k];
    }
    return sum;
  }

  [[nodiscard]] Means along(const Coordinates& arm) {
    ends_.assign({0.0, 1.0});
    const Line ray{place_, arm};
    body_.append_crossings(ray, ends_);
    std::sort(ends_.begin(), ends_.end());
    double second = 0.0, third = 0.0;
    for (std::size_t k = 0; k + 1 < ends_.size(); ++k) {
      const double from = std::max(ends_[k], 0.0), to = std::min(ends_[k + 1], 1.0);
      if (!(to > from) || !body_.contains(ray.at(0.5 * (from + to)))) continue;
      second += (to * to * to - from * from * from) / 3.0;
      third += (to * to * to * to - from * from * from * from) / 4.0;
    }
    return {second, third * arm[0], third * arm[1], third * arm[2]};
  }

  [[nodiscard]] Means quartered(const Triangle& on, double factor, const Means& whole, int depth) {
    const auto middle = [&](std::size_t a, std::size_t b) {
      return scaled<3>(0.5, plus<3>(on[a], on[b]));
    };
    const Coordinates ab = middle(0, 1), bc = middle(1, 2), ca = middle(2, 0);
    const std::array<Triangle, 4> parts{
        {{on[0], ab, ca}, {ab, on[1], bc}, {ca, bc, on[2]}, {ab, bc, ca}}};
    std::array<Means, 4> estimates{};
    Means sum{};
    for (std::size_t k = 0; k < 4; ++k) {
      estimates[k] = estimate(parts[k], 0.25 * factor);
      for (std::size_t m = 0; m < 4; ++m) sum[m] += estimates[k][m];
    }
    const bool agrees = depth >= least_depth && std::abs(sum[0] - whole[0]) <= least_change_;
    if (agrees || depth == most_depth_) return sum;
    sum = {};
    for (std::size_t k = 0; k < 4; ++k) {
      const Means part = quartered(parts[k], 0.25 * factor, estimates[k], depth + 1);
      for (std::size_t m = 0; m < 4; ++m) sum[m] += part[m];
    }
    return sum;
  }

  const Coordinates& place_;
  const Solid& body_;
  double least_change_;  // of a triangle's part [m3]
  int most_depth_;
  std::vector<double> ends_;
};

}  // namespace

PolyhedronPart polyhedron_in_body(const Coordinates& place, const std::vector<Coordinates>& corners,
                                  const std::vector<std::vector<std::size_t>>& faces, double volume,
                                  const Solid& body, Accuracy accuracy) {
  const bool is_rough = accuracy == Accuracy::rough;
  Rays rays(place, body, (is_rough ? 1e-3 : 1e-5) * volume, is_rough ? 3 : 5);
  PolyhedronPart part;
  for (const std::vector<std::size_t>& face : faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      const Triangle triangle{corners[face[0]], corners[face[k]], corners[face[k + 1]]};
      const double six_pyramids =
          std::abs(dot<3>(triangle[0], cross<double>(triangle[1], triangle[2])));
      const Means found = rays.integral(triangle, 0.5 * six_pyramids);
      part.volume += found[0];
      for (std::size_t c = 0; c < 3; ++c) part.moment[c] += found[c + 1];
    }
  }
  return part;
}

}  // namespace peristat
