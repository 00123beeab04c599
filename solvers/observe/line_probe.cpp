#include "solvers/observe/line_probe.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "solvers/observe/probe.hpp"
#include "src/geometry/points_on_line.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {
namespace {

/// Positions at which rows of numbers begin, sorted by the rows' first two numbers.
std::vector<std::size_t> in_order(const std::vector<double>& rows, std::size_t width) {
  std::vector<std::size_t> begin;
  for (std::size_t at = 0; at < rows.size(); at += width) begin.push_back(at);
  std::ranges::sort(begin, [&](std::size_t a, std::size_t b) {
    return std::pair(rows[a], rows[a + 1]) < std::pair(rows[b], rows[b + 1]);
  });
  return begin;
}

}  // namespace

std::vector<LineValues> line_values(const ProbeSpecification& probe, const RecordedPoints& points,
                                    const PointValues& fields) {
  const auto d = std::size_t(points.dimension());
  const std::size_t width = 2 + d + chosen_components(probe, points.dimension()).size();
  std::vector<double> mine;  // distance, number, position, values
  for (const auto& [distance, point] :
       points_on_line(points.points(), *probe.from, *probe.to, points.count())) {
    mine.insert(mine.end(), {distance, double(points.number(point))});
    const Coordinates at = points.points().position(point);
    mine.insert(mine.end(), at.begin(), at.begin() + std::ptrdiff_t(d));
    const std::vector<double> values = values_at(probe, points.dimension(), fields, point);
    mine.insert(mine.end(), values.begin(), values.end());
  }
  const std::vector<double> all = concatenated(points.ranks(), mine);
  std::vector<LineValues> line;
  for (const std::size_t first : in_order(all, width)) {
    const auto of_point = all.begin() + std::ptrdiff_t(first);
    const auto values = of_point + 2 + std::ptrdiff_t(d);
    LineValues at{
        std::int64_t(of_point[1]), of_point[0], {}, {values, of_point + std::ptrdiff_t(width)}};
    std::copy(of_point + 2, values, at.reference.begin());
    line.push_back(std::move(at));
  }
  return line;
}

}  // namespace peristat
