#pragma once

#include "src/core/communicator.hpp"

namespace peristat {

/// Sum over the ranks that share this one's machine, and so its memory. A call that all ranks make.
[[nodiscard]] double sum_on_machine(const Communicator& ranks, double mine);

}  // namespace peristat
