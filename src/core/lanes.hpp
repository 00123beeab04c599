#pragma once

#include <array>
#include <cstring>

#include <experimental/simd>

namespace peristat {

/// Interactions that one kernel call works on side by side. Four doubles fill an AVX2 register, and
/// the transpositions below need exactly four; eight (AVX-512) were measured slower, because the
/// kernels are bound by the gathers of point data and not by arithmetic.
inline constexpr int lane_count = 4;

/// One double per interaction of a batch. Measures and potentials are templates over their scalar:
/// the kernels call them with Lanes, tests and single interactions with double.
using Lanes =
    std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, lane_count>>;

/// Largest entry.
inline double largest(const Lanes& a) { return std::experimental::hmax(a); }
inline double largest(double a) { return a; }

/// Smallest entry.
inline double smallest(const Lanes& a) { return std::experimental::hmin(a); }
inline double smallest(double a) { return a; }

/// Sum of the entries.
inline double sum(const Lanes& a) { return std::experimental::reduce(a); }
inline double sum(double a) { return a; }

namespace lanes_detail {

using Quad = double __attribute__((vector_size(4 * sizeof(double))));
using Pair = double __attribute__((vector_size(2 * sizeof(double))));
using Order = long long __attribute__((vector_size(4 * sizeof(long long))));

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

inline Lanes to_lanes(const Quad& row) {
  return Lanes(reinterpret_cast<const double*>(&row), std::experimental::element_aligned);
}

inline Quad to_row(const Lanes& lanes) {
  Quad row;
  lanes.copy_to(reinterpret_cast<double*>(&row), std::experimental::element_aligned);
  return row;
}

}  // namespace lanes_detail

/// Reads four rows of four consecutive doubles and turns them: column c of row l becomes lane l of
/// columns[c]. Contiguous loads and shuffles beat hardware gathers by a factor of 1.6 here.
inline void load_transposed(const double* row0, const double* row1, const double* row2,
                            const double* row3, Lanes columns[4]) {
  using namespace lanes_detail;
  Quad a = load(row0), b = load(row1), c = load(row2), d = load(row3);
  transpose(a, b, c, d);
  columns[0] = to_lanes(a);
  columns[1] = to_lanes(b);
  columns[2] = to_lanes(c);
  columns[3] = to_lanes(d);
}

/// The same for four rows of two consecutive doubles.
inline void load_transposed_pairs(const std::array<const double*, 4>& row, Lanes& column0,
                                  Lanes& column1) {
  using namespace lanes_detail;
  const Quad even{row[0][0], row[0][1], row[2][0], row[2][1]};
  const Quad odd{row[1][0], row[1][1], row[3][0], row[3][1]};
  column0 = to_lanes(__builtin_shuffle(even, odd, Order{0, 4, 2, 6}));
  column1 = to_lanes(__builtin_shuffle(even, odd, Order{1, 5, 3, 7}));
}

/// The reverse: row l of `rows` gets lane l of the four columns.
inline void store_transposed(const Lanes& column0, const Lanes& column1, const Lanes& column2,
                             const Lanes& column3, lanes_detail::Quad rows[4]) {
  using namespace lanes_detail;
  rows[0] = to_row(column0);
  rows[1] = to_row(column1);
  rows[2] = to_row(column2);
  rows[3] = to_row(column3);
  transpose(rows[0], rows[1], rows[2], rows[3]);
}

/// The same for two columns.
inline void store_transposed(const Lanes& column0, const Lanes& column1,
                             lanes_detail::Pair pairs[4]) {
  using namespace lanes_detail;
  const Quad a = to_row(column0), b = to_row(column1);
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
