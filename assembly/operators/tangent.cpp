#include "assembly/operators/tangent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "assembly/energy/tangent_forms.hpp"
#include "src/core/threads.hpp"

namespace peristat {
namespace {

/// Expands a stored block to a whole one.
template <int D, Tangent::Blocks stored_as>
[[gnu::always_inline]] inline std::array<double, D * D> whole_block(const double* stored) {
  std::array<double, D * D> block;
  if constexpr (stored_as == Tangent::Blocks::whole) {
    for (int k = 0; k < D * D; ++k) block[k] = stored[k];
  } else {
    int k = 0;
    for (int r = 0; r < D; ++r) {
      for (int c = r; c < D; ++c) block[r * D + c] = block[c * D + r] = stored[k++];
    }
  }
  return block;
}

constexpr int block_size_of(int dimension, Tangent::Blocks stored_as) {
  return stored_as == Tangent::Blocks::whole ? dimension * dimension
                                             : dimension * (dimension + 1) / 2;
}

/// Calls body with the dimension and the way of storing as compile-time constants.
template <class Body>
void dispatch(const Tangent& tangent, const Body& body) {
  const auto with_dimension = [&](auto stored_as) {
    if (tangent.dimension == 1) body(std::integral_constant<int, 1>{}, stored_as);
    if (tangent.dimension == 2) body(std::integral_constant<int, 2>{}, stored_as);
    if (tangent.dimension == 3) body(std::integral_constant<int, 3>{}, stored_as);
  };
  using Blocks = Tangent::Blocks;
  if (tangent.blocks == Blocks::whole) {
    with_dimension(std::integral_constant<Blocks, Blocks::whole>{});
  } else {
    with_dimension(std::integral_constant<Blocks, Blocks::upper_halves>{});
  }
}

/// result = K v. Each part sums its own rows and, separately, what its bonds contribute to later
/// parts' rows; these contributions are added in the order of the parts.
template <int D, Tangent::Blocks stored_as>
void multiply_rows(const Tangent& tangent, std::span<const double> v, std::span<double> result) {
  std::vector<std::vector<double>>& spilled = tangent.spilled;
  const auto sum_own = [&](int part) {
    const RowRange range = tangent.ranges[part];
    std::fill(result.begin() + std::ptrdiff_t(range.first) * D,
              result.begin() + std::ptrdiff_t(range.last) * D, 0.0);
    std::fill(spilled[part].begin(), spilled[part].end(), 0.0);
    double* const beyond = spilled[part].data();
    for (Index i = range.first; i < range.last; ++i) {
      const double* own = &v[std::size_t(i) * D];
      const double* diagonal = &tangent.diagonal[std::size_t(i) * D * D];
      double sum[D] = {};
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) sum[r] += diagonal[r * D + c] * own[c];
      }
      constexpr int size = block_size_of(D, stored_as);
      const double* stored =
          tangent.off_diagonal.data() + std::size_t(tangent.pattern.offset[i]) * size;
      for (Offset bond = tangent.pattern.offset[i]; bond < tangent.pattern.offset[i + 1];
           ++bond, stored += size) {
        const auto block = whole_block<D, stored_as>(stored);
        const Index j = tangent.pattern.partner(i, bond);
        const double* other = &v[std::size_t(j) * D];
        double* to =
            j < range.last ? &result[std::size_t(j) * D] : beyond + range.place_beyond(j) * D;
        for (int r = 0; r < D; ++r) {
          for (int c = 0; c < D; ++c) {
            sum[r] += block[r * D + c] * other[c];
            to[c] += block[r * D + c] * own[r];
          }
        }
      }
      for (int r = 0; r < D; ++r) result[std::size_t(i) * D + r] += sum[r];
    }
  };
  const auto add_spilled = [&](int part) {
    const RowRange range = tangent.ranges[part];
    for (int earlier = 0; earlier < part; ++earlier) {
      const RowRange other = tangent.ranges[earlier];
      other.for_each_beyond(range, [&](Index first, Index last) {
        const double* from = &spilled[earlier][std::size_t(other.place_beyond(first)) * D];
        for (std::ptrdiff_t k = std::ptrdiff_t(first) * D; k < std::ptrdiff_t(last) * D; ++k) {
          result[k] += *from++;
        }
      });
    }
  };
  const int busy = std::min(tangent.threads(), tangent.parts());
  run_on_threads(busy, [&](int thread) {
    for_parts_of_thread(thread, busy, tangent.parts(), sum_own);
#pragma omp barrier
    for_parts_of_thread(thread, busy, tangent.parts(), add_spilled);
  });
}

}  // namespace

Tangent::Tangent(const BlockPattern& of, int dimension_of_points, int threads, Blocks stored_as)
    : Tangent(of, dimension_of_points, threads, of.points(), stored_as) {}

Tangent::Tangent(const BlockPattern& of, int dimension_of_points, int threads, Index own,
                 Blocks stored_as)
    : TangentOperator(of, dimension_of_points, threads,
                      partition_rows(of, parts_of_rows(of, threads, own), own)),
      blocks(stored_as),
      off_diagonal(std::size_t(of.blocks()) * block_size()),
      position(std::size_t(of.points()) * dimension),
      own_(own) {
  make_room_for_spills();
}

Tangent::Tangent(const Energy& energy)
    : Tangent(energy.pattern(), energy.points().dimension, energy.threads(),
              energy.points().own_rows(),
              energy.has_symmetric_blocks() ? Blocks::upper_halves : Blocks::whole) {}

std::size_t Tangent::block_size() const { return std::size_t(block_size_of(dimension, blocks)); }

std::size_t Tangent::place_in_block(int r, int c) const {
  if (blocks == Blocks::whole) return std::size_t(r * dimension + c);
  const int row = std::min(r, c), column = std::max(r, c);
  return std::size_t(row * dimension - row * (row - 1) / 2 + column - row);
}

void Tangent::clear() {
  std::fill(diagonal.begin(), diagonal.end(), 0.0);
  std::fill(off_diagonal.begin(), off_diagonal.end(), 0.0);
}

void Tangent::add_to_block(Offset block, std::span<const double> entries) {
  double* const to = &off_diagonal[std::size_t(block) * block_size()];
  for (int r = 0; r < dimension; ++r) {
    const int first = blocks == Blocks::whole ? 0 : r;  // an upper half holds each entry once
    for (int c = first; c < dimension; ++c) {
      to[place_in_block(r, c)] += entries[std::size_t(r * dimension + c)];
    }
  }
}

void Tangent::take_pattern(const BlockPattern& of, int version_of_it) {
  pattern = of;
  version = version_of_it;
  ranges = partition_rows(of, parts_of_rows(of, threads(), own_), own_);
  off_diagonal.assign(std::size_t(of.blocks()) * block_size(), 0.0);
  make_room_for_spills();
}

void Tangent::make_room_for_spills() {
  spilled.clear();
  for (const RowRange& range : ranges) {
    spilled.emplace_back(std::size_t(range.rows_beyond()) * std::size_t(dimension));
  }
}

void Tangent::linearise(Energy& energy, const StateView& at, double projection) {
  const int version_now = energy.cover_contacts(at);
  if (version_now != version) take_pattern(energy.pattern(), version_now);
  energy.forms().blocks->tangent(at, *this, projection, Write::over);
}

void Tangent::multiply(std::span<const double> v, std::span<double> result) const {
  dispatch(*this, [&](auto d, auto stored_as) {
    multiply_rows<decltype(d)::value, decltype(stored_as)::value>(*this, v, result);
  });
}

void Tangent::for_each_row(const RowVisitor& visit) const {
  dispatch(*this, [&](auto d, auto stored_as) {
    constexpr int D = decltype(d)::value;
    constexpr Blocks as = decltype(stored_as)::value;
    constexpr std::size_t size = block_size_of(D, as);
    run_on_parts(threads(), parts(), [&](int part) {
      std::vector<double> row;
      for (Index i = ranges[part].first; i < ranges[part].last; ++i) {
        const std::size_t first = std::size_t(pattern.offset[i]),
                          last = std::size_t(pattern.offset[i + 1]);
        if constexpr (as == Blocks::whole) {
          visit(part, i, std::span(off_diagonal).subspan(first * size, (last - first) * size));
        } else {
          row.clear();
          for (std::size_t bond = first; bond < last; ++bond) {
            const auto block = whole_block<D, as>(off_diagonal.data() + bond * size);
            row.insert(row.end(), block.begin(), block.end());
          }
          visit(part, i, row);
        }
      }
    });
  });
}

double Tangent::frobenius_norm() const {
  double sum = 0.0;
  for (double of_diagonal : diagonal) sum += of_diagonal * of_diagonal;
  for (Offset bond = 0; bond < pattern.blocks(); ++bond) {
    for (int r = 0; r < dimension; ++r) {
      for (int c = 0; c < dimension; ++c) sum += 2.0 * entry(bond, r, c) * entry(bond, r, c);
    }
  }
  return std::sqrt(sum);
}

}  // namespace peristat
