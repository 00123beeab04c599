#include "solvers/ranks/part_of_body.hpp"

namespace peristat {

PartOfBody::PartOfBody(const Part& part, const Communicator& ranks)
    : ranks_(ranks),
      number_(part.number.begin(), part.number.begin() + std::ptrdiff_t(part.owned)),
      whole_(part.whole),
      ghosts_(make_ghost_exchange(
          ranks, number_, {part.number.begin() + std::ptrdiff_t(part.owned), part.number.end()},
          part.points.dimension)) {}

}  // namespace peristat
