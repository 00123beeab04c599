#include "assembly/convolutions/forces_with_images.hpp"

#include "assembly/convolutions/correspondence.hpp"
#include "assembly/convolutions/green_bonds.hpp"
#include "assembly/convolutions/linear_bonds.hpp"
#include "assembly/convolutions/linear_solid.hpp"
#include "src/constraints/constraints.hpp"
#include "tests/lattice_systems.hpp"

namespace peristat {
namespace {

using tests::ForcesAndEnergies;
using tests::HoledBody;
using tests::open;

/// What a law's forces are made of: box, periodic axes, neighbours, own points.
struct Law {
  std::string name;
  std::function<std::unique_ptr<LatticeForces>(const HoledBody& of, const LatticeBox& box,
                                               const std::array<bool, 3>& is_periodic,
                                               std::size_t own)>
      make;
};

template <class Pairs>
Law of_pairs(const std::string& name) {
  return {name, [](const HoledBody& of, const LatticeBox& box,
                   const std::array<bool, 3>& is_periodic, std::size_t own) {
            const auto make = [&]() -> std::unique_ptr<LatticeForces> {
              return std::make_unique<Pairs>(
                  box, is_periodic,
                  lattice_springs(of.kernel, of.points.spacing, 0.0, 2.3, of.volume()), 1);
            };
            if (own == box.place.size()) return make();
            return std::unique_ptr<LatticeForces>(
                std::make_unique<ForcesWithImages>(make(), make(), box.place.size(), own));
          }};
}

std::vector<Law> laws() {
  return {of_pairs<LinearBonds>("bonds"),
          of_pairs<GreenBonds>("Green bonds"),
          {"solid",
           [](const HoledBody& of, const LatticeBox& box, const std::array<bool, 3>& is_periodic,
              std::size_t own) -> std::unique_ptr<LatticeForces> {
             return std::make_unique<LinearSolid>(
                 box, is_periodic, of.arms(),
                 LinearSolid::Setting{{1.7, 0.9}, of.volume(), SolidForces::energy, own}, 1);
           }},
          {"correspondence",
           [](const HoledBody& of, const LatticeBox& box, const std::array<bool, 3>& is_periodic,
              std::size_t own) -> std::unique_ptr<LatticeForces> {
             return std::make_unique<Correspondence>(
                 box, is_periodic, of.arms(),
                 Correspondence::Setting{{1.7, 0.9}, of.volume(), 3.0 / of.volume(), own}, 1);
           }}};
}

/// A body with a hole, and with the images of its points beyond planes and periods.
struct ImagedBody {
  HoledBody own;
  Points points;
  LatticeBox box;
  Constraints constraints;

  ImagedBody(const tests::HoledSetting& setting, const std::vector<SymmetryPlane>& planes,
             const std::vector<Period>& periods)
      : own(setting), points(with_images_of(own, planes, periods)), constraints(points) {
    std::string why_not;
    box = lattice_box(points, why_not).value();
  }

  static Points with_images_of(const HoledBody& body, const std::vector<SymmetryPlane>& planes,
                               const std::vector<Period>& periods) {
    Points points = body.points;
    const double half_a_cell = 0.5 * points.spacing;
    add_images(points, planes, periods, body.kernel.horizon + half_a_cell);
    return points;
  }

  [[nodiscard]] std::vector<double> images_of(const std::vector<double>& field) const {
    std::vector<double> all(field);
    for (Index i = points.own(); i < points.count(); ++i) {
      all.push_back(field[std::size_t(points.source(i))]);
    }
    return all;
  }

  /// Displacements of all points, from those of its own and the jumps.
  [[nodiscard]] std::vector<double> displaced(const std::vector<double>& of_own,
                                              const std::vector<double>& jumps) const {
    std::vector<double> u(of_own);
    u.resize(points.reference.size());
    u.insert(u.end(), jumps.begin(), jumps.end());
    u.resize(constraints.dofs());
    constraints.move(u);
    return u;
  }

  [[nodiscard]] std::vector<double> of_points(std::vector<double> u) const {
    u.resize(points.reference.size());
    return u;
  }

  /// Forces on its own points and on the jumps; energies of its own points.
  [[nodiscard]] ForcesAndEnergies folded(LatticeForces& forces,
                                         const std::vector<double>& u) const {
    ForcesAndEnergies found = tests::evaluate(forces, of_points(u), std::size_t(points.count()));
    found.force.resize(u.size());
    std::fill(found.force.begin() + std::ptrdiff_t(points.reference.size()), found.force.end(),
              0.0);
    constraints.fold_images(found.force);
    found.force.erase(found.force.begin() + std::ptrdiff_t(own.points.reference.size()),
                      found.force.begin() + std::ptrdiff_t(points.reference.size()));
    for (Index i = points.own(); i < points.count(); ++i) {
      found.energy[std::size_t(points.source(i))] += found.energy[std::size_t(i)];
    }
    found.energy.resize(own.count());
    return found;
  }
};

/// Every axis is longer than two horizons, so that no point sees another one twice.
std::vector<tests::HoledSetting> settings() {
  return {{{13, 10}, 3.015, VolumeCorrection::linear}, {{7, 6, 9}, 2.015}};
}

double length_of(const HoledBody& body, int axis, const tests::HoledSetting& setting) {
  return setting.counts[std::size_t(axis)] * body.points.spacing.along(axis);
}

TEST(ForcesWithImages, AreThoseOfThePeriodicLattice) {
  for (const tests::HoledSetting& setting : settings()) {
    const HoledBody alone(setting);
    const ImagedBody body(
        setting, {},
        {{0, 0.0, length_of(alone, 0, setting)}, {1, 0.0, length_of(alone, 1, setting)}});
    const std::vector<double> u = alone.random(5), q = alone.mask();
    const std::vector<double> all = body.displaced(u, {});
    for (const Law& law : laws()) {
      SCOPED_TRACE(law.name);
      const auto periodic = law.make(alone, alone.box, {true, true, false}, alone.count());
      const auto imaged = law.make(alone, body.box, open, alone.count());
      for (const std::vector<double>& integrity : {std::vector<double>(alone.count(), 1.0), q}) {
        periodic->set_integrity(integrity);
        imaged->set_integrity(body.images_of(integrity));
        ForcesAndEnergies found = body.folded(*imaged, all);
        found.force.resize(u.size());
        tests::expect_equal(found, tests::evaluate(*periodic, u, alone.count()), 1e-13);
      }
    }
  }
}

/// With jumps over a period and a plane of symmetry: forces are what energies say, and products
/// and virials are those of the forces.
TEST(ForcesWithImages, AreMinusTheDerivativeOfTheEnergyOfTheBodyAlone) {
  for (const tests::HoledSetting& setting : settings()) {
    const HoledBody alone(setting);
    const ImagedBody body(setting, {{1, 0.0}}, {{0, 0.0, length_of(alone, 0, setting)}});
    const auto d = std::size_t(alone.dimension());
    const std::vector<double> jump = tests::Random(8).vector(d, 0.05),
                              change = tests::Random(9).vector(d, 0.05);
    const std::vector<double> u = body.displaced(alone.random(5), jump),
                              v = body.displaced(alone.random(6), change);
    for (const Law& law : laws()) {
      SCOPED_TRACE(law.name);
      const auto forces = law.make(alone, body.box, open, alone.count());
      forces->set_integrity(body.images_of(alone.mask()));
      const auto energy = [&](double step) {
        return body.folded(*forces, tests::moved(u, step, v)).total();
      };
      const double slope =
          (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / 12.0;
      const std::vector<double> force = body.folded(*forces, u).force;
      double work = 0.0, size = 0.0;
      for (std::size_t k = 0; k < force.size(); ++k) {
        const double moved =
            k < alone.points.reference.size()
                ? v[k]
                : v[k + body.points.reference.size() - alone.points.reference.size()];
        work -= force[k] * moved;
        size += std::abs(force[k] * moved);
      }
      ASSERT_GT(size, 0.0);
      EXPECT_NEAR(slope, work, 1e-11 * size);
      const auto count = std::size_t(body.points.count());
      tests::expect_tangent_of_forces(*forces, body.of_points(u), body.of_points(v), count);
      tests::expect_symmetric_tangent(*forces, body.of_points(u), body.of_points(v),
                                      body.of_points(body.displaced(alone.random(7), jump)));
    }
  }
}

/// The half beyond a plane of symmetry is there to see.
TEST(ForcesWithImages, AreThoseOfTheBodyThatThePlaneMirrors) {
  const tests::HoledSetting setting = settings().front();
  const HoledBody alone(setting);
  const ImagedBody body(setting, {{0, 0.0}}, {});
  Points both = alone.points;
  std::vector<double> u = alone.random(5);
  const std::vector<double> all = body.displaced(u, {});
  for (Index i = 0; i < alone.points.count(); ++i) {
    const Coordinates at = alone.points.position(i);
    both.reference.insert(both.reference.end(), {-at[0], at[1]});
    both.volume.push_back(alone.volume());
    u.insert(u.end(), {-u[std::size_t(i) * 2], u[std::size_t(i) * 2 + 1]});
  }
  std::string why_not;
  const LatticeBox box = lattice_box(both, why_not).value();
  for (const Law& law : laws()) {
    SCOPED_TRACE(law.name);
    const auto whole = law.make(alone, box, open, box.place.size());
    const auto imaged = law.make(alone, body.box, open, alone.count());
    ForcesAndEnergies expected = tests::evaluate(*whole, u, box.place.size());
    expected.force.resize(alone.points.reference.size());
    expected.energy.resize(alone.count());
    ForcesAndEnergies found = body.folded(*imaged, all);
    tests::expect_equal(found, expected, 1e-13);
    // Virials, too, with those that images hand back to their sources.
    std::vector<double> of_whole(box.place.size() * 4),
        of_all(std::size_t(body.points.count()) * 4);
    whole->add_virials(u, of_whole);
    imaged->add_virials(body.of_points(all), of_all);
    for (Index i = body.points.own(); i < body.points.count(); ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const double sign = k == 1 || k == 2 ? -1.0 : 1.0;
        of_all[std::size_t(body.points.source(i)) * 4 + k] += sign * of_all[std::size_t(i) * 4 + k];
      }
    }
    of_all.resize(alone.count() * 4);
    of_whole.resize(alone.count() * 4);
    ASSERT_GT(tests::norm(of_whole), 0.0);
    EXPECT_LE(tests::distance(of_all, of_whole), 1e-12 * tests::norm(of_whole));
  }
}

}  // namespace
}  // namespace peristat
