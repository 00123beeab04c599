#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "assembly/terms/bonds/part_runs.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/core/aligned_vector.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Doubles per gathered row: two vectors, each padded to the width of a transposition where one
/// does not hold both.
constexpr int row_width(int dimension) { return dimension == 3 ? 8 : 4; }

/// Two vectors per point that a pass reads. The first one may be a sum.
struct PointVectors {
  std::span<const double> first, second;
  std::span<const double> onto_first = {};  ///< added to the first one; empty: nothing

  /// Components of the two vectors of a point.
  template <int D>
  [[nodiscard]] double of_first(Index i, int c) const {
    const std::size_t at = std::size_t(i) * D + std::size_t(c);
    return onto_first.empty() ? first[at] : first[at] + onto_first[at];
  }
  template <int D>
  [[nodiscard]] double of_second(Index i, int c) const {
    return second[std::size_t(i) * D + std::size_t(c)];
  }
};

/// Rows of the two vectors per point, as kernels gather them: packed beforehand, or put together
/// where they are read.
template <int D>
class PointRows {
 public:
  using Scratch = std::array<double, row_width(D)>;

  PointRows(const double* packed, const PointVectors& vectors)
      : packed_(packed), vectors_(&vectors) {}

  /// @param scratch what the row may be put together in
  [[nodiscard, gnu::always_inline]] const double* of(Index i, Scratch& scratch) const {
    if (packed_) return packed_ + std::size_t(i) * row_width(D);
    put_together(i, scratch);
    return scratch.data();
  }

 private:
  [[gnu::noinline]] void put_together(Index i, Scratch& scratch) const {
    scratch.fill(0.0);
    for (int c = 0; c < D; ++c) {
      scratch[c] = vectors_->of_first<D>(i, c);
      scratch[row_width(D) / 2 + c] = vectors_->of_second<D>(i, c);
    }
  }

  const double* packed_;  // null: none are
  const PointVectors* vectors_;
};

/// Buffers of the passes over bonds.
struct BondWorkspace {
  /// @param kinds of the bonds, whose sums go along runs; null: they go bond by bond
  BondWorkspace(const Points& of, const Bonds& with, Workspace& shared,
                const BondKinds* kinds = nullptr)
      : points(of), bonds(with), threads(shared) {
    if (kinds) runs = PartRuns(of, with, *kinds, shared.ranges, shared.threads());
  }

  const Points& points;
  const Bonds& bonds;
  Workspace& threads;
  PartRuns runs;

  /// Packed rows. At its end those of a large body are released where sums go along runs.
  class Packed {
   public:
    explicit Packed(BondWorkspace& of) : of_(of) {}
    Packed(const Packed&) = delete;
    Packed& operator=(const Packed&) = delete;
    ~Packed() {
      if (of_.runs.in_use()) of_.release_rows();
    }

   private:
    BondWorkspace& of_;
  };

  /// Packs the vectors of a pass that visits bond by bond into rows: 64 bytes per point in 3D.
  template <int D>
  [[nodiscard]] Packed pack(const PointVectors& of) {
    pack_rows<D>(of);
    return Packed(*this);
  }

  /// Takes the vectors of a pass along runs, which outlive it. The few bonds that are in no run put
  /// their rows together.
  template <int D>
  void take(const PointVectors& of) {
    if (!runs.in_use()) return pack_rows<D>(of);
    release_rows();
    vectors_ = of;
  }

  /// Rows of the vectors that were packed or taken last.
  template <int D>
  [[nodiscard]] PointRows<D> rows() const {
    return {are_packed_ ? packed_.data() : nullptr, vectors_};
  }

  /// Sums the bonds of a part's rows: runs by on_run(run, damage, window), which reads and adds
  /// to the window's columns, the other ones by on_loose(bonds of a point, sums).
  /// @tparam columns of the window's sums that are added up
  /// @param sums `width` doubles per row, which everything is added to
  template <int D, int width, int columns = D, class OnRun, class OnLoose>
  void sum_range(int part, RowRange range, double* sums, const OnRun& on_run,
                 const OnLoose& on_loose) {
    if (!runs.in_use()) {
      for (Index i = range.first; i < range.last; ++i) {
        on_loose(LooseBonds{i, bonds.offset[i], bonds.offset[i + 1]}, sums);
      }
      return;
    }
    PartRuns::OfPart& one = runs.of(part);
    RunWindow& window = runs.window();
    window.first = window.last = range.first;
    RunDamage* damage = one.damage.empty() ? nullptr : one.damage.data();
    for (std::size_t g = 0; g < one.bonds.groups(); ++g) {
      const BondRuns::Group group = one.bonds.group(g);
      if (std::min(group.last + one.reach, range.near_end) > window.last) {
        add_sums<columns, width>(window, sums);
        move<D>(window, group.first, range.near_end);
      }
      for (const BondRun& run : group.runs) on_run(run, damage ? damage++ : nullptr, window);
      for (const LooseBonds& loose : group.loose) on_loose(loose, sums);
    }
    add_sums<columns, width>(window, sums);
  }

 private:
  /// Doubles from which rows are released: small bodies' passes allocate nothing.
  static constexpr std::size_t large = std::size_t(1) << 17;

  void release_rows() {
    are_packed_ = false;
    if (packed_.size() >= large) packed_ = AlignedVector<double>();
  }

  template <int D>
  void pack_rows(const PointVectors& of) {
    constexpr int width = row_width(D);
    const Index count = points.count();
    packed_.resize(std::size_t(count) * width);
#pragma omp parallel for num_threads(threads.threads())
    for (Index i = 0; i < count; ++i) {
      double* row = &packed_[std::size_t(i) * width];
      for (int c = 0; c < D; ++c) {
        row[c] = of.of_first<D>(i, c);
        row[width / 2 + c] = of.of_second<D>(i, c);
      }
    }
    vectors_ = of;
    are_packed_ = true;
  }

  template <int columns, int width>
  static void add_sums(const RunWindow& window, double* sums) {
    for (Index i = window.first; i < window.last; ++i) {
      for (int c = 0; c < columns; ++c) sums[std::ptrdiff_t(i) * width + c] += window.sums[c][i];
    }
  }

  /// Lets a window start at this point, with its vectors and sums of zero.
  template <int D>
  void move(RunWindow& window, Index first, Index end) const {
    window.first = first;
    window.last = std::min(first + window.capacity, end);
    window.vectors.start_at(first);
    window.sums.start_at(first);
    window.sums.clear();
    for (Index i = first; i < window.last; ++i) {
      for (int c = 0; c < D; ++c) {
        window.vectors[c][i] = vectors_.of_first<D>(i, c);
        window.vectors[D + c][i] = vectors_.of_second<D>(i, c);
      }
    }
  }

  PointVectors vectors_;
  AlignedVector<double> packed_;
  bool are_packed_ = false;
};

}  // namespace peristat
