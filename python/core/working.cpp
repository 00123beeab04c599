#include "python/core/working.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>

#include <pthread.h>

namespace peristat::python {
namespace py = pybind11;
namespace {

std::mutex& turn() {
  static std::mutex of_all;
  return of_all;
}

std::atomic<bool> python_ends = false;

/// Pieces of work that have begun and not ended, also those that wait for a call into Python.
struct Begun {
  std::mutex mutex;
  std::condition_variable changed;
  int count = 0;
};

Begun& begun() {
  static Begun of_all;
  return of_all;
}

void count(int change) {
  const std::lock_guard held(begun().mutex);
  begun().count += change;
  begun().changed.notify_all();
}

}  // namespace

Working::Working() {
  if (python_ends) throw std::runtime_error("Python is about to end");
  if (turn().try_lock()) return;
  throw std::runtime_error(
      "another thread is running peristat, and only one thread at a time may do so; peristat.sweep "
      "with jobs=N runs cases in parallel processes");
}

Working::~Working() { turn().unlock(); }

Unfinished::Unfinished() { count(1); }

Unfinished::~Unfinished() { count(-1); }

void bind_unfinished(py::module_& module) {
  using Block = std::optional<Unfinished>;
  py::class_<Block>(module, "Unfinished")
      .def(py::init<>())
      .def("__enter__", [](Block& block) { block.emplace(); })
      .def("__exit__", [](Block& block, const py::args&) { block.reset(); });
}

bool is_python_ending() { return python_ends; }

void let_python_wait() {
  // Other threads do not exist in a process that has been forked.
  pthread_atfork(nullptr, nullptr, [] { new (&begun()) Begun; });
  const auto wait = [] {
    python_ends = true;
    const py::gil_scoped_release while_waiting;
    Begun& all = begun();
    std::unique_lock held(all.mutex);
    all.changed.wait_for(held, std::chrono::minutes(1), [&] { return all.count <= 0; });
  };
  py::module_::import("atexit").attr("register")(py::cpp_function(wait));
}

Calling::Calling() { turn().unlock(); }

Calling::~Calling() {
  // Another thread may have the turn now and need the global lock to end it.
  const py::gil_scoped_release while_waiting;
  turn().lock();
}

}  // namespace peristat::python
