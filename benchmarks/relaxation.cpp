// Iterations of adaptive dynamic relaxation, and matrix-free products of the same bonds in the same
// state.
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "benchmarks/lattice_bodies.hpp"
#include "solvers/search/dynamic_relaxation.hpp"

namespace {

using namespace peristat;

/// Rows of points at once, or bond by bond.
enum class Sums { along_runs, one_by_one };

constexpr int iterations_per_call = 300;  ///< so that a call's tangent costs a hundredth of it

/// What bonds are: `broken` is `tanh` with every fiftieth bond broken.
enum Law { elastic, tanh_law, broken };

Points held_box(const benchmark::State& state) {
  Points points = state.range(0) == 2 ? benchmark_bodies::box(2, {100, 100, 0})
                                      : benchmark_bodies::box(3, {25, 25, 25});
  for (Index i = 0; i < points.count(); ++i) {
    if (points.position(i)[0] < 3.0) points.sets["held"].push_back(i);
  }
  return points;
}

Model model_of(const Points& points, Law law, Sums sums) {
  Model model = benchmark_bodies::model(points);
  if (law != elastic) {
    const double modulus = std::get<Harmonic>(model.bond_failure()->potential()).modulus;
    model = Model(model.bonds(), Degraded<TanhDegradation>{modulus, {0.016, 0.020, 3.0}});
  }
  if (sums == Sums::one_by_one) model.sum_one_by_one();
  return model;
}

SupportSpecification hold(int dimension) {
  SupportSpecification support{"held", {"0", "0", {}}};
  if (dimension == 3) support.displacement[2] = "0";
  return support;
}

/// A held body in a state that damages nothing; arguments: dimension, law, whether the histories
/// follow every iteration.
struct HeldBody {
  Points points;
  Model model;
  Conditions conditions;
  FreeDofs free;
  Assembler assembler;
  Breaking breaking;
  State from;

  HeldBody(const benchmark::State& state, Sums sums)
      : points(held_box(state)),
        model(model_of(points, Law(state.range(1)), sums)),
        conditions(points, {hold(points.dimension)}, {}),
        free(conditions.prescribed(), points.dimension),
        assembler(points, model, omp_get_max_threads()),
        breaking(state.range(2) ? Breaking::transient : Breaking::at_equilibrium),
        from{std::vector<double>(points.reference.size()), 1.0, assembler.initial_history()} {
    for (std::size_t k = 0; k < from.displacement.size(); ++k) {
      from.displacement[k] = 1e-3 * std::sin(7.0 * double(k));
    }
    if (state.range(1) != broken) return;
    std::vector<double> stretches(std::size_t(model.bonds().count()), 0.0);
    for (std::size_t bond = 0; bond < stretches.size(); bond += 50) stretches[bond] = 0.021;
    from.history = assembler.history_of(stretches);
  }
};

void count(benchmark::State& state, const HeldBody& body, int passes) {
  state.counters["bond"] = benchmark::Counter(double(passes) * double(body.model.bonds().count()),
                                              benchmark::Counter::kIsIterationInvariantRate);
}

template <Sums sums>
void relaxation(benchmark::State& state) {
  HeldBody body(state, sums);
  Tangent tangent(BlockPattern(body.model.bonds()), body.points.dimension);
  RelaxationOptions options;
  options.ramp = iterations_per_call;
  options.holds = false;
  options.breaking = body.breaking;
  for (auto _ : state) {
    RelaxationMotion motion;
    const RelaxationResult result = relax({body.assembler, body.conditions, body.free}, tangent,
                                          body.from, 1.0, options, motion, {});
    if (result.iterations != iterations_per_call || result.growth.degrading > 0) {
      state.SkipWithError("the relaxation was not the one to be measured");
    }
  }
  count(state, body, iterations_per_call);
}

template <Sums sums>
void relaxation_product(benchmark::State& state) {
  HeldBody body(state, sums);
  std::vector<double> v(body.from.displacement.size()), result(v.size());
  for (std::size_t k = 0; k < v.size(); ++k) v[k] = std::sin(3.0 * double(k));
  for (auto _ : state) {
    body.assembler.product(body.from, v, result);
    benchmark::ClobberMemory();
  }
  count(state, body, 1);
}

void bodies(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"dimension", "law", "transient"})
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
  for (int dimension : {2, 3}) {
    benchmark->Args({dimension, elastic, 0});
    for (int law : {tanh_law, broken}) {
      for (int transient : {0, 1}) benchmark->Args({dimension, law, transient});
    }
  }
}

BENCHMARK(relaxation<Sums::along_runs>)->Name("relaxation")->Apply(bodies);
BENCHMARK(relaxation<Sums::one_by_one>)->Name("listed_relaxation")->Apply(bodies);
BENCHMARK(relaxation_product<Sums::along_runs>)->Name("relaxation_product")->Apply(bodies);
BENCHMARK(relaxation_product<Sums::one_by_one>)->Name("listed_relaxation_product")->Apply(bodies);

}  // namespace
