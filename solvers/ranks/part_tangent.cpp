#include "solvers/ranks/part_tangent.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace peristat {

PartTangent::PartTangent(Assembler& energy)
    : TangentOperator(energy.pattern(), energy.points().dimension, energy.threads()),
      energy_(energy),
      tangent_(energy) {
  if (!energy.sharing()) throw std::logic_error("PartTangent: of a whole body");
  reference = energy.points().reference;
  factor_.resize(reference.size());
}

void PartTangent::linearise(Energy& energy, const StateView& at, double projection) {
  if (&energy != &energy_) throw std::logic_error("PartTangent: of another energy");
  tangent_.linearise(energy, at, projection);
  diagonal = tangent_.diagonal;
}

void PartTangent::multiply(std::span<const double> v, std::span<double> result) const {
  std::copy(v.begin(), v.end(), factor_.begin());
  energy_.sharing()->update_ghosts(factor_);
  tangent_.multiply(factor_, result);
}

std::vector<char> without_ghosts(const Sharing& sharing, std::vector<char> prescribed,
                                 int dimension) {
  const std::size_t owned = std::size_t(sharing.owned()) * std::size_t(dimension);
  std::fill(prescribed.begin() + std::ptrdiff_t(owned), prescribed.end(), char(1));
  return prescribed;
}

}  // namespace peristat
