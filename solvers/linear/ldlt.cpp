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
#include "solvers/linear/vector_verbs.hpp"
#include "src/core/stopwatch.hpp"

namespace peristat {
namespace {

/// Address space of MUMPS' libraries, and what they allocate at once.
constexpr std::size_t room_for_mumps = std::size_t(64) << 20;

/// Largest relative residual of a solve, after refinement. Beside a critical point the solution is
/// so large that its last digits leave more: it still solves a system that is this near.
constexpr double accepted_residual = 1e-6, accepted_backward_error = 1e-12;

/// Corrections of a solution by its residual: more do not help where two did not.
constexpr int most_refinements = 2;

const mumps::Module& module() {
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
  std::vector<std::size_t> begin;  // of the columns among the entries
  std::vector<double> values;
  const FreeDofs* free = nullptr;
  const Tangent* tangent = nullptr;
  std::optional<Inertia> inertia;
  LinearStatistics statistics;
  std::vector<double> full_in, full_out;

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

  double largest_row_sum() {
    tangent->absolute_row_sums(full_out);
    return *std::max_element(full_out.begin(), full_out.end());
  }

  /// residual = b - K x
  void find_residual(std::span<const double> b, std::span<const double> x,
                     std::span<double> residual) {
    free->extend_by_zero(x, full_in);
    tangent->multiply(full_in, full_out);
    free->restrict_to_free(full_out, residual);
    for (std::size_t e = 0; e < b.size(); ++e) residual[e] = b[e] - residual[e];
  }
};

Ldlt::Ldlt() : implementation_(std::make_unique<Implementation>()) {}
Ldlt::~Ldlt() = default;

LinearOutcome Ldlt::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  Implementation& own = *implementation_;
  const Stopwatch watch(own.statistics.seconds);
  own.free = &free;
  own.inertia.reset();
  own.full_in.resize(free.equation.size());
  own.full_out.resize(free.equation.size());
  own.list_entries(pattern);
  if (free.count() == 0) return LinearOutcome::solved;
  own.factor = module().make_symmetric_factor();
  return outcome_of(own.factor->analyze(own.entries));
}

LinearOutcome Ldlt::factorize(const TangentOperator& tangent, FactorUse /*use*/) {
  Implementation& own = *implementation_;
  const Stopwatch watch(own.statistics.seconds);
  own.tangent = tangent.as_tangent();
  if (!own.tangent) throw std::logic_error("a direct solver needs a stored tangent");
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
  std::copy(b.begin(), b.end(), x.begin());
  own.factor->solve(x.data());
  const double size = norm(b);
  std::vector<double> residual(b.size());
  own.find_residual(b, x, residual);
  constexpr double fine = 1e-12;
  for (int k = 0; k < most_refinements && norm(residual) > fine * size; ++k) {
    own.factor->solve(residual.data());
    add_scaled(x, 1.0, residual);
    own.find_residual(b, x, residual);
  }
  const bool is_accurate =
      norm(residual) <= accepted_residual * size ||
      norm(residual) <= accepted_backward_error * own.largest_row_sum() * norm(x);
  return is_accurate ? LinearOutcome::solved : LinearOutcome::inaccurate;
}

std::optional<Inertia> Ldlt::inertia() const { return implementation_->inertia; }
LinearStatistics Ldlt::statistics() const { return implementation_->statistics; }

std::string Ldlt::describe() const {
  const auto& factor = implementation_->factor;
  const double entries = factor ? factor->expected_entries() : 0.0;
  return fmt::format("MUMPS LDL^T with pivoting, factor {:.3g} entries ({:.0f} MB), {:.3g} flops",
                     entries, 8e-6 * entries, factor ? factor->expected_flops() : 0.0);
}

std::string Ldlt::library_version() { return module().version(); }

}  // namespace peristat
