// Neighbour search and the passes over the bonds.
#include <cmath>
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "benchmarks/lattice_bodies.hpp"
#include "src/neighbourhood/search.hpp"

namespace {

using namespace peristat;

Points body(const benchmark::State& state) {
  return state.range(0) == 2 ? benchmark_bodies::box(2, {300, 300, 0})
                             : benchmark_bodies::box(3, {40, 40, 40});
}

/// A small displacement and a direction, different at every point.
std::vector<double> wave(const Points& points, double amplitude, double frequency) {
  std::vector<double> values(points.reference.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = amplitude * std::sin(frequency * double(k));
  }
  return values;
}

void count_bonds(benchmark::State& state, double bonds) {
  state.counters["bond"] = benchmark::Counter(bonds, benchmark::Counter::kIsIterationInvariantRate);
}

void neighbour_search(benchmark::State& state) {
  const Points points = body(state);
  double directed = 0.0;
  for (auto _ : state) {
    const Bonds bonds = search_bonds(points, benchmark_bodies::horizon, omp_get_max_threads());
    directed = 2.0 * double(bonds.count());
  }
  count_bonds(state, directed);
}

enum class Pass { energy, gradient, tangent, product, single_product, stored_product };

/// Bonds in the rows of the lattice at once, one by one, and states.
enum class Solid { bonds, listed_bonds, states };

template <Pass pass, Solid solid = Solid::bonds>
void assembly(benchmark::State& state) {
  const Points points = body(state);
  Model model = solid == Solid::states
                    ? benchmark_bodies::state_model(points, omp_get_max_threads())
                    : benchmark_bodies::model(points);
  if (solid == Solid::listed_bonds) model.sum_one_by_one();
  // Products of states need no blocks between second neighbours.
  const auto pattern =
      solid == Solid::states ? Assembler::PatternOf::visited_rows : Assembler::PatternOf::blocks;
  Assembler assembler(points, model, omp_get_max_threads(), whole_body(), pattern);
  // Only where it is used.
  std::optional<Tangent> tangent;
  if (pass == Pass::tangent || pass == Pass::stored_product) tangent.emplace(assembler);
  const std::vector<double> displacement = wave(points, 1e-2, 7.0), v = wave(points, 1.0, 3.0);
  std::vector<double> result(v.size());
  for (auto _ : state) {
    if constexpr (pass == Pass::energy) {
      benchmark::DoNotOptimize(assembler.energy(displacement));
    } else if constexpr (pass == Pass::gradient) {
      benchmark::DoNotOptimize(assembler.gradient(displacement, result));
    } else if constexpr (pass == Pass::tangent) {
      assembler.tangent(displacement, *tangent);
    } else if constexpr (pass == Pass::product) {
      assembler.product(displacement, v, result);
    } else if constexpr (pass == Pass::single_product) {
      StateView at(displacement);
      at.precision = Precision::single;
      assembler.product(at, v, result);
    } else {
      tangent->multiply(v, result);
    }
    benchmark::ClobberMemory();
  }
  count_bonds(state, double(model.bonds().count()));
}

void both_dimensions(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("dimension")->Arg(2)->Arg(3)->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(neighbour_search)->Apply(both_dimensions);
BENCHMARK(assembly<Pass::energy>)->Name("energy")->Apply(both_dimensions);
BENCHMARK(assembly<Pass::gradient>)->Name("gradient")->Apply(both_dimensions);
BENCHMARK(assembly<Pass::tangent>)->Name("tangent")->Apply(both_dimensions);
BENCHMARK(assembly<Pass::product>)->Name("matrix_free_product")->Apply(both_dimensions);
BENCHMARK(assembly<Pass::single_product>)->Name("single_product")->Apply(both_dimensions);
BENCHMARK(assembly<Pass::energy, Solid::listed_bonds>)
    ->Name("listed_energy")
    ->Apply(both_dimensions);
BENCHMARK(assembly<Pass::gradient, Solid::listed_bonds>)
    ->Name("listed_gradient")
    ->Apply(both_dimensions);
BENCHMARK(assembly<Pass::product, Solid::listed_bonds>)
    ->Name("listed_product")
    ->Apply(both_dimensions);
BENCHMARK(assembly<Pass::gradient, Solid::states>)->Name("state_gradient")->Apply(both_dimensions);
BENCHMARK(assembly<Pass::product, Solid::states>)->Name("state_product")->Apply(both_dimensions);
BENCHMARK(assembly<Pass::stored_product>)->Name("stored_product")->Apply(both_dimensions);

}  // namespace
