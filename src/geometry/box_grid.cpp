#include "src/geometry/box_grid.hpp"

#include <algorithm>
#include <cmath>

#include "src/core/infinity.hpp"

namespace peristat {

BoxGrid::BoxGrid(int dimension, const std::vector<Box>& boxes, double cell) : cell_(cell) {
  if (boxes.empty()) return;
  Coordinates high{-infinity, -infinity, -infinity};
  low_ = {infinity, infinity, infinity};
  for (const Box& box : boxes) {
    for (std::size_t c = 0; c < 3; ++c) {
      low_[c] = std::min(low_[c], box.min[c]);
      high[c] = std::max(high[c], box.max[c]);
    }
  }
  const auto count_along = [&](std::size_t c) { return std::floor((high[c] - low_[c]) / cell_); };
  const double most = 8.0 * double(boxes.size()) + 1e3;
  const auto count_all = [&] {
    double all = 1.0;
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) all *= count_along(c) + 1.0;
    return all;
  };
  while (count_all() > most) cell_ *= 1.25;
  for (std::size_t c = 0; c < std::size_t(dimension); ++c)
    cells_[c] = std::size_t(count_along(c)) + 1;

  offset_.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
  const auto for_each_cell = [&](const Box& box, const auto& visit) {
    const Range first = cell_at(box.min), last = cell_at(box.max);
    for (std::size_t x = first[0]; x <= last[0]; ++x) {
      for (std::size_t y = first[1]; y <= last[1]; ++y) {
        for (std::size_t z = first[2]; z <= last[2]; ++z)
          visit((x * cells_[1] + y) * cells_[2] + z);
      }
    }
  };
  for (const Box& box : boxes) for_each_cell(box, [&](std::size_t k) { ++offset_[k + 1]; });
  for (std::size_t k = 1; k < offset_.size(); ++k) offset_[k] += offset_[k - 1];
  members_.resize(offset_.back());
  std::vector<std::size_t> next(offset_.begin(), offset_.end() - 1);
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for_each_cell(boxes[k], [&](std::size_t at) { members_[next[at]++] = Index(k); });
}

BoxGrid::Range BoxGrid::cell_at(const Coordinates& place) const {
  Range cell{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double along = std::floor((place[c] - low_[c]) / cell_);
    cell[c] = std::size_t(std::clamp(along, 0.0, double(cells_[c] - 1)));
  }
  return cell;
}

Box box_with(const std::vector<Coordinates>& places, int dimension, double larger) {
  Box box{places.front(), places.front()};
  for (const Coordinates& place : places) {
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
      box.min[c] = std::min(box.min[c], place[c] - larger);
      box.max[c] = std::max(box.max[c], place[c] + larger);
    }
  }
  return box;
}

bool do_overlap(const Box& one, const Box& other, int dimension) {
  for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
    if (one.max[c] < other.min[c] || one.min[c] > other.max[c]) return false;
  }
  return true;
}

}  // namespace peristat
