#include <pybind11/stl.h>

#include "cases/runner/setup/preflight.hpp"
#include "cases/runner/setup/preflight_rules.hpp"
#include "python/core/arrays.hpp"
#include "python/core/case_binding.hpp"
#include "python/core/working.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat::python {
namespace py = pybind11;
namespace {

const Points& points_of(const BoundBody& of) { return of.body->points; }

py::array_t<double> positions(const py::object& self) {
  const Points& points = points_of(self.cast<const BoundBody&>());
  return view_of(points.reference.data(), {points.own(), points.dimension}, self);
}

py::array_t<double> volumes(const py::object& self) {
  const Points& points = points_of(self.cast<const BoundBody&>());
  return view_of(points.volume.data(), {points.own()}, self);
}

py::dict sets(const py::object& self) {
  py::dict all;
  for (const auto& [name, members] : points_of(self.cast<const BoundBody&>()).sets) {
    all[py::str(name)] = view_of(members.data(), {py::ssize_t(members.size())}, self);
  }
  return all;
}

py::dict columns(const py::object& self) {
  const Points& points = points_of(self.cast<const BoundBody&>());
  py::dict all;
  for (const auto& [name, values] : points.columns) {
    all[py::str(name)] = view_of(values.data(), {points.own()}, self);
  }
  return all;
}

py::object given_numbers(const py::object& self) {
  const std::vector<std::int32_t>& rows = points_of(self.cast<const BoundBody&>()).source_row;
  if (rows.empty()) return py::none();
  return view_of(rows.data(), {py::ssize_t(rows.size())}, self);
}

std::vector<std::string> warnings(const BoundBody& of) {
  const Working working;
  return located_errors(*of.of,
                        [&] { return warnings_of(preflight_of(*of.of, *of.body, sole_rank())); });
}

}  // namespace

void bind_body(py::module_& module) {
  py::class_<BoundBody>(module, "Body")
      .def_property_readonly("count", [](const BoundBody& of) { return points_of(of).own(); })
      .def_property_readonly("dimension",
                             [](const BoundBody& of) { return points_of(of).dimension; })
      .def_property_readonly("spacing",
                             [](const BoundBody& of) { return double(points_of(of).spacing); })
      .def_property_readonly("horizon",
                             [](const BoundBody& of) { return of.body->setting.horizon; })
      .def_property_readonly(
          "bonds", [](const BoundBody& of) { return of.body->model.failure().count_of_bonds(); })
      .def_property_readonly("positions", positions)
      .def_property_readonly("volumes", volumes)
      .def_property_readonly("sets", sets)
      .def_property_readonly("columns", columns)
      .def_property_readonly("given_numbers", given_numbers)
      .def("warnings", warnings);
}

}  // namespace peristat::python
