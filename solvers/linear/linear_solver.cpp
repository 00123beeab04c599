#include "solvers/linear/linear_solver.hpp"

namespace peristat {

std::string name(LinearOutcome outcome) {
  switch (outcome) {
    case LinearOutcome::solved:
      return "solved";
    case LinearOutcome::not_positive_definite:
      return "not_positive_definite";
    case LinearOutcome::singular:
      return "singular";
    case LinearOutcome::out_of_memory:
      return "out_of_memory";
    case LinearOutcome::inaccurate:
      return "inaccurate";
  }
  return "";
}

}  // namespace peristat
