#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "assembly/operators/block_pattern.hpp"
#include "src/core/lanes.hpp"
#include "src/neighbourhood/bond_runs.hpp"

namespace peristat {

/// Flags of the bonds of a run: those that are k-th of their points lie side by side.
class RunFlags {
 public:
  RunFlags() = default;
  RunFlags(Index points, Offset per_point)
      : stride_(std::size_t(points) / 8 + 2), bits_(stride_ * std::size_t(per_point), 0) {}

  /// Flags of the bonds k of lane_count points from this one of the run on, the first in the lowest
  /// bit.
  [[nodiscard]] unsigned of(Offset k, Index point) {
    const std::size_t at = place(k, point);
    const unsigned two = unsigned(byte(at).load(std::memory_order_relaxed)) |
                         unsigned(byte(at + 1).load(std::memory_order_relaxed)) << 8;
    return (two >> (point % 8)) & ((1u << lane_count) - 1);
  }

  void raise(Offset k, Index point) {
    byte(place(k, point)).fetch_or(std::uint8_t(1u << (point % 8)), std::memory_order_relaxed);
  }

 private:
  [[nodiscard]] std::size_t place(Offset k, Index point) const {
    return std::size_t(k) * stride_ + std::size_t(point) / 8;
  }
  /// Threads that share a run may share a byte.
  [[nodiscard]] std::atomic_ref<std::uint8_t> byte(std::size_t at) {
    return std::atomic_ref(bits_[at]);
  }

  std::size_t stride_ = 0;  // with a byte that may be read past the points
  std::vector<std::uint8_t> bits_;
};

/// Consecutive points of a run, few enough for their vectors to stay in the nearest cache.
struct RunPiece {
  Index first, last;
  Index first_of_run;
  double free_below;  ///< stretch at which the first of the undamaged bonds starts to fail
  RunFlags* damaged;  ///< null: no bond can be
};

/// The runs of a body, with the bonds of them that a history has damaged.
class RunPieces {
 public:
  /// Most points of a piece.
  static constexpr Index longest = 128;

  explicit RunPieces(std::vector<BondRun> runs) : runs_(std::move(runs)) {}

  [[nodiscard]] bool empty() const { return runs_.empty(); }

  /// Points to the farthest partner ahead of a run's point.
  [[nodiscard]] Index reach(const Bonds& bonds) const {
    Index most = 0;
    for (const BondRun& run : runs_) {
      most = std::max(most, bonds.partner[bonds.offset[run.first + 1] - 1] - run.first);
    }
    return most;
  }

  /// Finds the damaged bonds of a history, unless they are known.
  /// @param law of the bonds at that history
  /// @param version of the history, see History::version
  template <class P>
  void follow(const Bonds& bonds, const P& law, const double* largest_stretch,
              std::uint64_t version, int threads);
  /// To be called with the version of a history whose damage of the last commit has raised flags.
  void have_followed(std::uint64_t version) { version_ = version; }

  /// Calls on_piece(piece) and on_rows(first, last), which together cover the range once, in order.
  template <class OnPiece, class OnRows>
  void for_each(RowRange range, const OnPiece& on_piece, const OnRows& on_rows);

 private:
  /// Damage of a run; unknown for bonds that cannot fail.
  struct Damage {
    double free_below = std::numeric_limits<double>::infinity();
    RunFlags damaged;
  };

  std::vector<BondRun> runs_;
  std::vector<Damage> damage_;  // of the runs; empty: no bond can fail
  bool onsets_move_ = false;    // with histories: rows take the place of runs
  std::uint64_t version_ = 0;
};

template <class P>
void RunPieces::follow(const Bonds& bonds, const P& law, const double* largest_stretch,
                       std::uint64_t version, int threads) {
  if constexpr (requires { law.onset; }) onsets_move_ = law.onset != nullptr;
  if (onsets_move_ || (!damage_.empty() && version == version_)) return;
  version_ = version;
  damage_.resize(runs_.size());
  const auto count = std::ptrdiff_t(runs_.size());
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
  for (std::ptrdiff_t r = 0; r < count; ++r) {
    const BondRun run = runs_[std::size_t(r)];
    Damage found;
    Offset bond = bonds.offset[run.first];
    const Offset per_point = bonds.offset[run.first + 1] - bond;
    found.damaged = RunFlags(run.last - run.first, per_point);
    for (Index i = 0; i < run.last - run.first; ++i) {
      for (Offset k = 0; k < per_point; ++k, ++bond) {
        const double onset = law.onset_of(bond);
        found.free_below = std::min(found.free_below, onset);
        // Brittle bonds may be broken at their onset itself.
        if (largest_stretch[bond] >= onset) found.damaged.raise(k, i);
      }
    }
    damage_[std::size_t(r)] = std::move(found);
  }
}

template <class OnPiece, class OnRows>
void RunPieces::for_each(RowRange range, const OnPiece& on_piece, const OnRows& on_rows) {
  Index done = range.first;
  const auto starts_before = [&](const BondRun& run) { return run.last <= range.first; };
  auto run = onsets_move_ ? runs_.end() : std::ranges::partition_point(runs_, starts_before);
  for (; run != runs_.end() && run->first < range.last; ++run) {
    RunPiece piece{std::max(run->first, range.first), 0, run->first,
                   std::numeric_limits<double>::infinity(), nullptr};
    if (!damage_.empty()) {
      Damage& damage = damage_[std::size_t(run - runs_.begin())];
      piece.free_below = damage.free_below;
      piece.damaged = &damage.damaged;
    }
    if (done < piece.first) on_rows(done, piece.first);
    const Index end = std::min(run->last, range.last);
    for (; piece.first < end; piece.first = piece.last) {
      piece.last = std::min(end, piece.first + longest);
      on_piece(piece);
    }
    done = end;
  }
  if (done < range.last) on_rows(done, range.last);
}

}  // namespace peristat
