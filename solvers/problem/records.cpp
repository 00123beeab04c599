#include "solvers/problem/records.hpp"

namespace peristat {

std::string name(Decision decision) {
  switch (decision) {
    case Decision::accept:
      return "accept";
    case Decision::accept_and_grow:
      return "accept and grow";
    case Decision::accept_at_round_off:
      return "accept at round-off";
    case Decision::cut:
      return "cut";
    case Decision::stop:
      return "stop";
    case Decision::hand_over:
      return "hand over to relaxation";
    case Decision::hand_back:
      return "hand back to newton";
    case Decision::hold_fragments:
      return "hold fragments";
    case Decision::remove_fragments:
      return "remove fragments";
    case Decision::change_linear_solver:
      return "change linear solver";
  }
  return "";
}

}  // namespace peristat
