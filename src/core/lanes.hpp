#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace peristat {

/// Interactions that one kernel call works on side by side. Four doubles fill an AVX2 register, and
/// the transpositions below need exactly four; eight (AVX-512) were measured slower, because the
/// kernels are bound by the gathers of point data and not by arithmetic.
inline constexpr int lane_count = 4;

namespace lanes_detail {

template <class Number, int count>
struct Register {
  // Typedefs: GCC ignores the attributes of an alias of a dependent type.
  typedef Number Row __attribute__((vector_size(count * sizeof(Number))));
  typedef Row RowInMemory __attribute__((aligned(sizeof(Number)), may_alias));  // at any address
  /// Of a comparison: all bits of an entry set, or none.
  using Truths = decltype(Row() < Row());
};

using Quad = Register<double, 4>::Row;
using Pair = Register<double, 2>::Row;
using Order = Register<long long, 4>::Row;

}  // namespace lanes_detail

/// Truth values of lanes: all bits of a lane set, or none.
template <class Real, int count>
struct MaskOf {
  typename lanes_detail::Register<Real, count>::Truths bits;

  [[nodiscard]] bool operator[](int l) const { return bits[l] != 0; }
  friend MaskOf operator!(const MaskOf& a) { return {~a.bits}; }
  friend MaskOf operator&&(const MaskOf& a, const MaskOf& b) { return {a.bits & b.bits}; }
  friend MaskOf operator||(const MaskOf& a, const MaskOf& b) { return {a.bits | b.bits}; }
};

using LaneMask = MaskOf<double, lane_count>;

/// A bit for each lane, that of lane 0 the lowest.
inline unsigned bits_of(const LaneMask& a) {
#ifdef __AVX__
  return unsigned(__builtin_ia32_movmskpd256(lanes_detail::Quad(a.bits)));
#else
  return unsigned((a.bits[0] & 1) | (a.bits[1] & 2) | (a.bits[2] & 4) | (a.bits[3] & 8));
#endif
}
/// The lanes whose bits are set.
inline LaneMask mask_of(unsigned bits) {
  const auto all = static_cast<long long>(bits);
  return {(lanes_detail::Order{all, all, all, all} & lanes_detail::Order{1, 2, 4, 8}) != 0};
}
inline bool any_of(const LaneMask& a) { return bits_of(a) != 0; }
template <class Real, int count>
bool any_of(const MaskOf<Real, count>& a) {
  for (int l = 0; l < count; ++l) {
    if (a[l]) return true;
  }
  return false;
}
template <class Real, int count>
bool none_of(const MaskOf<Real, count>& a) {
  return !any_of(a);
}

/// One number per interaction of a batch, in a vector register. Measures and potentials are
/// templates over their scalar: the kernels call them with Lanes, tests and single interactions
/// with double. (<experimental/simd> does the same, and takes a second to compile in every file.)
template <class Real, int number>
class LanesOf {
  using Register = lanes_detail::Register<Real, number>;

 public:
  using Row = typename Register::Row;
  using Mask = MaskOf<Real, number>;
  static constexpr int count = number;

  LanesOf() = default;
  /// One number in all lanes.
  LanesOf(double all) : LanesOf([all](int) { return all; }) {}
  explicit LanesOf(const Row& row) : row_(row) {}
  /// Numbers in a row.
  explicit LanesOf(const Real* from)
      : row_(*reinterpret_cast<const typename Register::RowInMemory*>(from)) {}
  /// of_lane(l) in lane l.
  template <class OfLane>
  requires requires(const OfLane& of_lane) { double(of_lane(0)); }
  explicit LanesOf(const OfLane& of_lane)
      : LanesOf(of_lane, std::make_integer_sequence<int, number>()) {}

  /// A store of the whole register: memcpy would be compiled to two halves.
  void copy_to(Real* to) const { *reinterpret_cast<typename Register::RowInMemory*>(to) = row_; }
  [[nodiscard]] const Row& row() const { return row_; }

  [[nodiscard]] Real operator[](int l) const { return row_[l]; }
  void set(int l, Real value) { row_[l] = value; }

  LanesOf operator-() const { return LanesOf(-row_); }
  friend LanesOf operator+(const LanesOf& a, const LanesOf& b) { return LanesOf(a.row_ + b.row_); }
  friend LanesOf operator-(const LanesOf& a, const LanesOf& b) { return LanesOf(a.row_ - b.row_); }
  friend LanesOf operator*(const LanesOf& a, const LanesOf& b) { return LanesOf(a.row_ * b.row_); }
  friend LanesOf operator/(const LanesOf& a, const LanesOf& b) { return LanesOf(a.row_ / b.row_); }
  LanesOf& operator+=(const LanesOf& b) { return *this = *this + b; }
  LanesOf& operator-=(const LanesOf& b) { return *this = *this - b; }
  LanesOf& operator*=(const LanesOf& b) { return *this = *this * b; }
  LanesOf& operator/=(const LanesOf& b) { return *this = *this / b; }

  friend Mask operator<(const LanesOf& a, const LanesOf& b) { return {a.row_ < b.row_}; }
  friend Mask operator>(const LanesOf& a, const LanesOf& b) { return {a.row_ > b.row_}; }
  friend Mask operator<=(const LanesOf& a, const LanesOf& b) { return {a.row_ <= b.row_}; }
  friend Mask operator>=(const LanesOf& a, const LanesOf& b) { return {a.row_ >= b.row_}; }

  /// a where the mask is set, b elsewhere.
  friend LanesOf chosen(const Mask& mask, const LanesOf& a, const LanesOf& b) {
    return LanesOf(Row(mask.bits ? a.row_ : b.row_));
  }
  friend LanesOf min(const LanesOf& a, const LanesOf& b) { return chosen(b < a, b, a); }
  friend LanesOf max(const LanesOf& a, const LanesOf& b) { return chosen(a < b, b, a); }

 private:
  template <class OfLane, int... lanes>
  LanesOf(const OfLane& of_lane, std::integer_sequence<int, lanes...>)
      : row_{Real(of_lane(lanes))...} {}

  Row row_;
};

using Lanes = LanesOf<double, lane_count>;
/// Twice as many numbers in a register, for what need not be more accurate.
using SingleLanes = LanesOf<float, 2 * lane_count>;

inline Lanes abs(const Lanes& a) {
  using namespace lanes_detail;
  const Order sign = Order(Quad{-0.0, -0.0, -0.0, -0.0});
  return Lanes(Quad(Order(a.row()) & ~sign));
}
inline Lanes sqrt(const Lanes& a) {
#ifdef __AVX__
  return Lanes(__builtin_ia32_sqrtpd256(a.row()));  // GCC would take two halves
#else
  return Lanes([&](int l) { return std::sqrt(a[l]); });
#endif
}

inline SingleLanes sqrt(const SingleLanes& a) {
#ifdef __AVX__
  return SingleLanes(__builtin_ia32_sqrtps256(a.row()));
#else
  return SingleLanes([&](int l) { return std::sqrt(a[l]); });
#endif
}

/// Two registers, rounded to one.
inline SingleLanes rounded(const Lanes& low, const Lanes& high) {
  using Half = lanes_detail::Register<float, lane_count>::Row;
  return SingleLanes(__builtin_shufflevector(__builtin_convertvector(low.row(), Half),
                                             __builtin_convertvector(high.row(), Half), 0, 1, 2, 3,
                                             4, 5, 6, 7));
}
/// One half of the lanes in double precision.
template <int half>
Lanes half_of(const SingleLanes& a) {
  constexpr int first = half * lane_count;
  const auto row =
      __builtin_shufflevector(a.row(), a.row(), first, first + 1, first + 2, first + 3);
#ifdef __AVX__
  return Lanes(__builtin_ia32_cvtps2pd256(row));  // GCC would take two halves
#else
  return Lanes(__builtin_convertvector(row, lanes_detail::Quad));
#endif
}

/// Largest entry.
inline double largest(const Lanes& a) {
  return std::max(std::max(a[0], a[1]), std::max(a[2], a[3]));
}
inline double largest(double a) { return a; }

/// Smallest entry.
inline double smallest(const Lanes& a) {
  return std::min(std::min(a[0], a[1]), std::min(a[2], a[3]));
}
inline double smallest(double a) { return a; }

/// Sum of the entries.
inline double sum(const Lanes& a) { return (a[0] + a[2]) + (a[1] + a[3]); }
inline double sum(double a) { return a; }

namespace lanes_detail {

inline Quad load(const double* from) {
  Quad row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

inline void transpose(Quad& a, Quad& b, Quad& c, Quad& d) {
  const Quad ab_even = __builtin_shuffle(a, b, Order{0, 4, 2, 6});
  const Quad ab_odd = __builtin_shuffle(a, b, Order{1, 5, 3, 7});
  const Quad cd_even = __builtin_shuffle(c, d, Order{0, 4, 2, 6});
  const Quad cd_odd = __builtin_shuffle(c, d, Order{1, 5, 3, 7});
  a = __builtin_shuffle(ab_even, cd_even, Order{0, 1, 4, 5});
  b = __builtin_shuffle(ab_odd, cd_odd, Order{0, 1, 4, 5});
  c = __builtin_shuffle(ab_even, cd_even, Order{2, 3, 6, 7});
  d = __builtin_shuffle(ab_odd, cd_odd, Order{2, 3, 6, 7});
}

}  // namespace lanes_detail

/// Reads four rows of four consecutive doubles and transposes them: column c of row l becomes lane
/// l of columns[c]. Contiguous loads and shuffles beat hardware gathers by a factor of 1.6 here.
inline void load_transposed(const double* row0, const double* row1, const double* row2,
                            const double* row3, Lanes columns[4]) {
  using namespace lanes_detail;
  Quad a = load(row0), b = load(row1), c = load(row2), d = load(row3);
  transpose(a, b, c, d);
  columns[0] = Lanes(a);
  columns[1] = Lanes(b);
  columns[2] = Lanes(c);
  columns[3] = Lanes(d);
}

/// The same for four rows of two consecutive doubles.
inline void load_transposed_pairs(const std::array<const double*, 4>& row, Lanes& column0,
                                  Lanes& column1) {
  using namespace lanes_detail;
  const Quad even{row[0][0], row[0][1], row[2][0], row[2][1]};
  const Quad odd{row[1][0], row[1][1], row[3][0], row[3][1]};
  column0 = Lanes(__builtin_shuffle(even, odd, Order{0, 4, 2, 6}));
  column1 = Lanes(__builtin_shuffle(even, odd, Order{1, 5, 3, 7}));
}

/// The reverse: row l of `rows` gets lane l of the four columns.
inline void store_transposed(const Lanes& column0, const Lanes& column1, const Lanes& column2,
                             const Lanes& column3, lanes_detail::Quad rows[4]) {
  using namespace lanes_detail;
  rows[0] = column0.row();
  rows[1] = column1.row();
  rows[2] = column2.row();
  rows[3] = column3.row();
  transpose(rows[0], rows[1], rows[2], rows[3]);
}

/// The same for two columns.
inline void store_transposed(const Lanes& column0, const Lanes& column1,
                             lanes_detail::Pair pairs[4]) {
  using namespace lanes_detail;
  const Quad a = column0.row(), b = column1.row();
  const Quad even = __builtin_shuffle(a, b, Order{0, 4, 2, 6});
  const Quad odd = __builtin_shuffle(a, b, Order{1, 5, 3, 7});
  pairs[0] = Pair{even[0], even[1]};
  pairs[1] = Pair{odd[0], odd[1]};
  pairs[2] = Pair{even[2], even[3]};
  pairs[3] = Pair{odd[2], odd[3]};
}

/// Adds a row of four (or two) doubles to memory.
template <class Row>
inline void add_row(double* to, const Row& row) {
  Row total;
  std::memcpy(&total, to, sizeof total);
  total += row;
  std::memcpy(to, &total, sizeof total);
}

/// Writes a row of four doubles to memory.
inline void store_row(double* to, const lanes_detail::Quad& row) {
  std::memcpy(to, &row, sizeof row);
}

}  // namespace peristat
