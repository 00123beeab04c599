// The product with the tangent at rest by convolutions, beside the one over the bonds: from which
// horizon on the first is faster. ./peristat bench --convolutions; threads are OMP_NUM_THREADS.
//
// Prints nanoseconds per point, the best of rounds in which all take turns.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "assembly/convolutions/linear_bonds.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "benchmarks/lattice_bodies.hpp"

namespace {

using namespace peristat;

constexpr int rounds = 5;

struct Setting {
  int dimension;
  std::array<int, 3> extent;
  double horizon;
};

const std::vector<Setting> settings{
    {2, {1000, 1000, 0}, 2.015}, {2, {1000, 1000, 0}, 3.015}, {2, {1000, 1000, 0}, 4.015},
    {2, {1000, 1000, 0}, 5.1},   {2, {1000, 1000, 0}, 8.015}, {3, {80, 80, 80}, 2.015},
    {3, {80, 80, 80}, 3.015},    {3, {80, 80, 80}, 4.015},    {3, {80, 80, 80}, 5.1},
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure(const Setting& setting) {
  const Points points = benchmark_bodies::box(setting.dimension, setting.extent);
  const Model model = benchmark_bodies::model(points, setting.horizon);
  Assembler assembler(points, model, omp_get_max_threads());
  MatrixFreeTangent tangent(assembler);
  tangent.linearise(assembler, std::vector<double>(points.reference.size(), 0.0), 0.0);
  const BondSetting bond = benchmark_bodies::setting(setting.dimension, setting.horizon);
  std::string why_not;
  LinearBonds convolutions(lattice_box(points, why_not).value(), {},
                           lattice_springs(bond, 1.0, 0.0, micromodulus(1.0, bond), 1.0),
                           omp_get_max_threads());
  const FourierTransform& transform = convolutions.transform();
  fftw::Buffer field = transform.make_field();

  std::vector<double> v(points.reference.size()), product(v.size());
  std::vector<double> energy(std::size_t(points.count()));
  for (std::size_t k = 0; k < v.size(); ++k) v[k] = std::sin(3.0 * double(k));
  std::vector<double> in_place = v;
  const std::array<std::function<void()>, 4> all{
      [&] { tangent.multiply(in_place, tangent.multiplies_in_place() ? in_place : product); },
      [&] { convolutions.multiply(v, v, product); },
      [&] { convolutions.find_forces_and_energies(v, product, energy); },
      [&] {
        for (int c = 0; c < setting.dimension; ++c) {
          transform.to_modes(field);
          transform.to_places(field);
        }
      }};
  std::array<double, all.size()> best{};
  for (int round = 0; round < rounds; ++round) {
    in_place = v;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double seconds = seconds_of(all[k]);
      best[k] = round == 0 ? seconds : std::min(best[k], seconds);
    }
  }
  fmt::print("| {} | {:g} |", setting.dimension, setting.horizon);
  for (const double seconds : best) fmt::print(" {:.0f} |", 1e9 * seconds / double(points.count()));
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

int main() {
  fmt::print(
      "| dimension | ratio | over bonds [ns] | by convolutions [ns] | with energies [ns] | FFTW "
      "alone [ns] |\n|---|---|---|---|---|---|\n");
  for (const Setting& setting : settings) measure(setting);
  return 0;
}
