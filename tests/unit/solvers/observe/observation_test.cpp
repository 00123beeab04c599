// What a program reads from a state through the library.
#include "solvers/observe/observation.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "cases/runner/setup/peristat.hpp"

namespace peristat {
namespace {

constexpr double spacing = 0.1, modulus = 3.0;
constexpr double along = 1e-4, across = -2e-5;  // strains

Lattice square() {
  Lattice lattice;
  lattice.spacing = spacing;
  lattice.cross_section = 0.5;
  lattice.shapes = {{ShapeStep::Action::add, Box{{-0.8, -0.8}, {0.8, 0.8}}}};
  return lattice;
}

/// Sets all points, the border four points deep, and the rest of the body.
Points with_sets(Points points) {
  for (Index i = 0; i < points.count(); ++i) {
    const Coordinates at = points.position(i);
    const bool is_inside = std::max(std::abs(at[0]), std::abs(at[1])) < 0.4;
    points.sets["all"].push_back(i);
    points.sets[is_inside ? "middle" : "border"].push_back(i);
  }
  return points;
}

BodySpecification stretched() {
  BodySpecification of;
  of.horizon = 0.3015;
  of.material.youngs_modulus = modulus;
  of.supports = {{"border", {"1e-4*x*load", "-2e-5*y*load"}}};
  return of;
}

/// A plate whose border moves as in a state of uniform strain: all of it then does.
class UniformStrain : public testing::Test {
 protected:
  const std::unique_ptr<const Body> body =
      make_body(with_sets(make_points(square())), stretched(), 1);
  const StudyResult result = solve(*body, {.loading = {.steps = 1}, .threads = 1});
  Observation observed{*body, result.state, 1};

  double middle_of(const std::string& field, const std::string& component = "") {
    ProbeSpecification probe;
    probe.set = "middle";
    probe.field = field;
    probe.component = component;
    return probe_values(probe, observed).at(0);
  }
};

TEST_F(UniformStrain, HasTheStrainAndStressOfTheClosedForm) {
  ASSERT_EQ(result.outcome, Outcome::converged);
  const double strain_x = along + 0.5 * along * along, strain_y = across + 0.5 * across * across;
  EXPECT_NEAR(middle_of("strain", "xx"), strain_x, 1e-12);
  EXPECT_NEAR(middle_of("strain", "yy"), strain_y, 1e-12);
  EXPECT_NEAR(middle_of("strain", "xy"), 0.0, 1e-12);
  EXPECT_NEAR(middle_of("divergence"), along + across, 1e-12);
  EXPECT_NEAR(middle_of("missing_neighbourhood"), 0.0, 1e-12);
  // Plane stress with Poisson's ratio 1/3; the sum over a lattice's bonds differs by some percent.
  const double stiffness = modulus / (1.0 - 1.0 / 9.0);
  const double stress_x = stiffness * (along + across / 3.0);
  EXPECT_NEAR(middle_of("stress", "xx"), stress_x, 0.05 * stress_x);
  // But the energy is exactly that of this stress, up to the square of the strain.
  const double energy =
      0.5 * (middle_of("stress", "xx") * along + middle_of("stress", "yy") * across);
  EXPECT_NEAR(middle_of("energy_density"), energy, 1e-3 * energy);
}

TEST_F(UniformStrain, IsReadAtPlacesAndAlongLines) {
  ProbeSpecification probe;
  probe.at = Coordinates{0.25, -0.15, 0.0};
  const std::vector<double> moved = probe_values(probe, observed);
  EXPECT_NEAR(moved.at(0), along * 0.25, 1e-13);
  EXPECT_NEAR(moved.at(1), across * -0.15, 1e-13);
  probe.at.reset();
  probe.from = Coordinates{-0.8, 0.05, 0.0};
  probe.to = Coordinates{0.8, 0.05, 0.0};
  const std::vector<LineValues> line = line_values(probe, observed.points(), observed.computed());
  ASSERT_EQ(line.size(), 16u);
  for (const LineValues& point : line) {
    EXPECT_NEAR(point.reference[0], point.distance - 0.8, 1e-12);
    EXPECT_NEAR(point.values.at(0), along * point.reference[0], 1e-13);
  }
}

TEST_F(UniformStrain, HasForcesOnlyWhereTheyAreNotInBalance) {
  const std::vector<double>& force = observed.values("force");
  ASSERT_EQ(force.size(), 2 * body->points.volume.size());
  double largest = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < force.size(); ++k) {
    largest = std::max(largest, std::abs(force[k]));
    if (k % 2 == 0) sum += force[k];
  }
  EXPECT_NEAR(sum, 0.0, 1e-9 * largest);
  for (const Index point : body->points.sets.at("middle")) {
    EXPECT_NEAR(force[2 * std::size_t(point)], 0.0, 1e-6 * largest);
  }
  // A state's force balances the reaction of the support.
  double held = 0.0;
  for (const Index point : body->points.sets.at("border")) {
    if (body->points.position(point)[0] > 0.0) held += force[2 * std::size_t(point)];
  }
  EXPECT_LT(held, 0.0);
}

TEST_F(UniformStrain, ReadsEveryFieldOfABodyAtRest) {
  for (const PointField& field : point_fields()) {
    if (field.needs == FieldNeeds::motion) {
      EXPECT_THROW(static_cast<void>(observed.values(field.name)), InputError);
      continue;
    }
    std::size_t width = 1;
    for (const std::uint64_t extent : field.extents(2)) width *= extent;
    EXPECT_EQ(observed.values(field.name).size(), width * body->points.volume.size()) << field.name;
  }
  EXPECT_EQ(observed.computed().size(), point_fields().size() - 2);
}

TEST_F(UniformStrain, RefusesProbesThatItCannotAnswer) {
  const auto refused_key = [&](const std::function<void(ProbeSpecification&)>& change) {
    ProbeSpecification probe;
    probe.set = "middle";
    change(probe);
    try {
      static_cast<void>(probe_values(probe, observed));
    } catch (const InputError& error) {
      return error.key();
    }
    return std::string("none");
  };
  EXPECT_EQ(refused_key([](auto&) {}), "none");
  EXPECT_EQ(refused_key([](auto& probe) { probe.field = "stres"; }), "field");
  EXPECT_EQ(refused_key([](auto& probe) { probe.field = "velocity"; }), "field");
  EXPECT_EQ(refused_key([](auto& probe) { probe.set = "midle"; }), "set");
  EXPECT_EQ(refused_key([](auto& probe) { probe.set = "", probe.field = "crack_length"; }), "set");
  EXPECT_EQ(refused_key([](auto& probe) { probe.field = "opening"; }), "other");
  EXPECT_EQ(refused_key([](auto& probe) { probe.component = "z"; }), "component");
  EXPECT_EQ(refused_key([](auto& probe) { probe.axis = 2; }), "axis");
  EXPECT_EQ(refused_key([](auto& probe) { probe.at = Coordinates{5.0, 0.0, 0.0}; }), "probe[0].at");
  EXPECT_EQ(refused_key([](auto& probe) { probe.statistic = Statistic::rms_error; }), "expected");
}

TEST(Cracks, HaveTheirLengthInASolvedState) {
  BodySpecification of = stretched();
  of.cracks = {CrackSegment{{-0.3, 0.0, 0.0}, {0.45, 0.0, 0.0}}};
  const auto body = make_body(with_sets(make_points(square())), of, 1);
  const StudyResult result = solve(*body, {.loading = {.steps = 1}, .threads = 1});
  ASSERT_EQ(result.outcome, Outcome::converged);
  Observation observed(*body, result.state, 1);
  SeparatedBonds separated(*body);
  EXPECT_TRUE(separated.add_broken(result.state.history).empty());
  ProbeSpecification probe;
  probe.set = "all";
  const auto measured = [&](const std::string& field) {
    probe.field = field;
    return probe_values(probe, observed, separated.cracks(result.steps.back())).at(0);
  };
  EXPECT_NEAR(measured("crack_length"), 0.75, spacing);
  EXPECT_NEAR(measured("crack_end"), 0.45, spacing);
  EXPECT_NEAR(measured("crack_area"), 0.75 * 0.5, spacing * 0.5);
  EXPECT_NEAR(measured("crack_angle"), 0.0, 1e-9);
}

}  // namespace
}  // namespace peristat
