#include "python/core/errors.hpp"

#include <new>
#include <system_error>

#include "solvers/linear/available_memory.hpp"
#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"

namespace peristat::python {
namespace py = pybind11;
namespace {

void raise(const py::object& error) {
  PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
}

void raise(const char* name, const char* message) {
  raise(py::module_::import("peristat.errors").attr(name)(message));
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise(py::module_::import("peristat.errors")
              .attr("InputError")(error.what(), error.key(), error.value(), error.allowed(),
                                  error.place()));
  } catch (const MemoryError& error) {
    raise("MemoryError", error.what());
  } catch (const std::bad_alloc&) {
    raise("MemoryError", "out of memory");
  } catch (const MachineError& error) {
    raise("MachineError", error.what());
  } catch (const std::system_error& error) {
    raise("MachineError", error.what());
  }
}

}  // namespace

void translate_errors(py::module_&) { py::register_exception_translator(translate); }

}  // namespace peristat::python
