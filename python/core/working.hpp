#pragma once

#include <pybind11/pybind11.h>

namespace peristat::python {

/// Work that Python waits for before it ends, see let_python_wait.
struct Unfinished {
  Unfinished();
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
};

/// Makes it a context manager of the module, for what Python does after a run.
void bind_unfinished(pybind11::module_& module);

/// The turn of a thread to work in peristat, without Python's global lock. One thread works at a
/// time: the threads of OpenMP would compete for the cores, and expressions are not thread-safe.
///
/// @throws std::runtime_error if another thread is at work, or if Python is about to end
class Working {
 public:
  Working();
  ~Working();
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;

 private:
  const Unfinished unfinished_{};  // until it has Python's global lock again
  pybind11::gil_scoped_release released_;
};

/// True once Python is about to end: runs end after their present iteration.
[[nodiscard]] bool is_python_ending();

/// Before Python ends it waits for the end of what other threads do here, for a minute at most. A
/// thread that asks for Python's global lock afterwards would end in the midst of C++, and the
/// process with an error.
void let_python_wait();

/// Holds Python's global lock for a call from C++ into Python. The turn is given up meanwhile, so
/// that the called function may use peristat.
class Calling {
 public:
  Calling();
  ~Calling();
  Calling(const Calling&) = delete;
  Calling& operator=(const Calling&) = delete;

 private:
  pybind11::gil_scoped_acquire held_;
};

}  // namespace peristat::python
