#pragma once

#include <string>

#include "cases/runner/process/failure.hpp"

namespace peristat {

/// JSON schema (draft-07) of case files, by which editors complete and check them. It says less
/// than the reader, which also knows the limits that depend on other keys.
[[nodiscard]] std::string case_schema();

/// The command `schema`: prints it.
[[nodiscard]] Exit print_schema();

}  // namespace peristat
