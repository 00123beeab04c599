#include "solvers/formulations/faster_operator.hpp"

#include "solvers/formulations/check_specification.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/formulations.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// Horizon over spacing from which convolutions are faster than sums over bonds: measured in 2D and
/// 3D, where the two break even at 2.
constexpr double least_ratio_of_convolutions = 2.5;

}  // namespace

bool needs_convolutions(const BodySpecification& of) {
  return formulation_of(of).needs_convolutions || of.form == SolidForm::printed;
}

ForceOperator faster_operator(const BodySpecification& from, const Points& points,
                              bool is_explicit) {
  if (needs_convolutions(from)) return ForceOperator::fft;
  // With images convolutions take twice as long.
  const bool has_images = !from.constraints.symmetries.empty() || !from.constraints.periods.empty();
  const bool may_be = formulation_of(from).takes_convolved && !has_images;
  const double ratio = from.horizon / points.spacing;
  if (!may_be || !is_explicit || ratio < least_ratio_of_convolutions) return ForceOperator::bonds;
  BodySpecification convolved = from;
  convolved.force_operator = ForceOperator::fft;
  try {
    check_specification(convolved, points);
    require_convolutions(convolved, points);
  } catch (const InputError&) {  // no convolution; other errors are reported for bonds, too
    return ForceOperator::bonds;
  }
  return ForceOperator::fft;
}

}  // namespace peristat
