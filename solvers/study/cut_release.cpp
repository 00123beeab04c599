#include "solvers/study/cut_release.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "assembly/terms/damage.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/search/newton.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/geometry/images.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// The cutting segment, in 3D a strip along the whole front.
Crack segment_ahead(const CrackTipSpecification& tip, const Points& points) {
  const double size = std::sqrt(dot<3>(tip.direction, tip.direction));
  const Coordinates end = plus<3>(tip.at, scaled<3>(tip.cut / size, tip.direction));
  if (points.dimension == 2) return CrackSegment{tip.at, end};
  double reach = 0.0;
  for (Index i = 0; i < points.count(); ++i) {
    const Coordinates arm = minus<3>(points.position(i), tip.at);
    reach = std::max(reach, std::sqrt(dot<3>(arm, arm)));
  }
  const double front = std::sqrt(dot<3>(tip.front, tip.front));
  const Coordinates half = scaled<3>(2.0 * reach / front, tip.front);
  return CrackPolygon{
      {minus<3>(tip.at, half), minus<3>(end, half), plus<3>(end, half), plus<3>(tip.at, half)}};
}

void refuse_what_has_no_rate(const Body& body, const CrackTipSpecification& tip,
                             const std::string& key) {
  const Formulation& can = formulation_of(body.specification);
  if (body.specification.is_convolved() && can.couples_second_neighbours) {
    throw InputError(key, number_text(tip.cut),
                     "needs bonds to cut, which this model with operator \"fft\" does not have; "
                     "take \"bonds\", or J without a cut");
  }
  const BondFailure* const failing = body.model.failing_bonds();
  if (failing && failing->onsets()) {
    throw InputError(key, "", "is not allowed with a strength_surface; take J without a cut");
  }
  const Conditions& conditions = *body.conditions;
  if (!(tip.cut >= body.setting.reach() * (1.0 - 1e-9))) {
    throw InputError(key, number_text(tip.cut),
                     "must be at least a horizon, " + number_text(body.setting.reach()) +
                         " m: a shorter cut leaves bonds across it");
  }
  if (conditions.control()) throw InputError(key, "", "is not allowed with a [[control]]");
  const double end = conditions.programme().end();
  if (conditions.environment(end)) {
    throw InputError(key, "", "is not allowed with pressures or a ground that moves");
  }
  std::vector<double> force(conditions.constraints().dofs()), moved(force.size(), 0.0);
  conditions.external_force(end, force);
  conditions.prescribe(end, moved);
  if (norm(force) > 0.0 && norm(moved) > 0.0) {
    throw InputError(key, "", "needs a body with loads only, or with moving supports only");
  }
}

}  // namespace

CutRelease::CutRelease(const Body& body, const CrackTipSpecification& tip, double share,
                       const StudyOptions& options, const std::string& key)
    : body_(body), length_(tip.cut), share_(share) {
  refuse_what_has_no_rate(body, tip, key);
  BodySpecification longer = body.specification;
  longer.cracks.push_back(segment_ahead(tip, body.points));
  cut_ = make_body(without_images(body.points), longer, options.threads);
  if (cut_->model.bonds().count() == body.model.bonds().count()) {
    throw InputError(key, number_text(tip.cut), "cuts no bond: there is no body ahead of the tip");
  }
  study_ = std::make_unique<Study>(*cut_, options);
}

History CutRelease::history_of(const History& before) const {
  const std::span<const double> stretches = bond_stretches(body_.model, before);
  if (stretches.empty()) return before;  // histories of points, which are the same
  const Bonds &whole = body_.model.bonds(), &left = cut_->model.bonds();
  std::vector<double> kept;
  for (Index i = 0; i < left.points(); ++i) {
    Offset bond = whole.offset[i];
    for (Offset b = left.offset[i]; b < left.offset[i + 1]; ++b, ++bond) {
      while (whole.partner(i, bond) != left.partner(i, b)) ++bond;
      kept.push_back(stretches[std::size_t(bond)]);
    }
  }
  return study_->equations().assembler().history_of(kept);
}

std::optional<ReleaseRates> CutRelease::rates(const Trial& before, double stage) {
  const double energy = before.stored_energy;
  if (!(energy > 0.0)) return ReleaseRates{};
  if (study_->analyze() != LinearOutcome::solved) return std::nullopt;
  const SolvedBody solved = study_->equations().solved();
  const EquilibriumProblem problem{solved.assembler, *cut_->conditions, study_->free()};
  NewtonOptions options = study_->options().newton;
  options.damage = Damage::held;
  const NewtonResult after =
      newton(problem, solved.solver, solved.tangent,
             {before.displacement, stage, history_of(before.history), {}, before.environment},
             stage, options, {});
  if (after.outcome != Outcome::converged) return std::nullopt;
  const double longer = after.state.stored_energy, scale = share_ / length_;
  const bool is_loaded = norm(after.external_force) > 0.0;
  if (is_loaded) {
    return ReleaseRates{scale * energy * (1.0 - energy / longer), scale * (longer - energy)};
  }
  return ReleaseRates{scale * (energy - longer), scale * energy * (energy / longer - 1.0)};
}

}  // namespace peristat
