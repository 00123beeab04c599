#include "src/neighbourhood/ghost_sites.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "src/core/counter_random.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/lattice_sites.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

/// Key of a row of places along the last axis of the lattice: their common other coordinates.
using RowKey = std::array<std::int64_t, 2>;

struct Occupant {
  std::int64_t at = 0;  // along the row
  Index point = 0;
  bool operator<(const Occupant& other) const { return at < other.at; }
};

/// Places from `first` to `last`.
struct Run {
  std::int64_t first = 0, last = 0;
};

/// A ball's places on a row, relative to the ball's middle.
struct RowOfBall {
  RowKey beside{};
  std::int64_t half = 0;  // places on either side of the middle one
};

/// Points at the places of a lattice, by rows, so that neighbours need no memory per point.
class Occupation {
 public:
  Occupation(const LatticeFrame& frame, const Points& points)
      : frame_(frame), points_(points), last_axis_(std::size_t(frame.dimension()) - 1) {
    for (Index point = 0; point < points.count(); ++point) {
      const Coordinates at = frame.spacings_to(points.position(point));
      Cell cell{};
      double off = 0.0;
      for (std::size_t c = 0; c <= last_axis_; ++c) {
        cell[c] = std::llround(at[c]);
        off += std::pow((at[c] - double(cell[c])) * frame.spacing().along(int(c)), 2);
      }
      farthest_off_ = std::max(farthest_off_, std::sqrt(off));
      rows_[key_of(cell)].push_back({cell[last_axis_], point});
    }
    for (auto& [key, row] : rows_) std::stable_sort(row.begin(), row.end());
  }

  /// Largest distance of a point from its place [m].
  [[nodiscard]] double farthest_off() const { return farthest_off_; }

  /// visit(cell) for all empty places within a radius of the place of a point, in ascending order.
  template <class Visit>
  void for_each_ghost(double radius, const Visit& visit) const {
    const std::vector<RowOfBall> ball = rows_of_ball(radius);
    std::set<RowKey> keys;
    for (const auto& [key, row] : rows_)
      for (const RowOfBall& part : ball) keys.insert(sum(key, part.beside));
    for (const RowKey& key : keys) {
      const auto own = rows_.find(key);
      for (const Run& run : reached(key, ball)) {
        for (std::int64_t at = run.first; at <= run.last; ++at) {
          if (own != rows_.end() && holds(own->second, at)) continue;
          visit(cell_of(key, at));
        }
      }
    }
  }

  /// True if a point that is no image lies within a radius of the ghost of a cell.
  [[nodiscard]] bool has_point_near(const Cell& cell, const Coordinates& place, double radius,
                                    const std::vector<RowOfBall>& ball) const {
    const double squared_radius = inclusive_radius(radius) * inclusive_radius(radius);
    for (const RowOfBall& part : ball) {
      const auto row = rows_.find(sum(key_of(cell), part.beside));
      if (row == rows_.end()) continue;
      const std::int64_t at = cell[last_axis_];
      auto occupant =
          std::lower_bound(row->second.begin(), row->second.end(), Occupant{at - part.half, 0});
      for (; occupant != row->second.end() && occupant->at <= at + part.half; ++occupant) {
        if (points_.is_image(occupant->point)) continue;
        const Coordinates of_point = points_.position(occupant->point);
        double squared = 0.0;
        for (std::size_t c = 0; c < 3; ++c)
          squared += (of_point[c] - place[c]) * (of_point[c] - place[c]);
        if (squared <= squared_radius) return true;
      }
    }
    return false;
  }

  [[nodiscard]] std::vector<RowOfBall> rows_of_ball(double radius) const {
    const double longest = inclusive_radius(radius);
    std::array<std::int64_t, 2> width{};
    for (std::size_t c = 0; c < last_axis_; ++c)
      width[c] = std::int64_t(longest / frame_.spacing().along(int(c)));
    std::vector<RowOfBall> ball;
    for (std::int64_t x = -width[0]; x <= width[0]; ++x) {
      for (std::int64_t y = -width[1]; y <= width[1]; ++y) {
        const double rest = longest * longest - std::pow(double(x) * frame_.spacing().along(0), 2) -
                            std::pow(double(y) * frame_.spacing().along(1), 2);
        if (rest < 0.0) continue;
        const double step = frame_.spacing().along(int(last_axis_));
        ball.push_back({{x, y}, std::int64_t(std::sqrt(rest) / step)});
      }
    }
    return ball;
  }

 private:
  [[nodiscard]] RowKey key_of(const Cell& cell) const {
    RowKey key{};
    for (std::size_t c = 0; c < last_axis_; ++c) key[c] = cell[c];
    return key;
  }

  [[nodiscard]] Cell cell_of(const RowKey& key, std::int64_t at) const {
    Cell cell{};
    for (std::size_t c = 0; c < last_axis_; ++c) cell[c] = key[c];
    cell[last_axis_] = at;
    return cell;
  }

  static RowKey sum(const RowKey& a, const RowKey& b) { return {a[0] + b[0], a[1] + b[1]}; }

  static bool holds(const std::vector<Occupant>& row, std::int64_t at) {
    return std::binary_search(row.begin(), row.end(), Occupant{at, 0});
  }

  /// Places of a row that balls around points reach, as ascending runs that don't touch.
  [[nodiscard]] std::vector<Run> reached(const RowKey& key,
                                         const std::vector<RowOfBall>& ball) const {
    std::vector<Run> runs;
    for (const RowOfBall& part : ball) {
      const auto row = rows_.find(sum(key, part.beside));
      if (row == rows_.end()) continue;
      const std::size_t before = runs.size();
      for (const Occupant& occupant : row->second) {
        if (points_.is_image(occupant.point)) continue;
        const Run run{occupant.at - part.half, occupant.at + part.half};
        if (runs.size() > before && run.first <= runs.back().last + 1) {
          runs.back().last = run.last;
        } else {
          runs.push_back(run);
        }
      }
    }
    std::sort(runs.begin(), runs.end(),
              [](const Run& a, const Run& b) { return a.first < b.first; });
    std::vector<Run> merged;
    for (const Run& run : runs) {
      if (!merged.empty() && run.first <= merged.back().last + 1) {
        merged.back().last = std::max(merged.back().last, run.last);
      } else {
        merged.push_back(run);
      }
    }
    return merged;
  }

  const LatticeFrame& frame_;
  const Points& points_;
  std::size_t last_axis_;
  double farthest_off_ = 0.0;
  std::map<RowKey, std::vector<Occupant>> rows_;
};

/// Shift of the ghost at a place [m].
Coordinates shift_of(const Lattice& lattice, const LatticeFrame& frame, const Cell& cell) {
  std::uint64_t bits = lattice.seed;
  for (const std::int64_t place : cell) bits = random_bits(bits, std::uint64_t(place));
  Coordinates along{};
  for (int c = 0; c < lattice.dimension; ++c) {
    const double from_minus_one_to_one = 2.0 * open_unit(random_bits(bits, std::uint64_t(c))) - 1.0;
    along[std::size_t(c)] = lattice.perturbation * lattice.spacing.along(c) * from_minus_one_to_one;
  }
  return frame.turned(along);
}

[[noreturn]] void refuse(double radius, const std::string& allowed) {
  throw InputError("radius", number_text(radius), allowed);
}

/// Sum of the largest distances of points and ghosts from their places [m]; 0 if all stand on them,
/// so that the lattice decides exactly who is within a radius.
double off_places(const Lattice& lattice, const LatticeFrame& frame, const Occupation& occupation) {
  const double largest_shift = 2.0 * lattice.perturbation * frame.half_diagonal();
  const double off = occupation.farthest_off() + largest_shift;
  return off > grid_tolerance * frame.half_diagonal() ? off : 0.0;
}

}  // namespace

double reach_beyond_balls(const Lattice& lattice, const Points& points) {
  const LatticeFrame frame = frame_of(lattice);
  return off_places(lattice, frame, {frame, points});
}

GhostSites ghost_sites(const Lattice& lattice, const Points& points, double radius) {
  // A ball of so many spacings has more places than points can be numbered.
  constexpr double most_spacings = 1e4;
  if (!(radius > 0.0 && radius <= most_spacings * lattice.spacing))
    refuse(radius, "must be positive, and at most 10000 spacings");
  const LatticeFrame frame = frame_of(lattice);
  const Occupation occupation(frame, points);
  const double off = off_places(lattice, frame, occupation);
  const double reach = radius + off;
  const std::vector<RowOfBall> ball = occupation.rows_of_ball(reach);
  const std::int64_t most = std::numeric_limits<Index>::max() - std::int64_t(points.count());
  GhostSites ghosts;
  occupation.for_each_ghost(reach, [&](const Cell& cell) {
    Coordinates place = frame.position(cell);
    if (lattice.perturbation > 0.0) {
      const Coordinates shift = shift_of(lattice, frame, cell);
      for (std::size_t c = 0; c < 3; ++c) place[c] += shift[c];
    }
    if (off > 0.0 && !occupation.has_point_near(cell, place, radius, ball)) return;
    if (std::int64_t(ghosts.cell.size()) == most)
      refuse(radius, "there are more points and surrounding lattice sites than can be numbered");
    ghosts.cell.push_back(cell);
    ghosts.reference.insert(ghosts.reference.end(), place.begin(),
                            place.begin() + lattice.dimension);
  });
  return ghosts;
}

}  // namespace peristat
