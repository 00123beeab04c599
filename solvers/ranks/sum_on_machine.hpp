#pragma once

#include "src/parallel/communicator.hpp"

namespace peristat {

/// Sum over the ranks on this machine, which share its memory. Collective.
[[nodiscard]] double sum_on_machine(const Communicator& ranks, double mine);

}  // namespace peristat
