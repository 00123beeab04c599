#include <new>
#include <stdexcept>
#include <string>

#include "solvers/linear/load_module.hpp"
#include "solvers/linear/trilinos/module.hpp"

namespace peristat {
namespace {

/// Address space of Trilinos, 180 MB as measured, and of what its solvers allocate.
constexpr std::size_t room_for_trilinos = std::size_t(256) << 20;

/// Loads the module on the first call. It stays loaded: Kokkos is stopped when the process ends.
const trilinos::Module& trilinos_module() {
  static const trilinos::Module* const loaded = [] {
    void* const symbol =
        load_module("Trilinos", trilinos::module_file, trilinos::module_symbol, room_for_trilinos);
    return reinterpret_cast<const trilinos::Module* (*)()>(symbol)();
  }();
  return *loaded;
}

}  // namespace

KrylovResult solve_krylov(int size, const VectorMap& matrix, const VectorMap& preconditioner,
                          const double* right_hand_side, double* solution,
                          const KrylovOptions& options) {
  return trilinos_module().solve_krylov(size, matrix, preconditioner, right_hand_side, solution,
                                        options);
}

struct MatrixPreconditioner::Implementation {
  std::unique_ptr<trilinos::Preconditioner> preconditioner;
  std::string failure;
};

MatrixPreconditioner::MatrixPreconditioner(MatrixPreconditionerKind kind,
                                           const MatrixPreconditionerOptions& options)
    : implementation_(
          new Implementation{trilinos_module().make_preconditioner(kind, options), {}}) {}

MatrixPreconditioner::~MatrixPreconditioner() = default;

bool MatrixPreconditioner::build(const CompressedRows& matrix, const EquationBlocks& blocks,
                                 const NearNullSpace& near_null_space) {
  implementation_->failure.clear();
  try {
    implementation_->preconditioner->build(matrix, blocks, near_null_space);
    return true;
  } catch (const trilinos::NoPreconditioner& error) {
    implementation_->failure = error.what();
  } catch (const std::bad_alloc&) {
    if (matrix.ranks) throw;
    implementation_->failure = "out of memory";
  } catch (const std::exception& error) {
    if (matrix.ranks) throw;
    implementation_->failure = error.what();
  }
  return false;
}

const std::string& MatrixPreconditioner::failure() const { return implementation_->failure; }

void MatrixPreconditioner::apply(const double* r, double* z) {
  implementation_->preconditioner->apply(r, z);
}

std::string MatrixPreconditioner::describe() const {
  return implementation_->preconditioner->describe();
}

std::string trilinos_version() { return trilinos_module().version(); }

}  // namespace peristat
