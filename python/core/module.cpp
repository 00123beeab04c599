#include <malloc.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "cases/runner/commands/case_schema.hpp"
#include "cases/runner/commands/run.hpp"
#include "cases/runner/input/case_file.hpp"
#include "python/core/case_binding.hpp"
#include "python/core/errors.hpp"
#include "python/core/run_binding.hpp"
#include "python/core/step.hpp"
#include "python/core/working.hpp"
#include "solvers/observe/point_fields.hpp"

namespace py = pybind11;

PYBIND11_MODULE(_core, module) {
  using namespace peristat;
  module.doc() = "The compiled part of peristat; the package peristat is its interface.";
  // Memory of large vectors goes back to the system when they are freed, as in the program.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  python::translate_errors(module);
  python::let_python_wait();
  python::bind_unfinished(module);
  python::bind_case(module);
  python::bind_body(module);
  python::bind_step(module);
  python::bind_runs(module);
  module.def("versions", versions);
  module.def(
      "case_text", [](const std::string& file) { return read_case_text(file); }, py::arg("file"));
  module.def("schema", case_schema);
  module.def("fields", [] {
    std::vector<std::tuple<std::string, std::string, std::string>> all;
    for (const PointField& field : point_fields()) {
      all.emplace_back(field.name, field.unit, field.meaning);
    }
    return all;
  });
}
