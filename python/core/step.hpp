#pragma once

#include <memory>
#include <string>

#include <pybind11/numpy.h>

#include "cases/runner/commands/run_company.hpp"
#include "solvers/observe/observation.hpp"

namespace peristat::python {

/// An accepted step for Python. Its record stays; its fields can be read until it is over.
class Step {
 public:
  explicit Step(const AcceptedStep& told)
      : record_(told.record), dimension_(told.body.points.dimension), told_(&told) {}

  [[nodiscard]] const StepRecord& record() const { return record_; }
  [[nodiscard]] int dimension() const { return dimension_; }
  /// Values of a field at the points, as an array of its own: points x components.
  /// @throws InputError ("field") if there is none of this name
  /// @throws std::runtime_error if the step is over
  [[nodiscard]] pybind11::array_t<double> field(const std::string& name);
  /// Displacement without the fields' cost, likewise: points x dimension [m].
  [[nodiscard]] pybind11::array_t<double> displacement() const;

  /// Asks the run to end after this step.
  void stop(const std::string& reason) {
    stops_ = true;
    reason_ = reason;
  }
  [[nodiscard]] bool stops() const { return stops_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

  void end() {
    observed_.reset();
    told_ = nullptr;
  }

 private:
  [[nodiscard]] const AcceptedStep& told() const;

  const StepRecord record_;
  const int dimension_;
  const AcceptedStep* told_;
  std::unique_ptr<Observation> observed_;
  bool stops_ = false;
  std::string reason_;
};

void bind_step(pybind11::module_& module);

}  // namespace peristat::python
