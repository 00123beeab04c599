#pragma once

#include <functional>
#include <memory>

#include "assembly/assembler.hpp"
#include "cases/runner/process/progress.hpp"
#include "solvers/body/body.hpp"
#include "solvers/drivers/load_stepping.hpp"

namespace peristat {

/// An accepted step, as long as it is being told.
struct AcceptedStep {
  const StepRecord& record;  ///< with its probes
  const AcceptedState& state;
  const Body& body;
  Assembler& assembler;
  bool count_cracks;  ///< output.count_cracks
};

/// A program that runs a case inside its own process, and goes on after the run. The run then
/// leaves the handling of signals to it, and its exceptions reach it after the results have been
/// closed. Members may be empty.
struct RunCompany {
  std::shared_ptr<const Body> body{};  ///< of the same case; null: the run makes it
  Progress::Sink line{};               ///< gets the lines of the run in the place of the terminal
  std::function<void(const AcceptedStep&)> accepted{};
  std::function<bool()> interrupted{};  ///< true: the run ends after the step, as by a signal
  std::function<void(std::shared_ptr<const Body> body, LoadSteppingResult&&)> ended{};
};

}  // namespace peristat
