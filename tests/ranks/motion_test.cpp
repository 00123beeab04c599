#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/formulations/formulations.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "solvers/study/study.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/slab.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

/// Of waves that a velocity and a displacement of one corner begin.
BodySpecification in_motion(const RanksBody& body) {
  BodySpecification of{.horizon = body.horizon_ratio * body.lattice.spacing};
  of.material.youngs_modulus = 3.0;
  of.material.density = 2.0;
  of.end_time = 0.5;
  of.initial.push_back({"", {"0.01*exp(-20*(x-0.3)^2)", "0", "0"}, {"0.3*x", "-0.2*x*x", "0"}});
  of.absorbing.push_back({"", "x > 0.6 ? 3 : 0"});
  return of;
}

std::unique_ptr<const Body> whole_body(const RanksBody& body, const BodySpecification& of) {
  return make_body(make_points(body.lattice), of, 1);
}
std::unique_ptr<const Body> whole_body(const RanksBody& body) {
  return whole_body(body, in_motion(body));
}

std::unique_ptr<const Body> part_of(const RanksBody& body, const BodySpecification& of) {
  Part slab = make_slab(body.lattice, all_ranks());
  const double reach = reach_of_bonds(slab.points, of.surface_correction, body.setting(),
                                      all_ranks(), formulation_of(of).part_bonds);
  return make_body(distribute(std::move(slab), of.horizon, reach, all_ranks(), 1), of, all_ranks(),
                   1);
}
std::unique_ptr<const Body> part_of(const RanksBody& body) {
  return part_of(body, in_motion(body));
}

StudyOptions explicit_steps() {
  StudyOptions options;
  options.loading.mode = Mode::dynamics;
  options.loading.dynamics.steps_per_row = 7;
  options.threads = 1;
  return options;
}

struct Moved {
  Outcome outcome = Outcome::inconsistent;
  std::vector<StepRecord> rows;
  std::vector<double> displacement, velocity;
  History history{};
};

Moved move(const Body& body) {
  Moved moved;
  LoadSteppingObserver observer;
  observer.accepted = [&](const StepRecord& record, const AcceptedState& state) {
    moved.rows.push_back(record);
    moved.displacement = state.trial.displacement;
    moved.velocity.assign(state.velocity.begin(), state.velocity.end());
    moved.history = state.trial.history;
  };
  moved.outcome = Study(body, explicit_steps()).follow(observer).outcome;
  return moved;
}

/// Expects what this rank has of its own points.
void expect_near(const Body& part, const std::vector<double>& mine,
                 const std::vector<double>& whole) {
  const auto d = std::size_t(part.points.dimension);
  const std::span<const GlobalIndex> number = part.index_map->numbered().owned;
  double scale = 0.0;
  for (const double value : whole) scale = std::max(scale, std::abs(value));
  EXPECT_GT(scale, 0.0);
  for (std::size_t k = 0; k < number.size() * d; ++k) {
    EXPECT_NEAR(mine[k], whole[std::size_t(number[k / d]) * d + k % d], 1e-10 * scale);
  }
}

TEST(MotionOnRanks, goes_where_that_of_the_whole_body_goes) {
  for (const RanksBody& body : all_bodies()) {
    SCOPED_TRACE(body.name);
    const auto whole = whole_body(body), part = part_of(body);
    const Moved expected = move(*whole), found = move(*part);
    EXPECT_EQ(expected.outcome, Outcome::converged);
    EXPECT_EQ(found.outcome, Outcome::converged);
    EXPECT_GT(expected.rows.size(), 1U);
    EXPECT_EQ(found.rows.size(), expected.rows.size());
    expect_near(*part, found.displacement, expected.displacement);
    expect_near(*part, found.velocity, expected.velocity);
    const double energy = expected.rows.front().external_work;
    for (std::size_t k = 0; k < std::min(found.rows.size(), expected.rows.size()); ++k) {
      const StepRecord &mine = found.rows[k], &of_whole = expected.rows[k];
      EXPECT_NEAR(mine.motion->time_step, of_whole.motion->time_step,
                  1e-10 * of_whole.motion->time_step);
      EXPECT_NEAR(mine.motion->kinetic_energy, of_whole.motion->kinetic_energy, 1e-10 * energy);
      EXPECT_NEAR(mine.motion->modified_energy, of_whole.motion->modified_energy, 1e-10 * energy);
      EXPECT_NEAR(mine.stored_energy, of_whole.stored_energy, 1e-10 * energy);
      EXPECT_NEAR(mine.drained_energy, of_whole.drained_energy, 1e-10 * energy);
      EXPECT_NEAR(mine.external_work, of_whole.external_work, 1e-10 * energy);
    }
  }
}

TEST(MotionOnRanks, has_the_stable_step_of_the_whole_body) {
  for (const RanksBody& body : all_bodies()) {
    SCOPED_TRACE(body.name);
    const auto whole = whole_body(body), part = part_of(body);
    const Stiffness expected = Study(*whole, explicit_steps()).find_initial_stiffness();
    const Stiffness found = Study(*part, explicit_steps()).find_initial_stiffness();
    EXPECT_GT(expected.eigenvalue, 0.0);
    EXPECT_NEAR(found.eigenvalue, expected.eigenvalue, 1e-10 * expected.eigenvalue);
    EXPECT_NEAR(found.bound, expected.bound, 1e-12 * expected.bound);
    EXPECT_EQ(all_ranks().min(found.eigenvalue), all_ranks().max(found.eigenvalue));
  }
}

/// What the bonds of all ranks remember, by the numbers of their ends; expects ranks that have the
/// same bond to have the same bits of it.
void expect_agreement(const Body& part, const History& history) {
  const std::span<const double> stretches = bond_stretches(part.model, history);
  const Bonds& bonds = part.model.bonds();
  std::vector<double> mine;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const auto [low, high] = std::minmax(
          {part.index_map->number_of(i), part.index_map->number_of(bonds.partner(i, bond))});
      mine.insert(mine.end(), {double(low), double(high), stretches[std::size_t(bond)]});
    }
  }
  std::map<std::pair<double, double>, double> known;
  const std::vector<double> all = concatenated(all_ranks(), mine);
  std::size_t different = 0;
  for (std::size_t k = 0; k < all.size(); k += 3) {
    const auto [at, is_new] = known.try_emplace({all[k], all[k + 1]}, all[k + 2]);
    different += !is_new && at->second != all[k + 2];
  }
  EXPECT_EQ(different, 0u);
}

/// @return how many bonds are broken
Index expect_same_damage(const RanksBody& body, const BodySpecification& of) {
  const auto whole = whole_body(body, of), part = part_of(body, of);
  const Moved expected = move(*whole), found = move(*part);
  EXPECT_EQ(expected.outcome, found.outcome);
  EXPECT_EQ(found.rows.size(), expected.rows.size());
  const double energy = expected.rows.front().external_work;
  for (std::size_t k = 0; k < std::min(found.rows.size(), expected.rows.size()); ++k) {
    const StepRecord &mine = found.rows[k], &of_whole = expected.rows[k];
    EXPECT_EQ(mine.broken_bonds, of_whole.broken_bonds);
    EXPECT_NEAR(mine.dissipated_energy, of_whole.dissipated_energy, 1e-10 * energy);
    EXPECT_NEAR(mine.stored_energy, of_whole.stored_energy, 1e-10 * energy);
    EXPECT_NEAR(mine.balance_error, of_whole.balance_error, 1e-10 * energy);
  }
  expect_near(*part, found.displacement, expected.displacement);
  expect_agreement(*part, found.history);
  return expected.rows.back().broken_bonds;
}

TEST(MotionOnRanks, breaks_the_bonds_that_the_whole_body_breaks) {
  for (const RanksBody& body : all_bodies()) {
    SCOPED_TRACE(body.name);
    BodySpecification of = in_motion(body);
    of.material.damage.law = DamageLaw::critical_stretch;
    of.material.damage.critical = 0.002;
    // Three points lose all of their bonds, and fly on.
    EXPECT_GT(expect_same_damage(body, of), 0);
  }
}

/// Bonds between ghosts are followed where nobody counts them.
TEST(MotionOnRanks, loses_triangles_with_the_bonds_that_the_whole_body_loses) {
  for (const RanksBody& body : {wide_layers(), plate_with_hole(), turned_plate()}) {
    SCOPED_TRACE(body.name);
    BodySpecification of = in_motion(body);
    of.material = {.model = MaterialModel::cpd, .c1 = 1.0, .c2 = 30.0, .density = 0.02};
    of.material.damage = {.law = DamageLaw::tanh, .onset = 0.01, .critical = 0.02};
    EXPECT_GT(expect_same_damage(body, of), 0);
  }
}

/// As many exchanges as time steps, but for those of looks at the stiffness and of rows.
TEST(MotionOnRanks, exchanges_once_a_step) {
  BodySpecification of = in_motion(plate_with_hole());
  of.material.damage.law = DamageLaw::critical_stretch;
  of.material.damage.critical = 0.05;
  const auto part = part_of(plate_with_hole(), of);
  StudyOptions options = explicit_steps();
  options.loading.dynamics.time_step = 1e-3;  // safely below the stable one: no eigenvalue
  options.loading.dynamics.steps_per_row = 1000;
  Study study(*part, options);
  static_cast<void>(study.find_initial_stiffness());
  const auto before = part->index_map->traffic().exchanges;
  EXPECT_EQ(study.follow({}).outcome, Outcome::converged);
  constexpr int steps = 500, others = 10;
  const auto exchanges = part->index_map->traffic().exchanges - before;
  EXPECT_GE(exchanges, steps);
  EXPECT_LE(exchanges, steps + others);
}

}  // namespace
}  // namespace peristat::tests
