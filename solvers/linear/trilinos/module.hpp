#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "solvers/linear/trilinos/krylov.hpp"
#include "solvers/linear/trilinos/matrix_preconditioner.hpp"

// Trilinos brings a hundred shared libraries, which cost every start of the program 60 ms and 40
// MB. The code that uses it is therefore a module that is loaded on the first call
// (load_trilinos.cpp), and this header is the interface between program and module.

namespace peristat::trilinos {

/// Thrown if there is no preconditioner, by all ranks at the same place.
struct NoPreconditioner : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Implementation of MatrixPreconditioner inside the module. build() throws if there is none.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void build(const CompressedRows& matrix, const EquationBlocks& blocks,
                     const NearNullSpace& near_null_space) = 0;
  virtual void apply(const double* r, double* z) = 0;
  [[nodiscard]] virtual std::string describe() const = 0;
};

using SolveKrylov = KrylovResult(int size, const VectorMap& matrix, const VectorMap& preconditioner,
                                 const double* right_hand_side, double* solution,
                                 const KrylovOptions& options);
SolveKrylov solve_krylov;

using MakePreconditioner = std::unique_ptr<Preconditioner>(
    MatrixPreconditionerKind kind, const MatrixPreconditionerOptions& options);
MakePreconditioner make_preconditioner;

using Version = std::string();
Version version;

struct Module {
  SolveKrylov* solve_krylov;
  MakePreconditioner* make_preconditioner;
  Version* version;
};

/// The module's one symbol, of type `const Module*()`.
inline constexpr const char* module_symbol = "peristat_trilinos_module";
/// Its file, beside the program.
inline constexpr const char* module_file = "peristat_trilinos.so";

}  // namespace peristat::trilinos
