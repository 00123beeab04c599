// What contact of points costs where nothing touches: the search for pairs, and forces of a body
// whose bonds can fail, without and with contact.
#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <omp.h>

#include "assembly/assembler.hpp"
#include "assembly/terms/contact/pair_contact_term.hpp"
#include "benchmarks/lattice_bodies.hpp"

namespace {

using namespace peristat;

/// 10^5 points; arguments: dimension, 1: contact.
struct FailingBody {
  Points points;
  Model model;
  std::shared_ptr<PairContactTerm> contact;

  explicit FailingBody(const benchmark::State& state)
      : points(state.range(0) == 2 ? benchmark_bodies::box(2, {316, 316, 0})
                                   : benchmark_bodies::box(3, {46, 46, 46})) {
    const Model elastic = benchmark_bodies::model(points);
    const double modulus = std::get<Harmonic>(elastic.bond_failure()->potential()).modulus;
    model = Model(elastic.bonds(), Degraded<TanhDegradation>{modulus, {0.016, 0.020, 3.0}});
    const std::vector<double> ones(std::size_t(points.count()), 1.0);
    contact = std::make_shared<PairContactTerm>(std::make_shared<const PointContacts>(
        ContactPairs(points, model.bonds(), {PairContactRule{}}, ones, ones, points.cross_section(),
                     true),
        model.bonds()));
    if (state.range(1) != 0) model.add(contact);
  }
  [[nodiscard]] std::vector<double> displacement() const {
    std::vector<double> at(points.reference.size());
    for (std::size_t k = 0; k < at.size(); ++k) at[k] = 1e-3 * std::sin(7.0 * double(k));
    return at;
  }
};

void search_for_contacts(benchmark::State& state) {
  const FailingBody body(state);
  const std::vector<double> at = body.displacement();
  for (auto _ : state) {
    benchmark::DoNotOptimize(body.contact->contacts().pairs.near(at, omp_get_max_threads()));
  }
}

/// A commit in which nothing fails, as in each step of relaxation and of explicit dynamics.
void commit_beside_contact(benchmark::State& state) {
  const FailingBody body(state);
  Assembler assembler(body.points, body.model, omp_get_max_threads());
  const std::vector<double> at = body.displacement();
  std::vector<double> gradient(at.size());
  History history = assembler.initial_history();
  for (auto _ : state) {
    benchmark::DoNotOptimize(assembler.commit(at, history, gradient));
    benchmark::ClobberMemory();
  }
}

BENCHMARK(search_for_contacts)
    ->ArgNames({"dimension", "contact"})
    ->ArgsProduct({{2, 3}, {1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(commit_beside_contact)
    ->ArgNames({"dimension", "contact"})
    ->ArgsProduct({{2, 3}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
