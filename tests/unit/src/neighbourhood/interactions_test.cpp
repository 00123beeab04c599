#include "src/neighbourhood/interactions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "src/materials/effective_volumes.hpp"
#include "src/neighbourhood/neighbour_counts.hpp"
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
  LocalNeighbourhood<D> local(body.points, body.model.bonds());
  InteractionScratch scratch(UpperNeighbourhood::largest(body.model.bonds()));
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

/// On a lattice what is not flat has the full weight, to the last bit.
template <class Found, class Interactions>
void expect_full_weights(const Found& found, const Interactions& interactions) {
  for (const auto& entry : found) EXPECT_EQ(std::abs(entry.second[0]), 1.0);
  for (std::size_t a = 0; a < interactions.per_point().size(); ++a) {
    EXPECT_EQ(interactions.effective_counts()[a], double(interactions.per_point()[a]));
  }
}

TEST(Triangles, AreAllWithMutualDistancesWithinTheHorizonButCollinearOnes) {
  for (int dimension : {2, 3}) {
    const Body body(tests::small_box(dimension));
    const Triangles triangles(body.points, body.model.bonds(), body.setting.cross_section, 2);
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
    expect_full_weights(found, triangles);
  }
}

TEST(Tetrahedra, AreAllWithMutualDistancesWithinTheHorizonButCoplanarOnes) {
  const Body body(tests::small_box(3));
  const Tetrahedra tetrahedra(body.points, body.model.bonds(), body.setting.cross_section, 2);
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
  expect_full_weights(found, tetrahedra);
}

template <class AnyFound>
void expect_alike(const AnyFound& one, const AnyFound& other) {
  ASSERT_EQ(one.size(), other.size());
  double largest_weight = 0.0, largest_measure = 0.0;
  for (const auto& [points, values] : other) {
    largest_weight = std::max(largest_weight, std::abs(values[0]));
    largest_measure = std::max(largest_measure, std::abs(1.0 / values[1]));
  }
  for (auto a = one.begin(), b = other.begin(); a != one.end(); ++a, ++b) {
    ASSERT_EQ(a->first, b->first);
    EXPECT_NEAR(a->second[0], b->second[0], 1e-14 * largest_weight);
    EXPECT_NEAR(1.0 / a->second[1], 1.0 / b->second[1], 1e-14 * largest_measure);
  }
}

template <class Measure, int D>
void expect_consistent(double perturbation) {
  tests::BoxSetting box = tests::small_box(D);
  box.perturbation = perturbation;
  box.horizon_ratio = D == 2 ? 9.1 : 2.6;  // 2D: more than 64 partners, two words of bits
  if (D == 2) box.extent = {13, 12, 0};
  BoxBody body(box);
  ASSERT_GT(UpperNeighbourhood::largest(body.model.bonds()), D == 2 ? 64 : 30);
  tests::Random random(3);  // cells of every size, as of a cloud of points
  for (double& volume : body.points.volume) volume *= 1.0 + 0.3 * random.number();
  Interactions<Measure> interactions(body.points, body.model.bonds(), body.setting.cross_section,
                                     1);
  std::vector<double> shares(body.points.volume.size());
  for (std::size_t a = 0; a < shares.size(); ++a) shares[a] = 1.0 + 0.01 * double(a);
  interactions.set_shares(shares);
  const auto found = all_of<D>(body, interactions);
  ASSERT_GT(found.size(), 1000u);

  std::vector<std::int32_t> per_point(shares.size(), 0);
  std::vector<double> effective(shares.size(), 0.0);
  int negative = 0, partly = 0;
  for (const auto& [points, values] : found) {
    double weight = 0.0, cell = 0.0;
    for (Index point : points) {
      weight += shares[point];
      cell += std::pow(body.points.volume[point] / box.cross_section, double(Measure::arms) / D) /
              double(points.size());
    }
    const double flatness = 1.0 / std::abs(values[1]) / cell, factor = flatness_factor(flatness);
    EXPECT_GT(flatness, 0.25);
    EXPECT_NEAR(std::abs(values[0]) / weight, factor, 1e-13);  // its slope is up to 3
    EXPECT_GT(values[0] * values[1], 0.0);                     // signs of weight and measure agree
    for (Index point : points) {
      ++per_point[point];
      effective[point] += factor;
    }
    negative += values[0] < 0.0;
    partly += factor < 1.0;
  }
  EXPECT_EQ(partly > 10, perturbation > 0.0);
  EXPECT_EQ(interactions.per_point(), per_point);
  for (std::size_t a = 0; a < effective.size(); ++a) {
    EXPECT_NEAR(interactions.effective_counts()[a], effective[a], 1e-12 * effective[a]);
  }
  if (Measure::template singular_at_zero<D>) {
    EXPECT_EQ(negative, 0);
  } else {
    EXPECT_GT(negative, 0);
  }

  // Stored with any number of threads they are the same, and those that are found but for
  // round-off: the search here and the one that stores are compiled apart.
  std::optional<Found<Measure::arms + 1>> stored;
  const double bytes = interactions.stored_bytes();
  for (int threads : {1, 3}) {
    Interactions<Measure> other(body.points, body.model.bonds(), body.setting.cross_section,
                                threads);
    EXPECT_EQ(other.count(), interactions.count());
    EXPECT_EQ(other.per_point(), interactions.per_point());
    for (std::size_t a = 0; a < effective.size(); ++a) {
      EXPECT_NEAR(other.effective_counts()[a], effective[a], 1e-12 * effective[a]);
    }
    EXPECT_EQ(other.stored_bytes(), bytes);
    other.set_shares(shares);
    EXPECT_FALSE(other.is_stored());
    other.store(body.points, body.model.bonds(), threads);
    EXPECT_TRUE(other.is_stored());
    const auto again = all_of<D>(body, other);
    expect_alike(again, found);
    if (!stored) stored = again;
    EXPECT_TRUE(again == *stored);
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
  ASSERT_EQ(body.model.bonds().count(), 1);
  EXPECT_EQ(Triangles(body.points, body.model.bonds(), body.setting.cross_section, 2).count(), 0);
  EXPECT_EQ(Tetrahedra(body.points, body.model.bonds(), body.setting.cross_section, 2).count(), 0);
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
      const std::vector<std::int32_t> neighbours = neighbour_counts(body.model.bonds());
      const double v1 = effective_neighbour_volume(bulk);
      const auto check = [&](const auto& interactions, auto power, double orders) {
        const std::vector<double> effective =
            effective_volumes(interactions, neighbours, bulk, InteractionWeights::mean);
        std::vector<double> sum(effective.size(), 0.0);
        const auto add = [&](const auto& found) {
          ASSERT_GT(found.size(), 0u);
          for (const auto& entry : found) {
            const double factor = std::abs(entry.second[0]);
            for (Index point : entry.first) sum[point] += orders * factor * effective[point];
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
      check(Triangles(body.points, body.model.bonds(), body.setting.cross_section, 1),
            std::integral_constant<int, 2>{}, 2.0);
      if (dimension == 3) {
        check(Tetrahedra(body.points, body.model.bonds(), body.setting.cross_section, 1),
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
  const Tetrahedra tetrahedra(body.points, body.model.bonds(), body.setting.cross_section, 1);
  const std::vector<std::int32_t> neighbours = neighbour_counts(body.model.bonds());
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

// ---- Almost collinear and coplanar points

TEST(FlatnessFactor, RisesOnceDifferentiablyFromNothingToOne) {
  EXPECT_EQ(flatness_factor(0.0), 0.0);
  EXPECT_EQ(flatness_factor(0.25), 0.0);
  EXPECT_EQ(flatness_factor(0.5), 0.5);
  EXPECT_EQ(flatness_factor(0.75), 1.0);
  EXPECT_EQ(flatness_factor(1e9), 1.0);
  double before = 0.0;
  for (double t = 0.25; t < 0.76; t += 1e-3) {
    EXPECT_GE(flatness_factor(t), before);
    before = flatness_factor(t);
  }
  constexpr double h = 1e-5;  // the slope at the ends falls with the step
  EXPECT_LT(flatness_factor(0.25 + h), 20.0 * h * h);
  EXPECT_LT(1.0 - flatness_factor(0.75 - h), 20.0 * h * h);
  EXPECT_EQ(cell_measure(0.5 * 0.04, 0.5, 2, 2), 0.04);
  EXPECT_NEAR(cell_measure(0.008, 1.0, 2, 3), 0.04, 1e-16);
  EXPECT_NEAR(cell_measure(0.008, 1.0, 3, 3), 0.008, 1e-17);
}

/// What a body stores, pulls and counts under one displacement of its points.
std::vector<double> state_of(const BoxBody& body) {
  Assembler assembler(body.points, body.model, 1);
  const std::vector<double> displacement = tests::Random(5).vector(body.dofs(), 0.004);
  std::vector<double> all(body.dofs());
  const double energy = assembler.gradient(displacement, all).energy;
  const double scale = tests::norm(all);
  for (double& entry : all) entry /= scale;
  all.push_back(energy / (scale * 0.004));
  if (const SimplexTerm* const simplices = body.simplex_term()) {
    simplices->for_each_kind([&](const auto& kind) {
      for (const double count : kind.interactions.effective_counts()) all.push_back(count / 10.0);
    });
  }
  return all;
}

/// A small lattice within one horizon, so that no bond comes or goes, whose middle point moves
/// through the lines and planes of the others. Largest second differences of everything, as it
/// moves in steps.
double largest_second_difference(int dimension, bool tetrahedra, int steps) {
  tests::BoxSetting box = tests::small_box(dimension);
  box.spacing = 0.04;
  box.extent = {3, 3, dimension == 3 ? 2 : 0};
  const Points lattice = tests::box_points(box);
  box.spacing = 0.1;  // horizon 0.2 m
  (tetrahedra ? box.tetrahedra : box.triangles) = 1.0;
  std::array<std::vector<double>, 3> last;
  double most = 0.0;
  int changes = 0;
  Offset count = -1;
  for (int k = 0; k <= steps; ++k) {
    Points points = lattice;
    const double way = 0.9 * 0.04 * double(k) / steps;
    double* middle = &points.reference[4 * std::size_t(dimension)];
    middle[0] += way;
    middle[1] += 0.43 * way;
    if (dimension == 3) middle[2] += 0.61 * way;
    const BoxBody body(points, box);
    const Offset present = body.simplex_term()->counts().front().count;
    changes += present != count;
    count = present;
    last = {last[1], last[2], state_of(body)};
    for (std::size_t i = 0; i < last[0].size(); ++i) {
      most = std::max(most, std::abs(last[0][i] - 2.0 * last[1][i] + last[2][i]));
    }
  }
  EXPECT_GE(changes, 4);  // interactions have come and gone on the way
  return most;
}

// A jump leaves the second differences as they are when the steps get shorter, and a kink makes
// them fall with the step. Those of a function with a continuous slope and a bounded curvature fall
// with its square.
TEST(FlatInteractions, ComeAndGoWithoutJumpOrKink) {
  for (const auto& [dimension, tetrahedra] :
       {std::pair{2, false}, std::pair{3, false}, std::pair{3, true}}) {
    const int steps = dimension == 2 ? 200 : 60;
    const double coarse = largest_second_difference(dimension, tetrahedra, steps);
    const double fine = largest_second_difference(dimension, tetrahedra, 4 * steps);
    EXPECT_GT(coarse, 0.0);
    EXPECT_LT(fine, coarse / 11.0) << dimension << "D" << (tetrahedra ? ", tetrahedra" : "");
  }
}

// The last triangle of a point takes its weight along as it gets flat: the effective volume of a
// point without any full one is not shared among what is left.
TEST(FlatInteractions, OfAPointWithoutOthersVanish) {
  const std::vector<double> pulled{0.0, 0.0, 0.01, 0.0, 0.0, 0.0};  // areas grow by a tenth
  double first = 0.0, last = 0.0;
  for (const double height : {0.26, 0.3, 0.5, 0.7, 0.75, 1.0}) {
    tests::BoxSetting box = tests::small_box(2);
    box.triangles = 1.0;
    Points points;
    points.dimension = 2;
    points.spacing = box.spacing;
    points.volume.assign(3, box.spacing * box.spacing * box.cross_section);
    points.reference = {0.0, 0.0, 0.1, 0.0, 0.0, height * 0.1};
    const BoxBody body(points, box);
    const Model bonds_alone = body.bonds_alone();
    const double energy = Assembler(body.points, body.model, 1).energy(pulled).energy -
                          Assembler(body.points, bonds_alone, 1).energy(pulled).energy;
    EXPECT_GT(energy, last);
    last = energy;
    if (first == 0.0) first = energy;
  }
  EXPECT_LT(first, 0.005 * last);
}

}  // namespace
}  // namespace peristat
