#pragma once

#include <pybind11/pybind11.h>

namespace peristat::python {

/// The turn of a thread to work in peristat, without Python's global lock. One thread works at a
/// time: the threads of OpenMP would compete for the cores, and expressions are not thread-safe.
///
/// @throws std::runtime_error if another thread is at work
class Working {
 public:
  Working();
  ~Working();
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;

 private:
  pybind11::gil_scoped_release released_;
};

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
