#include <exception>
#include <iostream>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "solvers/ranks/ranks.hpp"
#include "src/parallel/communicator.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

std::unique_ptr<Communicator>& started() {
  static std::unique_ptr<Communicator> ranks;
  return ranks;
}

/// Prints what fails on other ranks than the first.
class Failures : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    std::cerr << "rank " << all_ranks().rank() << ": " << result.file_name() << ":"
              << result.line_number() << ": " << result.message() << std::endl;
  }
};

}  // namespace

const Communicator& all_ranks() { return *started(); }

}  // namespace peristat::tests

int main(int argc, char** argv) {
  using namespace peristat::tests;
  testing::InitGoogleTest(&argc, argv);
  started() = peristat::start_ranks();
  testing::GTEST_FLAG(catch_exceptions) = false;  // others would wait for a rank that goes on alone
  if (all_ranks().rank() > 0) {
    testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new Failures);
  }
  try {
    if (argc > 1 && std::string(argv[1]) == "fail-on-rank-1") {
      if (all_ranks().rank() == 1) all_ranks().abort(3);
      return int(all_ranks().sum(1.0));  // waits for the other, in vain
    }
    const int failed = int(all_ranks().max(double(RUN_ALL_TESTS())));
    started().reset();
    return failed;
  } catch (const std::exception& error) {
    std::cerr << error.what() << std::endl;
    all_ranks().abort(1);
  }
}
