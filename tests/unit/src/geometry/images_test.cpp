#include "src/geometry/images.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"
#include "src/geometry/points.hpp"

namespace peristat {
namespace {

/// A row of points half a spacing inside its ends, from 0 on.
Points row(Index count, double spacing = 1.0) {
  Points points;
  points.dimension = 1;
  points.spacing = spacing;
  for (Index i = 0; i < count; ++i) {
    points.reference.push_back((i + 0.5) * spacing);
    points.volume.push_back(1.0);
  }
  return points;
}

std::string refusal(Points points, const std::vector<SymmetryPlane>& planes,
                    const std::vector<Period>& periods) {
  try {
    add_images(points, planes, periods, 2.0 * points.spacing);
  } catch (const InputError& error) {
    return error.key() + ": " + error.allowed();
  }
  return "";
}

TEST(Images, OfAPeriodContinueRowsOfAnyLength) {
  for (const Index count : {1, 2, 3, 19, 20, 21, 30, 1000, 100000}) {
    const double spacing = 1e-3;
    Points points = row(count, spacing);
    add_images(points, {}, {{0, 0.0, count * spacing}}, 3.015 * spacing);
    // Three places beyond each end lie within the horizon of a point, whatever stands there.
    ASSERT_EQ(points.count() - points.own(), 6) << count;
    for (Index image = points.own(); image < points.count(); ++image) {
      const double at = points.reference[std::size_t(image)] / spacing - 0.5;
      const auto place = static_cast<Index>(std::lround(at));
      EXPECT_NEAR(at, place, 1e-9 * count);
      EXPECT_TRUE((place >= -3 && place < 0) || (place >= count && place < count + 3)) << place;
      EXPECT_EQ(points.source(image), ((place % count) + count) % count);
      EXPECT_EQ(points.image_kind(image).periods[0] * count + points.source(image), place);
    }
  }
}

TEST(Images, OfAPlaneMirror) {
  Points points = row(4);
  add_images(points, {{0, 0.0}}, {}, 2.5);
  ASSERT_EQ(points.count() - points.own(), 2);  // 1 and 2 from the first point
  for (Index image = points.own(); image < points.count(); ++image) {
    EXPECT_EQ(points.reference[std::size_t(image)],
              -points.reference[std::size_t(points.source(image))]);
  }
}

TEST(Images, AreNoneWithoutThem) {
  Points points = row(4);
  add_images(points, {{0, 0.0}}, {}, 1.5);
  const Points own = without_images(points);
  EXPECT_EQ(own.count(), 4);
  EXPECT_EQ(own.own(), 4);
  EXPECT_EQ(own.reference, row(4).reference);
  EXPECT_EQ(own.images.kinds.size(), points.images.kinds.size());
}

TEST(Images, OfWhatDoesNotGoOnAreRefused) {
  for (const Index count : {4, 40, 400}) {
    const double length = count;
    EXPECT_EQ(refusal(row(count), {}, {{0, 0.0, length}}), "");
    EXPECT_EQ(refusal(row(count), {}, {{0, 0.0, length + 7.0}}), "");  // of a cloud: a gap
    for (const Period& period : std::vector<Period>{
             {0, 0.6, length + 0.6}, {0, 0.0, length - 0.6}, {0, 0.5, length - 0.5}}) {
      EXPECT_NE(refusal(row(count), {}, {period}).find("periods[0].to: points lie between"),
                std::string::npos)
          << count;
    }
    EXPECT_NE(refusal(row(count), {{0, 0.5}}, {}).find("passes through points"), std::string::npos);
    EXPECT_NE(refusal(row(count), {{0, 2.0}}, {}).find("both sides"), std::string::npos);
    EXPECT_NE(refusal(row(count), {{0, 0.0}}, {{0, 0.0, length}}).find("has a plane of symmetry"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace peristat
