#pragma once

namespace peristat {

/// Number of processors that this process may run on; 1 if unknown.
[[nodiscard]] int processors();

}  // namespace peristat
