#include "solvers/linear/cholesky.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include <suitesparse/cholmod.h>

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/lower_triangle.hpp"
#include "solvers/linear/single_factor.hpp"
#include "solvers/linear/speeds.hpp"
#include "solvers/linear/trilinos/krylov.hpp"
#include "solvers/linear/zero_pivot.hpp"
#include "src/core/stopwatch.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

using Long = SuiteSparse_long;

constexpr std::array<const char*, 3> ordering_names{"natural", "AMD", "METIS"};
constexpr std::array<int, 3> orderings{CHOLMOD_NATURAL, CHOLMOD_AMD, CHOLMOD_METIS};

/// Below this number of points METIS gains nothing over AMD and costs more to find.
constexpr Index smallest_for_metis = 5000;

/// Largest relative residual of a direct solve; backward-stable factorisations stay far below.
constexpr double accepted_residual = 1e-6;

/// Relative residual that needs no check if the first solution with a factor in single precision
/// has met it: whoever asks for no more evaluates the residual of the state itself.
constexpr double coarse = 1e-4;

/// Largest number of corrections of a solution in single precision: where more are needed the
/// system is too ill-conditioned for it.
constexpr int most_refinements = 3;

}  // namespace

struct Cholesky::Cholmod {
  cholmod_common common;
  cholmod_sparse* matrix = nullptr;
  cholmod_factor* factor = nullptr;
  cholmod_dense *right_hand_side = nullptr, *solution = nullptr, *work_y = nullptr,
                *work_e = nullptr;
  const FreeDofs* free = nullptr;
  const Tangent* tangent = nullptr;
  FactorReuse reuse;
  double largest_factor = 0.0;
  FactorEstimate estimate;
  LinearStatistics statistics;
  std::optional<Inertia> inertia;
  std::optional<SingleFactor> single;  // of the present tangent, if many solves follow
  bool single_is_checked = false;      // its first solution has been coarse or better
  std::vector<double> full_in, full_out;
  int last_iterations = 0;
  bool counts_pivots = true;
  bool factor_valid = false;    // factor holds numbers
  bool factor_current = false;  // factor is that of the present tangent

  explicit Cholmod(FactorReuse how) : reuse(how) {
    cholmod_l_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.try_catch = 1;
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;
  ~Cholmod() {
    release_symbolic();
    cholmod_l_finish(&common);
  }

  void release_symbolic() {
    single.reset();
    cholmod_l_free_sparse(&matrix, &common);
    cholmod_l_free_factor(&factor, &common);
    cholmod_l_free_dense(&right_hand_side, &common);
    cholmod_l_free_dense(&solution, &common);
    cholmod_l_free_dense(&work_y, &common);
    cholmod_l_free_dense(&work_e, &common);
  }

  /// Returns a fill-reducing order of the points that have an equation, by their numbers.
  std::vector<Long> order_points(const BlockPattern& pattern,
                                 const std::vector<Index>& number_of_point, Index points) {
    const auto at = [](void* array) { return static_cast<Long*>(array); };
    Offset entries = 0;
    for_each_free_block(pattern, number_of_point, [&](Index, Index) { ++entries; });
    cholmod_sparse* graph = cholmod_l_allocate_sparse(points, points, std::size_t(entries), 1, 1,
                                                      -1, CHOLMOD_PATTERN, &common);
    if (!graph) return {};
    Offset place = 0;
    Index column = 0;
    at(graph->p)[0] = 0;
    for_each_free_block(pattern, number_of_point, [&](Index i, Index j) {
      for (; column < i; ++column) at(graph->p)[column + 1] = place;
      at(graph->i)[place++] = j;
    });
    for (; column < points; ++column) at(graph->p)[column + 1] = place;

    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = points >= smallest_for_metis ? 3 : 2;
    for (int m = 0; m < common.nmethods; ++m) common.method[m].ordering = orderings[m];
    cholmod_factor* symbolic = cholmod_l_analyze(graph, &common);
    std::vector<Long> order;
    if (symbolic) {
      order.assign(at(symbolic->Perm), at(symbolic->Perm) + points);
      estimate.ordering = ordering_names[common.selected];
    }
    cholmod_l_free_factor(&symbolic, &common);
    cholmod_l_free_sparse(&graph, &common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    return order;
  }

  /// Calls visit(i, j) for the diagonal and each block i < j; i and j number the points that have
  /// an equation.
  template <class Visit>
  static void for_each_free_block(const BlockPattern& pattern, const std::vector<Index>& number,
                                  const Visit& visit) {
    for (Index i = 0; i < pattern.points(); ++i) {
      if (number[i] == FreeDofs::none) continue;
      visit(number[i], number[i]);
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        const Index j = number[pattern.partner(i, bond)];
        if (j != FreeDofs::none) visit(number[i], j);
      }
    }
  }

  void build_matrix(const BlockPattern& pattern) {
    const Index size = free->count();
    std::vector<Long> begin(std::size_t(size) + 1, 0);
    for (Index e = 0; e < size; ++e) {
      Long entries = 0;
      for_each_entry_of_column(pattern, *free, e, [&](Index, const EntryPlace&) { ++entries; });
      begin[std::size_t(e) + 1] = begin[e] + entries;
    }
    matrix = cholmod_l_allocate_sparse(size, size, std::size_t(begin.back()), 1, 1, -1,
                                       CHOLMOD_REAL, &common);
    if (!matrix) return;
    std::copy(begin.begin(), begin.end(), static_cast<Long*>(matrix->p));
    Long* rows = static_cast<Long*>(matrix->i);
    for (Index e = 0; e < size; ++e) {
      Long* row = rows + begin[e];
      for_each_entry_of_column(pattern, *free, e,
                               [&](Index at, const EntryPlace&) { *row++ = at; });
    }
  }

  void fill_matrix() {
    double* values = static_cast<double*>(matrix->x);
    const Long* begin = static_cast<const Long*>(matrix->p);
#pragma omp parallel for schedule(static)
    for (Index e = 0; e < free->count(); ++e) {
      double* value = values + begin[e];
      for_each_entry_of_column(tangent->pattern, *free, e, [&](Index, const EntryPlace& place) {
        *value++ = place.value(*tangent);
      });
    }
  }

  LinearOutcome outcome_of_status() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) {
      return LinearOutcome::out_of_memory;
    }
    if (common.status == CHOLMOD_NOT_POSDEF) return LinearOutcome::not_positive_definite;
    return common.status < CHOLMOD_OK ? LinearOutcome::singular : LinearOutcome::solved;
  }

  int most_iterations() const {
    const double affordable = affordable_iterations(estimate.flops, estimate.entries);
    return static_cast<int>(std::min(double(reuse.max_iterations), affordable));
  }

  bool tangent_is_finite() const {
    const auto finite = [](double entry) { return std::isfinite(entry); };
    return std::all_of(tangent->diagonal.begin(), tangent->diagonal.end(), finite);
  }

  LinearOutcome factorize() {
    factor_valid = factor_current = false;
    inertia.reset();
    single.reset();
    single_is_checked = false;
    if (!tangent_is_finite()) return LinearOutcome::singular;
    fill_matrix();
    ++statistics.factorisations;
    cholmod_l_factorize(matrix, factor, &common);
    const LinearOutcome outcome = outcome_of_status();
    if (outcome == LinearOutcome::not_positive_definite) return count_pivots();
    if (outcome != LinearOutcome::solved) return outcome;
    // The pivots of LL^T are the squares of its diagonal; rcond is the least over the largest.
    if (cholmod_l_rcond(factor, &common) <= zero_pivot) return LinearOutcome::singular;
    inertia = Inertia{free->count(), 0, 0};
    factor_valid = factor_current = true;
    return outcome;
  }

  /// Largest diagonal entry of the filled matrix; the diagonal entry comes first in its column.
  double largest_diagonal() const {
    const double* values = static_cast<const double*>(matrix->x);
    const Long* begin = static_cast<const Long*>(matrix->p);
    double largest = 0.0;
    for (Index e = 0; e < free->count(); ++e) {
      largest = std::max(largest, std::abs(values[begin[e]]));
    }
    return largest;
  }

  /// Computes the inertia by LDL^T (Sylvester's law), if it is wanted and affordable.
  LinearOutcome count_pivots() {
    if (!counts_pivots || estimate.flops > largest_inertia_flops)
      return LinearOutcome::not_positive_definite;
    cholmod_factor* signs = cholmod_l_copy_factor(factor, &common);
    if (!signs) return LinearOutcome::not_positive_definite;
    cholmod_l_change_factor(CHOLMOD_PATTERN, 0, 0, 1, 1, signs, &common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 0;
    common.dbound = 1e-3 * zero_pivot * largest_diagonal();  // LDL^T stops at an exact zero
    cholmod_l_factorize(matrix, signs, &common);
    const bool finished = common.status == CHOLMOD_OK || common.status == CHOLMOD_DSMALL;
    const bool complete = finished && signs->xtype == CHOLMOD_REAL;
    LinearOutcome outcome = LinearOutcome::not_positive_definite;
    if (complete && !signs->is_super) {
      const Long* begin = static_cast<const Long*>(signs->p);
      const double* value = static_cast<const double*>(signs->x);
      double largest = 0.0;
      for (std::size_t k = 0; k < signs->n; ++k) {
        largest = std::max(largest, std::abs(value[begin[k]]));
      }
      Inertia counted;
      for (std::size_t k = 0; k < signs->n; ++k) {
        const double pivot = value[begin[k]];
        if (std::abs(pivot) <= zero_pivot * largest) {
          ++counted.zero;
        } else {
          ++(pivot > 0.0 ? counted.positive : counted.negative);
        }
      }
      inertia = counted;
      if (counted.negative == 0) outcome = LinearOutcome::singular;
    }
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.dbound = 0.0;
    cholmod_l_free_factor(&signs, &common);
    return outcome;
  }

  bool apply_factor(std::span<const double> b, std::span<double> x) {
    std::copy(b.begin(), b.end(), static_cast<double*>(right_hand_side->x));
    if (!cholmod_l_solve2(CHOLMOD_A, factor, right_hand_side, nullptr, &solution, nullptr, &work_y,
                          &work_e, &common)) {
      return false;
    }
    const double* found = static_cast<const double*>(solution->x);
    std::copy(found, found + x.size(), x.begin());
    return true;
  }

  void multiply(std::span<const double> v, std::span<double> result) {
    free->extend_by_zero(v, full_in);
    tangent->multiply(full_in, full_out);
    free->restrict_to_free(full_out, result);
  }

  LinearOutcome solve_directly(std::span<const double> b, std::span<double> x) {
    last_iterations = 0;
    if (!factor_current) {
      const LinearOutcome outcome = factorize();
      if (outcome != LinearOutcome::solved) return outcome;
    }
    if (!apply_factor(b, x)) return outcome_of_status();
    std::vector<double> residual(b.size());
    find_residual(b, x, residual);
    return norm(residual) <= accepted_residual * norm(b) ? LinearOutcome::solved
                                                         : LinearOutcome::inaccurate;
  }

  void find_residual(std::span<const double> b, std::span<const double> x,
                     std::span<double> residual) {
    multiply(x, residual);
    for (std::size_t e = 0; e < b.size(); ++e) residual[e] = b[e] - residual[e];
  }

  /// Solves in single precision, and corrects by the residual down to the tolerance.
  /// @return false if it is not reached
  bool solve_in_single(std::span<const double> b, std::span<double> x, double tolerance) {
    std::vector<double> residual(b.size()), correction(b.size());
    single->solve(b, x);
    if (single_is_checked && tolerance >= coarse) return true;
    find_residual(b, x, residual);
    single_is_checked = norm(residual) <= coarse * norm(b);
    const double target = tolerance * norm(b);
    for (int k = 0; k < most_refinements && norm(residual) > target; ++k) {
      single->solve(residual, correction);
      add_scaled(x, 1.0, correction);
      find_residual(b, x, residual);
    }
    return norm(residual) <= target;
  }
};

Cholesky::Cholesky(FactorReuse reuse, double largest_factor)
    : cholmod_(std::make_unique<Cholmod>(reuse)) {
  cholmod_->largest_factor = largest_factor;
}
Cholesky::~Cholesky() = default;

LinearOutcome Cholesky::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  Cholmod& c = *cholmod_;
  const Stopwatch watch(c.statistics.seconds);
  c.release_symbolic();
  c.factor_valid = c.factor_current = false;
  c.free = &free;
  c.full_in.resize(free.equation.size());
  c.full_out.resize(free.equation.size());
  c.estimate = {};
  if (free.count() == 0) return LinearOutcome::solved;

  const int d = free.dimension;
  std::vector<Index> number(pattern.points(), FreeDofs::none);
  std::vector<Index> point;
  for (Index i = 0; i < pattern.points(); ++i) {
    for (int r = 0; r < d && number[i] == FreeDofs::none; ++r) {
      if (free.equation[std::size_t(i) * d + r] == FreeDofs::none) continue;
      number[i] = static_cast<Index>(point.size());
      point.push_back(i);
    }
  }
  const std::vector<Long> point_order =
      c.order_points(pattern, number, static_cast<Index>(point.size()));
  if (point_order.empty()) return c.outcome_of_status();
  std::vector<Long> order;
  order.reserve(std::size_t(free.count()));
  for (Long place : point_order) {
    for (int r = 0; r < d; ++r) {
      const Index equation = free.equation[std::size_t(point[place]) * d + r];
      if (equation != FreeDofs::none) order.push_back(equation);
    }
  }
  c.build_matrix(pattern);
  if (!c.matrix) return c.outcome_of_status();
  c.factor = cholmod_l_analyze_p(c.matrix, order.data(), nullptr, 0, &c.common);
  if (!c.factor) return c.outcome_of_status();
  c.estimate.entries = double(c.factor->xsize);
  c.estimate.flops = c.common.fl;
  if (c.estimate.bytes() > c.largest_factor) return LinearOutcome::out_of_memory;
  c.right_hand_side =
      cholmod_l_allocate_dense(free.count(), 1, free.count(), CHOLMOD_REAL, &c.common);
  return c.right_hand_side ? LinearOutcome::solved : c.outcome_of_status();
}

void Cholesky::count_pivots(bool counts) { cholmod_->counts_pivots = counts; }

LinearOutcome Cholesky::factorize(const TangentOperator& tangent, FactorUse use) {
  Cholmod& c = *cholmod_;
  const Stopwatch watch(c.statistics.seconds);
  c.tangent = tangent.as_tangent();
  if (!c.tangent) throw std::logic_error("a direct solver needs a stored tangent");
  c.factor_current = false;
  if (c.free->count() == 0) return LinearOutcome::solved;
  if (use == FactorUse::may_reuse && c.factor_valid && c.most_iterations() > 0) {
    return c.tangent_is_finite() ? LinearOutcome::solved : LinearOutcome::singular;
  }
  const LinearOutcome outcome = c.factorize();
  const bool is_for_many = use == FactorUse::factorize_for_many;
  if (outcome == LinearOutcome::solved && is_for_many) c.single.emplace(*c.factor);
  return outcome;
}

LinearOutcome Cholesky::solve(std::span<const double> b, std::span<double> x, double tolerance) {
  Cholmod& c = *cholmod_;
  const Stopwatch watch(c.statistics.seconds);
  c.last_iterations = 0;
  if (b.empty()) return LinearOutcome::solved;
  if (c.single && c.factor_current && c.solve_in_single(b, x, tolerance)) {
    return LinearOutcome::solved;
  }
  if (c.factor_current || !c.factor_valid) return c.solve_directly(b, x);
  const std::size_t size = b.size();
  KrylovOptions options;
  options.tolerance = std::min(tolerance, c.reuse.tolerance);
  options.max_iterations = c.most_iterations();
  const KrylovResult result = solve_krylov(
      int(size),
      [&](const double* v, double* product) {
        c.multiply({v, size}, {product, size});
      },
      [&](const double* v, double* product) {
        c.apply_factor({v, size}, {product, size});
      },
      b.data(), x.data(), options);
  c.statistics.iterations += result.iterations;
  if (result.outcome != KrylovOutcome::converged) return c.solve_directly(b, x);
  c.last_iterations = result.iterations;
  return LinearOutcome::solved;
}

std::optional<Inertia> Cholesky::inertia() const { return cholmod_->inertia; }
LinearStatistics Cholesky::statistics() const { return cholmod_->statistics; }
int Cholesky::last_iterations() const { return cholmod_->last_iterations; }
const FactorEstimate& Cholesky::estimate() const { return cholmod_->estimate; }

std::string Cholesky::library_version() {
  int version[3];
  cholmod_l_version(version);
  return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." +
         std::to_string(version[2]);
}

std::string Cholesky::describe() const {
  char text[200];
  std::snprintf(text, sizeof text,
                "CHOLMOD supernodal LL^T, %s order, factor %.3g entries (%.0f MB), %.3g flops",
                estimate().ordering.c_str(), estimate().entries, estimate().bytes() / 1e6,
                estimate().flops);
  return text;
}

}  // namespace peristat
