#include "assembly/stress.hpp"

#include <cmath>

#include <Eigen/LU>

#include "assembly/terms/bonds/deformation_gradients.hpp"
#include "assembly/terms/collocation/collocation_term.hpp"
#include "assembly/terms/damage.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/geometry/image_tensors.hpp"

namespace peristat {
namespace {

template <int D>
using TensorOf = Eigen::Matrix<double, D, D, Eigen::RowMajor>;

/// sqrt(3/2 s:s) with the deviator s of the stress in space.
template <int D>
double von_mises(const TensorOf<D>& in_plane, double across) {
  TensorOf<3> stress = TensorOf<3>::Zero();
  stress.template topLeftCorner<D, D>() = in_plane;
  if (D == 2) stress(2, 2) = across;
  const TensorOf<3> deviator = stress - stress.trace() / 3.0 * TensorOf<3>::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

/// Principal values, descending, and directions, whose largest component is positive.
template <int D>
void find_principal(const TensorOf<D>& stress, double* values, double* directions) {
  const SymmetricSpectrum<D> spectrum = symmetric_spectrum<D>(stress.data());
  for (int k = 0; k < D; ++k) {
    const auto place = std::size_t(D - 1 - k);
    values[k] = spectrum.values[place];
    Eigen::Matrix<double, D, 1> direction(spectrum.vectors[place].data());
    int largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    if (direction(largest) < 0.0) direction = -direction;
    for (int c = 0; c < D; ++c) directions[k * D + c] = direction(c);
  }
}

template <int D>
Stress stress_from(const Points& points, DeformationGradients gradients,
                   std::vector<double> virials, const std::vector<double>& out_of_plane,
                   AcrossPlane of, bool is_linear) {
  using Tensor = TensorOf<D>;
  const auto own = std::size_t(points.owned.value_or(points.own()));
  constexpr std::size_t entries = std::size_t(D) * D;
  virials.resize(own * entries);
  gradients.displacement.resize(own * entries);
  gradients.is_determined.resize(own);
  Stress found{std::move(gradients.displacement),
               std::vector<double>(own * entries),
               std::move(virials),
               std::vector<double>(own * entries),
               std::vector<double>(own),
               std::vector<double>(own * D),
               std::vector<double>(own * entries),
               std::move(gradients.is_determined)};
  for (std::size_t i = 0; i < own; ++i) {
    Eigen::Map<Tensor> F(&found.deformation_gradient[i * entries]), E(&found.strain[i * entries]);
    Eigen::Map<Tensor> P(&found.first_piola[i * entries]), sigma(&found.cauchy[i * entries]);
    P /= points.volume[i];
    const Tensor H = F;
    F += Tensor::Identity();
    const double volume_ratio = F.determinant();
    found.is_determined[i] = found.is_determined[i] && (is_linear || volume_ratio > 0.0);
    if (found.is_determined[i] && is_linear) {
      E = 0.5 * (H + H.transpose());
      sigma = P;
    } else if (found.is_determined[i]) {
      // Computed from H, not from F^T F - I: small strains keep their digits.
      E = 0.5 * (H + H.transpose() + H.transpose() * H);
      sigma = P * F.transpose() / volume_ratio;
    } else {
      F.setIdentity();
    }
    const Tensor symmetric = 0.5 * (sigma + sigma.transpose());
    const double ratio = out_of_plane[out_of_plane.size() == 1 ? 0 : i];
    const bool is_second = of == AcrossPlane::second_stress && found.is_determined[i];
    const double in_plane =
        is_second ? Tensor(F.inverse() * P).trace() / volume_ratio : symmetric.trace();
    found.von_mises[i] = von_mises<D>(symmetric, ratio * in_plane);
    find_principal<D>(symmetric, &found.principal[i * D], &found.principal_direction[i * entries]);
  }
  return found;
}

}  // namespace

namespace {

/// Replaces the fitted gradients by the linear solid's nonlocal ones, from which its own
/// dilatations and stresses are computed.
void use_nonlocal_gradients(Assembler& assembler, const CollocationTerm& term, const StateView& at,
                            DeformationGradients& gradients) {
  const Points& points = assembler.points();
  CollocationOperator solid(points, term.whole(), 1);
  solid.update(broken_bonds(assembler.model(), at.history));
  std::vector<double> found(gradients.displacement.size());
  solid.displacement_gradients(at.displacement, found);
  const auto entries = std::size_t(points.dimension * points.dimension);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (gradients.is_determined[k / entries]) gradients.displacement[k] = found[k];
  }
}

}  // namespace

Stress find_stress(Assembler& assembler, const StateView& at,
                   const std::vector<double>& out_of_plane, AcrossPlane of) {
  const Points& points = assembler.points();
  std::vector<double> virials(std::size_t(points.count()) *
                              std::size_t(points.dimension * points.dimension));
  assembler.virials(at, virials);
  gather_image_tensors(points, virials);
  DeformationGradients gradients = deformation_gradients(points, assembler.model(), at);
  const auto* const solid = assembler.model().find<CollocationTerm>();
  if (solid) use_nonlocal_gradients(assembler, *solid, at, gradients);
  const bool is_linear = solid != nullptr;
  switch (points.dimension) {
    case 1:
      return stress_from<1>(points, std::move(gradients), std::move(virials), out_of_plane, of,
                            is_linear);
    case 2:
      return stress_from<2>(points, std::move(gradients), std::move(virials), out_of_plane, of,
                            is_linear);
    default:
      return stress_from<3>(points, std::move(gradients), std::move(virials), out_of_plane, of,
                            is_linear);
  }
}

}  // namespace peristat
