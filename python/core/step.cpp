#include "python/core/step.hpp"

#include <pybind11/stl.h>

#include "python/core/arrays.hpp"
#include "solvers/observe/internal_force.hpp"
#include "src/core/input_error.hpp"
#include "src/core/nearest_name.hpp"

namespace peristat::python {
namespace py = pybind11;

namespace {

[[noreturn]] void refuse_field(const std::string& name) {
  std::vector<std::string> known;
  std::string list;
  for (const PointField& field : point_fields()) {
    known.push_back(field.name);
    list += (list.empty() ? "" : ", ") + field.name;
  }
  const std::string near = nearest_name(name, known);
  throw InputError("field", name,
                   "no field of this name" + (near.empty() ? "" : "; did you mean " + near + "?") +
                       "; there are " + list);
}

}  // namespace

const AcceptedStep& Step::told() const {
  if (told_ != nullptr) return *told_;
  throw std::runtime_error("step " + std::to_string(record_.step) +
                           " is over: its fields can be read only in the callback or loop of the "
                           "step, and later from the results");
}

py::array_t<double> Step::displacement() const {
  const Points& points = told().body.points;
  return copy_of(told().state.trial.displacement.data(), {points.own(), points.dimension});
}

py::array_t<double> Step::field(const std::string& name) {
  const AcceptedStep& step = told();
  const PointField* const field = point_field(name);
  if (field == nullptr) refuse_field(name);
  if (!observed_) {
    const AcceptedState& state = step.state;
    observed_ = std::make_unique<Observation>(
        step.body, step.assembler, state.trial.at(),
        ObservedExtras{internal_force(step.body, state.trial, state.external_force), state.piece,
                       state.velocity, state.life, step.count_cracks});
  }
  const std::vector<double>& values = observed_->values(name);
  const Points& points = step.body.points;
  std::vector<py::ssize_t> shape{points.own()};
  for (const std::uint64_t extent : field->extents(points.dimension)) {
    shape.push_back(py::ssize_t(extent));
  }
  return copy_of(values.data(), shape);
}

namespace {

/// A number of the record, for the table below.
template <auto member>
auto of_record(const Step& step) {
  return step.record().*member;
}

py::dict reactions(const Step& step) {
  py::dict all;
  for (const auto& [set, force] : step.record().reactions) {
    all[py::str(set)] = copy_of(force.data(), {step.dimension()});
  }
  return all;
}

py::dict probes(const Step& step) {
  py::dict all;
  for (const auto& [name, values] : step.record().probes) {
    all[py::str(name)] = values.size() == 1
                             ? py::object(py::float_(values.front()))
                             : py::object(copy_of(values.data(), {py::ssize_t(values.size())}));
  }
  return all;
}

}  // namespace

void bind_step(py::module_& module) {
  using Record = StepRecord;
  py::class_<Step, std::shared_ptr<Step>>(
      module, "Step",
      "An accepted step of a run. Its record stays; its fields can be read until the next step is "
      "searched. Numbers are in SI units.")
      .def_property_readonly("number", of_record<&Record::step>, "Number of the step, from 0.")
      .def_property_readonly("load", of_record<&Record::load_factor>,
                             "Load factor, the first load parameter.")
      .def_property_readonly("stage", of_record<&Record::stage>,
                             "Stage of the loading programme; of a motion the time [s].")
      .def_property_readonly("mode", of_record<&Record::mode>, "Mode that found the step.")
      .def_property_readonly("iterations", of_record<&Record::newton_iterations>,
                             "Iterations of Newton's method.")
      .def_property_readonly("relaxation_iterations", of_record<&Record::relaxation_iterations>,
                             "Iterations of dynamic relaxation.")
      .def_property_readonly("stored_energy", of_record<&Record::stored_energy>, "[J]")
      .def_property_readonly("dissipated_energy", of_record<&Record::dissipated_energy>, "[J]")
      .def_property_readonly("external_work", of_record<&Record::external_work>, "[J]")
      .def_property_readonly("broken_bonds", of_record<&Record::broken_bonds>,
                             "Bonds that broke in this step.")
      .def_property_readonly("max_damage", of_record<&Record::max_damage>,
                             "Largest damage of a point, from 0 to 1.")
      .def_property_readonly("max_stretch", of_record<&Record::max_stretch>,
                             "Largest stretch of a bond that is not broken.")
      .def_property_readonly("displacement", &Step::displacement,
                             "Displacement of the points [m], points x dimension, a copy.")
      .def_property_readonly("reactions", reactions,
                             "Force of the supports on each set [N], by the set's name.")
      .def_property_readonly("probes", probes, "Values of the probes by name, SI units.")
      .def("field", &Step::field, py::arg("name"),
           "Values of a field at the points, points x components, SI units; a copy.")
      .def("stop", &Step::stop, py::arg("reason") = "",
           "Ends the run after this step, which is kept. It can be resumed.")
      .def("__repr__", [](const Step& step) {
        return "<Step " + std::to_string(step.record().step) + " at load " +
               std::to_string(step.record().load_factor) + ">";
      });
}

}  // namespace peristat::python
