#include "cases/runner/results/dossier.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace peristat {
namespace {

constexpr std::size_t worst_told = 10;
constexpr std::size_t decisions_told = 20;

std::string suggestion(Outcome outcome, Mode mode) {
  const std::string adaptive =
      mode == Mode::newton
          ? "Run it with solver.mode = \"adaptive\": relaxation follows the crack from here, and "
            "Newton's method takes over again behind it."
          : "Give relaxation more room: smaller steps (relaxation.steps) or more iterations "
            "(relaxation.max_iterations).";
  switch (outcome) {
    case Outcome::limit_point:
    case Outcome::damage_limit:
      return adaptive +
             " Controlling displacements instead of forces moves a limit point further "
             "away.";
    case Outcome::not_positive_definite:
      return "The state is unstable: it buckles, wrinkles, or the material is beyond its stable "
             "range (./peristat calibrate tells that of cpd). A small imperfection "
             "(lattice.perturbation) lets the body leave a symmetric state.";
    case Outcome::iteration_limit:
      return mode == Mode::relaxation ? adaptive
                                      : "Take smaller steps (loading.steps, "
                                        "loading.smallest_step), allow more iterations "
                                        "(solver.max_iterations), and look at iterations.csv: "
                                        "residuals that fall slowly "
                                        "and then stall want a looser solver.relative_tolerance.";
    case Outcome::singular_tangent:
      return "Look at the worst points below: they have too few bonds, or the supports leave them "
             "a motion. ./peristat check tells parts that may move freely; a larger "
             "lattice.horizon_ratio gives points more bonds.";
    case Outcome::no_descent:
    case Outcome::line_search_failed:
      return "Take smaller steps (loading.steps); solver.projection = \"always\" is slower and "
             "more robust.";
    case Outcome::degenerate:
      if (mode == Mode::dynamics) {
        return "Take smaller time steps (dynamics.time_step, dynamics.step_share), or softer loads "
               "and initial fields: points have met, or have left the range of numbers.";
      }
      return "Points collapse onto each other near the worst points below: take smaller steps, or "
             "see whether a support moves points onto their neighbours.";
    case Outcome::fragmented:
      return "Go on with solver.fragments = \"hold\" or \"remove\".";
    case Outcome::linear_solver_inaccurate:
      return "The tangent is close to singular: look for points that hang on few bonds near the "
             "worst points below.";
    case Outcome::undefined_condition:
      return "Mend the expression of the support or load that is named above.";
    case Outcome::no_answer:
      return "Control another displacement: one that grows throughout, like the opening of the "
             "mouth "
             "of a crack, or a sum of several.";
    case Outcome::sharp_turn:
      return "Take smaller steps (loading.steps, loading.smallest_step). Where several pivots "
             "vanish "
             "together (decisions.csv), a small load or lattice.perturbation chooses a branch.";
    case Outcome::step_limit:
      return "Look at history.csv: if the path goes where you want it, end it with "
             "arc_length.steps; if it is long, allow longer steps (loading.largest_step).";
    case Outcome::damage_begins:
      return "Follow the damage by a [[control]] in mode newton, or in mode adaptive.";
    case Outcome::unstable_step:
      return "Take a smaller dynamics.time_step, or give dynamics.step_share, with which the step "
             "follows the stable one.";
    case Outcome::inconsistent:
      if (mode == Mode::dynamics) {
        return "The motion gains energy that nobody has put in: take smaller time steps "
               "(dynamics.time_step, dynamics.step_share).";
      }
      return "What was found is no state of this body. Take smaller steps (loading.steps, "
             "relaxation.steps, loading.smallest_step). If that does not help, the case shows a "
             "fault of the program: please report it with its case file.";
    case Outcome::converged:
    case Outcome::out_of_memory:
    case Outcome::interrupted:
      break;
  }
  return "";
}

std::string coordinates_text(const Points& points, Index point) {
  const Coordinates at = points.position(point);
  return fmt::format("({:.6g})", fmt::join(at.begin(), at.begin() + points.dimension, ", "));
}

}  // namespace

Dossier make_dossier(const Case& from, const Body& body, const LoadSteppingResult& result,
                     const std::optional<StepRecord>& last,
                     const std::vector<DecisionRecord>& decisions) {
  const Points points = without_images(body.points);
  const auto d = std::size_t(points.dimension);
  const Attempt& attempt = result.last_attempt;
  Dossier dossier;
  dossier.residual.assign(points.reference.size(), 0.0);
  dossier.displacement = attempt.state.displacement;
  dossier.displacement.resize(points.reference.size(), 0.0);
  const std::vector<char>& prescribed = body.conditions->prescribed();
  for (std::size_t dof = 0; dof < std::min(attempt.state.gradient.size(), dossier.residual.size());
       ++dof) {
    if (!prescribed[dof]) {
      dossier.residual[dof] = attempt.external_force[dof] - attempt.state.gradient[dof];
    }
  }
  // A search that went astray may end in a state that is not finite: such entries tell nothing.
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
  say(fmt::format("Last search: load factor {:.9g}, {} iterations",
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

  std::vector<double> size(std::size_t(points.count()), 0.0);
  for (std::size_t dof = 0; dof < dossier.residual.size(); ++dof) {
    size[dof / d] += dossier.residual[dof] * dossier.residual[dof];
  }
  std::vector<Index> order(size.size());
  std::iota(order.begin(), order.end(), 0);
  const std::size_t told = std::min(worst_told, order.size());
  std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(told), order.end(),
                    [&](Index a, Index b) { return size[a] > size[b]; });
  say("Worst points of that residual (all of it: /dossier/residual in results.h5)");
  say("  point       residual [N]   reference position [m]");
  for (std::size_t k = 0; k < told; ++k) {
    say(fmt::format("  {:<10}  {:<12.4g}   {}", order[k], std::sqrt(size[order[k]]),
                    coordinates_text(points, order[k])));
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
