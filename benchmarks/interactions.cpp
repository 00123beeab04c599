// The passes over triangles and tetrahedra.
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/simplices/simplex_term.hpp"
#include "benchmarks/lattice_bodies.hpp"

namespace {

using namespace peristat;

enum class Pass { gradient, tangent, product };

/// Arguments: horizon in thousandths of the spacing, whether the interactions are stored.
template <class Measure, Pass pass>
void assembly(benchmark::State& state) {
  const Points points = benchmark_bodies::box(3, {16, 16, 16});
  BondSetting setting = benchmark_bodies::setting(3);
  setting.horizon = 1e-3 * double(state.range(0));
  const int threads = omp_get_max_threads();
  Model model(make_bonds(points, SurfaceCorrection::none, setting, 1),
              Harmonic{micromodulus(1.0, setting)});
  Interactions<Measure> interactions(points, model.bonds(), setting.cross_section, threads);
  interactions.set_shares(std::vector<double>(points.volume.size(), 1.0));
  if (state.range(1)) interactions.store(points, model.bonds(), threads);
  const double count = double(interactions.count());
  Simplices<Measure> simplices{std::move(interactions), Harmonic{1e-3}};
  if constexpr (Measure::arms == 2) {
    model.add(
        std::make_shared<SimplexTerm>(model.bond_failure(), std::move(simplices), std::nullopt));
  } else {
    model.add(
        std::make_shared<SimplexTerm>(model.bond_failure(), std::nullopt, std::move(simplices)));
  }
  Assembler assembler(points, model, threads);
  Tangent tangent(BlockPattern(model.bonds()), 3);
  std::vector<double> displacement(points.reference.size()), result(displacement.size());
  for (std::size_t k = 0; k < displacement.size(); ++k) {
    displacement[k] = 1e-2 * std::sin(7.0 * double(k));
  }
  for (auto _ : state) {
    if constexpr (pass == Pass::gradient) {
      benchmark::DoNotOptimize(assembler.gradient(displacement, result));
    } else if constexpr (pass == Pass::tangent) {
      assembler.tangent(displacement, tangent);
    } else {
      assembler.product(displacement, displacement, result);
    }
    benchmark::ClobberMemory();
  }
  state.counters["interaction"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
}

void horizons(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"horizon", "stored"})->UseRealTime()->Unit(benchmark::kMillisecond);
  for (int horizon : {2015, 2500, 3015}) {
    for (int stored : {0, 1}) benchmark->Args({horizon, stored});
  }
}

BENCHMARK(assembly<Volume, Pass::tangent>)->Name("tetrahedra_tangent")->Apply(horizons);
BENCHMARK(assembly<Volume, Pass::gradient>)->Name("tetrahedra_gradient")->Apply(horizons);
BENCHMARK(assembly<Volume, Pass::product>)->Name("tetrahedra_product")->Apply(horizons);
BENCHMARK(assembly<Area, Pass::tangent>)->Name("triangles_tangent")->Apply(horizons);
BENCHMARK(assembly<Area, Pass::gradient>)->Name("triangles_gradient")->Apply(horizons);

}  // namespace
