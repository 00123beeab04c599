#include "solvers/study/study.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "src/geometry/lattice.hpp"

namespace peristat {
namespace {

/// A strip of 12 x 4 points with two rows more at either end.
Lattice strip_lattice() {
  Lattice lattice;
  lattice.spacing = 0.1;
  lattice.cross_section = 0.5;
  lattice.shapes = {{ShapeStep::Action::add, Box{{0.0, 0.0}, {1.2, 0.4}}}};
  lattice.layers = {{"left", {0, -1}, 2, ""}, {"right", {0, 1}, 2, ""}};
  return lattice;
}

/// Held on the left and pulled on the right.
BodySpecification strip() {
  BodySpecification of;
  of.horizon = 0.2015;
  of.material.youngs_modulus = 3.0;
  of.supports = {{"left", {"0", "0"}}, {"right", {"1e-3*load", "0"}}};
  return of;
}

struct Refusal {
  std::string name, key, told;
  std::function<void(Points&, BodySpecification&)> change;
};

class BodyOfWrongValues : public testing::TestWithParam<Refusal> {};

TEST_P(BodyOfWrongValues, IsRefused) {
  Points points = make_points(strip_lattice());
  BodySpecification of = strip();
  static_cast<void>(make_body(points, of, 1));  // is right before it is changed
  GetParam().change(points, of);
  try {
    const auto body = make_body(points, of, 1);
    static_cast<void>(Study(*body, {}));
    ADD_FAILURE() << "was not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), GetParam().key);
    EXPECT_NE(std::string(error.what()).find(GetParam().told), std::string::npos) << error.what();
  }
}

const double nan_value = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Values, BodyOfWrongValues,
    testing::Values(
        Refusal{"NoHorizon", "horizon", "must be positive",
                [](auto&, auto& of) { of.horizon = 0.0; }},
        Refusal{"ShortHorizon", "horizon", "horizon smaller than the mean spacing",
                [](auto&, auto& of) { of.horizon = 0.09; }},
        Refusal{"EndlessHorizon", "horizon", "at most 1000",
                [](auto&, auto& of) { of.horizon = 101.0; }},
        Refusal{"OtherThickness", "cross_section", "does not fit the points",
                [](auto&, auto& of) { of.cross_section = 1.0; }},
        Refusal{"OtherSpacing", "cross_section", "does not fit the points",
                [](auto& points, auto& of) {
                  of.cross_section = 0.5;
                  points.spacing = 0.11;
                }},
        Refusal{"ThicknessIn3d", "cross_section", "must be 1 in 3D",
                [](auto& points, auto& of) {
                  Lattice block = strip_lattice();
                  block.dimension = 3;
                  block.cross_section = 1.0;
                  block.shapes = {{ShapeStep::Action::add, Box{{0, 0, 0}, {0.4, 0.4, 0.4}}}};
                  points = make_points(block);
                  of.cross_section = 0.5;
                }},
        Refusal{"NoPoints", "points", "there are no points",
                [](auto& points, auto&) { points.volume.clear(), points.reference.clear(); }},
        Refusal{"TooFewPlaces", "points.reference", "as many entries as the dimension",
                [](auto& points, auto&) { points.reference.pop_back(); }},
        Refusal{"NoDimension", "points.dimension", "must be 1, 2 or 3",
                [](auto& points, auto&) { points.dimension = 0; }},
        Refusal{"PlaceIsNoNumber", "points.reference", "must be finite",
                [](auto& points, auto&) { points.reference[3] = nan_value; }},
        Refusal{"NegativeVolume", "points.volume", "must be positive",
                [](auto& points, auto&) { points.volume[3] = -1.0; }},
        Refusal{"TwoPointsAtOnePlace", "points.reference", "two points have the same position",
                [](auto& points, auto&) {
                  points.reference[2] = points.reference[0];
                  points.reference[3] = points.reference[1];
                }},
        Refusal{"FarFromTheOrigin", "points.reference", "move the body to the origin",
                [](auto& points, auto&) {
                  for (double& at : points.reference) at += 1e9;
                }},
        Refusal{"SetBeyondThePoints", "points.sets", "not the number of a point",
                [](auto& points, auto&) { points.sets["left"].push_back(points.count()); }},
        Refusal{"UnknownSet", "supports[0].set", "no set of this name; the sets are left, right",
                [](auto&, auto& of) { of.supports[0].set = "lef"; }},
        Refusal{"EmptySet", "supports[0].set", "selects no point",
                [](auto& points, auto&) { points.sets["left"].clear(); }},
        Refusal{"NoStiffness", "material", "needs a youngs_modulus or a micromodulus",
                [](auto&, auto& of) { of.material.youngs_modulus.reset(); }},
        Refusal{"NegativeStiffness", "material.youngs_modulus", "must be positive",
                [](auto&, auto& of) { of.material.youngs_modulus = -1.0; }},
        Refusal{"UnknownPotential", "material.potential", "no potential of this name",
                [](auto&, auto& of) { of.material.potential = "harmonik"; }},
        Refusal{"PoissonRatioOfBonds", "material.poisson_ratio", "is for models \"cpd\"",
                [](auto&, auto& of) { of.material.poisson_ratio = 0.3; }},
        Refusal{"CpdWithoutPoissonRatio", "material.poisson_ratio", "needs youngs_modulus",
                [](auto&, auto& of) { of.material.model = MaterialModel::cpd; }},
        Refusal{"DamageWithoutALaw", "material.damage.critical", "needs a law",
                [](auto&, auto& of) { of.material.damage.critical = 0.01; }},
        Refusal{"OnsetAboveCritical", "material.damage.onset", "smaller than critical",
                [](auto&, auto& of) {
                  of.material.damage = {DamageLaw::tanh, 0.2, 0.1, 3.0, {}};
                }},
        Refusal{"CrackWithoutLength", "cracks[0].to", "",
                [](auto&, auto& of) {
                  of.cracks = {CrackSegment{{0.5, 0.0}, {0.5, 0.0}}};
                }},
        Refusal{"Unheld", "supports", "do not hold the body",
                [](auto&, auto& of) { of.supports.clear(); }},
        Refusal{"Loose", "points", "hangs on too few bonds",
                [](auto& points, auto&) {
                  // Two spacings above the upper edge: within the horizon of one point alone.
                  points.reference.insert(points.reference.end(), {0.55, 0.55});
                  points.volume.push_back(points.volume.front());
                }}),
    [](const auto& refusal) { return refusal.param.name; });

void expect_refused(const StudyOptions& options, const std::string& key) {
  const auto body = make_body(make_points(strip_lattice()), strip(), 1);
  try {
    static_cast<void>(Study(*body, options));
    ADD_FAILURE() << key << " was not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), key);
  }
}

template <class Change>
StudyOptions options_with(const Change& change) {
  StudyOptions options;
  change(options);
  return options;
}

TEST(Study, OfWrongOptionsIsRefused) {
  const auto refused = [](const std::string& key, const auto& change) {
    expect_refused(options_with(change), key);
  };
  refused("loading.steps", [](auto& with) { with.loading.steps = 0; });
  refused("loading.mode", [](auto& with) { with.loading.mode = Mode{"newt"}; });
  refused("loading.largest_step", [](auto& with) { with.loading.largest_step = 0.5; });
  refused("newton.relative_tolerance", [](auto& with) { with.newton.relative_tolerance = 0.0; });
  refused("newton.max_iterations", [](auto& with) { with.newton.max_iterations = 0; });
  refused("linear.preconditioner", [](auto& with) {
    with.linear = {LinearMethod::cholesky, PreconditionerKind::jacobi};
  });
  refused("tangent", [](auto& with) {
    with.linear.method = LinearMethod::cholesky;
    with.tangent = TangentStorage::matrix_free;
  });
  refused("threads", [](auto& with) { with.threads = -1; });
}

TEST(Study, MatrixFreeTangentOfTrianglesIsRefused) {
  BodySpecification of = strip();
  of.material.model = MaterialModel::cpd;
  of.material.poisson_ratio = 0.4;
  const auto body = make_body(make_points(strip_lattice()), of, 1);
  EXPECT_THROW(static_cast<void>(solve(*body, options_with([](auto& with) {
                 with.tangent = TangentStorage::matrix_free;
               }))),
               InputError);
}

TEST(Study, NoConvergenceIsAnOutcome) {
  const auto body = make_body(make_points(strip_lattice()), strip(), 1);
  StudyOptions options;
  options.newton.max_iterations = 1;
  options.loading.adaptive = false;
  const StudyResult result = solve(*body, options);
  EXPECT_NE(result.outcome, Outcome::converged);
  EXPECT_EQ(result.steps.size(), 1u);  // step 0
  EXPECT_EQ(result.state.stage, 0.0);
  ASSERT_FALSE(result.decisions.empty());
  EXPECT_EQ(result.decisions.back().action, Decision::stop);
}

/// Reaction on the right of the strip.
double pull(const BodySpecification& of, const StudyOptions& options) {
  const auto body = make_body(make_points(strip_lattice()), of, 1);
  const StudyResult result = solve(*body, options);
  EXPECT_EQ(result.outcome, Outcome::converged);
  EXPECT_EQ(result.steps.size(), 1 + std::size_t(options.loading.steps));  // with step 0
  EXPECT_EQ(result.state.stage, 1.0);
  EXPECT_NEAR(mean_displacement(body->points, result.state, "right")[0], 1e-3, 1e-15);
  return result.steps.back().reactions.at("right")[0];
}

TEST(Study, EverySolverAndTangentGivesTheSameReaction) {
  const double expected = pull(strip(), options_with([](auto& with) { with.loading.steps = 2; }));
  // E w h u / L, up to the bonds that are missing at the edges of four rows and the held ends.
  EXPECT_NEAR(expected / (3.0 * 0.4 * 0.5 * 1e-3 / 1.2), 1.0, 0.4);
  // Tolerance: the residual's, 1e-10, times the strip's condition, some hundreds.
  const auto same = [&](LinearSolverOptions linear, TangentStorage tangent) {
    const StudyOptions options = options_with([&](auto& with) {
      with.linear = linear;
      with.tangent = tangent;
    });
    EXPECT_NEAR(pull(strip(), options) / expected, 1.0, 1e-7);
  };
  const auto automatic = PreconditionerKind::automatic;
  same({LinearMethod::conjugate_gradients, automatic}, TangentStorage::automatic);
  same({LinearMethod::conjugate_gradients, automatic}, TangentStorage::stored);
  same({LinearMethod::automatic, PreconditionerKind::block_jacobi}, TangentStorage::automatic);
  same({LinearMethod::cholesky, automatic}, TangentStorage::automatic);
}

TEST(Study, CpdAtTheBondsPoissonRatioIsABondBody) {
  BodySpecification of = strip();
  of.material.model = MaterialModel::cpd;
  of.material.youngs_modulus.reset();
  of.material.c1 = 7.0;
  BodySpecification bonds = strip();
  bonds.material.youngs_modulus.reset();
  bonds.material.micromodulus = 7.0;
  // With C2 = 0 they differ in the weights of bonds alone, which effective volumes make smaller or
  // larger by less than half at this horizon.
  EXPECT_NEAR(pull(of, {}) / pull(bonds, {}), 1.0, 0.5);
}

TEST(Study, TheObserverIsToldAndMayInterrupt) {
  const auto body = make_body(make_points(strip_lattice()), strip(), 1);
  int steps = 0, iterations = 0;
  LoadSteppingObserver observer;
  observer.accepted = [&](const StepRecord& row, const AcceptedState&) { steps = row.step; };
  observer.iteration = [&](const IterationRecord&) { ++iterations; };
  observer.interrupted = [&] { return steps == 2; };
  const StudyResult result =
      solve(*body, options_with([](auto& with) { with.loading.steps = 4; }), observer);
  EXPECT_EQ(result.outcome, Outcome::interrupted);
  EXPECT_EQ(steps, 2);
  EXPECT_GT(iterations, 2);
  EXPECT_EQ(result.steps.size(), 3u);  // step 0 is one
  EXPECT_EQ(result.state.stage, 0.5);
}

TEST(AddSet, RefusesWhatSelectsNothingAndNamesThatAreTaken) {
  Points points = make_points(strip_lattice());
  add_set(points, {"middle", "abs(x - 0.6) < spacing", {}});
  EXPECT_EQ(points.sets.at("middle").size(), 8u);  // two columns of four
  EXPECT_THROW(add_set(points, {"middle", "x > 0", {}}), InputError);
  EXPECT_THROW(add_set(points, {"nowhere", "x > 100", {}}), InputError);
  EXPECT_THROW(static_cast<void>(mean_displacement(points, {}, "nowhere")), InputError);
}

}  // namespace
}  // namespace peristat
