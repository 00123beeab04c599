#pragma once

#include "cases/runner/input/key_table.hpp"

namespace peristat {

/// The results.
[[nodiscard]] Table<OutputSpecification> output_keys();
[[nodiscard]] Table<ProbeSpecification> probe_keys();
[[nodiscard]] Table<CrackTipSpecification> crack_tip_keys();
[[nodiscard]] Table<SensitivitySpecification> sensitivity_keys();

}  // namespace peristat
