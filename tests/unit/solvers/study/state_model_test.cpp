// Bodies of model lps with the form energy, from plain values.
#include "solvers/formulations/state/state_model.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "assembly/terms/states/state_term.hpp"
#include "solvers/body/body.hpp"
#include "solvers/body/body_memory.hpp"
#include "solvers/formulations/check_specification.hpp"
#include "solvers/formulations/lps_energy/lps_energy.hpp"
#include "src/core/input_error.hpp"
#include "src/materials/lame_constants.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

tests::BoxSetting plate() {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {14, 12, 0};
  return box;
}

BodySpecification solid() {
  BodySpecification of{.horizon = 0.2015, .form = SolidForm::energy};
  of.material.model = MaterialModel::lps;
  of.material.influence = "inverse";
  of.material.youngs_modulus = 3.0;
  of.material.poisson_ratio = 0.2;
  return of;
}

Points points_of(const tests::BoxSetting& box) {
  Points points = tests::box_points(box);
  for (Index i = 0; i < points.count(); ++i) {
    points.sets[points.position(i)[0] < 0.7 ? "left" : "right"].push_back(i);
  }
  return points;
}

const StateTerm& states_of(const Body& body) { return *body.model.find<StateTerm>(); }

TEST(StateModel, MemoryCountsTheBlocksOfItsTangent) {
  const auto body = make_body(points_of(plate()), solid(), 1);
  const MemoryEstimate estimate = estimate_memory(*body);
  const double blocks = double(body->model.pattern().blocks());
  EXPECT_EQ(estimate.size.blocks, blocks);
  EXPECT_GT(blocks, 2.5 * double(body->model.bonds().count()));
  const BlockCount count = body->model.terms().front()->block_count(2);
  EXPECT_EQ(count.blocks, blocks);
  // The blocks' partners, and the bonds' blocks and directions while the tangent is written.
  EXPECT_GT(count.bytes_beside, 4.0 * blocks + 48.0 * double(body->model.bonds().count()));
  EXPECT_EQ(estimate.tangent_bytes, 8.0 * 4.0 * blocks + count.bytes_beside);
  BodySpecification bonds = solid();
  bonds.form = SolidForm::collocation;
  bonds.material.model = MaterialModel::bond;
  bonds.material.influence = "constant";
  bonds.material.poisson_ratio.reset();
  const MemoryEstimate of_bonds = estimate_memory(*make_body(points_of(plate()), bonds, 1));
  EXPECT_GT(estimate.direct_bytes(), 2.0 * of_bonds.direct_bytes() - 60e6);
  EXPECT_GT(estimate.factor_entries, 1.5 * of_bonds.factor_entries);
}

/// K = 1/r has the published formula, by whichever way.
TEST(StateModel, FractureEnergyGivesTheStretchOfADilation) {
  for (const int dimension : {2, 3}) {
    BondSetting setting{{dimension, 0.3, dimension == 2 ? 0.5 : 1.0}};
    const LamePair constants = lame_constants(3.0, 0.2, dimension, PlaneState::stress);
    setting.influence = influence_named("inverse");
    const double energy = crack_energy_of_dilation(constants, state_setting(setting));
    EXPECT_NEAR(energy, crack_energy_of_dilation(constants, 0.3, dimension), 1e-12 * energy);
    const MaterialSpecification material = solid().material;
    EXPECT_EQ(lps_energy_formulation().crack_energy_of_dilation(material, "m", setting, 0.1),
              energy);
    // Where K falls less, bonds are longer in the mean: int K r^3 / int K r^2.
    setting.influence = {};
    const double ratio = dimension == 2 ? 4.0 / 5.0 / (3.0 / 4.0) : 5.0 / 6.0 / (4.0 / 5.0);
    EXPECT_NEAR(crack_energy_of_dilation(constants, state_setting(setting)), ratio * energy,
                1e-12 * energy);
  }
}

/// A pre-crack is as if its bonds had broken: it changes no moment.
TEST(StateModel, PreCracksLeaveTheMoments) {
  BodySpecification of = solid();
  const auto whole = make_body(points_of(plate()), of, 1);
  of.cracks.push_back(CrackSegment{{0.0, 0.6, 0.0}, {0.7, 0.6, 0.0}});
  const auto cut = make_body(points_of(plate()), of, 1);
  EXPECT_LT(cut->model.bonds().count(), whole->model.bonds().count());
  EXPECT_EQ(states_of(*cut).shares().moment, states_of(*whole).shares().moment);
}

/// The kernel knows places alone; constants are those of the points, also beside a crack.
TEST(StateModel, RegionsHaveTheirConstants) {
  BodySpecification of = solid();
  of.cracks.push_back(CrackSegment{{0.0, 0.6, 0.0}, {0.7, 0.6, 0.0}});
  const auto one = make_body(points_of(plate()), of, 1);
  MaterialSpecification stiff = of.material;
  stiff.youngs_modulus = 30.0;
  stiff.poisson_ratio = 0.4;
  of.regions = {{"right", stiff}};
  const auto two = make_body(points_of(plate()), of, 1);
  const BondKinds &of_one = states_of(*one).shares().whole,
                  &of_two = states_of(*two).shares().whole;
  ASSERT_EQ(of_one.size(), of_two.size());
  for (Offset bond = 0; bond < Offset(of_one.size()); ++bond) {
    EXPECT_EQ(of_one[bond].weight, of_two[bond].weight);
  }
  const LamePair left = lame_constants(3.0, 0.2, 2, PlaneState::stress),
                 right = lame_constants(30.0, 0.4, 2, PlaneState::stress);
  for (Index i = 0; i < two->points.count(); ++i) {
    const auto& [lambda, mu] = states_of(*two).shares().constants[std::size_t(i)];
    const LamePair& expected = two->points.position(i)[0] < 0.7 ? left : right;
    EXPECT_EQ(lambda, expected.lambda);
    EXPECT_EQ(mu, expected.mu);
  }
}

std::string refusal(const BodySpecification& of) {
  try {
    static_cast<void>(make_body(points_of(plate()), of, 1));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(StateModel, RefusesWhatItDoesNotTake) {
  const auto refused = [](const auto& spoil) {
    BodySpecification of = solid();
    spoil(of);
    return refusal(of);
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(refusal(solid()), "nothing");
  EXPECT_TRUE(has(refused([](auto& of) { of.collocation.degree = 4; }), "degree"));
  EXPECT_TRUE(has(refused([](auto& of) { of.surface_correction = SurfaceCorrection::volume; }),
                  "surface_correction"));
  EXPECT_TRUE(has(refused([](auto& of) { of.material.damage.law = DamageLaw::linear; }), "law"));
  EXPECT_TRUE(has(refused([](auto& of) { of.constraints.symmetries = {{0, 0.0}}; }), "symmetry"));
  EXPECT_TRUE(has(refused([](auto& of) {
                    of.material.model = MaterialModel::bond;
                    of.material.poisson_ratio.reset();
                  }),
                  "form"));
  EXPECT_TRUE(has(refused([](auto& of) {
                    of.form = SolidForm::collocation;
                    of.material.influence = "cubic";
                  }),
                  "influence"));
}

TEST(StateModel, RefusesAPoissonRatioThatLeavesNoDigits) {
  MaterialSpecification material = solid().material;
  const auto is_refused = [&](double nu, int dimension, PlaneState plane) {
    material.poisson_ratio = nu;
    material.plane = plane;
    try {
      check_material(material, "material", dimension);
    } catch (const InputError& error) {
      EXPECT_EQ(error.key(), "material.poisson_ratio");
      return true;
    }
    return false;
  };
  for (const MaterialModel model : {MaterialModel::lps, MaterialModel::correspondence}) {
    material.model = model;
    material.influence = ConstantInfluence::name;
    for (const double nu : {0.5 - 1e-8, 0.5 - 1e-14, -1.0 + 1e-8}) {
      EXPECT_TRUE(is_refused(nu, 3, PlaneState::stress)) << nu;
      EXPECT_TRUE(is_refused(nu, 2, PlaneState::strain)) << nu;
    }
    EXPECT_FALSE(is_refused(0.499999, 3, PlaneState::stress));
    EXPECT_FALSE(is_refused(0.5 - 1e-14, 2, PlaneState::stress));  // nothing is incompressible
    EXPECT_TRUE(is_refused(-1.0 + 1e-8, 2, PlaneState::stress));
  }
}

}  // namespace
}  // namespace peristat
