#pragma once

#include "cases/runner/input/settings.hpp"
#include "cases/runner/results/files/hdf5_file.hpp"

namespace peristat {

/// Writes the values given by `--set` as the table /case/settings.
void write_settings(Hdf5File& file, const Settings& settings);

[[nodiscard]] Settings read_settings(const Hdf5File& file);

}  // namespace peristat
