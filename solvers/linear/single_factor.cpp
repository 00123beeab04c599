#include "solvers/linear/single_factor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <suitesparse/cholmod.h>

namespace peristat {
namespace {

using Long = SuiteSparse_long;

/// Entries of a group of columns lie as they are read: its triangle, then the rows below, strip by
/// strip, those of one column after the other's.
constexpr std::size_t group = 4, strip = 8, triangle = group * group;

std::size_t strips(std::size_t rows) { return (rows + strip - 1) / strip; }
std::size_t size_of_group(std::size_t rows_below) {
  return triangle + group * strip * strips(rows_below);
}

/// below -= entries times values
void subtract(const float* entries, const std::array<float, group>& value, float* below,
              std::size_t rows) {
  const auto [a, b, c, d] = value;
  for (std::size_t k = 0; k < strips(rows); ++k, entries += group * strip, below += strip) {
#pragma omp simd
    for (std::size_t r = 0; r < strip; ++r) {
      below[r] -= entries[r] * a + entries[strip + r] * b +
                  (entries[2 * strip + r] * c + entries[3 * strip + r] * d);
    }
  }
}

/// Products of the columns with what is below.
std::array<float, group> products(const float* entries, const float* below, std::size_t rows) {
  std::array<std::array<float, strip>, group> sums{};
  for (std::size_t k = 0; k < strips(rows); ++k, entries += group * strip, below += strip) {
    for (std::size_t column = 0; column < group; ++column) {
#pragma omp simd
      for (std::size_t r = 0; r < strip; ++r) {
        sums[column][r] += entries[column * strip + r] * below[r];
      }
    }
  }
  std::array<float, group> result{};
  for (std::size_t column = 0; column < group; ++column) {
    for (const float sum : sums[column]) result[column] += sum;
  }
  return result;
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
    for (std::size_t column = 0; column < end - begin; ++column) {
      const double* const from = columns + (begin + column) * node.rows;
      for (std::size_t k = column; k < end - begin; ++k) {
        at[k * group + column] = float(k == column ? 1.0 / from[begin + k] : from[begin + k]);
      }
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
    std::array<float, group> value{};
    for (std::size_t k = 0; k < end - begin; ++k) {
      float rest = part[begin + k];
      for (std::size_t column = 0; column < k; ++column) {
        rest -= at[k * group + column] * value[column];
      }
      part[begin + k] = value[k] = rest * at[k * group + k];
    }
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
    const std::array<float, group> sum = products(at + triangle, part + end, node.rows - end);
    for (std::size_t k = end - begin; k-- > 0;) {
      float rest = part[begin + k] - sum[k];
      for (std::size_t later = k + 1; later < end - begin; ++later) {
        rest -= at[later * group + k] * part[begin + later];
      }
      part[begin + k] = rest * at[k * group + k];
    }
    end = begin;
  }
  std::copy_n(part, node.columns, &x_[node.first_column]);
}

}  // namespace peristat
