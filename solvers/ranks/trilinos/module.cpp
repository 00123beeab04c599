#include "solvers/ranks/trilinos/module.hpp"

extern "C" const peristat::ranks::Module* peristat_ranks_module() {
  using namespace peristat::ranks;
  static constexpr Module module{start_ranks, exchange, partition, make_ghost_exchange};
  return &module;
}
