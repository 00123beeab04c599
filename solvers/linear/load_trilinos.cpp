#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include <dlfcn.h>

#include "solvers/linear/trilinos/module.hpp"
#include "src/core/address_space.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

// Address space of Trilinos, 180 MB as measured, and what its solvers allocate: where its libraries
// find none while they are loaded, the program ends.
constexpr std::size_t room_for_trilinos = std::size_t(256) << 20;

/// The loader tells why in words alone: "cannot open shared object file: Error 24", "failed to map
/// segment from shared object", "cannot allocate memory in static TLS block", ...
[[noreturn]] void throw_why_not(const std::string& reason) {
  for (const int cause : {EMFILE, ENFILE}) {
    if (reason.ends_with("Error " + std::to_string(cause)) ||
        reason.ends_with(std::strerror(cause))) {
      throw MachineError("Trilinos can't be loaded: " + reason);
    }
  }
  if (reason.find("map segment") != std::string::npos ||
      reason.find("allocate memory") != std::string::npos) {
    throw std::bad_alloc();
  }
  throw std::runtime_error("Trilinos can't be loaded: " + reason);
}

/// Loads the module at the first call. It stays: Kokkos is stopped when the process ends.
const trilinos::Module& module() {
  static const trilinos::Module* const loaded = [] {
    // Found by the run path of the program. BLAS is the program's own: symbols that it already has
    // come first.
    if (!has_address_space(room_for_trilinos)) throw std::bad_alloc();
    void* const library = dlopen(trilinos::module_file, RTLD_LAZY | RTLD_LOCAL);
    if (!library) throw_why_not(dlerror());
    void* const symbol = dlsym(library, trilinos::module_symbol);
    if (!symbol) throw std::runtime_error(std::string("Trilinos can't be loaded: ") + dlerror());
    return reinterpret_cast<const trilinos::Module* (*)()>(symbol)();
  }();
  return *loaded;
}

}  // namespace

KrylovResult solve_krylov(int size, const VectorMap& matrix, const VectorMap& preconditioner,
                          const double* right_hand_side, double* solution,
                          const KrylovOptions& options) {
  return module().solve_krylov(size, matrix, preconditioner, right_hand_side, solution, options);
}

struct MatrixPreconditioner::Implementation {
  std::unique_ptr<trilinos::Preconditioner> preconditioner;
  std::string failure;
};

MatrixPreconditioner::MatrixPreconditioner(MatrixPreconditionerKind kind,
                                           const MatrixPreconditionerOptions& options)
    : implementation_(new Implementation{module().make_preconditioner(kind, options), {}}) {}

MatrixPreconditioner::~MatrixPreconditioner() = default;

bool MatrixPreconditioner::build(const CompressedRows& matrix, const EquationBlocks& blocks,
                                 const NearNullSpace& near_null_space) {
  implementation_->failure.clear();
  try {
    implementation_->preconditioner->build(matrix, blocks, near_null_space);
    return true;
  } catch (const std::bad_alloc&) {
    implementation_->failure = "out of memory";
  } catch (const std::exception& error) {
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

std::string trilinos_version() { return module().version(); }

}  // namespace peristat
