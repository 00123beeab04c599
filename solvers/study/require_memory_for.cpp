#include "solvers/study/require_memory_for.hpp"

#include <string>

#include <fmt/format.h>

#include "solvers/linear/available_memory.hpp"
#include "solvers/ranks/sum_on_machine.hpp"

namespace peristat {

void require_memory_for(const Body& body, double bytes) {
  if (!body.part) {
    return require_memory(bytes, fmt::format("the body with {} points", body.points.count()));
  }
  require_memory(sum_on_machine(body.part->ranks(), bytes),
                 fmt::format("what a machine has of the body with {} points", body.part->whole()));
}

}  // namespace peristat
