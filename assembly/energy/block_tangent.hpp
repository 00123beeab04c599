#pragma once

#include "assembly/energy/state.hpp"
#include "assembly/energy/write.hpp"

namespace peristat {

struct Tangent;

/// A tangent that can be stored in blocks.
class BlockTangent {
 public:
  virtual ~BlockTangent() = default;

  /// d2E/dx2 [N/m], in the blocks of the pattern.
  /// @param projection share in [0, 1] by which the relative Hessian of every interaction moves
  ///        towards its positive semidefinite part: 0 is exact, 1 gives a positive semidefinite
  ///        tangent
  virtual void tangent(const StateView& at, Tangent& tangent, double projection, Write how) = 0;
};

}  // namespace peristat
