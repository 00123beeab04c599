#include "solvers/linear/mumps/module.hpp"

extern "C" const peristat::mumps::Module* peristat_mumps_module() {
  using namespace peristat::mumps;
  static constexpr Module module{make_symmetric_factor, version};
  return &module;
}
