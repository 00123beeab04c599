#include "src/neighbourhood/interactions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "src/neighbourhood/effective_volumes.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

using tests::BoxBody;

/// Points of a triangle or tetrahedron, ascending, with its signed weight and inverse measure.
template <int Count>
using Found = std::map<std::array<Index, Count>, std::array<double, 2>>;

template <int D, class Measure>
Found<Measure::arms + 1> all_of(const BoxBody& body, const Interactions<Measure>& interactions) {
  Found<Measure::arms + 1> found;
  LocalNeighbourhood<D> local(body.points, body.model.bonds);
  InteractionScratch scratch(UpperNeighbourhood::largest(body.model.bonds));
  for (Index i = 0; i < body.points.count(); ++i) {
    local.move_to(i);
    local.upper.find_pairs();
    interactions.template for_each_group<D>(local, scratch, [&](const auto& group) {
      for (const InteractionBlock& block : group.blocks) {
        EXPECT_NE(block.active, 0u);
        for (int l = 0; l < lane_count; ++l) {
          if ((block.active >> l & 1U) == 0) {
            EXPECT_EQ(block.weight[l], 0.0);
            continue;
          }
          std::array<Index, Measure::arms + 1> points;
          points[0] = i;
          for (int p = 0; p + 1 < Measure::arms; ++p) {
            points[p + 1] = local.upper.points()[group.partners[p]];
          }
          points[Measure::arms] = local.upper.points()[block.first + l];
          EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
          EXPECT_TRUE(found.insert({points, {block.weight[l], block.inverse_reference[l]}}).second)
              << "visited twice";
        }
      }
    });
  }
  return found;
}

/// Lattice coordinates in spacings: exact, so that flatness is a matter of integers.
std::array<std::int64_t, 3> lattice_place(const Points& points, Index i) {
  const Coordinates at = points.position(i);
  return {std::llround(at[0] / points.spacing - 0.5), std::llround(at[1] / points.spacing - 0.5),
          points.dimension == 3 ? std::llround(at[2] / points.spacing - 0.5) : 0};
}

std::array<std::int64_t, 3> arm(const Points& points, Index from, Index to) {
  const auto a = lattice_place(points, from), b = lattice_place(points, to);
  return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}

std::array<std::int64_t, 3> cross(const std::array<std::int64_t, 3>& a,
                                  const std::array<std::int64_t, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::int64_t dot(const std::array<std::int64_t, 3>& a, const std::array<std::int64_t, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

std::array<std::int64_t, 3> area_vector(const Points& points, Index i, Index j, Index k) {
  return cross(arm(points, i, j), arm(points, i, k));
}

std::int64_t volume(const Points& points, Index i, Index j, Index k, Index l) {
  return dot(area_vector(points, i, j, k), arm(points, i, l));
}

struct Body : BoxBody {
  using BoxBody::BoxBody;
  [[nodiscard]] bool near(Index i, Index j) const {
    return tests::reference_distance(points, i, j) <= setting.horizon;
  }
};

TEST(Triangles, AreAllWithMutualDistancesWithinTheHorizonButCollinearOnes) {
  for (int dimension : {2, 3}) {
    const Body body(tests::small_box(dimension));
    const Triangles triangles(body.points, body.model.bonds, body.setting.horizon, 2);
    const auto found = dimension == 2 ? all_of<2>(body, triangles) : all_of<3>(body, triangles);
    const Index n = body.points.count();
    std::size_t count = 0, collinear = 0;
    for (Index i = 0; i < n; ++i) {
      for (Index j = i + 1; j < n; ++j) {
        if (!body.near(i, j)) continue;
        for (Index k = j + 1; k < n; ++k) {
          if (!body.near(i, k) || !body.near(j, k)) continue;
          const auto vector = area_vector(body.points, i, j, k);
          if (dot(vector, vector) == 0) {
            ++collinear;
            EXPECT_FALSE(found.contains({i, j, k}));
            continue;
          }
          ++count;
          const auto entry = found.find({i, j, k});
          ASSERT_NE(entry, found.end());
          const double expected =
              dimension == 2 ? double(vector[2]) : std::sqrt(double(dot(vector, vector)));
          EXPECT_NEAR(entry->second[1] * expected * body.points.spacing * body.points.spacing, 1.0,
                      1e-13);  // round-off of the coordinates over the spacing
        }
      }
    }
    EXPECT_GT(collinear, 0u);
    EXPECT_GT(count, 100u);
    EXPECT_EQ(found.size(), count);
    EXPECT_EQ(triangles.count(), Offset(count));
  }
}

TEST(Tetrahedra, AreAllWithMutualDistancesWithinTheHorizonButCoplanarOnes) {
  const Body body(tests::small_box(3));
  const Tetrahedra tetrahedra(body.points, body.model.bonds, body.setting.horizon, 2);
  const auto found = all_of<3>(body, tetrahedra);
  const Index n = body.points.count();
  std::size_t count = 0, coplanar = 0;
  for (Index i = 0; i < n; ++i) {
    for (Index j = i + 1; j < n; ++j) {
      if (!body.near(i, j)) continue;
      for (Index k = j + 1; k < n; ++k) {
        if (!body.near(i, k) || !body.near(j, k)) continue;
        for (Index l = k + 1; l < n; ++l) {
          if (!body.near(i, l) || !body.near(j, l) || !body.near(k, l)) continue;
          const std::int64_t reference = volume(body.points, i, j, k, l);
          if (reference == 0) {
            ++coplanar;
            EXPECT_FALSE(found.contains({i, j, k, l}));
            continue;
          }
          ++count;
          const auto entry = found.find({i, j, k, l});
          ASSERT_NE(entry, found.end());
          EXPECT_NEAR(entry->second[1] * double(reference) * std::pow(body.points.spacing, 3), 1.0,
                      1e-13);
        }
      }
    }
  }
  EXPECT_GT(coplanar, 0u);
  EXPECT_GT(count, 100u);
  EXPECT_EQ(found.size(), count);
  EXPECT_EQ(tetrahedra.count(), Offset(count));
}

template <class Measure, int D>
void expect_consistent(double perturbation) {
  tests::BoxSetting box = tests::small_box(D);
  box.perturbation = perturbation;
  box.horizon_ratio = D == 2 ? 9.1 : 2.6;  // 2D: more than 64 partners, two words of bits
  if (D == 2) box.extent = {13, 12, 0};
  const BoxBody body(box);
  ASSERT_GT(UpperNeighbourhood::largest(body.model.bonds), D == 2 ? 64 : 30);
  Interactions<Measure> interactions(body.points, body.model.bonds, body.setting.horizon, 1);
  std::vector<double> shares(body.points.volume.size());
  for (std::size_t a = 0; a < shares.size(); ++a) shares[a] = 1.0 + 0.01 * double(a);
  interactions.set_shares(shares);
  const auto found = all_of<D>(body, interactions);
  ASSERT_GT(found.size(), 1000u);

  std::vector<std::int32_t> per_point(shares.size(), 0);
  int negative = 0;
  for (const auto& [points, values] : found) {
    double weight = 0.0;
    for (Index point : points) {
      weight += shares[point];
      ++per_point[point];
    }
    EXPECT_NEAR(std::abs(values[0]) / weight, 1.0, 1e-14);
    EXPECT_GT(values[0] * values[1], 0.0);  // signs of weight and measure agree
    negative += values[0] < 0.0;
  }
  EXPECT_EQ(interactions.per_point(), per_point);
  if (Measure::template singular_at_zero<D>) {
    EXPECT_EQ(negative, 0);
  } else {
    EXPECT_GT(negative, 0);
  }

  // Stored, and counted with any number of threads, they are the same.
  const double bytes = interactions.stored_bytes();
  for (int threads : {1, 3}) {
    Interactions<Measure> other(body.points, body.model.bonds, body.setting.horizon, threads);
    EXPECT_EQ(other.count(), interactions.count());
    EXPECT_EQ(other.per_point(), interactions.per_point());
    EXPECT_EQ(other.stored_bytes(), bytes);
    other.set_shares(shares);
    EXPECT_FALSE(other.is_stored());
    other.store(body.points, body.model.bonds, threads);
    EXPECT_TRUE(other.is_stored());
    EXPECT_EQ(all_of<D>(body, other), found);
  }
  EXPECT_GT(bytes, 18.0 * double(found.size()));  // 72 bytes for at most four
}

TEST(Triangles, AreTheSameFoundAndStored2D) { expect_consistent<Area, 2>(0.2); }
TEST(Triangles, AreTheSameFoundAndStored3D) { expect_consistent<Area, 3>(0.0); }
TEST(Tetrahedra, AreTheSameFoundAndStored) { expect_consistent<Volume, 3>(0.2); }

TEST(Interactions, OfABodyWithoutNeighboursAreNone) {
  tests::BoxSetting box = tests::small_box(3);
  box.extent = {2, 1, 1};
  const BoxBody body(box);
  ASSERT_EQ(body.model.bonds.count(), 1);
  EXPECT_EQ(Triangles(body.points, body.model.bonds, body.setting.horizon, 2).count(), 0);
  EXPECT_EQ(Tetrahedra(body.points, body.model.bonds, body.setting.horizon, 2).count(), 0);
}

// Conditions (35) of [CPD]: the quadrature of 1 over the neighbourhood, its square and its cube.
TEST(EffectiveVolumes, SumUpToThePowersOfTheNeighbourhoodsVolume) {
  for (int dimension : {2, 3}) {
    for (double perturbation : {0.0, 0.2}) {
      tests::BoxSetting box = tests::small_box(dimension);
      box.perturbation = perturbation;
      const BoxBody body(box);
      const BulkNeighbourhood bulk = bulk_neighbourhood(
          dimension, body.points.spacing, body.setting.horizon, body.setting.cross_section);
      const std::vector<std::int32_t> neighbours = neighbour_counts(body.model.bonds);
      const double v1 = effective_neighbour_volume(bulk);
      const auto check = [&](const auto& interactions, auto power, double orders) {
        const std::vector<double> effective =
            effective_volumes(interactions, neighbours, bulk, InteractionWeights::mean);
        std::vector<double> sum(effective.size(), 0.0);
        const auto add = [&](const auto& found) {
          ASSERT_GT(found.size(), 0u);
          for (const auto& entry : found) {
            for (Index point : entry.first) sum[point] += orders * effective[point];
          }
        };
        if (dimension == 2) {
          if constexpr (power() == 2) add(all_of<2>(body, interactions));
        } else {
          add(all_of<3>(body, interactions));
        }
        for (std::size_t a = 0; a < sum.size(); ++a) {
          const double volume = v1 * neighbours[a];  // sum of V1 over the neighbours: V_H
          EXPECT_NEAR(sum[a] / std::pow(volume, power()), 1.0, 1e-12);
        }
      };
      check(Triangles(body.points, body.model.bonds, body.setting.horizon, 1),
            std::integral_constant<int, 2>{}, 2.0);
      if (dimension == 3) {
        check(Tetrahedra(body.points, body.model.bonds, body.setting.horizon, 1),
              std::integral_constant<int, 3>{}, 6.0);
      }
    }
  }
}

TEST(EffectiveVolumes, OfTheBulkAreThoseOfAPointFarFromSurfaces) {
  tests::BoxSetting box = tests::small_box(3);
  box.extent = {7, 7, 7};
  const BoxBody body(box);
  const BulkNeighbourhood bulk =
      bulk_neighbourhood(3, body.points.spacing, body.setting.horizon, 1.0);
  EXPECT_NEAR(bulk.volume / (4.0 / 3.0 * M_PI * std::pow(body.setting.horizon, 3)), 1.0, 1e-14);
  const Tetrahedra tetrahedra(body.points, body.model.bonds, body.setting.horizon, 1);
  const std::vector<std::int32_t> neighbours = neighbour_counts(body.model.bonds);
  const auto mean = effective_volumes(tetrahedra, neighbours, bulk, InteractionWeights::mean);
  const auto constant = effective_volumes(tetrahedra, neighbours, bulk, InteractionWeights::bulk);
  int inside = 0, outside = 0;
  for (Index i = 0; i < body.points.count(); ++i) {
    EXPECT_EQ(constant[i], constant[0]);
    if (tests::is_inside(body.points, i, box, body.setting.horizon)) {
      ++inside;
      EXPECT_EQ(neighbours[i], bulk.neighbours);
      EXPECT_NEAR(mean[i] / constant[i], 1.0, 1e-14);
      EXPECT_EQ(6 * std::int64_t(tetrahedra.per_point()[i]), bulk.triplets);
    } else if (std::abs(mean[i] / constant[i] - 1.0) > 0.01) {
      ++outside;
    }
  }
  EXPECT_GT(inside, 0);
  EXPECT_GT(outside, 0);
}

}  // namespace
}  // namespace peristat
