#pragma once

#include <span>
#include <vector>

#include "assembly/operators/tangent_operator.hpp"

namespace peristat {

/// Tangent whose blocks are stored: the symmetric half of K.
struct Tangent : TangentOperator {
  /// Off-diagonal blocks are stored whole, row major, or as their upper halves (xx xy xz yy yz zz):
  /// those of bonds are symmetric, those of triangles and tetrahedra are not.
  enum class Blocks { whole, upper_halves };

  Tangent(const BlockPattern& of, int dimension_of_points, int threads = 1,
          Blocks stored_as = Blocks::whole);
  /// Tangent for an energy that has blocks, stored as the energy needs them.
  explicit Tangent(const Energy& energy);
  /// @param own rows before those of images and ghosts
  Tangent(const BlockPattern& of, int dimension_of_points, int threads, Index own,
          Blocks stored_as);

  Blocks blocks;
  std::vector<double> off_diagonal;  ///< block (i, partner), in the order of the pattern [N/m]
  std::vector<double> position;      ///< see positions

  /// Numbers that are stored per off-diagonal block.
  [[nodiscard]] std::size_t block_size() const;
  /// Entry (r, c) of an off-diagonal block [N/m].
  [[nodiscard]] double entry(Offset block, int r, int c) const {
    return off_diagonal[std::size_t(block) * block_size() + place_in_block(r, c)];
  }
  /// Position of entry (r, c) in a stored block.
  [[nodiscard]] std::size_t place_in_block(int r, int c) const;

  /// Takes another pattern of the same points; the blocks are then undefined.
  void take_pattern(const BlockPattern& of, int version_of_it);
  /// Makes all blocks zero.
  void clear();
  /// Adds dimension x dimension numbers, row major, to an off-diagonal block [N/m].
  void add_to_block(Offset block, std::span<const double> entries);

  [[nodiscard]] std::vector<double> positions() const override { return position; }
  void linearise(Energy& energy, const StateView& at, double projection) override;
  void multiply(std::span<const double> v, std::span<double> result) const override;
  void for_each_row(const RowVisitor& visit) const override;
  [[nodiscard]] const Tangent* as_tangent() const override { return this; }
  [[nodiscard]] Tangent* as_tangent() override { return this; }

  /// sqrt of the sum of squares of all entries, both halves counted [N/m].
  [[nodiscard]] double frobenius_norm() const;

  /// Per part, contributions of a product to the rows beyond it; overwritten by each product.
  mutable std::vector<std::vector<double>> spilled;

 private:
  void make_room_for_spills();

  Index own_;
};

}  // namespace peristat
