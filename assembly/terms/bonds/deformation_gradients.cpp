#include "assembly/terms/bonds/deformation_gradients.hpp"

#include <Eigen/Core>

#include "assembly/terms/damage.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/geometry/image_tensors.hpp"

namespace peristat {
namespace {

/// Smallest over largest second moment of a neighbourhood below which its bonds lie in a line or
/// plane but for round-off.
constexpr double flat = 1e-10;

struct Moments {
  std::vector<double> reference;     // sum w xi (x) xi per point
  std::vector<double> displacement;  // sum w eta (x) xi
};

template <int D>
Moments moments(const Points& points, const Model& model, const StateView& at) {
  const std::size_t entries = std::size_t(points.count()) * D * D;
  Moments sums{std::vector<double>(entries), std::vector<double>(entries)};
  const DamagedNetwork network = damaged_network(model, at.history);
  const std::vector<char>& broken = network.broken;
  const Bonds& bonds = *network.bonds;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!broken.empty() && broken[bond]) continue;
      const Index ends[] = {i, bonds.partner(i, bond)};
      const double weight = bonds.weight(bond);
      double xi[D], eta[D];
      for (int c = 0; c < D; ++c) {
        const std::size_t from = std::size_t(ends[0]) * D + c, to = std::size_t(ends[1]) * D + c;
        xi[c] = points.reference[to] - points.reference[from];
        eta[c] = at.displacement[to] - at.displacement[from];
      }
      for (const Index point : ends) {
        for (int r = 0; r < D; ++r) {
          for (int c = 0; c < D; ++c) {
            const std::size_t entry = (std::size_t(point) * D + r) * D + c;
            sums.reference[entry] += weight * xi[r] * xi[c];
            sums.displacement[entry] += weight * eta[r] * xi[c];
          }
        }
      }
    }
  }
  gather_image_tensors(points, sums.reference);
  gather_image_tensors(points, sums.displacement);
  return sums;
}

template <int D>
DeformationGradients solve(const Points& points, const Moments& sums) {
  using Tensor = Eigen::Matrix<double, D, D, Eigen::RowMajor>;
  const auto own = std::size_t(points.own());
  DeformationGradients found{std::vector<double>(own * D * D), std::vector<char>(own)};
  for (std::size_t i = 0; i < own; ++i) {
    const SymmetricSpectrum<D> spectrum = symmetric_spectrum<D>(&sums.reference[i * D * D]);
    const Eigen::Map<const Eigen::Matrix<double, D, 1>> moment(spectrum.values.data());
    found.is_determined[i] = moment(0) > flat * moment(D - 1);
    if (!found.is_determined[i]) continue;
    Tensor axes;
    for (int k = 0; k < D; ++k) {
      for (int c = 0; c < D; ++c) axes(c, k) = spectrum.vectors[k][c];
    }
    Eigen::Map<Tensor>(&found.displacement[i * D * D]) =
        Eigen::Map<const Tensor>(&sums.displacement[i * D * D]) * axes *
        moment.cwiseInverse().asDiagonal() * axes.transpose();
  }
  return found;
}

}  // namespace

DeformationGradients deformation_gradients(const Points& points, const Model& model,
                                           const StateView& at) {
  switch (points.dimension) {
    case 1:
      return solve<1>(points, moments<1>(points, model, at));
    case 2:
      return solve<2>(points, moments<2>(points, model, at));
    default:
      return solve<3>(points, moments<3>(points, model, at));
  }
}

}  // namespace peristat
