#include "cases/runner/results/dossier.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "solvers/observe/recorded_points.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {
namespace {

constexpr std::size_t worst_told = 10;
constexpr std::size_t decisions_told = 20;

std::string suggestion(Outcome outcome, Mode mode) {
  const std::string adaptive =
      mode == Mode::newton ? "Run it with solver.mode = \"adaptive\": relaxation follows the crack "
                             "from here, and Newton's method takes over again afterwards."
                           : "Take smaller relaxed steps (relaxation.steps) or allow more "
                             "iterations (relaxation.max_iterations).";
  switch (outcome) {
    case Outcome::limit_point:
    case Outcome::damage_limit:
      return adaptive +
             " If displacements are prescribed instead of forces, a limit point comes later.";
    case Outcome::not_positive_definite:
      return "The state is unstable: the body buckles or wrinkles, or the material is beyond its "
             "stable range (./peristat calibrate prints the range for cpd). With a small "
             "imperfection (lattice.perturbation) the body can leave a symmetric state.";
    case Outcome::iteration_limit:
      return mode == Mode::relaxation
                 ? adaptive
                 : "Take smaller steps (loading.steps, loading.smallest_step), allow more "
                   "iterations (solver.max_iterations), and look at iterations.csv: if residuals "
                   "fall slowly and then stall, increase solver.relative_tolerance.";
    case Outcome::singular_tangent:
      return "Look at the worst points below: they have too few bonds, or supports do not hold "
             "them. ./peristat check lists parts that may move freely; a larger "
             "lattice.horizon_ratio gives points more bonds.";
    case Outcome::no_descent:
    case Outcome::line_search_failed:
      return "Take smaller steps (loading.steps); solver.projection = \"always\" is slower and "
             "more robust.";
    case Outcome::degenerate:
      if (mode == Mode::dynamics) {
        return "Take smaller time steps (dynamics.time_step, dynamics.step_share), or smaller "
               "loads and initial fields: points have met, or values are out of the range of "
               "numbers.";
      }
      return "Points collapse onto each other near the worst points below: take smaller steps, or "
             "check whether a support moves points onto their neighbours.";
    case Outcome::fragmented:
      return "Continue with solver.fragments = \"hold\" or \"remove\".";
    case Outcome::linear_solver_inaccurate:
      return "The tangent is close to singular: look for points with few bonds near the worst "
             "points below.";
    case Outcome::undefined_condition:
      return "Correct the expression of the support or load that is named above.";
    case Outcome::no_answer:
      return "Control another displacement that grows throughout, such as the opening of a crack "
             "mouth, or a sum of several. If bonds break and the path snaps back in every "
             "displacement, run the case without a control and with solver.mode = \"path\", which "
             "unloads the body before the next bond breaks.";
    case Outcome::sharp_turn:
      return "Take smaller steps (loading.steps, loading.smallest_step). Where several pivots "
             "vanish together (decisions.csv), a small load or a lattice.perturbation selects a "
             "branch.";
    case Outcome::step_limit:
      return "Look at history.csv. If the path has reached the states that you need, end it with "
             "arc_length.steps. If it is long, allow longer steps (arc_length.largest_step).";
    case Outcome::damage_begins:
      if (mode == Mode::dynamics) {
        return "Start with smaller loads at t = 0, and let them grow with time, or take "
               "dynamics.start = \"rest\".";
      }
      return "Follow the damage by a [[control]] in mode newton, or in mode adaptive.";
    case Outcome::unstable_step:
      return "Take a smaller dynamics.time_step, or give dynamics.step_share: then the step stays "
             "below the stable one.";
    case Outcome::inconsistent:
      if (mode == Mode::dynamics) {
        return "The motion gains energy that was not supplied: take smaller time steps "
               "(dynamics.time_step, dynamics.step_share).";
      }
      return "The result is not a valid state of this body. Take smaller steps (loading.steps, "
             "relaxation.steps, loading.smallest_step). If that does not help, the case shows an "
             "error in the program: please report it with its case file.";
    case Outcome::converged:
    case Outcome::out_of_memory:
    case Outcome::interrupted:
      break;
  }
  return "";
}

struct WorstPoint {
  double residual = 0.0;  ///< 2-norm [N]
  std::int64_t number = 0;
  Coordinates place{};

  [[nodiscard]] bool comes_before(const WorstPoint& other) const {
    return std::pair(-residual, number) < std::pair(-other.residual, other.number);
  }
};

void keep_worst(std::vector<WorstPoint>& points) {
  const std::size_t kept = std::min(worst_told, points.size());
  std::partial_sort(points.begin(), points.begin() + std::ptrdiff_t(kept), points.end(),
                    [](const WorstPoint& a, const WorstPoint& b) { return a.comes_before(b); });
  points.resize(kept);
}

/// Points with the largest residual, among all ranks.
std::vector<WorstPoint> worst_points(const RecordedPoints& recorded,
                                     const std::vector<double>& residual) {
  const auto d = std::size_t(recorded.dimension());
  std::vector<WorstPoint> worst;
  for (Index point = 0; point < recorded.count(); ++point) {
    double squared = 0.0;
    for (std::size_t c = 0; c < d; ++c) {
      squared += residual[std::size_t(point) * d + c] * residual[std::size_t(point) * d + c];
    }
    worst.push_back(
        {std::sqrt(squared), recorded.number(point), recorded.points().position(point)});
  }
  keep_worst(worst);
  std::vector<double> mine;
  for (const WorstPoint& point : worst) {
    mine.insert(mine.end(), {point.residual, double(point.number)});
    mine.insert(mine.end(), point.place.begin(), point.place.end());
  }
  const std::vector<double> all = concatenated(recorded.ranks(), mine);
  worst.clear();
  for (auto at = all.begin(); at != all.end(); at += 5) {
    worst.push_back({at[0], std::int64_t(at[1]), {at[2], at[3], at[4]}});
  }
  keep_worst(worst);
  return worst;
}

}  // namespace

Dossier make_dossier(const Case& from, const Body& body, const LoadSteppingResult& result,
                     const std::optional<StepRecord>& last,
                     const std::vector<DecisionRecord>& decisions) {
  const RecordedPoints recorded(body.points, *body.index_map);
  const auto dofs = std::size_t(recorded.count()) * std::size_t(recorded.dimension());
  const Attempt& attempt = result.last_attempt;
  Dossier dossier;
  dossier.residual.assign(dofs, 0.0);
  dossier.displacement = attempt.state.displacement;
  dossier.displacement.resize(dofs, 0.0);
  const std::vector<char>& prescribed = body.conditions->prescribed();
  for (std::size_t dof = 0; dof < std::min(attempt.state.gradient.size(), dossier.residual.size());
       ++dof) {
    if (!prescribed[dof]) {
      dossier.residual[dof] = attempt.external_force[dof] - attempt.state.gradient[dof];
    }
  }
  // A search that diverged may end in a state that is not finite: such entries become 0.
  for (std::vector<double>* field : {&dossier.residual, &dossier.displacement}) {
    for (double& entry : *field) entry = std::isfinite(entry) ? entry : 0.0;
  }

  std::string& text = dossier.text;
  const auto say = [&](const std::string& line) { text += line + "\n"; };
  say(fmt::format("{}", from.title.empty() ? from.file : from.title));
  say(fmt::format("Stopped: {}", name(result.outcome)));
  say(fmt::format("  {}", explanation(result.outcome)));
  say(fmt::format("What to do: {}", suggestion(result.outcome, from.solver.mode)));
  say("");
  if (last) {
    say(fmt::format("Last accepted state: step {}, load factor {:.9g} ({})", last->step,
                    last->load_factor, last->mode));
    say(fmt::format("  {} broken bonds, largest damage {:.4g}, largest stretch {:.4g}",
                    last->broken_bonds, last->max_damage, last->max_stretch));
    for (const auto& [set, force] : last->reactions) {
      say(fmt::format("  reaction on {}: ({:.6g}) N", set, fmt::join(force, ", ")));
    }
  } else {
    say("Last accepted state: none; the first step failed");
  }
  say("");
  const bool finds_load =
      body.conditions->control() != nullptr || from.solver.mode == Mode::arc_length;
  say(fmt::format("Last search: {} {:.9g}, {} iterations",
                  finds_load ? "ended at the iterate of the load factor" : "load factor",
                  body.conditions->load_factor(attempt.at), attempt.iterations));
  say(fmt::format("  residual {:.4g} N, measured against {:.4g} N; tolerance {:.3g} of that",
                  attempt.state.residual_norm, attempt.scale, from.solver.relative_tolerance));
  if (attempt.inertia) {
    say(fmt::format("  pivots of the tangent: {} positive, {} negative, {} zero",
                    attempt.inertia->positive, attempt.inertia->negative, attempt.inertia->zero));
  } else {
    say(fmt::format("  pivots: not counted; {}", attempt.has_negative_pivots
                                                     ? "some of the last tangent are negative"
                                                     : "none are known to be negative"));
  }
  say("");

  say("Worst points of that residual (all of it: /dossier/residual in results.h5)");
  say("  point       residual [N]   reference position [m]");
  for (const WorstPoint& worst : worst_points(recorded, dossier.residual)) {
    say(fmt::format(
        "  {:<10}  {:<12.4g}   ({:.6g})", worst.number, worst.residual,
        fmt::join(worst.place.begin(), worst.place.begin() + recorded.dimension(), ", ")));
  }
  say("");
  say("Last decisions (all of them: decisions.csv)");
  const std::size_t first = decisions.size() - std::min(decisions_told, decisions.size());
  for (std::size_t k = first; k < decisions.size(); ++k) {
    const DecisionRecord& row = decisions[k];
    say(fmt::format("  step {}, load {:.9g}: {}; {}", row.step, row.load_factor, name(row.action),
                    row.reason));
  }
  return dossier;
}

}  // namespace peristat
