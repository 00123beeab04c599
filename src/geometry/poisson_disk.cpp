#include "src/geometry/poisson_disk.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "src/core/counter_random.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Places by the cell of a grid that they lie in.
class Grid {
 public:
  Grid(int dimension, const Box& box, double cell) : dimension_(dimension), low_(box.min) {
    std::size_t cells = 1;
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
      extent_[c] = std::size_t(std::max(1.0, std::ceil((box.max[c] - box.min[c]) / cell)));
      cells *= extent_[c];
    }
    cell_ = cell;
    last_.assign(cells, none);
  }

  void add(const Coordinates& place) {
    const std::size_t at = flat(cell_of(place));
    before_.push_back(last_[at]);
    last_[at] = Index(places_.size());
    places_.push_back(place);
  }

  [[nodiscard]] bool has_within(double distance, const Coordinates& place) const {
    const std::array<std::size_t, 3> centre = cell_of(place);
    std::array<std::size_t, 3> from{}, to{};
    const auto window = std::size_t(std::ceil(distance / cell_));
    for (std::size_t c = 0; c < 3; ++c) {
      from[c] = centre[c] - std::min(centre[c], window);
      to[c] = std::min(centre[c] + window, extent_[c] - 1);
    }
    for (std::size_t x = from[0]; x <= to[0]; ++x) {
      for (std::size_t y = from[1]; y <= to[1]; ++y) {
        for (std::size_t z = from[2]; z <= to[2]; ++z) {
          for (Index k = last_[flat({x, y, z})]; k != none; k = before_[std::size_t(k)]) {
            const Coordinates arm = minus<3>(places_[std::size_t(k)], place);
            if (dot<3>(arm, arm) < distance * distance) return true;
          }
        }
      }
    }
    return false;
  }

  [[nodiscard]] const std::vector<Coordinates>& places() const { return places_; }

 private:
  static constexpr Index none = -1;

  [[nodiscard]] std::array<std::size_t, 3> cell_of(const Coordinates& place) const {
    std::array<std::size_t, 3> cell{};
    for (std::size_t c = 0; c < std::size_t(dimension_); ++c)
      cell[c] = std::min(std::size_t((place[c] - low_[c]) / cell_), extent_[c] - 1);
    return cell;
  }
  [[nodiscard]] std::size_t flat(const std::array<std::size_t, 3>& cell) const {
    return (cell[0] * extent_[1] + cell[1]) * extent_[2] + cell[2];
  }

  int dimension_;
  Coordinates low_;
  double cell_ = 0.0;
  std::array<std::size_t, 3> extent_{1, 1, 1};
  std::vector<Index> last_, before_;  // last place per cell; per place the one before
  std::vector<Coordinates> places_;
};

/// Random places in boxes, in proportion to their counts.
class Darts {
 public:
  Darts(int dimension, const std::vector<Target>& targets, std::uint64_t seed)
      : dimension_(std::size_t(dimension)), targets_(targets), seed_(seed) {
    for (const Target& target : targets) up_to_.push_back(count() + target.count);
  }

  [[nodiscard]] Coordinates place(std::uint64_t dart) const {
    const std::uint64_t bits = random_bits(seed_, dart);
    const Box& box = targets_[target(bits)].box;
    Coordinates place{};
    for (std::size_t c = 0; c < dimension_; ++c)
      place[c] = box.min[c] + (box.max[c] - box.min[c]) * open_unit(random_bits(bits, c));
    return place;
  }

 private:
  [[nodiscard]] double count() const { return up_to_.empty() ? 0.0 : up_to_.back(); }
  [[nodiscard]] std::size_t target(std::uint64_t bits) const {
    const double at = count() * open_unit(random_bits(bits, 3));
    const auto found = std::upper_bound(up_to_.begin(), up_to_.end(), at) - up_to_.begin();
    return std::min(std::size_t(found), targets_.size() - 1);
  }

  std::size_t dimension_;
  const std::vector<Target>& targets_;
  std::uint64_t seed_;
  std::vector<double> up_to_;  // sum of the counts up to each target
};

}  // namespace

std::vector<Coordinates> poisson_disk_places(const Solid& body, std::size_t count,
                                             const SpacingField& spacing,
                                             const std::vector<Target>& targets,
                                             std::uint64_t seed) {
  const Darts darts(body.dimension(), targets, seed);
  Grid grid(body.dimension(), body.bounds(), spacing.finest());
  double share = 1.0;  // of the spacing that places keep as their distance
  const double shrink = 1.0 - 0.01 / double(count);
  for (std::uint64_t dart = 0; grid.places().size() < count; ++dart) {
    const Coordinates place = darts.place(dart);
    if (!body.contains(place)) continue;
    if (grid.has_within(share * spacing.at(place), place)) {
      share *= shrink;
    } else {
      grid.add(place);
    }
  }
  return grid.places();
}

}  // namespace peristat
