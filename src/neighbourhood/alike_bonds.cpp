#include "src/neighbourhood/alike_bonds.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "src/geometry/image_number.hpp"

namespace peristat {
namespace {

/// Finds the bonds of points that show bonds with images.
class Shown {
 public:
  Shown(const Points& points, const Bonds& bonds) : points_(points), bonds_(bonds) {
    std::vector<ImageKind> kinds{{}};  // numbers of images are positions in it
    kinds.insert(kinds.end(), points.images.kinds.begin(), points.images.kinds.end());
    const double tolerance = 1e-6 * double(points.spacing.largest());  // far above round-off
    for (const ImageKind& from : kinds) {
      for (const ImageKind& to : kinds) {
        const ImageKind between = relative(from, to);
        const auto found = std::ranges::find_if(
            kinds, [&](const ImageKind& one) { return is_same(one, between, tolerance); });
        between_.push_back(Index(found - kinds.begin()));
      }
    }
    count_ = Index(kinds.size());
    for (Index image = points.own(); image < points.count(); ++image) {
      image_of_[{points.source(image), image_number(points, image)}] = image;
    }
  }

  /// The bond of the source of i that the bond i-j shows, or nothing.
  [[nodiscard]] std::optional<Offset> from(Index i, Index j) const {
    const Index number =
        between_[std::size_t(image_number(points_, i) * count_ + image_number(points_, j))];
    const Index here = points_.source(i);
    Index there = points_.source(j);
    if (number > 0) {
      const auto image = image_of_.find({there, number});
      if (image == image_of_.end()) return std::nullopt;
      there = image->second;
    }
    return bonds_.find(here, there);
  }

 private:
  const Points& points_;
  const Bonds& bonds_;
  Index count_ = 0;
  std::vector<Index> between_;  // per two numbers of images the number of the relative one
  std::map<std::pair<Index, Index>, Index> image_of_;  // by source and number
};

}  // namespace

AlikeBonds::AlikeBonds(const Points& points, const Bonds& bonds) {
  if (points.own() == points.count()) return;
  const Shown shown(points, bonds);
  first_.resize(std::size_t(bonds.count()));
  next_.assign(std::size_t(bonds.count()), -1);
  std::vector<Offset> last(std::size_t(bonds.count()));
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      // Bonds between images come last, after those of points that they show.
      const auto of_first = shown.from(i, j), of_second = shown.from(j, i);
      const bool is_shown = points.is_image(i) ? of_first || of_second : of_first && of_second;
      if (!is_shown) throw std::logic_error("a bond without its other half");
      Offset first = bond;
      for (const auto found : {of_first, of_second}) {
        if (found && *found < bond) first = std::min(first, this->first(*found));
      }
      first_[std::size_t(bond)] = first;
      if (first < bond) next_[std::size_t(last[std::size_t(first)])] = bond;
      last[std::size_t(first)] = bond;
    }
  }
}

}  // namespace peristat
