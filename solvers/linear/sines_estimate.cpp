#include "solvers/linear/sines_estimate.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace peristat {
namespace {

/// Largest ratio of length to width, by dimension. Iterations grow from some 22 by 2 for each width
/// that a plate is long, in 3D from 25 by 6. Rigid pieces take 32 and 36, and the cost of 13
/// products more for each build.
constexpr std::array<double, 3> most_slender{std::numeric_limits<double>::infinity(), 4.0, 2.0};

/// Smallest filled fraction of the box, and largest fraction of interrupted rows. A slot half
/// through a plate takes 35 to 41 iterations, a hole a fifth as wide as the plate 21.
constexpr double least_filled = 0.75, most_interrupted = 0.3;

using Numbers = std::array<Index, 3>;

/// Range of the free points of a component, or of all points.
struct Ranges {
  Numbers first{}, last{-1, -1, -1};
  Index count = 0;

  void add(const Numbers& at) {
    for (int a = 0; a < 3; ++a) {
      first[a] = count == 0 ? at[a] : std::min(first[a], at[a]);
      last[a] = count == 0 ? at[a] : std::max(last[a], at[a]);
    }
    ++count;
  }
  [[nodiscard]] bool holds(const Numbers& at) const {
    for (int a = 0; a < 3; ++a) {
      if (at[a] < first[a] || at[a] > last[a]) return false;
    }
    return true;
  }
  [[nodiscard]] double extent(int axis) const { return double(last[axis] - first[axis]) + 1.0; }
};

/// Fraction of the rows of lattice sites along an axis in which an empty site lies between points.
double interrupted_rows(const LatticeBox& box, int axis) {
  const auto other = [&](int k) { return (axis + k) % 3; };
  const std::size_t rows = std::size_t(box.extent[other(1)]) * std::size_t(box.extent[other(2)]);
  std::vector<Ranges> row(rows);
  for (const Index place : box.place) {
    const Numbers at = box.numbers(place);
    row[std::size_t(at[other(1)]) * std::size_t(box.extent[other(2)]) + std::size_t(at[other(2)])]
        .add(at);
  }
  const auto interrupted = std::count_if(row.begin(), row.end(), [&](const Ranges& points) {
    return points.count > 0 && double(points.count) < points.extent(axis);
  });
  return double(interrupted) / double(rows);
}

bool is_held_by_sides(const LatticeBox& box, const std::vector<char>& prescribed, int component) {
  const auto d = std::size_t(box.dimension);
  const auto is_prescribed = [&](std::size_t i) {
    return prescribed[i * d + std::size_t(component)] != 0;
  };
  Ranges free;
  for (std::size_t i = 0; i < box.place.size(); ++i) {
    if (!is_prescribed(i)) free.add(box.numbers(box.place[i]));
  }
  if (free.count == 0) return true;
  Index beyond = 0;
  std::array<std::array<double, 2>, 3> in_front{};
  for (std::size_t i = 0; i < box.place.size(); ++i) {
    if (!is_prescribed(i)) continue;
    const Numbers at = box.numbers(box.place[i]);
    if (free.holds(at)) return false;
    ++beyond;
    for (int a = 0; a < box.dimension; ++a) {
      in_front[a][0] += at[a] == free.first[a] - 1;
      in_front[a][1] += at[a] == free.last[a] + 1;
    }
  }
  // A side is held as a whole or not at all.
  bool is_held = false;
  for (int a = 0; a < box.dimension; ++a) {
    double side = 1.0;
    for (int b = 0; b < box.dimension; ++b) side *= b == a ? 1.0 : free.extent(b);
    for (const double held : in_front[a]) {
      if (held > 0.0 && held < 0.9 * side) return false;
      is_held = is_held || held > 0.0;
    }
  }
  return is_held && beyond > 0;
}

}  // namespace

bool suits_sines(const LatticeBox& box, const std::vector<char>& prescribed) {
  if (double(box.place.size()) < least_filled * double(box.count())) return false;
  Index shortest = box.extent[0], longest = box.extent[0];
  for (int a = 1; a < box.dimension; ++a) {
    shortest = std::min(shortest, box.extent[a]);
    longest = std::max(longest, box.extent[a]);
  }
  if (double(longest) > most_slender[std::size_t(box.dimension) - 1] * double(shortest)) {
    return false;
  }
  for (int a = 0; a < box.dimension; ++a) {
    if (box.dimension > 1 && interrupted_rows(box, a) > most_interrupted) return false;
    if (!is_held_by_sides(box, prescribed, a)) return false;
  }
  return true;
}

}  // namespace peristat
