// Weights of the optimisation-based quadrature, of lattices and of points off their places.
#include "src/neighbourhood/optimised_weights.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <omp.h>

#include "tests/bodies.hpp"

namespace {

using namespace peristat;

struct Cloud {
  std::vector<double> reference;
  std::vector<Offset> offset{0};
  std::vector<Index> neighbour;
};

/// Points that have all of their neighbours, at spacing 1, and these.
Cloud cloud(int dimension, int side, double horizon, double perturbation) {
  tests::Random random(1);
  const int beyond = int(std::ceil(horizon)) + 1, all = side + 2 * beyond;
  const int deep = dimension == 3 ? all : 1;
  Cloud result;
  for (int x = 0; x < all; ++x) {
    for (int y = 0; y < all; ++y) {
      for (int z = 0; z < deep; ++z) {
        const std::array<int, 3> cell{x, y, z};
        for (int c = 0; c < dimension; ++c)
          result.reference.push_back(cell[std::size_t(c)] + perturbation * random.number());
      }
    }
  }
  const auto is_inside = [&](int k) { return k >= beyond && k < all - beyond; };
  std::vector<Index> order, points, others;
  for (Index k = 0; k < all * all * deep; ++k) {
    const bool inside = is_inside(k / deep / all) && is_inside(k / deep % all) &&
                        (dimension == 2 || is_inside(k % deep));
    (inside ? points : others).push_back(k);
  }
  order = points;
  order.insert(order.end(), others.begin(), others.end());
  std::vector<double> ordered;
  for (const Index k : order) {
    const auto at = result.reference.begin() + k * dimension;
    ordered.insert(ordered.end(), at, at + dimension);
  }
  result.reference = ordered;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < order.size(); ++j) {
      double squared = 0.0;
      for (std::size_t c = 0; c < std::size_t(dimension); ++c) {
        const double arm =
            ordered[j * std::size_t(dimension) + c] - ordered[i * std::size_t(dimension) + c];
        squared += arm * arm;
      }
      if (j != i && squared <= horizon * horizon * (1.0 + 1e-8))
        result.neighbour.push_back(Index(j));
    }
    result.offset.push_back(Offset(result.neighbour.size()));
  }
  return result;
}

void weights(benchmark::State& state) {
  const int dimension = int(state.range(0)), horizon = int(state.range(1));
  const Cloud points =
      cloud(dimension, dimension == 2 ? 40 : 8, horizon, 0.01 * double(state.range(2)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(optimised_weights(dimension, horizon, 5,
                                               {points.offset, points.neighbour, points.reference},
                                               omp_get_max_threads()));
  }
  state.counters["point"] = benchmark::Counter(double(points.offset.size() - 1),
                                               benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK(weights)
    ->Name("optimised_weights")
    ->ArgNames({"dimension", "horizon", "percent"})
    ->Args({2, 3, 20})
    ->Args({2, 4, 20})
    ->Args({2, 4, 0})
    ->Args({3, 3, 20})
    ->Args({3, 4, 20})
    ->Args({3, 4, 0})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
