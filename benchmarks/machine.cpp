// What the machine can do at best, measured in the same run as everything else: all figures are
// read against these.
#include <vector>

#include <benchmark/benchmark.h>
#include <cblas.h>
#include <omp.h>

namespace {

void dgemm(benchmark::State& state) {
  const int size = 1200;
  const std::vector<double> a(std::size_t(size) * size, 1.1), b(a.size(), 0.7);
  std::vector<double> c(a.size());
  for (auto _ : state) {
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, size, size, size, 1.0, a.data(), size,
                b.data(), size, 0.0, c.data(), size);
    benchmark::ClobberMemory();
  }
  state.counters["flop"] = benchmark::Counter(2.0 * size * double(size) * size,
                                              benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(dgemm)->UseRealTime()->Unit(benchmark::kMillisecond);

void stream_triad(benchmark::State& state) {
  const std::ptrdiff_t size = 20'000'000;
  std::vector<double> a(size), b(size), c(size);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t k = 0; k < size; ++k) b[k] = c[k] = 1.0;
  for (auto _ : state) {
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t k = 0; k < size; ++k) a[k] = b[k] + 3.0 * c[k];
    benchmark::ClobberMemory();
  }
  state.counters["byte"] =
      benchmark::Counter(24.0 * double(size), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(stream_triad)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
