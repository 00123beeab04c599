#include "cases/runner/process/blas_memory.hpp"

#include <algorithm>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <cblas.h>

#include "cases/runner/process/blas_buffers.hpp"
#include "cases/runner/process/processors.hpp"
#include "src/core/address_space.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

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
  const int buffers = std::min(threads, most_blas_buffers) + 1;
  const int taken = std::min({threads, processors(), most_blas_buffers});
  if (!has_address_space(std::size_t(buffers - taken) * blas_buffer_bytes + loading_bytes)) {
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
