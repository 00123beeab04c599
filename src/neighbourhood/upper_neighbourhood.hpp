#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// The part of the bond graph in which the interactions with lowest point i lie: the partners of i
/// above it, numbered locally 0, 1, … in ascending order, and the bonds between them. Three (four)
/// points with all mutual distances within the horizon are i and two (three) partners that are
/// mutually bonded, so that each triangle (tetrahedron) belongs to exactly one i.
class UpperNeighbourhood {
 public:
  /// Two bonded partners a < b, and their bond.
  struct Pair {
    int a, b;
    Offset bond;
  };

  /// The bonds must outlive this.
  explicit UpperNeighbourhood(const Bonds& bonds);

  void move_to(Index i);

  /// Finds the pairs of the present point; until then pairs() is empty and mutual() not valid.
  void find_pairs();

  [[nodiscard]] Index own() const { return own_; }
  [[nodiscard]] int count() const { return static_cast<int>(points_.size()); }
  [[nodiscard]] std::span<const Index> points() const { return points_; }

  /// Bonded pairs in ascending order of a, then b.
  [[nodiscard]] const std::vector<Pair>& pairs() const { return pairs_; }

  /// Bit b of the words of a is set if b > a is bonded to a.
  [[nodiscard]] const std::uint64_t* mutual(int a) const {
    return &mutual_[std::size_t(a) * words_];
  }
  [[nodiscard]] int words() const { return words_; }

  /// Largest count() of any point.
  [[nodiscard]] static int largest(const Bonds& bonds);

 private:
  const Bonds& bonds_;
  Index own_ = 0;
  int words_;
  std::vector<Index> points_;
  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> mutual_;
  std::vector<std::int32_t> local_;  // of every point: its local number, or -1
};

}  // namespace peristat
