#include "solvers/linear/trilinos/krylov.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

#include <BelosBiCGStabIter.hpp>
#include <BelosBlockGmresSolMgr.hpp>
#include <BelosLinearProblem.hpp>
#include <BelosMinresIter.hpp>
#include <BelosMultiVecTraits_Tpetra.hpp>
#include <BelosOperatorTraits_Tpetra.hpp>
#include <BelosOutputManager.hpp>
#include <BelosPseudoBlockCGIter.hpp>
#include <BelosStatusTest.hpp>
#include <Teuchos_Comm.hpp>
#include <Teuchos_oblackholestream.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include "solvers/linear/trilinos/module.hpp"
#include "solvers/linear/trilinos/teuchos_communicator.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat::trilinos {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;

// The only types that Debian's Tpetra is instantiated for.
using Map = Tpetra::Map<int, long long>;
using Vector = Tpetra::MultiVector<double, int, long long>;
using Operator = Tpetra::Operator<double, int, long long>;
using Problem = Belos::LinearProblem<double, Vector, Operator>;
using Iteration = Belos::Iteration<double, Vector, Operator>;

/// 2-norm of a vector over all ranks.
double norm(const std::vector<double>& v, const Communicator* ranks) {
  double squared = 0.0;
  for (double entry : v) squared += entry * entry;
  return std::sqrt(ranks ? ranks->sum(squared) : squared);
}

/// Adapter of a VectorMap to Tpetra's operators.
class MapOperator : public Operator {
 public:
  MapOperator(RCP<const Map> rows, const VectorMap& map) : rows_(std::move(rows)), map_(map) {}

  RCP<const Map> getDomainMap() const override { return rows_; }
  RCP<const Map> getRangeMap() const override { return rows_; }

  /// y = A x, the only form that Belos uses.
  void apply(const Vector& x, Vector& y, Teuchos::ETransp mode, double alpha,
             double beta) const override {
    if (mode != Teuchos::NO_TRANS || alpha != 1.0 || beta != 0.0) {
      throw std::logic_error("MapOperator: only y = A x");
    }
    for (std::size_t column = 0; column < x.getNumVectors(); ++column) {
      map_(x.getData(column).getRawPtr(), y.getDataNonConst(column).getRawPtr());
    }
  }

 private:
  RCP<const Map> rows_;
  const VectorMap& map_;
};

/// b - A x, computed without Trilinos.
class TrueResidual {
 public:
  TrueResidual(const VectorMap& matrix, const double* b, int size, const Communicator* ranks)
      : matrix_(matrix),
        b_(b),
        size_(std::size_t(size)),
        ranks_(ranks),
        values(b, b + size),
        norm(trilinos::norm(values, ranks)) {}

  void update(const double* x) {
    values.resize(size_);
    matrix_(x, values.data());
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = b_[k] - values[k];
    norm = trilinos::norm(values, ranks_);
  }
  /// Takes what is known from elsewhere.
  /// @param scale that it has to be multiplied by
  void take(const Vector& known, double scale) {
    const Teuchos::ArrayRCP<const double> entries = known.getData(0);
    values.assign(entries.begin(), entries.end());
    for (double& value : values) value *= scale;
    norm = trilinos::norm(values, ranks_);
  }

 private:
  const VectorMap& matrix_;
  const double* b_;
  std::size_t size_;
  const Communicator* ranks_;

 public:
  std::vector<double> values;  ///< may be moved out until the next update
  double norm;
};

/// Ends an iteration of Belos: at the target, at the limit, at values that are not finite, or where
/// the true residual no longer follows the iteration's own.
class StoppingRule : public Belos::StatusTest<double, Vector, Operator> {
 public:
  /// @param target 2-norm of the residual
  StoppingRule(double target, int max_iterations)
      : target_(target), max_iterations_(max_iterations) {}

  Belos::StatusType checkStatus(Iteration* iteration) override {
    stops_ = reached(*iteration);
    return getStatus();
  }
  Belos::StatusType getStatus() const override { return stops_ ? Belos::Passed : Belos::Failed; }
  void reset() override { stops_ = false; }
  void print(std::ostream&, int) const override {}

  [[nodiscard]] bool at_limit() const { return at_limit_; }
  [[nodiscard]] bool not_finite() const { return not_finite_; }
  /// True if the residual of the iteration is b - A x itself.
  [[nodiscard]] virtual bool has_true_residual() const { return false; }

 protected:
  /// True if the present state is good enough, or can't become so.
  [[nodiscard]] virtual bool satisfied(const Iteration&, double residual) {
    return residual <= target_;
  }

  double target_;

 private:
  [[nodiscard]] bool reached(const Iteration& iteration) {
    // Either the residual or its norm; which one depends on the method.
    std::vector<double> norms(1, 0.0);
    const RCP<const Vector> residual = iteration.getNativeResiduals(&norms);
    if (!residual.is_null()) residual->norm2(norms);
    not_finite_ = !std::isfinite(norms[0]);
    if (not_finite_ || satisfied(iteration, norms[0])) return true;
    at_limit_ = iteration.getNumIters() >= max_iterations_;
    return at_limit_;
  }

  int max_iterations_;
  bool stops_ = false, at_limit_ = false, not_finite_ = false;
};

/// Conjugate gradients whose products are rounded. Their residual drifts away from b - A x, which
/// replaces it from time to time and decides in the end. Directions stay as they are, so that
/// convergence goes on without a restart (van der Vorst and Ye, SIAM J. Sci. Comput. 22, 2000).
///
/// A run is given up where b - A x is twice the iteration's residual, and where the residual falls
/// by less than a decade in `iterations_per_decade` from its largest value, but for a first decade:
/// such systems are so ill-conditioned that rounding costs more iterations (up to twice as many)
/// than it saves time.
class RoughStoppingRule : public StoppingRule {
 public:
  /// @param matrix A, not rounded
  /// @param start 2-norm of b
  RoughStoppingRule(const VectorMap& matrix, double start, double target, int max_iterations)
      : StoppingRule(target, max_iterations),
        matrix_(matrix),
        largest_(start),
        largest_since_(start) {}

  [[nodiscard]] bool has_true_residual() const override { return has_true_residual_; }

 private:
  static constexpr double iterations_per_decade = 8.0;
  /// Share of the largest residual since the last true one at which the next one is computed. Rarer
  /// ones save hardly any time, and cost slender bodies iterations.
  static constexpr double gain = 1e-2;

  [[nodiscard]] bool satisfied(const Iteration& iteration, double residual) override {
    largest_ = std::max(largest_, residual);
    largest_since_ = std::max(largest_since_, residual);
    has_true_residual_ = residual <= std::max(target_, gain * largest_since_);
    if (!has_true_residual_) {
      const double decades = iteration.getNumIters() / iterations_per_decade;
      return residual > largest_ * std::pow(10.0, 1.0 - decades);
    }
    largest_since_ = replace_residual(iteration);
    return largest_since_ <= target_ || largest_since_ > 2.0 * std::max(target_, residual);
  }

  /// Returns the 2-norm of b - A x, the iteration's residual from now on.
  [[nodiscard]] double replace_residual(const Iteration& iteration) const {
    const Problem& problem = iteration.getProblem();
    // Belos hands out the vector that it works on.
    const auto residual = Teuchos::rcp_const_cast<Vector>(iteration.getNativeResiduals(nullptr));
    matrix_(problem.getLHS()->getData(0).getRawPtr(), residual->getDataNonConst(0).getRawPtr());
    residual->update(1.0, *problem.getRHS(), -1.0);
    std::vector<double> norms(1);
    residual->norm2(norms);
    return norms[0];
  }

  const VectorMap& matrix_;
  double largest_;        ///< residual so far
  double largest_since_;  ///< b - A x was last computed
  bool has_true_residual_ = false;
};

/// MINRES computes its residual only in the norm of the preconditioner, sqrt(r.M r). Once that has
/// fallen as far as the 2-norm should, the true residual is computed; it decides, and sets the next
/// threshold.
class MinresStoppingRule : public StoppingRule {
 public:
  MinresStoppingRule(double start, double target, int max_iterations)
      : StoppingRule(target, max_iterations), last_norm_(start) {}

 private:
  [[nodiscard]] bool satisfied(const Iteration& iteration, double residual) override {
    if (threshold_ < 0.0) threshold_ = residual * target_ / last_norm_;
    if (residual > threshold_) return false;
    const Problem& problem = iteration.getProblem();
    Vector difference(*problem.getRHS(), Teuchos::Copy);
    problem.computeCurrResVec(&difference);
    std::vector<double> norms(1);
    difference.norm2(norms);
    if (norms[0] <= target_) return true;
    // Between two checks the recursive residual at least halves. If the true one does not fall, it
    // is at its limit; refinement goes on from there.
    if (!(norms[0] < 0.9 * last_norm_)) return true;
    last_norm_ = norms[0];
    threshold_ = residual * std::clamp(target_ / norms[0], 0.1, 0.5);
    return false;
  }

  double threshold_ = -1.0;  ///< of sqrt(r.M r), at which to check the true residual
  double last_norm_;         ///< true residual at the last check
};

/// Rethrows within a handler if there are several ranks: one rank may have met the exception alone,
/// and the others wait.
void leave_if_several(const Problem& problem) {
  if (problem.getRHS()->getMap()->getComm()->getSize() > 1) throw;
}

/// One run of Belos on A d = r from d = 0.
struct Run {
  KrylovOutcome outcome = KrylovOutcome::breakdown;
  int iterations = 0;
  RCP<const Vector> true_residual{};  ///< null: not known
};

Run outcome_of(const StoppingRule& rule, int iterations) {
  if (rule.not_finite()) return {KrylovOutcome::breakdown, iterations};
  if (rule.at_limit()) return {KrylovOutcome::iteration_limit, iterations};
  return {KrylovOutcome::converged, iterations};
}

RCP<Belos::OutputManager<double>> silence() {
  return rcp(new Belos::OutputManager<double>(Belos::Errors, rcp(new Teuchos::oblackholestream)));
}

Run run_conjugate_gradients(const RCP<Problem>& problem, const RCP<StoppingRule>& rule) {
  Teuchos::ParameterList parameters;
  Belos::PseudoBlockCGIter<double, Vector, Operator> iteration(problem, silence(), rule,
                                                               parameters);
  Belos::CGIterationState<double, Vector> start;
  start.R = problem->getInitResVec();
  try {
    iteration.initializeCG(start);
    iteration.iterate();
  } catch (const Belos::CGIterateFailure&) {
    // Either p.A p <= 0 or r.M r < 0; the latter also at the start, before A p exists. A zero
    // direction is M's fault as well: M r = 0.
    Run run{KrylovOutcome::breakdown, iteration.getNumIters()};
    if (run.iterations == 0) return run;
    const auto state = iteration.getState();
    std::vector<double> curvature(1), length(1);
    state.P->dot(*state.AP, curvature);
    state.P->norm2(length);
    if (curvature[0] <= 0.0 && length[0] > 0.0) run.outcome = KrylovOutcome::negative_curvature;
    return run;
  } catch (const std::exception&) {
    leave_if_several(*problem);
    return {KrylovOutcome::breakdown, iteration.getNumIters()};
  }
  Run run = outcome_of(*rule, iteration.getNumIters());
  if (rule->has_true_residual()) run.true_residual = iteration.getNativeResiduals(nullptr);
  return run;
}

Run run_minres(const RCP<Problem>& problem, double start_norm, double target, int max_iterations) {
  const RCP<MinresStoppingRule> rule =
      rcp(new MinresStoppingRule(start_norm, target, max_iterations));
  Teuchos::ParameterList parameters;
  Belos::MinresIter<double, Vector, Operator> iteration(problem, silence(), rule, parameters);
  Belos::MinresIterationState<double, Vector> start;
  start.Y = problem->getInitResVec();
  try {
    iteration.initializeMinres(start);
    iteration.iterate();
  } catch (const std::exception&) {  // r.M r < 0
    leave_if_several(*problem);
    return {KrylovOutcome::breakdown, iteration.getNumIters()};
  }
  return outcome_of(*rule, iteration.getNumIters());
}

/// If the method breaks down, the run ends as converged, and refinement restarts it from there.
Run run_bicgstab(const RCP<Problem>& problem, double target, int max_iterations) {
  const RCP<StoppingRule> rule = rcp(new StoppingRule(target, max_iterations));
  Teuchos::ParameterList parameters;
  Belos::BiCGStabIter<double, Vector, Operator> iteration(problem, silence(), rule, parameters);
  Belos::BiCGStabIterationState<double, Vector> start;
  start.R = problem->getInitResVec();
  try {
    iteration.initializeBiCGStab(start);
    iteration.iterate();
  } catch (const std::exception&) {
    leave_if_several(*problem);
    return {KrylovOutcome::breakdown, iteration.getNumIters()};
  }
  return outcome_of(*rule, iteration.getNumIters());
}

Run run_gmres(const RCP<Problem>& problem, double relative_target, int max_iterations,
              int restart) {
  const RCP<Teuchos::ParameterList> parameters = rcp(new Teuchos::ParameterList);
  parameters->set("Convergence Tolerance", relative_target);
  parameters->set("Maximum Iterations", max_iterations);
  parameters->set("Maximum Restarts", max_iterations);
  parameters->set("Num Blocks", std::min(restart, max_iterations));
  parameters->set("Implicit Residual Scaling", "Norm of RHS");
  parameters->set("Verbosity", int(Belos::Errors));
  parameters->set("Output Stream", RCP<std::ostream>(rcp(new Teuchos::oblackholestream)));
  Belos::BlockGmresSolMgr<double, Vector, Operator> solver(problem, parameters);
  try {
    const bool converged = solver.solve() == Belos::Converged;
    // If its own residual and the true one differ, Belos stops; refinement goes on.
    if (converged || solver.isLOADetected()) {
      return {KrylovOutcome::converged, solver.getNumIters()};
    }
    const bool at_limit = solver.getNumIters() >= max_iterations;
    return {at_limit ? KrylovOutcome::iteration_limit : KrylovOutcome::breakdown,
            solver.getNumIters()};
  } catch (const std::exception&) {
    leave_if_several(*problem);
    return {KrylovOutcome::breakdown, solver.getNumIters()};
  }
}

/// Solves for the correction of a solution with the given residual.
/// @param is_rough if the matrix is rounded
/// @param residual freed before Belos allocates its own memory
Run run_belos(const RCP<const Map>& rows, const VectorMap& exact, bool is_rough,
              const VectorMap& preconditioner, std::vector<double> residual, double residual_norm,
              double target, int max_iterations, const KrylovOptions& options,
              RCP<Vector>& correction) {
  const RCP<MapOperator> matrix_operator =
      rcp(new MapOperator(rows, is_rough ? options.rough_matrix : exact));
  const RCP<Vector> d = rcp(new Vector(rows, 1)), r = rcp(new Vector(rows, 1));
  std::copy(residual.begin(), residual.end(), r->getDataNonConst(0).begin());
  residual = std::vector<double>();

  const RCP<Problem> problem = rcp(new Problem(matrix_operator, d, r));
  if (options.method == KrylovMethod::conjugate_gradients ||
      options.method == KrylovMethod::minres) {
    problem->setHermitian();
  }
  // Preconditions from the right, even if the method makes no difference: from the left, Belos
  // would precondition the initial residual once for nothing.
  if (preconditioner) problem->setRightPrec(rcp(new MapOperator(rows, preconditioner)));
  problem->setInitResVec(r);  // for the start at zero
  problem->setProblem();

  Run run;
  if (options.method == KrylovMethod::gmres) {
    run = run_gmres(problem, target / residual_norm, max_iterations, options.restart);
  } else {
    problem->setLSIndex({0});
    if (options.method == KrylovMethod::minres) {
      run = run_minres(problem, residual_norm, target, max_iterations);
    } else if (options.method == KrylovMethod::bicgstab) {
      run = run_bicgstab(problem, target, max_iterations);
    } else if (is_rough) {
      run = run_conjugate_gradients(
          problem, rcp(new RoughStoppingRule(exact, residual_norm, target, max_iterations)));
    } else {
      run = run_conjugate_gradients(problem, rcp(new StoppingRule(target, max_iterations)));
    }
    problem->setCurrLS();
  }
  correction = d;
  return run;
}

/// Runs Belos until the true residual is small enough, or until another run doesn't help.
KrylovResult refine(int size, const VectorMap& matrix, const VectorMap& preconditioner,
                    const double* b, double* x, const KrylovOptions& options) {
  TrueResidual residual(matrix, b, size, options.ranks);
  const double scale = residual.norm, target = options.tolerance * scale;
  if (scale == 0.0) return {};
  KrylovResult result{KrylovOutcome::breakdown, 0, 1.0};
  if (!std::isfinite(scale)) {
    result.relative_residual = scale;
    return result;
  }
  if (options.max_iterations <= 0) {
    result.outcome = KrylovOutcome::iteration_limit;
    return result;
  }

  const SoleRank sole;
  const auto any = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  const RCP<const Map> rows = rcp(new Map(
      any, std::size_t(size), 0, teuchos_communicator(options.ranks ? *options.ranks : sole)));
  bool is_rough = options.rough_matrix != nullptr;  // of the first run
  while (true) {
    const double before = residual.norm;
    RCP<Vector> correction;
    // Single precision has a short range: the system is scaled to a residual of norm 1.
    const double unit = is_rough ? before : 1.0;
    for (double& value : residual.values) value /= unit;
    Run run =
        run_belos(rows, matrix, is_rough, preconditioner, std::move(residual.values), before / unit,
                  target / unit, options.max_iterations - result.iterations, options, correction);
    result.iterations += run.iterations;
    std::vector<double> candidate(x, x + size);
    {
      const Teuchos::ArrayRCP<const double> values = correction->getData(0);
      for (int k = 0; k < size; ++k) candidate[std::size_t(k)] += unit * values[k];
    }
    correction = Teuchos::null;
    if (run.true_residual.is_null()) {
      residual.update(candidate.data());
    } else {
      residual.take(*run.true_residual, unit);
      run.true_residual = Teuchos::null;
    }

    // A failed run may end with a worse solution than it started from, or one that is not finite.
    const bool improved = residual.norm < before;
    result.outcome = run.outcome;
    if (improved) {
      std::copy(candidate.begin(), candidate.end(), x);
      result.relative_residual = residual.norm / scale;
    }
    if (improved && residual.norm <= target) {
      result.outcome = KrylovOutcome::converged;
      return result;
    }
    if (run.outcome == KrylovOutcome::iteration_limit ||
        result.iterations >= options.max_iterations) {
      result.outcome = KrylovOutcome::iteration_limit;
      return result;
    }
    if (is_rough) {
      is_rough = false;
      if (!improved) residual.update(x);
      continue;
    }
    if (run.outcome != KrylovOutcome::converged) return result;
    const bool has_helped = residual.norm <= 0.5 * before;
    if (!has_helped) {
      result.outcome = KrylovOutcome::breakdown;
      return result;
    }
  }
}

}  // namespace

KrylovResult solve_krylov(int size, const VectorMap& matrix, const VectorMap& preconditioner,
                          const double* right_hand_side, double* solution,
                          const KrylovOptions& options) {
  std::fill(solution, solution + size, 0.0);
  if (options.ranks && options.ranks->count() > 1) {
    if (options.ranks->sum(double(size)) == 0.0) return {};
    return refine(size, matrix, preconditioner, right_hand_side, solution, options);
  }
  if (size == 0) return {};
  try {
    return refine(size, matrix, preconditioner, right_hand_side, solution, options);
  } catch (const std::exception&) {
    return {KrylovOutcome::breakdown, 0, 1.0};
  }
}

}  // namespace peristat::trilinos
