// Mode path by release: with lambda = mu it is that of the bond model, event by event.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/terms/damage.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/linear/ldlt.hpp"
#include "src/potentials/make_saw_tooth.hpp"
#include "tests/release_body.hpp"

namespace peristat {
namespace {

using tests::BoxSetting;
using tests::ReleaseBody;

/// Rows of a path, and the bonds' histories in them.
struct Followed {
  std::vector<StepRecord> rows;
  std::vector<std::vector<double>> histories;
  Outcome outcome = Outcome::converged;
};

BoxSetting strip() {
  BoxSetting box = tests::small_box(2);
  box.extent = {12, 7, 0};
  box.perturbation = 0.15;
  return box;
}

Followed follow(const Points& points, const Model& model, const std::string& pull, int threads = 1,
                LoadingProgramme programme = {}) {
  Followed followed;
  const Conditions conditions(
      points, {tests::support("left", "0", "0"), tests::support("right", pull)}, {}, programme);
  const FreeDofs free(conditions.prescribed(), 2);
  Assembler assembler(points, model, threads);
  Tangent tangent(assembler.pattern(), 2);
  Cholesky solver;
  EXPECT_EQ(solver.analyze(tangent.pattern, free), LinearOutcome::solved);
  LoadSteppingOptions options;
  options.mode = Mode::path;
  options.steps = 2;
  LoadSteppingObserver observer;
  observer.accepted = [&](const StepRecord& row, const AcceptedState& state) {
    followed.rows.push_back(row);
    const std::span<const double> history = bond_stretches(model, state.trial.history);
    followed.histories.emplace_back(history.begin(), history.end());
  };
  const SolvedBody body{assembler, solver, tangent, free};
  followed.outcome = follow_loading({body, conditions, options, NewtonOptions(), observer}).outcome;
  return followed;
}

TEST(ReleasePath, IsThatOfTheBondModelAtItsPoissonRatio) {
  const BondPotential whole = Degraded<CriticalStretch>{1.0, CriticalStretch{0.02}};
  const BondPotential soft =
      with_teeth(Degraded<ForceEnvelope>{1.0, ForceEnvelope{0.015, 0.03}}, 3);
  for (const BondPotential& law : {whole, soft}) {
    const ReleaseBody body(strip(), 1.0 / 3.0, law);
    const Followed states = follow(body.points, body.model, "0.05*load");
    const Followed bonds = follow(body.points, body.bond_model, "0.05*load");
    ASSERT_EQ(states.outcome, Outcome::converged);
    ASSERT_EQ(bonds.outcome, Outcome::converged);
    ASSERT_EQ(states.rows.size(), bonds.rows.size());
    EXPECT_GT(states.rows.back().broken_bonds, 20);
    const double work = bonds.rows.back().external_work;
    for (std::size_t k = 0; k < bonds.rows.size(); ++k) {
      const StepRecord &one = states.rows[k], &other = bonds.rows[k];
      EXPECT_EQ(states.histories[k], bonds.histories[k]);
      EXPECT_NEAR(one.stage, other.stage, 1e-8);
      for (const auto& [a, b] : {std::pair(one.stored_energy, other.stored_energy),
                                 std::pair(one.dissipated_energy, other.dissipated_energy),
                                 std::pair(one.drained_energy, other.drained_energy),
                                 std::pair(one.released_energy, other.released_energy)}) {
        EXPECT_NEAR(a, b, 1e-8 * work);
      }
    }
  }
}

}  // namespace
}  // namespace peristat
