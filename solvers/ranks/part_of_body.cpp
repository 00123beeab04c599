#include "solvers/ranks/part_of_body.hpp"

#include <algorithm>

namespace peristat {

PartOfBody::PartOfBody(const Part& part, const Communicator& ranks)
    : ranks_(ranks),
      number_(part.number.begin(), part.number.begin() + std::ptrdiff_t(part.owned)),
      ghost_number_(part.number.begin() + std::ptrdiff_t(part.owned), part.number.end()),
      ghost_owner_(part.owner),
      whole_(part.whole),
      ghosts_(make_ghost_exchange(ranks, number_, ghost_number_, part.points.dimension)) {}

std::optional<Index> PartOfBody::find(GlobalIndex number) const {
  Index before = 0;
  for (const std::vector<GlobalIndex>* numbers : {&number_, &ghost_number_}) {
    const auto found = std::lower_bound(numbers->begin(), numbers->end(), number);
    if (found != numbers->end() && *found == number) {
      return before + Index(found - numbers->begin());
    }
    before += Index(numbers->size());
  }
  return std::nullopt;
}

}  // namespace peristat
