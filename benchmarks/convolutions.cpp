// The product with the tangent at rest by convolutions, beside the one over the bonds: where the
// horizon is long enough for the first. Each takes the dimension and a thousand times the horizon
// in spacings; threads are OMP_NUM_THREADS.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "assembly/convolutions/linear_bonds.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "benchmarks/lattice_bodies.hpp"

namespace {

using namespace peristat;

Points body(const benchmark::State& state) {
  return state.range(0) == 2 ? benchmark_bodies::box(2, {1000, 1000, 0})
                             : benchmark_bodies::box(3, {80, 80, 80});
}

double horizon(const benchmark::State& state) { return 1e-3 * double(state.range(1)); }

std::vector<double> wave(const Points& points) {
  std::vector<double> values(points.reference.size());
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::sin(3.0 * double(k));
  return values;
}

void count_points(benchmark::State& state, const Points& points) {
  state.counters["s_per_point"] =
      benchmark::Counter(double(points.count()), benchmark::Counter::kIsIterationInvariantRate |
                                                     benchmark::Counter::kInvert);
}

void product_over_bonds(benchmark::State& state) {
  const Points points = body(state);
  const Model model = benchmark_bodies::model(points, horizon(state));
  Assembler assembler(points, model, omp_get_max_threads());
  MatrixFreeTangent tangent(assembler);
  tangent.linearise(assembler, std::vector<double>(points.reference.size(), 0.0), 0.0);
  const std::vector<double> v = wave(points);
  std::vector<double> product(v);
  for (auto _ : state) {
    if (tangent.multiplies_in_place()) {
      tangent.multiply(product, product);
    } else {
      tangent.multiply(v, product);
    }
    benchmark::DoNotOptimize(product.data());
    if (tangent.multiplies_in_place()) product = v;
  }
  count_points(state, points);
}

LinearBonds linear_bonds(const Points& points, double reach) {
  const BondSetting setting = benchmark_bodies::setting(points.dimension, reach);
  std::string why_not;
  return {lattice_box(points, why_not).value(),
          {},
          lattice_springs(setting, 1.0, 0.0, micromodulus(1.0, setting), 1.0),
          omp_get_max_threads()};
}

template <bool with_energies>
void product_by_convolutions(benchmark::State& state) {
  const Points points = body(state);
  LinearBonds bonds = linear_bonds(points, horizon(state));
  const std::vector<double> v = wave(points);
  std::vector<double> product(v.size()), energy(std::size_t(points.count()));
  for (auto _ : state) {
    if constexpr (with_energies) {
      bonds.find_forces_and_energies(v, product, energy);
    } else {
      bonds.multiply(v, product);
    }
    benchmark::DoNotOptimize(product.data());
  }
  count_points(state, points);
}

/// What FFTW takes of it: all transforms there and back.
void transforms_of_a_product(benchmark::State& state) {
  const Points points = body(state);
  const Index reach = static_cast<Index>(horizon(state));
  const bool is_plane = points.dimension == 2;
  const Convolution convolution(
      is_plane ? std::array<ConvolutionAxis, 3>{{{1, 0}, {1000, reach}, {1000, reach}}}
               : std::array<ConvolutionAxis, 3>{{{80, reach}, {80, reach}, {80, reach}}},
      omp_get_max_threads());
  fftw::Buffer field = convolution.transform().make_field();
  for (auto _ : state) {
    for (int c = 0; c < points.dimension; ++c) {
      convolution.transform().to_modes(field);
      convolution.transform().to_places(field);
      for (std::size_t k = 0; k < 8; ++k) field.data()[k] = 1.0;
    }
    benchmark::DoNotOptimize(field.data());
  }
  count_points(state, points);
}

void arguments(benchmark::internal::Benchmark* of) {
  for (const int ratio : {2015, 3015, 4015, 5100, 8015}) of->Args({2, ratio});
  for (const int ratio : {2015, 3015, 4015, 5100}) of->Args({3, ratio});
  of->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(product_over_bonds)->Apply(arguments);
BENCHMARK(product_by_convolutions<false>)->Name("product_by_convolutions")->Apply(arguments);
BENCHMARK(product_by_convolutions<true>)
    ->Name("forces_and_energies_by_convolutions")
    ->Apply(arguments);
BENCHMARK(transforms_of_a_product)
    ->Args({2, 3015})
    ->Args({3, 3015})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
