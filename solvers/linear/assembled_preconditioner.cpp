#include "solvers/linear/assembled_preconditioner.hpp"

#include <stdexcept>

#include "solvers/linear/compressed_rows.hpp"

namespace peristat {

LinearOutcome AssembledPreconditioner::build(const TangentOperator& tangent) {
  if (!tangent.as_tangent()) throw std::logic_error("this preconditioner needs a stored tangent");
  const bool built = preconditioner_.build(
      compressed_rows(*tangent.as_tangent(), *free_, index_map_), equation_blocks(*free_),
      rigid_motions(tangent.positions(), *free_, index_map_));
  description_ = built ? preconditioner_.describe() : preconditioner_.failure();
  if (built) return LinearOutcome::solved;
  return preconditioner_.failure() == "out of memory" ? LinearOutcome::out_of_memory
                                                      : LinearOutcome::inaccurate;
}

}  // namespace peristat
