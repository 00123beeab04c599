#pragma once

#include <limits>
#include <span>

#include "solvers/search/condition_rates.hpp"
#include "solvers/search/newton.hpp"
#include "solvers/search/updated_tangent.hpp"

namespace peristat {

/// Utilisation of the most utilised bond in a state at its strength: near enough to 1 for every
/// digit that is printed, and on the side on which no bond is overloaded.
inline constexpr double share_at_strength = 1.0 - 1e-9;

/// Search along an elastic path for the next strength. The path's parameter is the stage or, before
/// step 0, the share of the preload, which acts at load 0.
struct StrengthStep {
  bool preloads = false;          ///< the "stage" is the share of the preload, 0 to 1
  std::span<const double> borne;  ///< resistance of each bond, see borne_stretches
  LoadRange range;                ///< limits of the stage
  double stop = 0.0;              ///< stage to end at, going up, if no strength is met before
  bool settles = false;           ///< only finds equilibrium at its stage
  double least_scale = 0.0;       ///< that the residual is measured against [N]
  /// Largest change of the stage; no strength beyond it is searched.
  double longest = std::numeric_limits<double>::infinity();

  [[nodiscard]] LoadPoint point(double stage) const {
    return preloads ? LoadPoint::of_preload(stage) : LoadPoint(stage);
  }
};

/// How a search ends.
enum class StrengthEnd {
  at_strength,   ///< the next bonds reach their resistance
  at_stop,       ///< at the stage to stop at, no bond overloaded
  on_the_way,    ///< after the longest step, no bond overloaded (if the stage increased)
  inadmissible,  ///< at every stage within the range some bond is overloaded
};

struct StrengthResult {
  NewtonResult newton;
  double stage = 0.0;
  StrengthEnd end = StrengthEnd::inadmissible;
  bool goes_up = true;  ///< the stage increases
};

/// Newton-Raphson for the equilibrium at which the next bonds reach their resistance, from an
/// equilibrium whose integrities have just changed, or stay as they are. With integrities fixed the
/// body is elastic:
///
///   f_ext(l) - dE/dx_f(u) = 0,   max_b s_b(u) / s_b^borne = share_at_strength,   u_p = u_p(l).
///
/// Each iteration solves, with a tangent that may be that of a state nearby, K_ff a = f_ext -
/// dE/dx_f and K_ff b = df_ext/dl - K_fp du_p/dl. From the stretches at u + a and their rates along
/// b it finds the range of dl in which no bond is overloaded. If the present stage is within it,
/// the next strength is at its upper end; otherwise the strength that is met first is at the nearer
/// end, up or down. The stretches are those of the state itself: the strength is exact at finite
/// strain.
/// @return outcome iteration_limit also if the path is too curved for one step
[[nodiscard]] StrengthResult search_strength(const EquilibriumProblem& problem,
                                             UpdatedTangent& tangent, const State& from,
                                             const StrengthStep& step, const NewtonOptions& options,
                                             const IterationObserver& observer);

}  // namespace peristat
