#pragma once

#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "assembly/terms/model.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Deformation gradients of the points' neighbourhoods.
struct DeformationGradients {
  std::vector<double> displacement;  ///< F - I, points x dimension x dimension, row major
  std::vector<char> is_determined;   ///< per point; where it is not, F - I is zero
};

/// The deformation gradient F of every point that fits its unbroken bonds best,
///
///   F = I + (sum_j w eta (x) xi) (sum_j w xi (x) xi)^(-1),
///
/// least squares with the weight w of each bond in the energy (volumes, partial volumes, influence,
/// corrections, relative stiffness); xi is the reference vector and eta the relative displacement.
/// Exact for homogeneous deformations whatever the weights. Softened bonds count in full. A point
/// whose unbroken bonds do not span the space determines none. Images are left out: their F is that
/// of their source, mirrored.
[[nodiscard]] DeformationGradients deformation_gradients(const Points& points, const Model& model,
                                                         const StateView& at);

}  // namespace peristat
