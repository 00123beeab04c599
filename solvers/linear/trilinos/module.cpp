#include "solvers/linear/trilinos/module.hpp"

extern "C" const peristat::trilinos::Module* peristat_trilinos_module() {
  using namespace peristat::trilinos;
  static constexpr Module module{solve_krylov, make_preconditioner, version};
  return &module;
}
