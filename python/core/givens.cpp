#include "python/core/givens.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "python/core/arrays.hpp"
#include "python/core/working.hpp"

namespace peristat::python {
namespace py = pybind11;
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A function of Python that threads without Python's lock may copy and drop.
using SharedFunction = std::shared_ptr<py::function>;

SharedFunction shared(py::function function) {
  return {new py::function(std::move(function)), [](py::function* last) {
            const py::gil_scoped_acquire held;
            delete last;
          }};
}

GivenFunction given(int arguments, SharedFunction fill) {
  const auto call = [fill = std::move(fill)](std::span<const std::span<const double>> places,
                                             std::span<double> values) {
    const Calling calling;
    py::list all;
    for (const std::span<const double> of : places) {
      all.append(copy_of(of.data(), {py::ssize_t(of.size())}));
    }
    const auto found = (*fill)(all, values.size()).cast<Numbers>();
    std::copy_n(found.data(), values.size(), values.begin());
  };
  return {arguments, call};
}

std::vector<double> numbers(const py::object& array) {
  const auto of = array.cast<Numbers>();
  return {of.data(), of.data() + of.size()};
}

Points points_of(const py::object& given) {
  Points points;
  const py::object positions = given.attr("positions");
  points.dimension = positions.attr("shape")[py::int_(1)].cast<int>();
  points.reference = numbers(positions);
  points.volume = numbers(given.attr("volumes"));
  points.sets = given.attr("sets").cast<std::map<std::string, std::vector<Index>>>();
  for (const auto& [name, values] : given.attr("columns").cast<py::dict>()) {
    points.columns[name.cast<std::string>()] = numbers(py::reinterpret_borrow<py::object>(values));
  }
  return points;
}

}  // namespace

std::shared_ptr<const Givens> givens_of(const py::dict& functions, const py::object& points) {
  auto givens = std::make_shared<Givens>();
  for (const auto& [name, function] : functions) {
    const auto [arguments, fill] = function.cast<std::pair<int, py::function>>();
    givens->functions[name.cast<std::string>()] = given(arguments, shared(fill));
  }
  if (!points.is_none()) givens->points = points_of(points);
  return givens;
}

}  // namespace peristat::python
