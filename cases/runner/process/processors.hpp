#pragma once

namespace peristat {

/// Processors that this process may run on; 1 if the system does not tell.
[[nodiscard]] int processors();

}  // namespace peristat
