#include "solvers/ranks/heard_of_bonds.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "solvers/ranks/ranks.hpp"
#include "src/geometry/image_number.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// A bond as all ranks identify it: by the numbers of its ends, and by the image of the second one
/// that it ends at (image_number).
struct EndsOfBond {
  GlobalIndex first = 0, second = 0, image = 0;
};

/// Ends of a bond between two images, moved to the source of the first one: the other end is then
/// the image of the second's source by the relative kind; nothing if no such kind exists.
std::optional<EndsOfBond> ends_of_source(const Points& points, const NumberedPoints& numbered,
                                         Index image, Index other) {
  const std::vector<ImageKind>& kinds = points.images.kinds;
  const auto kind_of = [&](Index point) {
    return kinds[std::size_t(image_number(points, point) - 1)];
  };
  const ImageKind between = relative(kind_of(image), kind_of(other));
  EndsOfBond ends{numbered.number_of(points.source(image)),
                  numbered.number_of(points.source(other)), 0};
  const double tolerance = 1e-6 * points.spacing.largest();  // far above round-off of the planes
  if (is_same(between, ImageKind{}, tolerance)) return ends;
  const auto found = std::ranges::find_if(
      kinds, [&](const ImageKind& kind) { return is_same(kind, between, tolerance); });
  if (found == kinds.end()) return std::nullopt;
  ends.image = (found - kinds.begin()) + 1;
  return ends;
}

/// Ends by which other ranks identify a bond.
EndsOfBond ends_of(const Points& points, const NumberedPoints& numbered, Index i, Index j) {
  if (!points.is_image(i)) {
    return {numbered.number_of(i), numbered.number_of(points.source(j)), image_number(points, j)};
  }
  auto ends = ends_of_source(points, numbered, i, j);
  if (!ends) ends = ends_of_source(points, numbered, j, i);
  if (!ends) throw std::logic_error("a bond between two images is one of no point");
  return *ends;
}

/// The local bond with these ends.
Offset bond_of(const Bonds& bonds, const Points& points, const NumberedPoints& numbered,
               const EndsOfBond& ends) {
  const std::optional<Index> one = numbered.find(ends.first), other = numbered.find(ends.second);
  if (!one || !other) throw std::logic_error("a bond of two parts has a point that is not here");
  const bool is_between = ends.image == 0;
  const Index lower = is_between ? std::min(*one, *other) : *one;
  const Index upper = is_between ? std::max(*one, *other) : points.own();
  const PartnersOfPoint partners = bonds.of(lower);
  const auto last = partners.end();
  auto found = std::lower_bound(partners.begin(), last, upper);
  if (!is_between) {
    found = std::find_if(found, last, [&](Index image) {
      return points.source(image) == *other && image_number(points, image) == ends.image;
    });
  }
  if (found == last || (is_between && *found != upper)) {
    throw std::logic_error("a bond between two parts is on one rank alone");
  }
  return bonds.offset[lower] + (found - partners.begin());
}

/// Requests bonds from the ranks that send their values: the requesting rank, the ends, and the
/// bond's number there. A rank sends requests to itself for bonds between images.
Records questions(const Bonds& bonds, const Points& points, const NumberedPoints& numbered,
                  const Communicator& ranks, BetweenImages between_images) {
  Records asked{1, 4, {}, {}};
  std::vector<int> to;
  for (Index i = 0; i < bonds.points(); ++i) {
    if (points.is_image(i) && between_images == BetweenImages::nothing) continue;
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const EndsOfBond ends = ends_of(points, numbered, i, bonds.partner(i, bond));
      const Index teller =
          *numbered.find(ends.image > 0 ? ends.first : std::min(ends.first, ends.second));
      if (!numbered.is_ghost(teller) && !points.is_image(i)) continue;
      to.push_back(numbered.is_ghost(teller) ? numbered.owner_of_ghost(teller) : ranks.rank());
      asked.values.push_back(double(ranks.rank()));
      asked.numbers.insert(asked.numbers.end(), {ends.first, ends.second, ends.image, bond});
    }
  }
  return exchange(ranks, to, asked);
}

}  // namespace

HeardOfBonds heard_of_bonds(const Bonds& bonds, const Points& points,
                            const NumberedPoints& numbered, const Communicator& ranks,
                            BetweenImages between_images, int width,
                            const std::function<void(Offset, double*)>& tell) {
  const Records asked = questions(bonds, points, numbered, ranks, between_images);
  const auto each = std::size_t(width);
  Records told{width, 1, std::vector<double>(asked.values.size() * each), {}};
  std::vector<int> to;
  for (std::size_t k = 0; k < asked.values.size(); ++k) {
    const auto* const numbers = &asked.numbers[4 * k];
    tell(bond_of(bonds, points, numbered, {numbers[0], numbers[1], numbers[2]}),
         &told.values[k * each]);
    told.numbers.push_back(numbers[3]);
    to.push_back(int(asked.values[k]));
  }
  Records heard = exchange(ranks, to, told);
  return {{heard.numbers.begin(), heard.numbers.end()}, std::move(heard.values)};
}

}  // namespace peristat
