#pragma once

#include <limits>
#include <span>

#include "solvers/search/condition_rates.hpp"
#include "solvers/search/newton.hpp"
#include "solvers/search/updated_tangent.hpp"

namespace peristat {

/// A state at its strength has its most utilised bond at this share of what it bears: near enough
/// for every digit that is printed, and on the side on which all bonds are whole.
inline constexpr double share_at_strength = 1.0 - 1e-9;

/// Where an elastic path is looked along for the next strength: in the stage, or, on the way to
/// step 0, in the share of what acts at load 0.
struct StrengthStep {
  bool preloads = false;          ///< "stage" is that share here, 0 to 1
  std::span<const double> borne;  ///< per bond, see borne_stretches
  LoadRange range;                ///< that the stage may not leave
  double stop = 0.0;              ///< stage to end at, going up, if no strength is met before
  bool settles = false;           ///< at its stage, whatever the bonds bear
  double least_scale = 0.0;       ///< that the residual is measured against [N]
  /// Largest change of the stage; a strength beyond it is not looked for.
  double longest = std::numeric_limits<double>::infinity();

  [[nodiscard]] LoadPoint point(double stage) const {
    return preloads ? LoadPoint::of_preload(stage) : LoadPoint(stage);
  }
};

/// What the end of a search is.
enum class StrengthEnd {
  at_strength,   ///< the next bonds are at what they bear
  at_stop,       ///< at the stage to stop at, no bond above what it bears
  on_the_way,    ///< the longest step was made, no bond above what it bears
  inadmissible,  ///< at no stage within the range all bonds bear what they are stretched to
};

struct StrengthResult {
  NewtonResult newton;
  double stage = 0.0;
  StrengthEnd end = StrengthEnd::inadmissible;
  bool goes_up = true;  ///< in the stage
};

/// Newton-Raphson for the equilibrium at which the next bonds reach what they bear, from an
/// equilibrium whose integrities have just changed, or stay as they are. With integrities fixed
/// the body is elastic:
///
///   f_ext(l) - dE/dx_f(u) = 0,   max_b s_b(u) / s_b^borne = share_at_strength,   u_p = u_p(l).
///
/// Each iteration solves, with a tangent that may be of a state nearby, K_ff a = f_ext - dE/dx_f
/// and K_ff b = df_ext/dl - K_fp du_p/dl, and with the stretches at u + a and their rates along b
/// finds the range of dl in which no bond is above what it bears. Where the present stage is within
/// it the next strength is at its upper end; otherwise the one that is met first from here is at
/// the end that is nearer, up or down. The stretches are those of the state itself: the strength is
/// exact at finite strain.
/// @return outcome iteration_limit also where the way is too curved for one step
[[nodiscard]] StrengthResult search_strength(const EquilibriumProblem& problem,
                                             UpdatedTangent& tangent, const State& from,
                                             const StrengthStep& step, const NewtonOptions& options,
                                             const IterationObserver& observer);

}  // namespace peristat
