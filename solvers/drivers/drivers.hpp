#pragma once

#include <memory>
#include <span>

#include "solvers/drivers/driver.hpp"

namespace peristat {

/// A row of the table of drivers.
struct DriverEntry {
  Mode mode;
  std::unique_ptr<Driver> (*make)(Path& path);
};

/// All drivers; `solver.mode` in a case file is the name of one.
[[nodiscard]] std::span<const DriverEntry> all_drivers();

/// @throws std::logic_error if no driver has that name
[[nodiscard]] std::unique_ptr<Driver> make_driver(const Mode& mode, Path& path);

}  // namespace peristat
