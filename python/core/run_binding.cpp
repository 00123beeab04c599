#include "python/core/run_binding.hpp"

#include <chrono>
#include <optional>

#include <pybind11/stl.h>

#include "cases/runner/commands/resume.hpp"
#include "cases/runner/commands/run.hpp"
#include "python/core/arrays.hpp"
#include "python/core/case_binding.hpp"
#include "python/core/givens.hpp"
#include "python/core/step.hpp"
#include "python/core/threads.hpp"
#include "python/core/working.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat::python {
namespace py = pybind11;
namespace {

/// Last accepted state of a run.
struct RunEnd {
  std::shared_ptr<const Body> body{};  ///< null: the run had reached its end before it was resumed
  std::vector<double> displacement{};
  std::string reason{};  ///< of a callback that has ended the run
};

/// Passes on to Python what a run tells, and to the run what Python wants of it: a callback or a
/// signal may end it. An exception of Python ends it after the step, and is raised again by
/// `settle`.
class PythonCompany {
 public:
  /// @param is_left None, or a function that is true once the run shall end
  PythonCompany(std::shared_ptr<const Body> body, py::object on_step, py::object on_line,
                py::object is_left)
      : on_step_(std::move(on_step)), on_line_(std::move(on_line)), is_left_(std::move(is_left)) {
    company_.body = std::move(body);
    company_.line = [this](const std::string& line, bool is_problem) { tell(line, is_problem); };
    if (!on_step_.is_none()) {
      company_.accepted = [this](const AcceptedStep& step) { tell(step); };
    }
    company_.interrupted = [this] {
      return stops_ || failure_ || is_python_ending() || is_interrupted();
    };
    company_.ended = [this](std::shared_ptr<const Body> of, LoadSteppingResult&& result) {
      end_.body = std::move(of);
      end_.displacement = std::move(result.state.displacement);
    };
  }

  [[nodiscard]] const RunCompany& company() const { return company_; }

  /// Raises what a callback has raised; else returns the end. Needs Python's global lock.
  [[nodiscard]] RunEnd settle() {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::move(end_);
  }

 private:
  /// Calls Python; keeps what it raises.
  template <class Call>
  void call(const Call& act) {
    if (failure_) return;  // the run is about to end
    const Calling calling;
    try {
      act();
    } catch (...) {
      failure_ = std::current_exception();
    }
  }

  void tell(const std::string& line, bool is_problem) {
    // That a callback has ended the run is what it wanted, and no problem.
    call([&] { on_line_(line, is_problem && !stops_); });
  }

  void tell(const AcceptedStep& told) {
    call([&] {
      const auto step = std::make_shared<Step>(told);
      const struct End {
        Step& step;
        ~End() { step.end(); }
      } end{*step};
      on_step_(step);
      if (!step->stops()) return;
      stops_ = true;
      end_.reason = step->reason();
    });
  }

  /// Lets Python handle signals, and asks whether it wants the run to go on, now and then: getting
  /// its lock takes time.
  bool is_interrupted() {
    using namespace std::chrono_literals;
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < 50ms) return false;
    asked_ = now;
    call([this] {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      stops_ = !is_left_.is_none() && is_left_().cast<bool>();
    });
    return stops_ || failure_;
  }

  const py::object on_step_, on_line_, is_left_;
  RunCompany company_;
  RunEnd end_;
  std::exception_ptr failure_;
  bool stops_ = false;
  std::chrono::steady_clock::time_point asked_{};
};

RunOptions options_of(int threads, const std::string& log, bool overwrite,
                      const PythonCompany& company) {
  RunOptions options;
  options.threads = prepare_threads(threads);
  options.log_file = log;
  options.overwrite = overwrite;
  options.company = &company.company();
  return options;
}

RunEnd run_case(const SharedCase& of, const std::optional<BoundBody>& body, py::object on_step,
                py::object on_line, py::object is_left, int threads, const std::string& log,
                bool overwrite) {
  PythonCompany company(body ? body->body : nullptr, std::move(on_step), std::move(on_line),
                        std::move(is_left));
  {
    const Working working;
    static_cast<void>(run(*of, options_of(threads, log, overwrite, company), sole_rank()));
  }
  return company.settle();
}

RunEnd resume_run(const std::string& directory, const Settings& settings, const py::dict& functions,
                  const py::object& points, py::object on_step, py::object on_line,
                  py::object is_left, int threads, const std::string& log) {
  PythonCompany company(nullptr, std::move(on_step), std::move(on_line), std::move(is_left));
  const std::shared_ptr<const Givens> givens = givens_of(functions, points);
  {
    const Working working;
    static_cast<void>(
        resume(directory, settings, options_of(threads, log, false, company), sole_rank(), givens));
  }
  return company.settle();
}

py::object displacement(const py::object& self) {
  const RunEnd& end = self.cast<const RunEnd&>();
  if (!end.body) return py::none();
  const Points& points = end.body->points;
  return view_of(end.displacement.data(), {points.own(), points.dimension}, self);
}

}  // namespace

void bind_runs(py::module_& module) {
  py::class_<RunEnd>(module, "RunEnd")
      .def_property_readonly("displacement", displacement)
      .def_readonly("reason", &RunEnd::reason);
  module.def("run", run_case, py::arg("case"), py::arg("body"), py::arg("on_step"),
             py::arg("on_line"), py::arg("is_left"), py::arg("threads"), py::arg("log"),
             py::arg("overwrite"));
  module.def("resume", resume_run, py::arg("directory"), py::arg("settings"), py::arg("functions"),
             py::arg("points"), py::arg("on_step"), py::arg("on_line"), py::arg("is_left"),
             py::arg("threads"), py::arg("log"));
}

}  // namespace peristat::python
