#include "src/geometry/cell_piece.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Volume and first moments about the cell's place, along the lattice's axes, in spacings.
using Moments = std::array<double, 4>;

Moments added(const Moments& a, const Moments& b) { return peristat::plus<4>(a, b); }

double largest_difference(const Moments& a, const Moments& b) {
  double largest = 0.0;
  for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

using Integrand = std::function<Moments(double)>;

/// Gauss's rule of three places.
Moments gauss(const Integrand& f, double from, double to) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  const double shift = half * std::sqrt(0.6);
  Moments sum{};
  for (const auto& [at, weight] :
       {std::pair(middle - shift, 5.0 / 9.0), {middle, 8.0 / 9.0}, {middle + shift, 5.0 / 9.0}}) {
    const Moments value = f(at);
    for (int k = 0; k < 4; ++k) sum[k] += half * weight * value[k];
  }
  return sum;
}

Moments integral(const Integrand& f, double from, double to, const Moments& estimate,
                 double tolerance, int depth) {
  const double middle = 0.5 * (from + to);
  const Moments left = gauss(f, from, middle), right = gauss(f, middle, to);
  const Moments sum = added(left, right);
  if (depth == 0 || largest_difference(sum, estimate) <= tolerance) return sum;
  return added(integral(f, from, middle, left, tolerance, depth - 1),
               integral(f, middle, to, right, tolerance, depth - 1));
}

/// Integrates over the cell's width, panel by panel between the given places in spacings from its
/// middle.
/// @param panels least number of panels, so that a corner without a break is not missed
Moments integral(const Integrand& f, std::vector<double>& breaks, double tolerance, int panels) {
  constexpr int deepest = 24;
  for (int k = 0; k <= panels; ++k) breaks.push_back(double(k) / panels - 0.5);
  std::sort(breaks.begin(), breaks.end());
  Moments sum{};
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double from = std::max(breaks[k], -0.5), to = std::min(breaks[k + 1], 0.5);
    if (!(to > from)) continue;
    sum = added(sum, integral(f, from, to, gauss(f, from, to), tolerance, deepest));
  }
  return sum;
}

class Measured {
 public:
  Measured(const LatticeFrame& frame, const Cell& cell, const Region& region)
      : frame_(frame), region_(region), place_(frame.position(cell)) {
    for (int c = 0; c < 3; ++c) {
      Coordinates axis{};
      axis[c] = 1.0;
      direction_[c] = frame.turned(axis);
      step_[c] = scaled<3>(frame.spacing().along(c), direction_[c]);
    }
  }

  [[nodiscard]] static double tolerance(int dimension) { return dimension < 3 ? 1e-9 : 1e-6; }

  [[nodiscard]] Moments moments() const {
    if (frame_.dimension() == 1) return chord({});
    if (frame_.dimension() == 2) return section(0.0, 1e-2 * tolerance(2));
    std::vector<double> breaks;
    append_levels(2, {}, breaks);
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5}) append_crossings(2, {x, y, 0.0}, breaks);
    return integral([&](double z) { return section(z, 1e-2 * tolerance(3)); }, breaks,
                    1e-1 * tolerance(3), 4);
  }

  /// Moments of a region between planes along the lattice's axes, summed over the blocks that they
  /// cut; none for any other region.
  [[nodiscard]] std::optional<Moments> moments_of_blocks() const {
    std::array<std::vector<double>, 3> planes;
    if (frame_.is_turned() || !region_.append_planes(planes)) return std::nullopt;
    for (int c = 0; c < 3; ++c) {
      for (double& plane : planes[c]) plane = (plane - place_[c]) / frame_.spacing().along(c);
      std::erase_if(planes[c], [](double at) { return !(std::abs(at) < 0.5 - grid_tolerance); });
      planes[c].insert(planes[c].end(), {-0.5, 0.5});
      std::sort(planes[c].begin(), planes[c].end());
      if (c >= frame_.dimension()) planes[c] = {-0.5, 0.5};
    }
    Moments sum{};
    for (std::size_t x = 1; x < planes[0].size(); ++x) {
      for (std::size_t y = 1; y < planes[1].size(); ++y) {
        for (std::size_t z = 1; z < planes[2].size(); ++z) {
          Coordinates middle{};
          double volume = 1.0;
          const std::array<std::size_t, 3> block{x, y, z};
          for (int c = 0; c < 3; ++c) {
            const double from = planes[c][block[c] - 1], to = planes[c][block[c]];
            middle[c] = 0.5 * (from + to);
            volume *= to - from;
          }
          if (volume == 0.0 || !region_.contains(at(middle))) continue;
          sum = added(sum, {volume, volume * middle[0], volume * middle[1], volume * middle[2]});
        }
      }
    }
    return sum;
  }

  /// A place given in spacings from the cell's, along the lattice's axes [m].
  [[nodiscard]] Coordinates at(const Coordinates& spacings) const {
    Coordinates place = place_;
    for (int c = 0; c < frame_.dimension(); ++c)
      place = peristat::plus<3>(place, scaled<3>(spacings[c], step_[c]));
    return place;
  }

 private:
  /// Appends the heights along an axis at which the section across it changes, in spacings from the
  /// place.
  void append_levels(int axis, const Coordinates& from, std::vector<double>& levels) const {
    const std::size_t first = levels.size();
    region_.append_levels(direction_[axis], levels);
    const double own = dot<3>(at(from), direction_[axis]);
    for (std::size_t k = first; k < levels.size(); ++k)
      levels[k] = (levels[k] - own) / frame_.spacing().along(axis);
  }

  void append_crossings(int axis, const Coordinates& from, std::vector<double>& t) const {
    region_.append_crossings({at(from), step_[axis]}, t);
  }

  /// Moments of the section at a height z.
  [[nodiscard]] Moments section(double z, double tolerance) const {
    std::vector<double> breaks;
    append_levels(1, {0.0, 0.0, z}, breaks);
    for (const double x : {-0.5, 0.5}) append_crossings(1, {x, 0.0, z}, breaks);
    return integral(
        [&](double y) {
          return chord({0.0, y, z});
        },
        breaks, tolerance, frame_.dimension() == 2 ? 64 : 4);
  }

  /// Moments of the chord through a place along the first axis.
  [[nodiscard]] Moments chord(const Coordinates& through) const {
    std::vector<double> ends{-0.5, 0.5};
    const Line line{at(through), step_[0]};
    region_.append_crossings(line, ends);
    std::sort(ends.begin(), ends.end());
    Moments sum{};
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      const double from = std::max(ends[k], -0.5), to = std::min(ends[k + 1], 0.5);
      if (!(to > from)) continue;
      const double middle = 0.5 * (from + to), length = to - from;
      if (!region_.contains(line.at(middle))) continue;
      sum = added(sum, {length, length * middle, length * through[1], length * through[2]});
    }
    return sum;
  }

  const LatticeFrame& frame_;
  const Region& region_;
  Coordinates place_;
  std::array<Coordinates, 3> direction_{}, step_{};
};

}  // namespace

CellPiece piece_of(const LatticeFrame& frame, const Cell& cell, const Region& region) {
  const Measured measured(frame, cell, region);
  const double tolerance = Measured::tolerance(frame.dimension());
  const Coordinates place = frame.position(cell);
  const std::optional<Moments> of_blocks = measured.moments_of_blocks();
  const Moments moments = of_blocks ? *of_blocks : measured.moments();
  if (moments[0] <= tolerance) return {0.0, place};
  if (moments[0] >= 1.0 - tolerance) return {1.0, place};
  return {moments[0],
          measured.at({moments[1] / moments[0], moments[2] / moments[0], moments[3] / moments[0]})};
}

}  // namespace peristat
