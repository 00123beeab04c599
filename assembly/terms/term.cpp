#include "assembly/terms/term.hpp"

#include <stdexcept>

namespace peristat {

void TermPasses::visit_tangent(const StateView&, double, const RowVisitor&, std::span<double>) {
  throw std::logic_error("the rows of this term's tangent are not found one by one");
}

SparseRows TermPasses::rows(const StateView&, RowReach) {
  throw std::logic_error("this term has a potential");
}

void TermPasses::outline_rows(const StateView&, std::span<double>, std::span<double>) {
  throw std::logic_error("this term has a potential");
}

}  // namespace peristat
