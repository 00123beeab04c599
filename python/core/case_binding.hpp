#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "cases/runner/input/case.hpp"
#include "solvers/body/body.hpp"

namespace peristat::python {

/// A case as Python holds it. Bodies that are made from it share it.
using SharedCase = std::shared_ptr<const Case>;

/// A body with the case that it was made of.
struct BoundBody {
  SharedCase of;
  std::shared_ptr<const Body> body;
};

void bind_case(pybind11::module_& module);
void bind_body(pybind11::module_& module);

}  // namespace peristat::python
