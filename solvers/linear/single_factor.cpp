#include "solvers/linear/single_factor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <suitesparse/cholmod.h>

#include "src/core/lanes.hpp"

namespace peristat {
namespace {

using Long = SuiteSparse_long;

/// Entries of a group of columns lie as they are read: its triangle's inverse, then the rows below,
/// strip by strip, those of one column after the other's.
constexpr std::size_t group = 4, strip = 8, triangle = group * group;

/// Floats of a page of memory, at whose end the processor's own prefetching stops.
constexpr std::size_t page = 1024;

/// Fetches the entries of a strip into the cache; the address need not exist.
void fetch_strip(const float* entries) {
  constexpr std::size_t line = 16;
  for (std::size_t k = 0; k < group * strip; k += line) __builtin_prefetch(entries + k);
}

std::size_t strips(std::size_t rows) { return (rows + strip - 1) / strip; }
std::size_t size_of_group(std::size_t rows_below) {
  return triangle + group * strip * strips(rows_below);
}

using FourFloats = lanes_detail::Register<float, group>::Row;
static_assert(strip == SingleLanes::count);

FourFloats load(const float* from) {
  FourFloats row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

/// Sums of the entries of four rows.
FourFloats sums_of(const FourFloats& a, const FourFloats& b, const FourFloats& c,
                   const FourFloats& d) {
  const FourFloats ab =
      __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const FourFloats cd =
      __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// Inverts the triangle at the head of some columns.
/// @param columns of a length of `rows` each
void invert(const double* columns, std::size_t rows, std::size_t size, float* inverse) {
  const auto entry = [&](std::size_t r, std::size_t c) { return columns[c * rows + r]; };
  for (std::size_t c = 0; c < size; ++c) {
    std::array<double, group> column{};
    for (std::size_t r = c; r < size; ++r) {
      double rest = r == c ? 1.0 : 0.0;
      for (std::size_t k = c; k < r; ++k) rest -= entry(r, k) * column[k];
      column[r] = rest / entry(r, r);
      inverse[r * group + c] = float(column[r]);
    }
  }
}

/// Rows of the inverse of a group's triangle times a vector.
FourFloats times_inverse(const float* inverse, const FourFloats& v) {
  return sums_of(load(inverse) * v, load(inverse + group) * v, load(inverse + 2 * group) * v,
                 load(inverse + 3 * group) * v);
}

/// The same times its transpose.
FourFloats times_transposed_inverse(const float* inverse, const FourFloats& v) {
  return (load(inverse) * v[0] + load(inverse + group) * v[1]) +
         (load(inverse + 2 * group) * v[2] + load(inverse + 3 * group) * v[3]);
}

/// below -= entries times values
void subtract(const float* entries, const FourFloats& value, float* below, std::size_t rows) {
  const SingleLanes a = double(value[0]), b = double(value[1]), c = double(value[2]),
                    d = double(value[3]);
  for (std::size_t k = 0; k < strips(rows); ++k, entries += group * strip, below += strip) {
    fetch_strip(entries + page);
    const SingleLanes sum =
        (SingleLanes(entries) * a + SingleLanes(entries + strip) * b) +
        (SingleLanes(entries + 2 * strip) * c + SingleLanes(entries + 3 * strip) * d);
    (SingleLanes(below) - sum).copy_to(below);
  }
}

/// Products of the columns with what is below. Two sums of each column wait for one another less.
FourFloats products(const float* entries, const float* below, std::size_t rows) {
  std::array<std::array<SingleLanes, group>, 2> sums;
  for (auto& of_parity : sums) of_parity.fill(0.0);
  const float* const before = entries - size_of_group(rows);  // the group that is next
  const auto add = [&](std::size_t k) {
    const SingleLanes v(below + k * strip);
    fetch_strip(before + k * group * strip);
    for (std::size_t column = 0; column < group; ++column) {
      sums[k % 2][column] += SingleLanes(entries + (k * group + column) * strip) * v;
    }
  };
  const std::size_t all = strips(rows);
  std::size_t k = 0;
  for (; k + 2 <= all; k += 2) {
    add(k);
    add(k + 1);
  }
  if (k < all) add(k);
  std::array<FourFloats, group> halved;
  for (std::size_t column = 0; column < group; ++column) {
    const auto row = (sums[0][column] + sums[1][column]).row();
    halved[column] = __builtin_shufflevector(row, row, 0, 1, 2, 3) +
                     __builtin_shufflevector(row, row, 4, 5, 6, 7);
  }
  return sums_of(halved[0], halved[1], halved[2], halved[3]);
}

}  // namespace

SingleFactor::SingleFactor(const cholmod_factor_struct& factor) : x_(factor.n) {
  const auto* const first = static_cast<const Long*>(factor.super);
  const auto* const rows = static_cast<const Long*>(factor.pi);
  const auto* const entries = static_cast<const Long*>(factor.px);
  const auto* const row = static_cast<const Long*>(factor.s);
  const auto* const entry = static_cast<const double*>(factor.x);
  const auto* const order = static_cast<const Long*>(factor.Perm);
  order_.assign(order, order + factor.n);
  std::size_t most_rows = 0;
  entry_.reserve(factor.xsize);
  for (std::size_t s = 0; s < factor.nsuper; ++s) {
    const Supernode node{std::size_t(first[s]), std::size_t(first[s + 1] - first[s]),
                         std::size_t(rows[s + 1] - rows[s]), row_.size(), entry_.size()};
    nodes_.push_back(node);
    row_.insert(row_.end(), row + rows[s], row + rows[s + 1]);
    pack(node, entry + entries[s]);
    most_rows = std::max(most_rows, node.rows);
  }
  part_.resize(most_rows + strip);
}

void SingleFactor::pack(const Supernode& node, const double* columns) {
  for (std::size_t begin = 0; begin < node.columns; begin += group) {
    const std::size_t end = std::min(begin + group, node.columns), below = node.rows - end;
    const std::size_t first = entry_.size();
    entry_.resize(first + size_of_group(below), 0.0F);
    float* const at = &entry_[first];
    invert(columns + begin * node.rows + begin, node.rows, end - begin, at);
    for (std::size_t column = 0; column < end - begin; ++column) {
      const double* const from = columns + (begin + column) * node.rows;
      for (std::size_t k = 0; k < below; ++k) {
        const std::size_t place = (k / strip * group + column) * strip + k % strip;
        at[triangle + place] = float(from[end + k]);
      }
    }
  }
}

void SingleFactor::solve(std::span<const double> b, std::span<double> x) {
  double largest = 0.0;  // single precision has a short range
  for (const double value : b) largest = std::max(largest, std::abs(value));
  const double scale = largest > 0.0 ? 1.0 / largest : 0.0;
  for (std::size_t k = 0; k < x_.size(); ++k) x_[k] = float(scale * b[std::size_t(order_[k])]);
  std::ranges::fill(part_, 0.0F);  // entries past the rows of a node are read, and must be finite
  for (const Supernode& node : nodes_) forward(node);
  const float* end = entry_.data() + entry_.size();
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    backward(*node, end);
    end = entry_.data() + node->entry;
  }
  for (std::size_t k = 0; k < x_.size(); ++k) x[std::size_t(order_[k])] = largest * double(x_[k]);
}

void SingleFactor::forward(const Supernode& node) {
  // A side with few entries, as for the column of a bond, leaves most nodes as they are.
  const auto own = std::span(x_).subspan(node.first_column, node.columns);
  if (std::ranges::all_of(own, [](float value) { return value == 0.0F; })) return;
  float* const part = part_.data();
  std::copy_n(&x_[node.first_column], node.columns, part);
  std::fill(part + node.columns, part + node.rows, 0.0F);
  const float* at = &entry_[node.entry];
  for (std::size_t begin = 0; begin < node.columns; begin += group) {
    const std::size_t end = std::min(begin + group, node.columns);
    const FourFloats value = times_inverse(at, load(part + begin));
    std::memcpy(part + begin, &value, (end - begin) * sizeof(float));
    subtract(at + triangle, value, part + end, node.rows - end);
    at += size_of_group(node.rows - end);
  }
  std::copy_n(part, node.columns, &x_[node.first_column]);
  const Index* const row = &row_[node.row];
  for (std::size_t k = node.columns; k < node.rows; ++k) x_[std::size_t(row[k])] += part[k];
}

void SingleFactor::backward(const Supernode& node, const float* at) {
  float* const part = part_.data();
  const Index* const row = &row_[node.row];
  std::copy_n(&x_[node.first_column], node.columns, part);
  for (std::size_t k = node.columns; k < node.rows; ++k) part[k] = x_[std::size_t(row[k])];
  for (std::size_t end = node.columns; end > 0;) {
    const std::size_t begin = (end - 1) / group * group;
    at -= size_of_group(node.rows - end);
    const FourFloats value = times_transposed_inverse(
        at, load(part + begin) - products(at + triangle, part + end, node.rows - end));
    std::memcpy(part + begin, &value, (end - begin) * sizeof(float));
    end = begin;
  }
  std::copy_n(part, node.columns, &x_[node.first_column]);
}

}  // namespace peristat
