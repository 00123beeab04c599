#include "solvers/body/require_memory_for.hpp"

#include <string>

#include <fmt/format.h>

#include "solvers/linear/available_memory.hpp"
#include "solvers/ranks/sum_on_machine.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

void require_memory_for(const Body& body, double bytes) {
  const IndexMap& index_map = *body.index_map;
  require_memory(sum_on_machine(index_map.ranks(), bytes),
                 fmt::format("{}the body with {} points",
                             index_map.ranks().count() == 1 ? "" : "what a machine has of ",
                             index_map.whole()));
}

}  // namespace peristat
