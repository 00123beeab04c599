#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <vector>

#include "assembly/assembler.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// The tangent of a part of a body: a Tangent, MatrixFreeTangent or other operator of its points
/// that updates the ghosts of vectors before it multiplies them. Rows of owned points are the whole
/// body's. Rows and diagonal blocks of ghosts are incomplete and meaningless. All calls are
/// collective.
template <class Operator>
struct PartTangent final : Operator {
  /// @throws std::logic_error if the energy is that of a whole body
  template <class... Options>
  explicit PartTangent(Assembler& energy, Options... options)
      : Operator(energy, options...), index_map_(energy.index_map()) {
    if (index_map_.is_whole()) throw std::logic_error("PartTangent: of a whole body");
    this->reference = energy.points().reference;
    factor_.resize(this->reference.size());
  }

  /// Ignores entries of v for ghosts; those of the result are meaningless.
  void multiply(std::span<const double> v, std::span<double> result) const override {
    update_ghosts(v);
    Operator::multiply(factor_, result);
  }
  void multiply_in_single(std::span<const double> v, std::span<double> result) const override {
    update_ghosts(v);
    Operator::multiply_in_single(factor_, result);
  }
  [[nodiscard]] bool multiplies_in_place() const override { return true; }

 private:
  void update_ghosts(std::span<const double> v) const {
    std::copy(v.begin(), v.end(), factor_.begin());
    index_map_.update_ghosts(factor_);
  }

  const IndexMap& index_map_;
  mutable std::vector<double> factor_;  // with the ghosts' values
};

/// Flags of degrees of freedom without an equation on this rank: those of ghosts and images, those
/// of handles except on rank 0, and those that are prescribed.
/// @param prescribed one flag per degree of freedom of all points here
[[nodiscard]] std::vector<char> without_ghosts(const IndexMap& index_map,
                                               std::vector<char> prescribed, int dimension);

}  // namespace peristat
