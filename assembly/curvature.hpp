#pragma once

namespace peristat {

/// Which second derivative of an interaction's energy goes into the tangent.
enum class Curvature {
  exact,
  projected,  ///< the positive semidefinite part of every interaction's relative Hessian
};

}  // namespace peristat
