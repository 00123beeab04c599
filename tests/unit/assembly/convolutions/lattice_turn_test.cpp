#include "assembly/convolutions/lattice_turn.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/convolutions/green_bonds.hpp"

namespace peristat {
namespace {

using Tensor3 = std::array<std::array<double, 3>, 3>;

constexpr double spacing = 0.1;

/// A whole box of points on a lattice that is turned about z by 27 degrees.
struct Block {
  LatticeBox box;
  std::vector<LatticeSpring> springs;
  std::vector<double> place;

  Block(int dimension, std::array<Index, 3> extent) {
    box.dimension = dimension;
    box.extent = extent;
    Kernel kernel;
    kernel.dimension = dimension;
    kernel.horizon = 2.015 * spacing;
    springs = lattice_springs(kernel, Spacing(spacing), 27.0, 2.3, std::pow(spacing, dimension));
    const double c = std::cos(27.0 * M_PI / 180.0), s = std::sin(27.0 * M_PI / 180.0);
    for (Index at = 0; at < Index(box.count()); ++at) {
      box.place.push_back(at);
      const auto [i, j, k] = box.numbers(at);
      const std::array<double, 3> x{spacing * (c * i - s * j), spacing * (s * i + c * j),
                                    spacing * k};
      place.insert(place.end(), x.begin(), x.begin() + dimension);
    }
  }
  [[nodiscard]] GreenBonds bonds() const { return GreenBonds(box, {}, springs, 1); }
  [[nodiscard]] std::size_t points() const { return box.place.size(); }
};

/// By two radians; in 3D about an axis that is none of the lattice's.
Tensor3 rotation(int dimension) {
  const double c = std::cos(2.0), s = std::sin(2.0);
  const std::array<double, 3> n =
      dimension == 2 ? std::array{0.0, 0.0, 1.0} : std::array{2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};
  const Tensor3 cross{{{0.0, -n[2], n[1]}, {n[2], 0.0, -n[0]}, {-n[1], n[0], 0.0}}};
  Tensor3 result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      result[i][j] = (i == j ? c : 0.0) + (1.0 - c) * n[i] * n[j] + s * cross[i][j];
    }
  }
  return result;
}

std::vector<double> turned(const std::vector<double>& field, std::size_t d) {
  const Tensor3 R = rotation(int(d));
  std::vector<double> result(field.size(), 0.0);
  for (std::size_t k = 0; k < field.size(); ++k) {
    for (std::size_t c = 0; c < d; ++c) result[k] += R[k % d][c] * field[k / d * d + c];
  }
  return result;
}

/// Strains of some 1e-4, not the same everywhere.
std::vector<double> strained(const Block& block) {
  const auto d = std::size_t(block.box.dimension);
  std::vector<double> u;
  for (std::size_t k = 0; k < block.place.size(); ++k) {
    const double along = block.place[k / d * d], across = block.place[k / d * d + 1];
    u.push_back(1e-4 * (k % d == 0 ? along + 0.3 * across * along : 0.5 * across - 0.2 * along));
  }
  return u;
}

/// R (X + u) - X, and somewhere else.
std::vector<double> moved_as_a_whole(const Block& block, const std::vector<double>& u) {
  std::vector<double> now(u);
  for (std::size_t k = 0; k < u.size(); ++k) now[k] += block.place[k];
  now = turned(now, std::size_t(block.box.dimension));
  for (std::size_t k = 0; k < u.size(); ++k) now[k] += 3.0 - block.place[k];
  return now;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    most = std::max(most, std::abs(a[k] - b[k]));
    scale = std::max(scale, std::abs(b[k]));
  }
  return most / scale;
}

std::vector<Block> blocks() { return {Block(2, {60, 20, 1}), Block(3, {18, 8, 7})}; }

TEST(LatticeTurn, CostsGreenBondsNoDigits) {
  for (const Block& block : blocks()) {
    const auto d = std::size_t(block.box.dimension);
    GreenBonds bonds = block.bonds();
    const std::vector<double> u = strained(block), after = moved_as_a_whole(block, u);
    std::vector<double> force(u), energy(block.points()), force_after(u), energy_after(energy);
    bonds.find_forces_and_energies(u, force, energy);
    bonds.find_forces_and_energies(after, force_after, energy_after);
    // Places have 16 digits, of which strains of 1e-4 keep 10; sums of u as it is leave none.
    EXPECT_LE(distance(energy_after, energy), 1e-9);
    EXPECT_LE(distance(force_after, turned(force, d)), 1e-9);
    const std::vector<double> v = strained(block);
    bonds.multiply(u, v, force);
    bonds.multiply(after, turned(v, d), force_after);
    EXPECT_LE(distance(force_after, turned(force, d)), 1e-9);
  }
}

TEST(LatticeTurn, TurnsVirialsAndOutlines) {
  for (const Block& block : blocks()) {
    const auto d = std::size_t(block.box.dimension);
    GreenBonds bonds = block.bonds();
    const std::vector<double> u = strained(block), after = moved_as_a_whole(block, u);
    const Tensor3 R = rotation(int(d));
    std::vector<double> virials(u.size() * d), virials_after(virials), blocks(virials),
        blocks_after(virials), sums(u.size()), sums_after(u.size());
    bonds.add_virials(u, virials);
    bonds.add_virials(after, virials_after);
    bonds.outline_tangent(u, blocks, sums);
    bonds.outline_tangent(after, blocks_after, sums_after);
    std::vector<double> of_virials(virials.size()), of_blocks(virials.size());
    for (std::size_t k = 0; k < virials.size(); ++k) {
      const std::size_t at = k / (d * d) * d * d, r = k % (d * d) / d, c = k % d;
      for (std::size_t a = 0; a < d; ++a) {
        of_virials[k] += R[r][a] * virials[at + a * d + c];  // of the body's own arms
        for (std::size_t b = 0; b < d; ++b)
          of_blocks[k] += R[r][a] * R[c][b] * blocks[at + a * d + b];
      }
    }
    EXPECT_LE(distance(virials_after, of_virials), 1e-9);
    EXPECT_LE(distance(blocks_after, of_blocks), 1e-9);
  }
}

/// Each column of K by a product.
TEST(LatticeTurn, LeavesSumsOfRowsThatAreNotTooSmall) {
  const Block block(2, {9, 7, 1});
  GreenBonds bonds = block.bonds();
  const std::vector<double> u = moved_as_a_whole(block, strained(block));
  const std::size_t size = u.size();
  std::vector<double> blocks(size * 2), bounds(size), sums(size), unit(size), column(size);
  bonds.outline_tangent(u, blocks, bounds);
  for (std::size_t k = 0; k < size; ++k) {
    unit[k] = 1.0;
    bonds.multiply(u, unit, column);
    unit[k] = 0.0;
    for (std::size_t r = 0; r < size; ++r) sums[r] += std::abs(column[r]);
  }
  for (std::size_t r = 0; r < size; ++r) EXPECT_GE(bounds[r], (1.0 - 1e-10) * sums[r]);
}

TEST(LatticeTurn, LeavesAloneWhatHardlyTurns) {
  const Block block(2, {60, 20, 1});
  LatticeFields whole(block.box, {}, {{1, 0, 0}, {0, 1, 0}}, 1);
  const LatticeTurns turns(block.box, {}, block.springs);
  whole.set_integrity(std::vector<double>(block.points(), 1.0));
  EXPECT_TRUE(turns.find(whole, strained(block)).is_one);
  EXPECT_TRUE(turns.find(whole, std::vector<double>(block.place.size(), 0.0)).is_one);
}

TEST(LatticeTurn, IsNoneWherePointsSeeTheirImages) {
  const Block block(2, {60, 20, 1});
  const LatticeTurns turns(block.box, {true, false, false}, block.springs);
  LatticeFields fields(block.box, {}, {{1, 0, 0}, {0, 1, 0}}, 1);
  fields.set_integrity(std::vector<double>(block.points(), 1.0));
  EXPECT_TRUE(turns.find(fields, moved_as_a_whole(block, strained(block))).is_one);
  EXPECT_EQ(turns.bytes(), 0.0);
}

}  // namespace
}  // namespace peristat
