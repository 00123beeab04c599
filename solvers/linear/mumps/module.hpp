#pragma once

#include <memory>
#include <string>

#include "solvers/linear/mumps/symmetric_factor.hpp"

// Sequential MUMPS brings its own replacement of MPI, whose functions must not clash with the MPI
// that Trilinos is linked with. It is therefore a module of its own
// (solvers/linear/load_module.hpp).

namespace peristat::mumps {

using MakeSymmetricFactor = std::unique_ptr<SymmetricFactor>();
MakeSymmetricFactor make_symmetric_factor;

struct Module {
  MakeSymmetricFactor* make_symmetric_factor;
  std::string (*version)();
};

/// The module's one symbol, of type `const Module*()`.
inline constexpr const char* module_symbol = "peristat_mumps_module";
/// Its file, beside the program.
inline constexpr const char* module_file = "peristat_mumps.so";

}  // namespace peristat::mumps
