#include "src/geometry/lattice_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/core/infinity.hpp"

namespace peristat {

LatticeFrame::LatticeFrame(int dimension, const Coordinates& anchor, double offset,
                           const Spacing& spacing, double angle)
    : dimension_(dimension), anchor_(anchor), offset_(offset), spacing_(spacing) {
  // In degrees, so that a quarter turn is exact; the remainder is exact.
  double rest = std::fmod(angle, 360.0);
  if (rest < 0.0) rest += 360.0;
  const double quarters = std::floor(rest / 90.0);
  const double radians = (rest - 90.0 * quarters) * std::numbers::pi / 180.0;
  cosine_ = std::cos(radians);
  sine_ = std::sin(radians);
  for (int turn = 0; turn < int(quarters); ++turn) {
    const double cosine = cosine_;
    cosine_ = sine_ == 0.0 ? 0.0 : -sine_;
    sine_ = cosine;
  }
  if (dimension_ > 1) anchor_ = turned(anchor);
}

Coordinates LatticeFrame::turned(const Coordinates& a) const {
  if (dimension_ < 2) return a;
  return {cosine_ * a[0] - sine_ * a[1], sine_ * a[0] + cosine_ * a[1], a[2]};
}

Coordinates LatticeFrame::position(const Cell& cell) const {
  Coordinates from_anchor{};
  for (int c = 0; c < dimension_; ++c) {
    from_anchor[c] = (double(cell[c]) + offset_) * spacing_.along(c);
  }
  from_anchor = turned(from_anchor);
  Coordinates place{};
  for (int c = 0; c < dimension_; ++c) {
    place[c] = anchor_[c] + from_anchor[c];
    if (std::abs(place[c]) < grid_tolerance * spacing_.along(c)) place[c] = 0.0;
  }
  return place;
}

Coordinates LatticeFrame::spacings_to(const Coordinates& place) const {
  Coordinates from_anchor{};
  for (int c = 0; c < dimension_; ++c) from_anchor[c] = place[c] - anchor_[c];
  if (dimension_ > 1) {
    from_anchor = {cosine_ * from_anchor[0] + sine_ * from_anchor[1],
                   cosine_ * from_anchor[1] - sine_ * from_anchor[0], from_anchor[2]};
  }
  for (int c = 0; c < dimension_; ++c) {
    from_anchor[c] = from_anchor[c] / spacing_.along(c) - offset_;
  }
  return from_anchor;
}

LatticeFrame::Range LatticeFrame::range_of(const Box& box, double beside) const {
  Coordinates low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  const int corners = is_turned() ? 4 : 2;  // of the box in the plane of the turn
  bool usable = spacing_ > 0.0;
  for (int corner = 0; corner < corners; ++corner) {
    const bool is_right = corner % 2 == 1, is_upper = corners == 2 ? is_right : corner > 1;
    const Coordinates at =
        spacings_to({is_right ? box.max[0] : box.min[0], is_upper ? box.max[1] : box.min[1],
                     is_right ? box.max[2] : box.min[2]});
    for (int c = 0; c < dimension_; ++c) {
      low[c] = std::min(low[c], at[c]);
      high[c] = std::max(high[c], at[c]);
      usable = usable && std::isfinite(at[c]);
    }
  }
  Range range;
  for (int c = 0; c < dimension_; ++c) {
    range.first[c] = std::ceil(low[c] - beside);
    range.count[c] = std::max(0.0, std::floor(high[c] + beside) - range.first[c] + 1);
    if (!usable) range.count[c] = infinity;
  }
  return range;
}

std::array<double, 2> LatticeFrame::part_in(const Box& box, double beside, double row,
                                            const Range& range) const {
  double first = range.first[1], last = first + range.count[1] - 1.0;
  const Coordinates along = turned({0.0, spacing_.along(1), 0.0});
  const Coordinates shift = turned({(row + offset_) * spacing_.along(0), 0.0, 0.0});
  const double slack = (2.0 * beside + grid_tolerance) * half_diagonal();
  for (int c = 0; c < 2; ++c) {
    // Places a + (k + o) b of the row; no limit where the row runs along the box.
    if (std::abs(along[c]) < grid_tolerance * spacing_.along(1)) continue;
    const double from = anchor_[c] + shift[c];
    const double a = (box.min[c] - slack - from) / along[c] - offset_;
    const double b = (box.max[c] + slack - from) / along[c] - offset_;
    first = std::max(first, std::ceil(std::min(a, b) - grid_tolerance));
    last = std::min(last, std::floor(std::max(a, b) + grid_tolerance));
  }
  return {first, last};
}

void LatticeFrame::for_each_cell(const Box& box, double beside,
                                 const std::function<void(const Cell&)>& visit) const {
  const Range range = range_of(box, beside);
  for (const double count : range.count)
    if (!std::isfinite(count)) return;
  for (double x = 0.0; x < range.count[0]; ++x) {
    const double row = range.first[0] + x;
    std::array<double, 2> part{range.first[1], range.first[1] + range.count[1] - 1.0};
    if (is_turned()) part = part_in(box, beside, row, range);
    for (double y = part[0]; y <= part[1]; ++y) {
      for (double z = 0.0; z < range.count[2]; ++z)
        visit({std::int64_t(row), std::int64_t(y), std::int64_t(range.first[2] + z)});
    }
  }
}

double LatticeFrame::most_places(const Box& box, double beside) const {
  const Range range = range_of(box, beside);
  double places = range.count[0] * range.count[1] * range.count[2];
  if (is_turned()) {
    // Cells of places in the box lie in the box that is larger by half a diagonal all around.
    const double slack = (1.0 + 2.0 * beside) * half_diagonal();
    double in_plane = 1.0;
    for (int c = 0; c < 2; ++c)
      in_plane *= (box.max[c] - box.min[c] + 2.0 * slack) / spacing_.along(c);
    places = std::ceil(in_plane) * range.count[2];
  }
  return places >= 0.0 ? places : std::numeric_limits<double>::infinity();
}

double LatticeFrame::half_diagonal() const {
  double square = 0.0;
  for (int c = 0; c < dimension_; ++c) square += spacing_.along(c) * spacing_.along(c);
  return 0.5 * std::sqrt(square);
}

}  // namespace peristat
