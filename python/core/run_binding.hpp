#pragma once

#include <pybind11/pybind11.h>

namespace peristat::python {

void bind_runs(pybind11::module_& module);

}  // namespace peristat::python
