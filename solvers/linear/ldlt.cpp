#include "solvers/linear/ldlt.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/load_module.hpp"
#include "solvers/linear/lower_triangle.hpp"
#include "solvers/linear/mumps/module.hpp"
#include "solvers/linear/refinement.hpp"
#include "src/core/stopwatch.hpp"

namespace peristat {
namespace {

/// Address space of MUMPS' libraries and their first allocations.
constexpr std::size_t room_for_mumps = std::size_t(64) << 20;

const mumps::Module& mumps_module() {
  static const mumps::Module* const loaded = [] {
    void* const symbol =
        load_module("MUMPS", mumps::module_file, mumps::module_symbol, room_for_mumps);
    return reinterpret_cast<const mumps::Module* (*)()>(symbol)();
  }();
  return *loaded;
}

LinearOutcome outcome_of(mumps::FactorOutcome outcome) {
  switch (outcome) {
    case mumps::FactorOutcome::done:
      return LinearOutcome::solved;
    case mumps::FactorOutcome::singular:
      return LinearOutcome::singular;
    case mumps::FactorOutcome::put_off:
      return LinearOutcome::inaccurate;
    case mumps::FactorOutcome::out_of_memory:
      return LinearOutcome::out_of_memory;
  }
  return LinearOutcome::singular;
}

}  // namespace

struct Ldlt::Implementation {
  std::unique_ptr<mumps::SymmetricFactor> factor;
  mumps::LowerEntries entries;
  std::vector<std::size_t> begin;  // start of each column in the entries
  std::vector<double> values;
  int version = 0;  // of the pattern
  const FreeDofs* free = nullptr;
  const Tangent* tangent = nullptr;
  std::optional<Inertia> inertia;
  LinearStatistics statistics;

  void list_entries(const BlockPattern& pattern) {
    entries = {};
    entries.rows = free->count();
    begin.assign(1, 0);
    for (Index e = 0; e < free->count(); ++e) {
      for_each_entry_of_column(pattern, *free, e, [&](Index row, const EntryPlace&) {
        entries.row.push_back(row + 1);
        entries.column.push_back(e + 1);
      });
      begin.push_back(entries.row.size());
    }
    values.resize(entries.row.size());
  }

  void fill_values() {
#pragma omp parallel for schedule(static)
    for (Index e = 0; e < free->count(); ++e) {
      double* value = values.data() + begin[std::size_t(e)];
      for_each_entry_of_column(tangent->pattern, *free, e, [&](Index, const EntryPlace& place) {
        *value++ = place.value(*tangent);
      });
    }
  }

  double largest_row_sum() const {
    std::vector<double> sums(free->equation.size());
    tangent->absolute_row_sums(sums);
    return *std::max_element(sums.begin(), sums.end());
  }
};

Ldlt::Ldlt() : implementation_(std::make_unique<Implementation>()) {}
Ldlt::~Ldlt() = default;

LinearOutcome Ldlt::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  Implementation& own = *implementation_;
  const Stopwatch watch(own.statistics.seconds);
  own.free = &free;
  own.inertia.reset();
  own.list_entries(pattern);
  if (free.count() == 0) return LinearOutcome::solved;
  own.factor = mumps_module().make_symmetric_factor();
  return outcome_of(own.factor->analyze(own.entries));
}

LinearOutcome Ldlt::factorize(const TangentOperator& tangent, FactorUse /*use*/) {
  Implementation& own = *implementation_;
  const Stopwatch watch(own.statistics.seconds);
  own.tangent = tangent.as_tangent();
  if (!own.tangent) throw std::logic_error("a direct solver needs a stored tangent");
  if (tangent.version != own.version) {
    own.version = tangent.version;
    const LinearOutcome outcome = analyze(tangent.pattern, *own.free);
    if (outcome != LinearOutcome::solved) return outcome;
  }
  own.inertia.reset();
  const Index size = own.free->count();
  if (size > 0) {
    own.fill_values();
    const auto is_finite = [](double value) { return std::isfinite(value); };
    if (!std::all_of(own.values.begin(), own.values.end(), is_finite)) {
      return LinearOutcome::singular;
    }
    ++own.statistics.factorisations;
    const LinearOutcome outcome = outcome_of(own.factor->factorize(own.values));
    if (outcome != LinearOutcome::solved) return outcome;
  }
  const auto negative = static_cast<Index>(size > 0 ? own.factor->negative_pivots() : 0);
  own.inertia = Inertia{size - negative, negative, 0};
  return LinearOutcome::solved;
}

LinearOutcome Ldlt::solve(std::span<const double> b, std::span<double> x, double /*tolerance*/) {
  Implementation& own = *implementation_;
  const Stopwatch watch(own.statistics.seconds);
  if (b.empty()) return LinearOutcome::solved;
  const FactorSolve factor{[&](std::span<double> v) { own.factor->solve(v.data()); },
                           [&] { return own.largest_row_sum(); }};
  return solve_refined(*own.tangent, *own.free, factor, b, x);
}

std::optional<Inertia> Ldlt::inertia() const { return implementation_->inertia; }
LinearStatistics Ldlt::statistics() const { return implementation_->statistics; }

std::string Ldlt::describe() const {
  const auto& factor = implementation_->factor;
  const double entries = factor ? factor->expected_entries() : 0.0;
  return fmt::format("MUMPS LDL^T with pivoting, factor {:.3g} entries ({:.0f} MB), {:.3g} flops",
                     entries, 8e-6 * entries, factor ? factor->expected_flops() : 0.0);
}

std::string Ldlt::library_version() { return mumps_module().version(); }

}  // namespace peristat
