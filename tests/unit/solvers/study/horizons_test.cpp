/// Horizons of points: the energy by its definition, one horizon as a special case, and refusals.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "solvers/body/body.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/fracture_data.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/point_sizes.hpp"
#include "src/neighbourhood/influence.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

constexpr double section = 0.5, ratio = 2.3;

/// Points at random whose sizes grow by a factor of four along x.
Points graded_cloud(int dimension) {
  tests::Random random(11);
  Points points;
  points.dimension = dimension;
  const int rows = dimension == 1 ? 40 : dimension == 2 ? 12 : 7;
  for (double x = 0.0, size = 0.1; size <= 0.4; x += size, size *= 1.13) {
    for (int k = 0; k < (dimension > 1 ? rows : 1); ++k) {
      for (int l = 0; l < (dimension > 2 ? rows : 1); ++l) {
        const double at[] = {x + 0.2 * size * random.number(),
                             size * (k + 0.5 + 0.2 * random.number()),
                             size * (l + 0.5 + 0.2 * random.number())};
        points.reference.insert(points.reference.end(), at, at + dimension);
        points.volume.push_back((1.0 + 0.1 * random.number()) * std::pow(size, dimension) *
                                (dimension == 3 ? 1.0 : section));
      }
    }
  }
  double mean = 0.0;
  for (const double volume : points.volume) mean += volume / double(points.volume.size());
  points.spacing = std::pow(mean / (dimension == 3 ? 1.0 : section), 1.0 / dimension);
  return points;
}

BodySpecification with_ratio(int dimension) {
  BodySpecification of;
  of.horizon_per_size = ratio;
  if (dimension < 3) of.cross_section = section;
  of.material.youngs_modulus = 3.0;
  return of;
}

/// sum_i V_i W_i with W_i = 1/2 sum_j c(delta_i) omega nu_ij r s^2 / 2 V_j over the points within
/// its own horizon.
double defined_energy(const Points& points, const BodySpecification& of,
                      const std::vector<double>& displacement) {
  const int d = points.dimension;
  const double cross_section = d == 3 ? 1.0 : section;
  double energy = 0.0;
  for (Index i = 0; i < points.count(); ++i) {
    BondSetting own;
    own.dimension = d;
    own.cross_section = cross_section;
    own.influence = influence_named(of.material.influence);
    own.horizon = of.horizon_per_size * std::pow(points.volume[i] / cross_section, 1.0 / d);
    const double c = micromodulus(*of.material.youngs_modulus, own);
    for (Index j = 0; j < points.count(); ++j) {
      if (i == j) continue;
      double length = 0.0, now = 0.0;
      for (int k = 0; k < d; ++k) {
        const double arm = points.reference[j * d + k] - points.reference[i * d + k];
        const double moved = arm + displacement[j * d + k] - displacement[i * d + k];
        length += arm * arm;
        now += moved * moved;
      }
      length = std::sqrt(length);
      const double stretch = std::sqrt(now) / length - 1.0;
      const double size = std::pow(points.volume[j] / cross_section, 1.0 / d);
      const double share = of.volume_correction == VolumeCorrection::linear
                               ? linear_partial_volume(length, own.horizon, size)
                               : double(length <= own.horizon);
      if (share == 0.0) continue;
      const double omega = own.influence ? own.influence(length / own.horizon) : 1.0;
      energy += 0.25 * points.volume[i] * points.volume[j] * share * omega * c * length * stretch *
                stretch;
    }
  }
  return energy;
}

TEST(HorizonsOfPoints, GiveTheSumOverDirectedBonds) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const VolumeCorrection correction : {VolumeCorrection::none, VolumeCorrection::linear}) {
      for (const char* const influence : {"constant", "linear", "inverse"}) {
        SCOPED_TRACE(::testing::Message() << dimension << "D " << influence << int(correction));
        BodySpecification of = with_ratio(dimension);
        of.volume_correction = correction;
        of.material.influence = influence;
        const auto body = make_body(graded_cloud(dimension), of, 2);
        Assembler assembler(body->points, body->model, 2);
        const std::vector<double> moved =
            tests::Random(5).vector(body->points.reference.size(), 0.02);
        std::vector<double> gradient(moved.size());
        const double energy = assembler.gradient({moved, {}}, gradient).energy;
        const double defined = defined_energy(body->points, of, moved);
        EXPECT_GT(defined, 0.0);
        EXPECT_NEAR(energy / defined, 1.0, 1e-12);  // a sum of some thousand bonds
        // Forces come in pairs.
        for (int c = 0; c < dimension; ++c) {
          double sum = 0.0, magnitude = 0.0;
          for (std::size_t k = std::size_t(c); k < gradient.size(); k += std::size_t(dimension)) {
            sum += gradient[k];
            magnitude += std::abs(gradient[k]);
          }
          EXPECT_GT(magnitude, 0.0);
          EXPECT_LT(std::abs(sum), 1e-13 * magnitude);
        }
      }
    }
  }
}

/// A square lattice as a cloud.
Points even_cloud(int dimension) {
  tests::BoxSetting box = tests::small_box(dimension);
  Points points = tests::box_points(box);
  points.lattice.reset();
  return points;
}

TEST(HorizonsOfPoints, ThatAreEqualGiveTheBodyOfOneHorizon) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const VolumeCorrection volume : {VolumeCorrection::none, VolumeCorrection::linear}) {
      for (const SurfaceCorrection surface :
           {SurfaceCorrection::none, SurfaceCorrection::volume, SurfaceCorrection::energy}) {
        BodySpecification one = with_ratio(dimension), own = one;
        one.horizon_per_size = 0.0;
        one.horizon = ratio * 0.1;
        for (BodySpecification* const of : {&one, &own}) {
          of->volume_correction = volume;
          of->surface_correction = surface;
          of->material.damage.law = DamageLaw::linear;
          of->material.damage.fracture_energy = 1e-4;
        }
        const auto of_one = make_body(even_cloud(dimension), one, 1);
        const auto of_own = make_body(even_cloud(dimension), own, 1);
        const Bonds &expected = of_one->model.bonds(), &bonds = of_own->model.bonds();
        ASSERT_GT(bonds.count(), 0);
        ASSERT_EQ(tests::upper_points(bonds), tests::upper_points(expected));
        ASSERT_EQ(bonds.offset, expected.offset);
        const auto& law =
            std::get<Degraded<ForceEnvelope, Harmonic>>(of_one->model.bond_failure()->potential());
        const auto& laws =
            std::get<DegradedByBond<Harmonic>>(of_own->model.bond_failure()->potential());
        for (Offset bond = 0; bond < bonds.count(); ++bond) {
          ASSERT_NEAR(bonds.weight(bond) / expected.weight(bond), 1.0, 1e-12);
          const AnyBondLaw found = laws.laws->at(bond);
          ASSERT_NEAR(found.critical() / law.law.critical(), 1.0, 1e-12);
          ASSERT_NEAR(found.onset() / law.law.onset(), 1.0, 1e-12);
        }
      }
    }
  }
}

TEST(HorizonsOfPoints, AreThoseOfTheirSizes) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const auto body = make_body(graded_cloud(dimension), with_ratio(dimension), 1);
    const Points& points = body->points;
    ASSERT_EQ(points.horizons.size(), points.volume.size());
    for (Index i = 0; i < points.count(); ++i) {
      const double volume = points.volume[i] / (dimension == 3 ? 1.0 : section);
      EXPECT_NEAR(std::pow(points.horizons[i] / ratio, dimension) / volume, 1.0, 1e-13);
    }
    EXPECT_EQ(body->setting.horizon, largest_horizon(points));
    EXPECT_NEAR(body->horizon_ratio(), ratio, 1e-12);
  }
}

/// The same horizons, given point by point.
TEST(HorizonsOfPoints, MayBeGivenByUsersOfTheLibrary) {
  const BodySpecification by_ratio = with_ratio(2);
  Points points = graded_cloud(2);
  const auto expected = make_body(points, by_ratio, 1);
  points.horizons = horizons_of_sizes(points, ratio, section);
  BodySpecification of = by_ratio;
  of.horizon_per_size = 0.0;
  of.horizon = largest_horizon(points);
  const auto body = make_body(points, of, 1);
  EXPECT_EQ(tests::kinds(body->model.bonds()), tests::kinds(expected->model.bonds()));
  EXPECT_GT(body->model.bonds().count(), 100);
}

/// Beyond a plane of symmetry stand the images of points, with their horizons.
TEST(HorizonsOfPoints, AreThoseOfImagesToo) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const SurfaceCorrection surface : {SurfaceCorrection::none, SurfaceCorrection::volume}) {
      // The largest points, most of all beyond the mean spacing, are next to the plane.
      const Points half = graded_cloud(dimension);
      const auto d = std::size_t(dimension);
      double plane = 0.0;
      for (std::size_t k = 0; k < half.reference.size(); k += d) {
        plane = std::max(plane, half.reference[k] + 0.2);
      }
      const std::vector<double> moved = tests::Random(3).vector(half.reference.size(), 0.01);
      Points whole = half;
      std::vector<double> of_whole = moved;
      for (Index i = 0; i < half.count(); ++i) {
        for (std::size_t c = 0; c < d; ++c) {
          const double at = half.reference[std::size_t(i) * d + c];
          whole.reference.push_back(c == 0 ? 2.0 * plane - at : at);
          of_whole.push_back((c == 0 ? -1.0 : 1.0) * moved[std::size_t(i) * d + c]);
        }
        whole.volume.push_back(half.volume[std::size_t(i)]);
      }
      BodySpecification of = with_ratio(dimension);
      of.volume_correction = VolumeCorrection::linear;
      of.surface_correction = surface;
      const auto expected = make_body(whole, of, 1);
      of.constraints.symmetries = {{0, plane}};
      const auto body = make_body(half, of, 1);
      ASSERT_GT(body->points.count(), body->points.own());
      std::vector<double> with_images = moved;
      for (Index image = body->points.own(); image < body->points.count(); ++image) {
        const Index source = body->points.source(image);
        for (std::size_t c = 0; c < d; ++c) {
          with_images.push_back((c == 0 ? -1.0 : 1.0) * moved[std::size_t(source) * d + c]);
        }
      }
      const double energy =
          Assembler(body->points, body->model, 1).energy({with_images, {}}).energy;
      const double twice =
          Assembler(expected->points, expected->model, 1).energy({of_whole, {}}).energy;
      EXPECT_GT(twice, 0.0);
      EXPECT_NEAR(2.0 * energy / twice, 1.0, 1e-12) << dimension << "D";
    }
  }
}

InputError refusal(Points points, const BodySpecification& of) {
  try {
    static_cast<void>(make_body(std::move(points), of, 1));
  } catch (const InputError& error) {
    return error;
  }
  return {"", "", "is accepted"};
}

TEST(HorizonsOfPoints, AreRefusedWhereOneNumberIsNeeded) {
  struct Rule {
    const char* key;
    void (*change)(BodySpecification&);
  };
  const Rule rules[] = {
      {"material.micromodulus",
       [](auto& of) {
         of.material.youngs_modulus.reset();
         of.material.micromodulus = 1.0;
       }},
      {"material.calibration", [](auto& of) { of.material.calibration = Calibration::lattice; }},
      {"material.damage.law",
       [](auto& of) {
         of.material.kinematics = Kinematics::linear;
         of.material.damage.law = DamageLaw::energy_density;
         of.material.damage.fracture_energy = 1.0;
       }},
      {"material.damage.strength",
       [](auto& of) {
         of.material.damage.law = DamageLaw::blended;
         of.material.damage.fracture_energy = 1.0;
         of.material.damage.strength = 1e-3;
       }},
      {"material.damage.onset",
       [](auto& of) {
         of.material.damage.law = DamageLaw::blended;
         of.material.damage.fracture_energy = 1.0;
         of.material.damage.onset = 1e-3;
         of.material.damage.peak = 2e-3;
       }},
      {"volume_correction", [](auto& of) { of.volume_correction = VolumeCorrection::exact; }},
      {"horizon_shape", [](auto& of) { of.horizon_shape = HorizonShape::box; }},
      {"points.horizons",
       [](auto& of) {
         of.material.model = MaterialModel::cpd;
         of.material.poisson_ratio = 0.3;
       }},
      {"horizon", [](auto& of) { of.horizon_per_size = 0.9; }},
      {"horizon", [](auto& of) { of.horizon_per_size = 1001.0; }},
      {"horizon", [](auto& of) { of.horizon_per_size = NAN; }}};
  EXPECT_EQ(refusal(graded_cloud(2), with_ratio(2)).allowed(), "is accepted");
  for (const auto& [key, change] : rules) {
    BodySpecification of = with_ratio(2);
    change(of);
    const InputError error = refusal(graded_cloud(2), of);
    EXPECT_EQ(error.key(), key) << error.what();
  }
}

TEST(HorizonsOfPoints, HaveToFitTheirPointsAndTheLargest) {
  Points points = graded_cloud(2);
  points.horizons = horizons_of_sizes(points, ratio, section);
  BodySpecification of = with_ratio(2);
  of.horizon_per_size = 0.0;
  of.horizon = 1.1 * largest_horizon(points);
  EXPECT_EQ(refusal(points, of).key(), "horizon");
  of.horizon = largest_horizon(points);
  Points few = points;
  few.horizons.pop_back();
  EXPECT_EQ(refusal(few, of).key(), "points.horizons");
  points.horizons.front() *= 0.3;
  EXPECT_EQ(refusal(points, of).key(), "points.horizons");
  points.horizons.front() = -1.0;
  EXPECT_EQ(refusal(points, of).key(), "points.horizons");
}

/// A bond that breaks releases what its two directions would at their own critical stretches.
TEST(HorizonsOfPoints, GiveBondsTheStretchOfTheirEnergy) {
  BodySpecification of = with_ratio(2);
  of.volume_correction = VolumeCorrection::linear;
  of.material.damage.law = DamageLaw::critical_stretch;
  of.material.damage.fracture_energy = 1e-3;
  const auto body = make_body(graded_cloud(2), of, 1);
  const Points& points = body->points;
  const Bonds& bonds = body->model.bonds();
  const auto& laws = std::get<DegradedByBond<Harmonic>>(body->model.bond_failure()->potential());
  double least = INFINITY, most = 0.0;
  tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
    double energy = 0.0, stiffness = 0.0;  // of both directions, over V_i V_j r
    for (const auto& [from, to] : {std::pair(i, j), std::pair(j, i)}) {
      BondSetting own = body->setting;
      own.horizon = points.horizons[from];
      const double c = micromodulus(3.0, own);
      // The shares of volumes make the bond area larger than in the continuum.
      const double area = own.cloud_moment(2, own.horizon / ratio) / own.moment(2);
      const double s = critical_stretch(1e-3 / area, c, own);
      const double size = size_of_point(points, to, section);
      const double share = linear_partial_volume(bonds.length(bond), own.horizon, size);
      stiffness += c * share;
      energy += c * share * s * s;
    }
    const double expected = std::sqrt(energy / stiffness);
    const double found = laws.laws->at(bond).critical();
    ASSERT_NEAR(found / expected, 1.0, 1e-10);
    least = std::min(least, found);
    most = std::max(most, found);
  });
  EXPECT_GT(most / least, 1.7);  // of sizes of 4 to 1: nearly 2
}

/// With a strength or an onset beside the fracture energy a bond has the law of its own horizon.
TEST(HorizonsOfPoints, GiveBondsTheStrengthOfTheirHorizon) {
  for (const auto& [law, has_strength] :
       {std::pair(DamageLaw::linear, true), std::pair(DamageLaw::exponential, false),
        std::pair(DamageLaw::tanh, false)}) {
    BodySpecification of = with_ratio(2);
    of.material.damage.law = law;
    of.material.damage.fracture_energy = 1e-3;
    if (has_strength) of.material.damage.strength = 0.03;
    if (!has_strength) of.material.damage.onset = 5e-3;
    const DamageSpecification damage = of.material.damage;
    const auto body = make_body(graded_cloud(2), of, 1);
    const Points& points = body->points;
    const Bonds& bonds = body->model.bonds();
    const auto& laws = std::get<DegradedByBond<Harmonic>>(body->model.bond_failure()->potential());
    const std::vector<double> fineness = fineness_of_bonds(points, bonds, body->setting);
    int compared = 0;
    for (Offset bond = 0; bond < bonds.count(); bond += 150, ++compared) {
      BondSetting own = body->setting;
      own.horizon /= fineness[std::size_t(bond)];
      const FractureScale scale = fracture_scale_of(of.material, "material", own, own.horizon);
      const DamageSpecification expected = with_stretches(damage, "material", scale);
      const AnyBondLaw found = laws.laws->at(bond);
      ASSERT_NEAR(found.onset() / expected.onset, 1.0, 2e-4);
      ASSERT_NEAR(found.critical() / expected.critical, 1.0, 2e-4);
      ASSERT_NEAR(found.work(Harmonic{1.0}, found.critical()) / total_work(expected), 1.0, 2e-4);
    }
    EXPECT_GT(compared, 4);
    const auto [least, most] = std::ranges::minmax(fineness);
    EXPECT_LT(least, 1.2);
    EXPECT_GT(most, 3.0);
  }
}

/// A quarter of a ring from radius 1 to 4.25 of rectangles whose sizes grow as the radius.
Points graded_ring(int along) {
  constexpr double quarter = 0.5 * std::numbers::pi, outer = 4.25;
  const double angle = quarter / along;
  const int rows = int(std::lround(std::log(outer) / angle));
  Points points;
  points.dimension = 2;
  double mean = 0.0;
  for (int k = 0; k < rows; ++k) {
    const double low = std::pow(outer, double(k) / rows), high = std::pow(outer, (k + 1.0) / rows);
    const double middle = 0.5 * (low + high), area = 0.5 * (high * high - low * low) * angle;
    for (int l = 0; l < along; ++l) {
      const double turn = (l + 0.5) * angle;
      points.reference.insert(points.reference.end(),
                              {middle * std::cos(turn), middle * std::sin(turn)});
      points.volume.push_back(area);
      mean += area / (rows * along);
    }
  }
  points.spacing = std::sqrt(mean);
  return points;
}

/// A straight cut along the gradient of sizes, across it, and between, in fine and coarse places.
TEST(HorizonsOfPoints, GiveACrackItsFractureEnergyAnywhere) {
  constexpr double fracture_energy = 10.0, middle = 0.25 * std::numbers::pi;
  const auto at = [](double radius, double turn) {
    return Coordinates{radius * std::cos(middle + turn), radius * std::sin(middle + turn), 0.0};
  };
  const std::array<std::array<Coordinates, 2>, 6> cuts{{{at(1.8, 0.003), at(3.0, 0.003)},
                                                        {at(1.6, -0.2), at(2.2, -0.2)},
                                                        {at(2.1, -0.25), at(2.1, 0.25)},
                                                        {at(2.9, -0.25), at(2.9, 0.25)},
                                                        {at(1.8, -0.15), at(3.0, 0.2)},
                                                        {at(2.0, 0.25), at(2.8, -0.25)}}};
  for (const DamageLaw law : {DamageLaw::critical_stretch, DamageLaw::linear, DamageLaw::tanh,
                              DamageLaw::exponential, DamageLaw::blended}) {
    BodySpecification of;
    of.horizon_per_size = 4.0;
    of.cross_section = 1.0;
    of.volume_correction = VolumeCorrection::linear;
    of.material.youngs_modulus = 70e9;
    of.material.damage.law = law;
    of.material.damage.fracture_energy = fracture_energy;
    const auto body = make_body(graded_ring(48), of, 2);
    const Points& points = body->points;
    const Bonds& bonds = body->model.bonds();
    const auto& laws = std::get<DegradedByBond<Harmonic>>(body->model.bond_failure()->potential());
    double mean = 0.0;
    for (const auto& [from, to] : cuts) {
      const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
      double energy = 0.0;
      tests::for_each_bond(bonds, [&](Index i, Index j, Offset bond) {
        const Coordinates a = points.position(i), b = points.position(j);
        const auto side = [&](const Coordinates& of_end) {
          return (to[0] - from[0]) * (of_end[1] - from[1]) -
                 (to[1] - from[1]) * (of_end[0] - from[0]);
        };
        const double one = side(a), other = side(b);
        if (one * other >= 0.0) return;
        const double t = one / (one - other);
        double along = 0.0;
        for (std::size_t c = 0; c < 2; ++c) {
          along += (a[c] + t * (b[c] - a[c]) - from[c]) * (to[c] - from[c]) / (length * length);
        }
        if (along <= 0.0 || along > 1.0) return;
        const AnyBondLaw of_bond = laws.laws->at(bond);
        energy += laws.modulus * bonds.weight(bond) * bonds.length(bond) *
                  of_bond.work(Harmonic{1.0}, of_bond.critical());
      });
      // The shares of `linear` beyond the horizon add 6/12 (h / delta)^2 to the second moment, in a
      // uniform cloud as well; the rest is of directions and gradients.
      EXPECT_NEAR(energy / length / fracture_energy, 1.0 + 0.5 / 16.0, 0.04) << int(law);
      mean += energy / length / fracture_energy / double(cuts.size());
    }
    EXPECT_NEAR(mean, 1.0 + 0.5 / 16.0, 0.02) << int(law);
  }
}

}  // namespace
}  // namespace peristat
