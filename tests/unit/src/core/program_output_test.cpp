#include "src/core/program_output.hpp"

#include <string>

#include <gtest/gtest.h>

#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

TEST(ProgramOutput, IsAllThatItWrites) {
  EXPECT_EQ(program_output({"/bin/echo", "a b", "$HOME"}), "a b $HOME\n");
  EXPECT_EQ(program_output({"/bin/cat"}), "");  // the input is empty
  EXPECT_EQ(program_output({"/usr/bin/head", "-c", "1000000", "/dev/zero"}),
            std::string(1000000, '\0'));
}

TEST(ProgramOutput, OfAFailureIsRefused) {
  EXPECT_THROW(static_cast<void>(program_output({"/no/such/program"})), MachineError);
  EXPECT_THROW(static_cast<void>(program_output({"/bin/false"})), MachineError);
  EXPECT_THROW(static_cast<void>(program_output({"/bin/sh", "-c", "kill -9 $$"})), MachineError);
}

}  // namespace
}  // namespace peristat
