#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "cases/runner/input/givens.hpp"

namespace peristat::python {

/// What Python gives beside the text of a case.
/// @param functions by name: (number of arguments, fill), where fill(arguments, count) returns an
///        array of `count` numbers; arguments are arrays of `count` numbers or of one
/// @param points None, or an object with positions, volumes, sets and columns (points.py)
[[nodiscard]] std::shared_ptr<const Givens> givens_of(const pybind11::dict& functions,
                                                      const pybind11::object& points);

}  // namespace peristat::python
