#include "python/core/working.hpp"

#include <mutex>
#include <optional>
#include <stdexcept>

namespace peristat::python {
namespace {

std::mutex& turn() {
  static std::mutex of_all;
  return of_all;
}

}  // namespace

Working::Working() {
  if (turn().try_lock()) return;
  throw std::runtime_error(
      "another thread is running peristat, and only one thread at a time may do so; peristat.sweep "
      "with jobs=N runs cases in parallel processes");
}

Working::~Working() { turn().unlock(); }

Calling::Calling() { turn().unlock(); }

Calling::~Calling() {
  // Another thread may have the turn now and need the global lock to end it.
  const pybind11::gil_scoped_release while_waiting;
  turn().lock();
}

}  // namespace peristat::python
