#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "src/core/types.hpp"
#include "src/neighbourhood/kind_numbers.hpp"

namespace peristat {

/// Data of a bond's energy besides the positions of its points.
struct BondKind {
  double inverse_length = 0.0;  ///< 1/L, L the reference length: kernels divide by L [1/m]
  double weight = 0.0;          ///< quadrature weight w of the bond's energy [m6]

  bool operator==(const BondKind&) const = default;
};

/// One BondKind per bond. The bonds of a lattice are of few kinds: each kind is kept once and a
/// bond keeps its number, 1 or 2 bytes instead of 16. Bonds whose two numbers agree to about 1e-12
/// are of one kind, that of the first of them, because positions on a lattice have round-off. With
/// more than 65536 kinds, as in a cloud of points, each bond keeps its own.
class BondKinds {
 public:
  [[nodiscard]] const BondKind& operator[](Offset bond) const {
    return kinds_[numbered_ ? std::size_t(number_[std::size_t(bond)]) : std::size_t(bond)];
  }
  /// True if each kind is kept once.
  [[nodiscard]] bool are_numbered() const { return numbered_; }
  /// The number of a bond's kind, if they are numbered.
  [[nodiscard]] std::uint16_t number(Offset bond) const { return number_[std::size_t(bond)]; }
  /// The kinds by their numbers, if they are numbered.
  [[nodiscard]] const BondKind* table() const { return kinds_.data(); }
  [[nodiscard]] std::size_t size() const { return numbered_ ? number_.size() : kinds_.size(); }
  /// Bytes that each bond takes.
  [[nodiscard]] std::size_t bytes_per_bond() const {
    return numbered_ ? number_.bytes_per_number() : sizeof(BondKind);
  }

  void reserve(std::size_t bonds);
  void push_back(const BondKind& kind);
  /// Appends the bonds of another.
  void append(const BondKinds& part);

  /// Makes a bond of the kind of another one.
  void copy(Offset from, Offset to);
  /// Keeps the first `count` bonds.
  void truncate(Offset count);

 private:
  friend class ReweighedKinds;

  static constexpr std::size_t most_kinds = 65536;

  using Key = std::pair<std::uint64_t, std::uint64_t>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  static Key key_of(const BondKind& kind);
  /// Number of a kind; most_kinds if there is none left for it.
  [[nodiscard]] std::size_t number_of(const BondKind& kind);
  void keep_each_its_own();

  bool numbered_ = true;
  std::vector<BondKind> kinds_;  // by number, or by bond
  KindNumbers number_;
  std::unordered_map<Key, std::size_t, KeyHash> known_;
  struct Recent {
    Key key{~std::uint64_t(0), ~std::uint64_t(0)};
    std::size_t number = 0;
  };
  std::array<Recent, 256> recent_;  // cache of known_, by hash
};

/// The kinds of the same bonds with other weights. Bonds of one kind mostly get one weight, which
/// is then looked up once.
class ReweighedKinds {
 public:
  explicit ReweighedKinds(const BondKinds& before);

  /// Gives the next bond its weight.
  void push_back(double weight);
  [[nodiscard]] BondKinds take() { return std::move(after_); }

 private:
  struct Last {
    double weight = std::numeric_limits<double>::quiet_NaN();
    std::uint16_t number = 0;
  };

  const BondKinds& before_;
  BondKinds after_;
  std::vector<Last> last_;  // by the number before
};

}  // namespace peristat
