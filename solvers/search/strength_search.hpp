#pragma once

#include <limits>
#include <span>
#include <vector>

#include "assembly/borne_stretches.hpp"
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
  double listed = 0.999;          ///< least utilisation of bonds that the result lists, below 1
  /// Largest change of the stage; no strength beyond it is searched.
  double longest = std::numeric_limits<double>::infinity();
  /// Change of the stage within which contacts that close and open are one corner of the path.
  double corner = 0.0;

  [[nodiscard]] LoadPoint point(double stage) const {
    return preloads ? LoadPoint::of_preload(stage) : LoadPoint(stage);
  }
};

/// How a search ends.
enum class StrengthEnd {
  at_strength,   ///< the next bonds reach their resistance
  at_stop,       ///< at the stage to stop at, no bond overloaded
  on_the_way,    ///< after the longest step or where a contact closes or opens, no bond overloaded
                 ///< (if the stage increased from where none was)
  inadmissible,  ///< at every stage within the range some bond is overloaded
};

struct StrengthResult {
  NewtonResult newton;
  double stage = 0.0;
  StrengthEnd end = StrengthEnd::inadmissible;
  std::vector<UtilisedBond> utilised;  ///< listed bonds of a converged state, see utilised_bonds
  bool goes_up = true;                 ///< the stage increases
  bool turns_at_contact = false;       ///< on the way: a contact closes or opens
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
/// strain. What the tangent lacks shows in the residuals: the tangent learns from each a, and b is
/// corrected by the first a after the step along it.
///
/// Where contacts close and open the path has corners, beyond which b means nothing. So a search
/// ends just behind the first one that b predicts. While contacts press, every iteration has a
/// tangent of its own. In the first one contacts that press, or that b closes at once, are springs
/// (StateView::foreseen): they have hardly any stiffness where they begin to press.
/// @return outcome iteration_limit also if the path is too curved for one step
[[nodiscard]] StrengthResult search_strength(const EquilibriumProblem& problem,
                                             UpdatedTangent& tangent, const State& from,
                                             const StrengthStep& step, const NewtonOptions& options,
                                             const IterationObserver& observer);

}  // namespace peristat
