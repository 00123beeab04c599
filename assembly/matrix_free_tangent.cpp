#include "assembly/matrix_free_tangent.hpp"

#include <stdexcept>

namespace peristat {

MatrixFreeTangent::MatrixFreeTangent(Assembler& assembler)
    : TangentOperator(Pattern(assembler.model().bonds), assembler.points().dimension,
                      assembler.threads()),
      assembler_(&assembler) {
  if (!assembler.model().has_only_bonds()) {
    throw std::logic_error("a tangent with triangles or tetrahedra must be stored");
  }
}

std::vector<double> MatrixFreeTangent::positions() const {
  std::vector<double> current = assembler_->points().reference;
  for (std::size_t k = 0; k < displacement_.size(); ++k) current[k] += displacement_[k];
  return current;
}

void MatrixFreeTangent::linearise(Assembler& assembler, const StateView& at, double projection) {
  assembler_ = &assembler;
  displacement_.assign(at.displacement.begin(), at.displacement.end());
  history_ = at.history;
  damage_ = at.damage;
  projection_ = projection;
  assembler.visit_tangent(
      at, projection, [](int, Index, std::span<const double>) {}, diagonal);
}

void MatrixFreeTangent::multiply(std::span<const double> v, std::span<double> result) const {
  assembler_->product(at(), v, result, projection_);
}

void MatrixFreeTangent::for_each_row(const RowVisitor& visit) const {
  assembler_->visit_tangent(at(), projection_, visit, {});
}

}  // namespace peristat
