// Cholesky factorisation of a plate held on one side.
#include <stdexcept>

#include <benchmark/benchmark.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "benchmarks/lattice_bodies.hpp"
#include "solvers/linear/cholesky.hpp"

namespace {

using namespace peristat;

void factorisation(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const Points points = benchmark_bodies::box(2, {width, width, 0});
  const Model model = benchmark_bodies::model(points);
  Assembler assembler(points, model, omp_get_max_threads());
  Tangent tangent(BlockPattern(model.bonds()), 2);
  assembler.tangent(std::vector<double>(points.reference.size(), 0.0), tangent);
  std::vector<char> prescribed(points.reference.size(), 0);
  std::fill_n(prescribed.begin(), std::size_t(2) * 3 * width, 1);
  const FreeDofs free(prescribed, 2);
  Cholesky solver;
  if (solver.analyze(tangent.pattern, free) != LinearOutcome::solved) {
    throw std::runtime_error("the analysis failed");
  }
  // The first factorisation also pays for the pages of the factor's memory (a tenth of it).
  if (solver.factorize(tangent, FactorUse::factorize_now) != LinearOutcome::solved) {
    throw std::runtime_error("the factorisation failed");
  }
  for (auto _ : state) {
    if (solver.factorize(tangent, FactorUse::factorize_now) != LinearOutcome::solved) {
      throw std::runtime_error("the factorisation failed");
    }
  }
  state.counters["flop"] =
      benchmark::Counter(solver.estimate().flops, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(factorisation)
    ->ArgName("width")
    ->Arg(100)
    ->Arg(300)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
