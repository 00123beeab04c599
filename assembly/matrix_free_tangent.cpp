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

void MatrixFreeTangent::linearise(Assembler& assembler, std::span<const double> displacement,
                                  double projection) {
  assembler_ = &assembler;
  displacement_.assign(displacement.begin(), displacement.end());
  projection_ = projection;
  assembler.visit_tangent(
      displacement, projection, [](int, Index, std::span<const double>) {}, diagonal);
}

void MatrixFreeTangent::multiply(std::span<const double> v, std::span<double> result) const {
  assembler_->product(displacement_, v, result, projection_);
}

void MatrixFreeTangent::for_each_row(const RowVisitor& visit) const {
  assembler_->visit_tangent(displacement_, projection_, visit, {});
}

}  // namespace peristat
