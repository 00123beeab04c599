#include "solvers/ranks/part_of_body.hpp"

namespace peristat {

PartOfBody::PartOfBody(const Part& part, const Communicator& ranks)
    : ranks_(ranks),
      number_(part.number.begin(), part.number.begin() + std::ptrdiff_t(part.owned)),
      ghost_number_(part.number.begin() + std::ptrdiff_t(part.owned), part.number.end()),
      ghost_owner_(part.owner),
      whole_(part.whole),
      ghosts_(make_ghost_exchange(ranks, number_, ghost_number_, part.points.dimension)) {}

}  // namespace peristat
