#include "cases/runner/process/blas_memory.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <cblas.h>
#include <sched.h>
#include <unistd.h>

#include "cases/runner/process/processors.hpp"
#include "src/core/address_space.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

// Buffer of OpenBLAS on x86-64: 32 MB << 2; measured as the growth of the address space per thread.
constexpr std::size_t buffer_bytes = std::size_t(128) << 20;
// Room for other allocations while libraries are loaded, and between the check of the room left and
// the allocation of the buffer, which OpenBLAS retries for ever if it fails.
constexpr std::size_t loading_bytes = std::size_t(16) << 20;
constexpr int most_buffers = 128;  // OpenBLAS of Debian takes no more threads

#if !defined(__SANITIZE_ADDRESS__)
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
  int buffers = std::min(processors(), most_buffers);
  for (const char* name : {"OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS"}) {
    if (const int threads = positive_variable(environment, name)) {
      buffers = std::min(buffers, threads);
      break;
    }
  }
  if (has_address_space(std::size_t(buffers) * buffer_bytes + loading_bytes)) return;
  constexpr char message[] =
      "peristat: too little address space to start: the shell allows less than the libraries need "
      "with their 134 MB per thread. See \"ulimit -v\"; fewer threads (OMP_NUM_THREADS=1) need "
      "less\n";
  [[maybe_unused]] const ssize_t ignored = write(STDERR_FILENO, message, sizeof message - 1);
  _exit(4);
}

[[gnu::section(".preinit_array"),
  gnu::used]] void (*before_libraries)(int, char**, char**) = require_room_to_load;
#endif

/// Starts `count` threads at once, as OpenMP will, and ends them again.
void try_threads(int count) {
  std::vector<std::jthread> team;
  for (int thread = 0; thread < count; ++thread) {
    team.emplace_back([](const std::stop_token& stop) {
      while (!stop.stop_requested()) std::this_thread::yield();
    });
  }
}

}  // namespace

void claim_blas_memory(int threads) {
  const int buffers = std::min(threads, most_buffers) + 1;
  const int taken = std::min({threads, processors(), most_buffers});
  if (!has_address_space(std::size_t(buffers - taken) * buffer_bytes + loading_bytes)) {
    throw std::bad_alloc();
  }
  openblas_set_num_threads(threads);
  // The calling thread's buffer is allocated by its first product that is not small: with AVX-512,
  // products of up to 1e6 multiplications need none.
  constexpr int size = 160;
  std::vector<double> a(std::size_t(size) * size, 1.0), c(a.size());
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, size, size, size, 1.0, a.data(), size,
              a.data(), size, 0.0, c.data(), size);
  try {
    try_threads(threads - 1);
  } catch (const std::system_error& error) {
    if (!has_address_space(std::size_t(threads) * loading_bytes)) throw std::bad_alloc();
    throw MachineError(std::string("the system does not provide ") + std::to_string(threads) +
                       " threads: " + error.what());
  }
#pragma omp parallel num_threads(threads)
  {}
}

}  // namespace peristat
