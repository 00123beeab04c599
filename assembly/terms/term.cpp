#include "assembly/terms/term.hpp"

#include <stdexcept>

namespace peristat {

void TermPasses::visit_tangent(const StateView&, double, const RowVisitor&, std::span<double>) {
  throw std::logic_error("the rows of this term's tangent are not found one by one");
}

}  // namespace peristat
