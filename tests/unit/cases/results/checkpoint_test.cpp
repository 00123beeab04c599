#include "cases/runner/results/checkpoint/checkpoint.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace peristat {
namespace {

Checkpoint example() {
  Checkpoint checkpoint;
  PathState& path = checkpoint.path;
  path.accepted.displacement = {1e-300, -0.0, 0.1, 1.0 / 3.0};
  path.accepted.stage = 1.75;
  path.accepted.history.replace(0, std::vector<double>(1000, 0.0));
  path.accepted.history.replace(1, std::vector<double>(1000, 1.0));
  path.accepted.history.change(0)[17] = 0.25;
  path.accepted.history.change(1)[999] = -0.0;
  path.steps = 12;
  path.ledger.force = {1, 2, 3, 4};
  path.pins.pinned = {0, 1, 0, 1};
  path.pins.found.loose = {3};
  path.relaxed.motion.velocity = {5.0};
  path.hand_over.relaxes = true;
  checkpoint.rows = {12, 40, 14, 3};
  checkpoint.last_with_fields = 10;
  checkpoint.unwritten.force = {7.0, 8.0};
  checkpoint.costs.factorisations = 9;
  checkpoint.costs.seconds.total = 1.5;
  return checkpoint;
}

TEST(Checkpoint, IsReadAsItWasWritten) {
  const std::string bytes = encode(example(), "1.2.3");
  const Checkpoint read = decode(bytes, "1.2.3");
  EXPECT_EQ(encode(read, "1.2.3"), bytes);
  EXPECT_TRUE(std::signbit(read.path.accepted.displacement[1]));
  EXPECT_EQ(read.path.accepted.displacement[3], 1.0 / 3.0);
  EXPECT_EQ(read.path.accepted.stage, 1.75);
  EXPECT_EQ(read.path.accepted.history.of(0)[17], 0.25);
  EXPECT_EQ(read.path.accepted.history.of(0)[18], 0.0);
  EXPECT_EQ(read.path.accepted.history.of(1)[998], 1.0);
  EXPECT_TRUE(std::signbit(read.path.accepted.history.of(1)[999]));
  EXPECT_EQ(read.path.pins.pinned, (std::vector<char>{0, 1, 0, 1}));
  EXPECT_EQ(read.path.pins.found.loose, std::vector<Index>{3});
  EXPECT_TRUE(read.path.hand_over.relaxes);
  EXPECT_EQ(read.rows.iterations, 40);
  EXPECT_EQ(read.last_with_fields, 10);
  EXPECT_EQ(read.costs.factorisations, 9);
  EXPECT_EQ(read.costs.seconds.total, 1.5);
}

TEST(Checkpoint, KeepsWhatDiffersOfArraysThatAreNearlyAll0Or1) {
  EXPECT_LT(encode(example(), "1.2.3").size(), 3200u);  // of 2000 doubles
}

TEST(Checkpoint, IsRefusedWhereverABitIsAnotherOrItEnds) {
  const std::string bytes = encode(example(), "1.2.3");
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (1 << (at % 8)));
    EXPECT_THROW((void)decode(changed, "1.2.3"), BadCheckpoint) << at;
    EXPECT_THROW((void)decode(bytes.substr(0, at), "1.2.3"), BadCheckpoint) << at;
  }
  EXPECT_NO_THROW((void)decode(bytes + "what an older, longer one has left", "1.2.3"));
}

TEST(Checkpoint, OfAnotherLayoutIsRefusedWithBothPrograms) {
  std::string bytes = encode(example(), "1.2.3");
  const std::string layout = std::to_string(checkpoint_layout), known = "checkpoint " + layout;
  bytes.replace(bytes.find(known), known.size(), "checkpoint 0");
  try {
    (void)decode(bytes, "4.5.6");
    FAIL();
  } catch (const BadCheckpoint& error) {
    EXPECT_EQ(error.what(),
              "has layout 0 of peristat 1.2.3; this is peristat 4.5.6, which resumes from layout " +
                  layout);
  }
}

}  // namespace
}  // namespace peristat
