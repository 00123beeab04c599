#include "python/core/case_binding.hpp"

#include <cstdio>
#include <cstdlib>

#include <pybind11/stl.h>

#include "cases/runner/commands/calibrate.hpp"
#include "cases/runner/commands/check.hpp"
#include "cases/runner/commands/check_tangent.hpp"
#include "cases/runner/setup/body.hpp"
#include "python/core/givens.hpp"
#include "python/core/threads.hpp"
#include "python/core/working.hpp"

namespace peristat::python {
namespace py = pybind11;
namespace {

/// What `print` prints to the file that it gets.
template <class Print>
std::string printed(const Print& print) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* const file = open_memstream(&text, &size);
  if (file == nullptr) throw std::bad_alloc();
  const auto close = [&] {
    std::fclose(file);
    const std::unique_ptr<char, decltype(&std::free)> owned(text, std::free);
    return std::string(text, size);
  };
  try {
    print(file);
  } catch (...) {
    static_cast<void>(close());
    throw;
  }
  return close();
}

std::shared_ptr<Case> read(const std::string& file, const std::string& text,
                           const Settings& settings, const py::dict& functions,
                           const py::object& points) {
  const std::shared_ptr<const Givens> givens = givens_of(functions, points);
  const Working working;
  return std::make_shared<Case>(read_case(file, text, settings, givens));
}

std::string check_text(const Case& of, int threads) {
  const Working working;
  const int prepared = prepare_threads(threads);
  return printed([&](std::FILE* out) { static_cast<void>(check(of, prepared, out)); });
}

std::string check_tangent_text(const Case& of, const std::string& deformation, int threads) {
  const Working working;
  const int prepared = prepare_threads(threads);
  return printed(
      [&](std::FILE* out) { static_cast<void>(check_tangent(of, deformation, prepared, out)); });
}

std::string calibrate_text(const Case& of, bool with_strengths) {
  const Working working;
  return printed([&](std::FILE* out) { static_cast<void>(calibrate(of, with_strengths, out)); });
}

BoundBody body_of(const SharedCase& of, int threads) {
  const Working working;
  return {of, make_body(*of, prepare_threads(threads))};
}

}  // namespace

void bind_case(py::module_& module) {
  py::class_<Case, std::shared_ptr<Case>>(module, "Case")
      .def(py::init(&read), py::arg("file"), py::arg("text"), py::arg("settings"),
           py::arg("functions"), py::arg("points"))
      .def_property_readonly("resolved", [](const Case& of) { return of.as_resolved; })
      .def_property_readonly("title", [](const Case& of) { return of.title; })
      .def_property_readonly("dimension", [](const Case& of) { return of.dimension; })
      .def_property_readonly("directory",
                             [](const Case& of) { return of.output.directory.string(); })
      .def("check", check_text, py::arg("threads"))
      .def("check_tangent", check_tangent_text, py::arg("deformation"), py::arg("threads"))
      .def("calibrate", calibrate_text, py::arg("strengths"))
      .def(
          "body", [](const std::shared_ptr<Case>& of, int threads) { return body_of(of, threads); },
          py::arg("threads"));
}

}  // namespace peristat::python
