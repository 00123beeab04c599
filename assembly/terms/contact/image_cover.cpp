#include "assembly/terms/contact/image_cover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/core/coordinates.hpp"

namespace peristat {

ImageCover::ImageCover(const Points& points, double range) : points_(points), range_(range) {
  const Index own = points.own();
  const std::size_t kinds = points.images.kinds.size();
  if (kinds == 0 || own == 0) return;
  const std::vector<double> at_rest(points.reference.size(), 0.0);
  const Box around = box(at_rest);
  Index handle = points.count();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool repeats = std::ranges::any_of(
        points.images.kinds, [axis](const ImageKind& kind) { return kind.periods[axis] != 0; });
    if (repeats) handle_[axis] = handle++;
  }
  std::vector<std::vector<char>> is_there(kinds, std::vector<char>(std::size_t(own), 0));
  for (Index image = own; image < points.count(); ++image) {
    is_there[points.images.kind[std::size_t(image - own)]][std::size_t(points.source(image))] = 1;
  }
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    Missing missing{kind, {}, std::numeric_limits<double>::infinity()};
    for (Index i = 0; i < own; ++i) {
      if (is_there[kind][std::size_t(i)]) continue;
      missing.sources.push_back(i);
      const Coordinates place = points.images.kinds[kind].place(points.position(i));
      missing.away = std::min(missing.away, around.distance(place));
    }
    if (!missing.sources.empty()) missing_.push_back(std::move(missing));
  }
}

bool ImageCover::holds(std::span<const double> displacement) const {
  if (missing_.empty()) return true;
  double longest = 0.0;
  for (Index i = 0; i < points_.own(); ++i) {
    longest = std::max(longest, length(moved(i, displacement)));
  }
  const auto is_far = [&](const Missing& of) {
    const Coordinates over = jump(points_.images.kinds[of.kind], displacement);
    return of.away > range_ + 2.0 * longest + length(over);
  };
  if (std::ranges::all_of(missing_, is_far)) return true;
  const Box around = box(displacement);
  return std::ranges::all_of(missing_, [&](const Missing& of) {
    if (is_far(of)) return true;
    const ImageKind& kind = points_.images.kinds[of.kind];
    const Coordinates over = jump(kind, displacement);
    return std::ranges::all_of(of.sources, [&](Index source) {
      const Coordinates now = plus(points_.position(source), moved(source, displacement));
      return around.distance(plus(kind.place(now), over)) > range_;
    });
  });
}

double ImageCover::Box::distance(const Coordinates& place) const {
  Coordinates beyond{};
  for (std::size_t c = 0; c < 3; ++c) {
    beyond[c] = std::max({0.0, least[c] - place[c], place[c] - most[c]});
  }
  return length(beyond);
}

ImageCover::Box ImageCover::box(std::span<const double> displacement) const {
  Box around;
  around.least.fill(std::numeric_limits<double>::infinity());
  around.most.fill(-std::numeric_limits<double>::infinity());
  for (Index i = 0; i < points_.own(); ++i) {
    const Coordinates now = plus(points_.position(i), moved(i, displacement));
    for (std::size_t c = 0; c < 3; ++c) {
      around.least[c] = std::min(around.least[c], now[c]);
      around.most[c] = std::max(around.most[c], now[c]);
    }
  }
  return around;
}

Coordinates ImageCover::moved(Index row, std::span<const double> displacement) const {
  const auto d = std::size_t(points_.dimension);
  Coordinates of_row{};
  for (std::size_t c = 0; c < d; ++c) of_row[c] = displacement[std::size_t(row) * d + c];
  return of_row;
}

Coordinates ImageCover::jump(const ImageKind& kind, std::span<const double> displacement) const {
  Coordinates over{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (kind.periods[axis] == 0) continue;
    over = plus(over, scaled(kind.periods[axis], moved(handle_[axis], displacement)));
  }
  return over;
}

}  // namespace peristat
