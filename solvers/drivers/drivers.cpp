#include "solvers/drivers/drivers.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "solvers/drivers/arc_length_stepping.hpp"
#include "solvers/drivers/dynamics.hpp"
#include "solvers/drivers/event_stepping.hpp"
#include "solvers/drivers/fatigue_stepping.hpp"
#include "solvers/drivers/hand_over.hpp"
#include "solvers/drivers/implicit_stepping.hpp"
#include "solvers/drivers/relaxed_stepping.hpp"

namespace peristat {
namespace {

template <class AnyDriver>
std::unique_ptr<Driver> make(Path& path) {
  return std::make_unique<AnyDriver>(path);
}

/// A new driver is one line here and a file of its own.
constexpr std::array drivers{
    DriverEntry{Mode::newton, make<ImplicitStepping>},
    DriverEntry{Mode::relaxation, make<RelaxedStepping>},
    DriverEntry{Mode::adaptive, make<HandOver>},
    DriverEntry{Mode::arc_length, make<ArcLengthStepping>},
    DriverEntry{Mode::path, make<EventStepping>},
    DriverEntry{Mode::dynamics, make<Dynamics>},
    DriverEntry{Mode::fatigue, make<FatigueStepping>},
};

}  // namespace

std::span<const DriverEntry> all_drivers() { return drivers; }

std::unique_ptr<Driver> make_driver(const Mode& mode, Path& path) {
  for (const DriverEntry& driver : drivers) {
    if (driver.mode == mode) return driver.make(path);
  }
  throw std::logic_error("no driver is called " + std::string(mode.name));
}

}  // namespace peristat
