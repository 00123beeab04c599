#pragma once

#include <pybind11/pybind11.h>

namespace peristat::python {

/// Turns exceptions of C++ into those of python/peristat/errors.py: InputError with its key, value,
/// sentence and place, MachineError and MemoryError. Any other becomes a RuntimeError.
void translate_errors(pybind11::module_& module);

}  // namespace peristat::python
