#include "src/geometry/voronoi.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "src/core/counter_random.hpp"

namespace peristat {
namespace {

const Box box{{-0.3, 0.1, 0.2}, {0.7, 0.9, 0.8}};

std::vector<Coordinates> random_places(int dimension, std::size_t count, std::uint64_t seed) {
  std::vector<Coordinates> places(count, Coordinates{});
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
      const double unit = open_unit(random_bits(random_bits(seed, k), c));
      places[k][c] = box.min[c] + (box.max[c] - box.min[c]) * unit;
    }
  }
  return places;
}

double squared(const Coordinates& a, const Coordinates& b) {
  return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
         (a[2] - b[2]) * (a[2] - b[2]);
}

/// Volumes and first moments of the cells by the places of a grid, each of the nearest one's.
struct Counted {
  std::vector<double> volume;
  std::vector<Coordinates> centroid;
};

Counted count_grid(int dimension, const std::vector<Coordinates>& places, int per_axis) {
  Counted counted{std::vector<double>(places.size(), 0.0),
                  std::vector<Coordinates>(places.size(), Coordinates{})};
  double cell = 1.0;
  for (std::size_t c = 0; c < std::size_t(dimension); ++c)
    cell *= (box.max[c] - box.min[c]) / per_axis;
  const int deep = dimension == 3 ? per_axis : 1;
  for (int x = 0; x < per_axis; ++x) {
    for (int y = 0; y < per_axis; ++y) {
      for (int z = 0; z < deep; ++z) {
        const std::array<int, 3> number{x, y, z};
        Coordinates at{};
        for (std::size_t c = 0; c < std::size_t(dimension); ++c)
          at[c] = box.min[c] + (box.max[c] - box.min[c]) * (number[c] + 0.5) / per_axis;
        std::size_t nearest = 0;
        for (std::size_t k = 1; k < places.size(); ++k)
          if (squared(places[k], at) < squared(places[nearest], at)) nearest = k;
        counted.volume[nearest] += cell;
        for (std::size_t c = 0; c < 3; ++c) counted.centroid[nearest][c] += cell * at[c];
      }
    }
  }
  return counted;
}

// Every place of a fine grid belongs to the nearest point: nothing but distances is asked there.
TEST(Voronoi, CellsAreWhatIsNearest) {
  for (const int dimension : {2, 3}) {
    const std::vector<Coordinates> places = random_places(dimension, 20, 7);
    const Counted counted = count_grid(dimension, places, dimension == 2 ? 1000 : 100);
    std::vector<int> visits(places.size(), 0);
    double sum = 0.0;
    for_each_voronoi_cell(dimension, box, 0.2, places, [&](std::size_t k, const ConvexCell& cell) {
      ++visits[k];
      sum += cell.volume;
      EXPECT_EQ(cell.place, places[k]);
      EXPECT_NEAR(cell.volume, counted.volume[k], dimension == 2 ? 3e-5 : 3e-4);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(cell.centroid[c] * cell.volume, counted.centroid[k][c], 3e-4);
      }
    });
    EXPECT_EQ(visits, std::vector<int>(places.size(), 1));
    EXPECT_NEAR(sum, dimension == 2 ? 0.8 : 0.48, 1e-14);
  }
}

// Corners of polygons go round anticlockwise, and are equally far from three places or the box.
TEST(Voronoi, PolygonsGoRound) {
  const std::vector<Coordinates> places = random_places(2, 200, 3);
  for_each_voronoi_cell(2, box, 0.06, places, [&](std::size_t k, const ConvexCell& cell) {
    const std::size_t count = cell.corners.size();
    ASSERT_GE(count, 3u);
    for (std::size_t c = 0; c < count; ++c) {
      const Coordinates &a = cell.corners[c], &b = cell.corners[(c + 1) % count];
      EXPECT_GT(a[0] * b[1] - a[1] * b[0], 0.0);
      const Coordinates at{places[k][0] + a[0], places[k][1] + a[1], 0.0};
      for (const Coordinates& other : places)
        EXPECT_GE(std::sqrt(squared(other, at)), std::hypot(a[0], a[1]) - 1e-12);
    }
  });
}

// A body as small or as far away as may be has the same cells: Voro++ has an absolute tolerance.
TEST(Voronoi, CellsDoNotDependOnUnits) {
  const std::vector<Coordinates> places = random_places(2, 100, 5);
  std::vector<double> volume(places.size());
  for_each_voronoi_cell(2, box, 0.1, places,
                        [&](std::size_t k, const ConvexCell& cell) { volume[k] = cell.volume; });
  const double small = 1e-9;
  std::vector<Coordinates> scaled_places = places;
  Box scaled_box = box;
  for (std::size_t c = 0; c < 3; ++c) {
    for (Coordinates& place : scaled_places) place[c] *= small;
    scaled_box.min[c] *= small;
    scaled_box.max[c] *= small;
  }
  for_each_voronoi_cell(2, scaled_box, 0.1 * small, scaled_places,
                        [&](std::size_t k, const ConvexCell& cell) {
                          EXPECT_NEAR(cell.volume / (small * small), volume[k], 1e-13);
                        });
}

}  // namespace
}  // namespace peristat
