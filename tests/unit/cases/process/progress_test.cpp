#include "cases/runner/process/progress.hpp"

#include <chrono>
#include <string>

#include <gtest/gtest.h>

namespace peristat {
namespace {

std::string told(std::chrono::milliseconds silence) {
  ::testing::internal::CaptureStdout();
  Progress progress(false, "");
  progress.show_life_after(silence);
  IterationRecord record;
  record.step = 16;
  record.iteration = 166;
  record.relative_residual = 0.25;
  progress.iteration(record);
  return ::testing::internal::GetCapturedStdout();
}

TEST(Progress, TellsThatALongSearchGoesOn) {
  using namespace std::chrono_literals;
  EXPECT_EQ(told(0ms), "  step 16: still searching, iteration 166, residual 2.5e-01\n");
  EXPECT_EQ(told(1h), "");
}

}  // namespace
}  // namespace peristat
