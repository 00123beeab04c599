// Two tables: the product with the tangent at rest by convolutions beside the one over the bonds,
// from which horizon on the first is faster; and what forces and energies of each material take.
// ./peristat bench --convolutions, on one thread and on all of OMP_NUM_THREADS.
//
// Prints nanoseconds per point, the best of rounds in which all take turns, of the processor time
// of the busiest thread: that is the time on a machine with nothing else to do, and other programs
// change it little.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "assembly/convolutions/correspondence.hpp"
#include "assembly/convolutions/green_bonds.hpp"
#include "assembly/convolutions/linear_bonds.hpp"
#include "assembly/convolutions/linear_solid.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "benchmarks/lattice_bodies.hpp"

namespace {

using namespace peristat;

constexpr int rounds = 5;
constexpr std::array<bool, 3> open{};

struct Setting {
  int dimension;
  std::array<int, 3> extent;
  double horizon;
};

const std::vector<Setting> settings{
    {2, {1000, 1000, 0}, 2.015}, {2, {1000, 1000, 0}, 3.015}, {2, {1000, 1000, 0}, 4.015},
    {2, {1000, 1000, 0}, 5.1},   {2, {1000, 1000, 0}, 8.015}, {3, {100, 100, 100}, 2.015},
    {3, {100, 100, 100}, 3.015}, {3, {100, 100, 100}, 4.015}, {3, {100, 100, 100}, 5.1},
};
/// Of cases/fcbm/glass_plate.toml, and a square.
const std::vector<Setting> bodies{{2, {1000, 1000, 0}, 5.1}, {3, {501, 201, 11}, 5.1}};

/// That each thread of a team has worked so far [s].
std::vector<double> processor_seconds(int threads) {
  std::vector<double> seconds(static_cast<std::size_t>(threads));
#pragma omp parallel num_threads(threads)
  {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    seconds[std::size_t(omp_get_thread_num())] = double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
  }
  return seconds;
}

double seconds_of(const std::function<void()>& work, int threads) {
  const std::vector<double> before = processor_seconds(threads);
  work();
  const std::vector<double> after = processor_seconds(threads);
  double longest = 0.0;
  for (std::size_t t = 0; t < after.size(); ++t) longest = std::max(longest, after[t] - before[t]);
  return longest;
}

/// Of each, the best of rounds in turns.
std::vector<double> best_of(const std::vector<std::function<void()>>& all, int threads) {
  std::vector<double> best(all.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double seconds = seconds_of(all[k], threads);
      best[k] = round == 0 ? seconds : std::min(best[k], seconds);
    }
  }
  return best;
}

void print_row(const std::string& of, std::span<const double> seconds, const Points& points) {
  fmt::print("| {} |", of);
  for (const double each : seconds) fmt::print(" {:.0f} |", 1e9 * each / double(points.count()));
  fmt::print("\n");
  std::fflush(stdout);
}

LatticeBox box_of(const Points& points) {
  std::string why_not;
  return lattice_box(points, why_not).value();
}

std::vector<LatticeSpring> springs_of(const Setting& setting) {
  const BondSetting bond = benchmark_bodies::setting(setting.dimension, setting.horizon);
  return lattice_springs(bond, 1.0, 0.0, micromodulus(1.0, bond), 1.0);
}

/// To modes and back.
std::function<void()> transforms_of(const FourierTransform& transform, fftw::Buffer& field,
                                    int pairs) {
  return [&transform, &field, pairs] {
    for (int c = 0; c < pairs; ++c) {
      transform.to_modes(field);
      transform.to_places(field);
    }
  };
}

void measure_product(const Setting& setting, int threads) {
  const Points points = benchmark_bodies::box(setting.dimension, setting.extent);
  const Model model = benchmark_bodies::model(points, setting.horizon);
  Assembler assembler(points, model, threads);
  MatrixFreeTangent tangent(assembler);
  tangent.linearise(assembler, std::vector<double>(points.reference.size(), 0.0), 0.0);
  LinearBonds convolutions(box_of(points), open, springs_of(setting), threads);
  fftw::Buffer field = convolutions.transform().make_field();

  std::vector<double> v(points.reference.size()), product(v.size());
  std::vector<double> energy(std::size_t(points.count()));
  for (std::size_t k = 0; k < v.size(); ++k) v[k] = std::sin(3.0 * double(k));
  std::vector<double> in_place = v;
  const std::vector<double> best = best_of(
      {
          [&] { tangent.multiply(in_place, tangent.multiplies_in_place() ? in_place : product); },
          [&] { convolutions.multiply(v, v, product); },
          [&] { convolutions.find_forces_and_energies(v, product, energy); },
          transforms_of(convolutions.transform(), field, setting.dimension),
      },
      threads);
  print_row(fmt::format("{} | {:g} | {}", setting.dimension, setting.horizon, threads), best,
            points);
}

struct Material {
  const char* name;
  std::function<std::unique_ptr<LatticeForces>()> make;
};

std::vector<Material> materials_of(const Setting& setting, const Points& points, int threads) {
  const LatticeBox box = box_of(points);
  const std::vector<LatticeSpring> springs = springs_of(setting);
  const std::vector<LatticeArm> arms =
      lattice_arms(benchmark_bodies::setting(setting.dimension, setting.horizon), 1.0, 0.0, 1.0);
  const LamePair constants{0.4, 0.4};
  const auto solid = [=](SolidForces form) {
    return std::make_unique<LinearSolid>(box, open, arms,
                                         LinearSolid::Setting{constants, 1.0, form}, threads);
  };
  return {
      {"bonds", [=] { return std::make_unique<LinearBonds>(box, open, springs, threads); }},
      {"solid", [=] { return solid(SolidForces::energy); }},
      {"solid, printed", [=] { return solid(SolidForces::printed); }},
      {"Green bonds", [=] { return std::make_unique<GreenBonds>(box, open, springs, threads); }},
      {"correspondence", [=] {
         return std::make_unique<Correspondence>(
             box, open, arms, Correspondence::Setting{constants, 1.0, 1e-3}, threads);
       }}};
}

void measure_materials(const Setting& setting, int threads) {
  const Points points = benchmark_bodies::box(setting.dimension, setting.extent);
  std::vector<double> u(points.reference.size()), force(u.size());
  std::vector<double> energy(std::size_t(points.count()));
  for (std::size_t k = 0; k < u.size(); ++k) u[k] = 1e-3 * std::sin(3.0 * double(k));
  const LinearBonds any(box_of(points), open, springs_of(setting), threads);
  fftw::Buffer field = any.transform().make_field();
  for (const auto& [name, make] : materials_of(setting, points, threads)) {
    const std::unique_ptr<LatticeForces> forces = make();
    forces->set_integrity(std::vector<double>(energy.size(), 1.0));
    print_row(fmt::format("{} | {} | {}", name, setting.dimension, threads),
              best_of({
                          [&] { forces->find_forces(u, force); },
                          [&] { forces->find_forces_and_energies(u, force, energy); },
                          transforms_of(any.transform(), field, 1),
                      },
                      threads),
              points);
  }
}

}  // namespace

int main() {
  std::vector<int> threads{1};
  if (omp_get_max_threads() > 1) threads.push_back(omp_get_max_threads());
  fmt::print(
      "| dimension | ratio | threads | over bonds [ns] | by convolutions [ns] | with energies [ns] "
      "| "
      "FFTW alone [ns] |\n|---|---|---|---|---|---|---|\n");
  for (const Setting& setting : settings) {
    for (const int each : threads) measure_product(setting, each);
  }
  fmt::print(
      "\n| material | dimension | threads | forces [ns] | with energies [ns] | one transform there "
      "and back [ns] |\n|---|---|---|---|---|---|\n");
  for (const Setting& body : bodies) {
    for (const int each : threads) measure_materials(body, each);
  }
  return 0;
}
