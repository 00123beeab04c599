// Linked into the program alone: shared libraries can't have functions that run before libraries
// are loaded.
#if !defined(__SANITIZE_ADDRESS__)

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <unistd.h>

#include "cases/runner/process/blas_buffers.hpp"
#include "cases/runner/process/processors.hpp"
#include "src/core/address_space.hpp"

namespace peristat {
namespace {

/// Value of a variable among "NAME=value", or 0.
int positive_variable(char** environment, const char* name) {
  const std::size_t length = std::strlen(name);
  for (char** entry = environment; *entry; ++entry) {
    if (std::strncmp(*entry, name, length) == 0 && (*entry)[length] == '=') {
      return std::max(0, std::atoi(*entry + length + 1));
    }
  }
  return 0;
}

/// Runs before the initialisers of all libraries, so it may use nothing that needs them.
void require_room_to_load(int, char**, char** environment) {
  int buffers = std::min(processors(), most_blas_buffers);
  for (const char* name : {"OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS"}) {
    if (const int threads = positive_variable(environment, name)) {
      buffers = std::min(buffers, threads);
      break;
    }
  }
  if (has_address_space(std::size_t(buffers) * blas_buffer_bytes + loading_bytes)) return;
  constexpr char message[] =
      "peristat: too little address space to start: the shell allows less than the libraries need "
      "with their 134 MB per thread. See \"ulimit -v\"; fewer threads (OMP_NUM_THREADS=1) need "
      "less\n";
  [[maybe_unused]] const ssize_t ignored = write(STDERR_FILENO, message, sizeof message - 1);
  _exit(4);
}

[[gnu::section(".preinit_array"),
  gnu::used]] void (*before_libraries)(int, char**, char**) = require_room_to_load;

}  // namespace
}  // namespace peristat

#endif
