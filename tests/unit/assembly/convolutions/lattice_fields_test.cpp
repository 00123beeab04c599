#include "assembly/convolutions/lattice_fields.hpp"

#include "tests/lattice_systems.hpp"

namespace peristat {
namespace {

using tests::HoledBody;

std::vector<LatticeStep> steps_of(const HoledBody& body) {
  std::vector<LatticeStep> steps;
  for (const LatticeArm& arm : body.arms()) steps.push_back(arm.step);
  return steps;
}

TEST(LatticeFields, FindSumsOverNeighbours) {
  for (const tests::HoledSetting& setting : tests::holed_settings()) {
    const HoledBody body(setting);
    SCOPED_TRACE(::testing::PrintToString(setting.counts));
    const std::vector<double> q = body.mask();
    const std::vector<double> a = tests::Random(2).vector(q.size()),
                              b = tests::Random(3).vector(q.size());
    const std::vector<LatticeArm> arms = body.arms();
    LatticeFields fields(body.box, {}, steps_of(body), 2);
    fields.set_integrity(q);
    const auto even =
        fields.spectrum(LatticeFields::Parity::even, [&](std::size_t s) { return arms[s].share; });
    const auto odd = fields.spectrum(LatticeFields::Parity::odd,
                                     [&](std::size_t s) { return arms[s].share * arms[s].xi[1]; });
    fields.fill(0, [&](std::size_t i) { return a[i]; });
    fields.fill(1, [&](std::size_t i) { return b[i]; });
    std::vector<double> found(q.size()), expected(q.size(), 0.0), alone(q.size());
    const std::array<LatticeFields::Product, 2> both{LatticeFields::Product{&even, 0},
                                                     LatticeFields::Product{&odd, 1, -20.0}};
    fields.find_sums(both, [&](std::size_t i, double sum) { found[i] = sum; });
    for (const tests::Neighbour& of : tests::neighbours(body)) {
      expected[of.i] += of.share * q[of.j] * (a[of.j] - 20.0 * of.xi[1] * b[of.j]);
    }
    ASSERT_GT(tests::norm(expected), 0.0);
    EXPECT_LE(tests::distance(found, expected), 1e-13 * tests::norm(expected));
    EXPECT_EQ(fields.transforms(), 3U);
    // Fields stay as they are.
    fields.find_sums(odd, 1, [&](std::size_t i, double sum) { alone[i] = sum; });
    fields.find_sums(even, 0, [&](std::size_t i, double sum) { alone[i] = sum - 20.0 * alone[i]; });
    EXPECT_LE(tests::distance(alone, expected), 1e-13 * tests::norm(expected));
  }
}

TEST(LatticeFields, KeepAnEighthOfTheModesWhereKernelsAreTheirMirrorImages) {
  const HoledBody upright({{7, 6, 9}, 3.015}),
      turned({{10, 13}, 2.015, VolumeCorrection::none, 27.0});
  for (const HoledBody* body : {&upright, &turned}) {
    const std::vector<LatticeArm> arms = body->arms();
    LatticeFields fields(body->box, {}, steps_of(*body), 1);
    const std::array<Index, 3> size = fields.transform().size();
    const auto quarter =
        std::size_t(size[0] / 2 + 1) * std::size_t(size[1] / 2 + 1) * std::size_t(size[2] / 2 + 1);
    const auto of_length =
        fields.spectrum(LatticeFields::Parity::even, [&](std::size_t s) { return arms[s].share; });
    EXPECT_EQ(of_length.amplitudes.size(), quarter);
    for (int c = 0; c < body->dimension(); ++c) {
      const auto along = fields.spectrum(
          LatticeFields::Parity::odd, [&](std::size_t s) { return arms[s].share * arms[s].xi[c]; });
      // Axes of a turned body are none of the lattice's.
      EXPECT_EQ(along.amplitudes.size(), body == &upright ? quarter : fields.transform().modes());
    }
    const auto across = fields.spectrum(LatticeFields::Parity::even, [&](std::size_t s) {
      return arms[s].share * arms[s].xi[0] * arms[s].xi[1];
    });
    EXPECT_EQ(across.amplitudes.size(), body == &upright ? quarter : fields.transform().modes());
  }
}

TEST(LatticeFields, CountPairs) {
  const HoledBody body({{7, 6, 9}, 2.015});
  LatticeFields fields(body.box, {}, steps_of(body), 1);
  const std::vector<double> q = body.mask();
  fields.set_integrity(q);
  const std::vector<double> pairs = fields.pairs();
  std::map<std::array<double, 3>, double> expected;
  for (const tests::Neighbour& of : tests::neighbours(body)) expected[of.xi] += q[of.i] * q[of.j];
  const std::vector<LatticeArm> arms = body.arms();
  ASSERT_EQ(pairs.size(), arms.size());
  for (std::size_t s = 0; s < arms.size(); ++s) {
    ASSERT_GT(expected[arms[s].xi], 0.0);
    EXPECT_NEAR(pairs[s], expected[arms[s].xi], 1e-12 * double(q.size()));
  }
}

TEST(LatticeFields, TakeOffTheMeanOfThePointsThatAreThere) {
  const HoledBody body({{13, 10}});
  LatticeFields fields(body.box, {}, steps_of(body), 1);
  std::vector<double> q(body.count(), 1.0), u(2 * body.count(), 0.0), without;
  q[3] = 0.0;
  q[4] = 0.5;
  for (std::size_t i = 0; i < q.size(); ++i) u[2 * i + 1] = 4.0;
  u[7] = 1e6;
  fields.set_integrity(q);
  fields.take_off_mean(u, without);
  for (std::size_t k = 0; k < u.size(); ++k) EXPECT_EQ(without[k], k == 7 ? 1e6 - 4.0 : 0.0) << k;
  fields.set_integrity(std::vector<double>(q.size(), 0.0));
  fields.take_off_mean(u, without);
  EXPECT_EQ(without, u);
}

TEST(LatticeFields, LeaveOutPointsWithoutNeighbours) {
  const HoledBody body({{13, 10}});
  const std::vector<LatticeArm> arms = body.arms();
  LatticeFields fields(body.box, {}, steps_of(body), 1);
  const std::vector<double> q = body.mask();
  fields.set_integrity(q);
  const auto shares =
      fields.spectrum(LatticeFields::Parity::even, [&](std::size_t s) { return arms[s].share; });
  double whole = 0.0;
  for (const LatticeArm& arm : arms) whole += 2.0 * arm.share;
  fields.fill(0, [](std::size_t) { return 1.0; });
  std::vector<double> sums(q.size());
  fields.find_sums(shares, 0, [&](std::size_t i, double sum) { sums[i] = sum; });
  fields.leave_out_lonely(whole, [&](std::size_t i) { return sums[i]; });
  ASSERT_EQ(q[0], 1.0);
  EXPECT_EQ(fields.integrity(0), 0.0);
  for (std::size_t i = 1; i < q.size(); ++i) EXPECT_EQ(fields.integrity(i), q[i]);
}

TEST(LatticeFields, HaveTheArmsOfTheSprings) {
  const HoledBody body({{10, 13}, 3.015, VolumeCorrection::linear, 27.0});
  const std::vector<LatticeArm> arms = body.arms();
  const std::vector<LatticeSpring> springs =
      lattice_springs(body.kernel, body.points.spacing, body.points.angle, 2.0, body.volume());
  ASSERT_GT(arms.size(), 0U);
  ASSERT_EQ(arms.size(), springs.size());
  for (std::size_t s = 0; s < arms.size(); ++s) {
    EXPECT_EQ(arms[s].step, springs[s].step);
    EXPECT_EQ(arms[s].xi, springs[s].arm);
    const double length = tests::norm(arms[s].xi);
    EXPECT_NEAR(springs[s].stiffness, 2.0 * arms[s].share / length, 1e-15 * springs[s].stiffness);
    EXPECT_NEAR(tests::dot(arms[s].xi, springs[s].direction), length, 1e-15);
  }
}

TEST(LatticeFields, RoundSumsUp) {
  const std::vector<double> sums{1.0, 0.0, -1e-15, 1e-16};
  std::vector<double> total(sums.size(), 0.0), none;
  add_rounded_up(sums, total);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    EXPECT_GT(total[k], sums[k]);
    EXPECT_GT(total[k], 0.0);
    EXPECT_NEAR(total[k], sums[k], 1e-9);
  }
  const std::vector<double> once = total;
  add_rounded_up(sums, total);
  EXPECT_GT(total[0], 2.0);
  EXPECT_NEAR(total[0], 2.0 * once[0], 1e-15);
  add_rounded_up(none, none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace peristat
