#include "solvers/ranks/point_records.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>

namespace peristat {
namespace {

/// Number of corners of each point's cell; 0 without cells. Only cells of lattices can be sent.
int corners_of(const Points& points) {
  if (points.polygons.empty()) return 0;
  const int corners = points.dimension == 1 ? 2 : 4;
  if (points.polygons.corners.size() != std::size_t(corners) * points.volume.size()) {
    throw std::logic_error("cells of other numbers of corners stay here");
  }
  return corners;
}

}  // namespace

PointRecords::PointRecords(const Part& like) : dimension_(like.points.dimension) {
  const Points& points = like.points;
  if (!points.images.source.empty() || !points.neighbours.empty() || !points.ghosts.empty()) {
    throw std::logic_error("images, given neighbours and sites of quadratures stay here");
  }
  corners_ = corners_of(points);
  const std::size_t numbers = (points.sets.size() + sets_per_number - 1) / sets_per_number;
  records_.doubles = dimension_ + 1 + 2 * corners_ + int(points.columns.size());
  records_.integers = 2 + int(numbers);
  of_sets_.assign(numbers, std::vector<long long>(points.volume.size(), 0));
  for (const auto& [name, members] : points.sets) {
    const std::size_t set = names_.size();
    for (const Index point : members) {
      of_sets_[set / sets_per_number][std::size_t(point)] |= 1LL << set % sets_per_number;
    }
    names_.push_back(name);
  }
}

void PointRecords::add(const Part& part, Index point, int owner) {
  const auto first = part.points.reference.begin() + std::ptrdiff_t(point) * dimension_;
  records_.values.insert(records_.values.end(), first, first + dimension_);
  records_.values.push_back(part.points.volume[std::size_t(point)]);
  if (corners_ > 0) {
    for (const auto& corner : part.points.polygons.of(std::size_t(point))) {
      records_.values.insert(records_.values.end(), corner.begin(), corner.end());
    }
  }
  for (const auto& [name, values] : part.points.columns) {
    records_.values.push_back(values[std::size_t(point)]);
  }
  records_.numbers.push_back(part.number[std::size_t(point)]);
  records_.numbers.push_back(owner);
  for (const auto& sets : of_sets_) records_.numbers.push_back(sets[std::size_t(point)]);
}

void PointRecords::append_to(Part& part, const Records& received, bool as_ghosts) const {
  const auto doubles = std::size_t(records_.doubles), integers = std::size_t(records_.integers);
  std::vector<std::size_t> order(received.numbers.size() / integers);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return received.numbers[a * integers] < received.numbers[b * integers];
  });
  Points& points = part.points;
  for (const std::size_t record : order) {
    const double* const value = &received.values[record * doubles];
    const long long* const number = &received.numbers[record * integers];
    for (std::size_t set = 0; set < names_.size(); ++set) {
      const long long sets = number[2 + set / sets_per_number];
      if (sets >> set % sets_per_number & 1) points.sets[names_[set]].push_back(points.count());
    }
    points.reference.insert(points.reference.end(), value, value + dimension_);
    points.volume.push_back(value[dimension_]);
    if (corners_ > 0) {
      std::vector<std::array<double, 2>> cell(std::size_t(corners_), {0.0, 0.0});
      const double* at = value + dimension_ + 1;
      for (auto& corner : cell) corner = {at[0], at[1]}, at += 2;
      points.polygons.append(cell);
    }
    const double* of_column = value + dimension_ + 1 + 2 * corners_;
    for (auto& [name, values] : points.columns) values.push_back(*of_column++);
    part.number.push_back(number[0]);
    if (as_ghosts) part.owner.push_back(int(number[1]));
  }
  if (!as_ghosts) part.owned = points.count();
}

Part empty_part(const Part& like) {
  Part part;
  part.points.dimension = like.points.dimension;
  part.points.spacing = like.points.spacing;
  part.points.angle = like.points.angle;
  part.points.cell_volume = like.points.cell_volume;
  part.points.lattice = like.points.lattice;
  if (!like.points.polygons.empty()) part.points.polygons.offset.push_back(0);
  for (const auto& [name, members] : like.points.sets) part.points.sets[name];
  for (const auto& [name, values] : like.points.columns) part.points.columns[name];
  part.whole = like.whole;
  return part;
}

}  // namespace peristat
