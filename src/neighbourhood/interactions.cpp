#include "src/neighbourhood/interactions.hpp"

#include <omp.h>

namespace peristat {
namespace {

/// Points [first, last) of one of `threads` threads.
struct Share {
  Index first, last;
};

/// Points with nearly equal numbers of bonds for every thread.
Share share_of_thread(const Bonds& bonds, int thread, int threads) {
  const auto bound = [&](int t) {
    const double goal = double(t) / threads * double(bonds.count());
    Index i = 0;
    while (i < bonds.points() && double(bonds.offset[i]) < goal) ++i;
    return t == threads ? bonds.points() : i;
  };
  return {bound(thread), bound(thread + 1)};
}

/// Interactions of a point, and the sum of their flatness factors.
struct PointCount {
  std::int32_t interactions = 0;
  double effective = 0.0;
  void operator+=(const PointCount& other) {
    interactions += other.interactions;
    effective += other.effective;
  }
};
using Counts = std::vector<PointCount>;

/// Number of points, the lowest ones, at which interactions are visited: all but images. In a part
/// without images the owned points suffice; with images, an interaction of an owned point's image
/// may have a ghost as its lowest point.
Index visited(const Points& points) {
  return points.images.kinds.empty() ? points.owned.value_or(points.own()) : points.own();
}

}  // namespace

template <class Measure>
Interactions<Measure>::Interactions(const Points& points, const Bonds& bonds, double cross_section,
                                    int threads)
    : own_(visited(points)),
      per_point_(std::size_t(points.count()), 0),
      effective_counts_(std::size_t(points.count()), 0.0),
      shares_(std::size_t(points.count()), 1.0 / (Measure::arms + 1)),
      cell_shares_(std::size_t(points.count())) {
  for (std::size_t a = 0; a < cell_shares_.size(); ++a) {
    cell_shares_[a] =
        cell_measure(points.volume[a], cross_section, Measure::arms, points.dimension) /
        (Measure::arms + 1);
  }
  if constexpr (Measure::arms == 2) {
    if (points.dimension == 2) count_in<2>(points, bonds, threads);
  }
  if (points.dimension == 3) count_in<3>(points, bonds, threads);
}

template <class Measure>
template <int D>
void Interactions<Measure>::count_in(const Points& points, const Bonds& bonds, int threads) {
  Offset count = 0, blocks = 0, groups = 0;
  std::vector<Counts> counts(static_cast<std::size_t>(threads));
#pragma omp parallel num_threads(threads) reduction(+ : count, blocks, groups)
  {
    // With fewer threads than asked for, some do the work of several.
    for (int t = omp_get_thread_num(); t < threads; t += omp_get_num_threads()) {
      const Share share = share_of_thread(bonds, t, threads);
      LocalNeighbourhood<D> local(points, bonds);
      InteractionScratch scratch(UpperNeighbourhood::largest(bonds));
      Counts& found = counts[std::size_t(t)];
      found.assign(per_point_.size(), {});
      for (Index i = share.first; i < share.last; ++i) {
        local.move_to(i);
        local.upper.find_pairs();
        const std::span<const Index> partner = local.upper.points();
        find_groups<D>(local, scratch, [&](const Group& group) {
          PointCount in_group;
          for (const InteractionBlock& block : group.blocks) {
            for (int l = 0; l < lane_count; ++l) {
              if ((block.active >> l & 1U) == 0) continue;
              const PointCount one{1, std::abs(block.weight[l])};
              found[partner[block.first + l]] += one;
              in_group += one;
            }
          }
          for (std::int32_t a : group.partners) found[partner[a]] += in_group;
          found[i] += in_group;
          count += in_group.interactions;
          blocks += Offset(group.blocks.size());
          ++groups;
        });
      }
    }
  }
  for (const Counts& found : counts) {  // in order, so that sums do not depend on timing
    for (std::size_t i = 0; i < found.size(); ++i) {
      per_point_[i] += found[i].interactions;
      effective_counts_[i] += found[i].effective;
    }
  }
  count_ = count;
  blocks_ = blocks;
  groups_ = groups;
}

template <class Measure>
double Interactions<Measure>::stored_bytes() const {
  return double(blocks_) * sizeof(InteractionBlock) + double(groups_) * sizeof(StoredGroup) +
         double(per_point_.size()) * 2 * sizeof(Offset);
}

template <class Measure>
void Interactions<Measure>::store(const Points& points, const Bonds& bonds, int threads) {
  if constexpr (Measure::arms == 2) {
    if (points.dimension == 2) return store_in<2>(points, bonds, threads);
  }
  store_in<3>(points, bonds, threads);
}

template <class Measure>
template <int D>
void Interactions<Measure>::store_in(const Points& points, const Bonds& bonds, int threads) {
  chunks_.clear();
  std::vector<Chunk> chunks(static_cast<std::size_t>(threads));
#pragma omp parallel num_threads(threads)
  {
    // With fewer threads than asked for, some do the work of several.
    for (int t = omp_get_thread_num(); t < threads; t += omp_get_num_threads()) {
      const Share share = share_of_thread(bonds, t, threads);
      Chunk& chunk = chunks[std::size_t(t)];
      chunk.first = share.first;
      LocalNeighbourhood<D> local(points, bonds);
      InteractionScratch scratch(UpperNeighbourhood::largest(bonds));
      const auto close_row = [&] {
        chunk.groups_before.push_back(Offset(chunk.groups.size()));
        chunk.blocks_before.push_back(Offset(chunk.blocks.size()));
      };
      // Threads' parts differ a little; growing beyond this would double the memory for a while.
      const double part = 1.05 / threads;
      chunk.groups.reserve(std::size_t(part * double(groups_)) + 1);
      chunk.blocks.reserve(std::size_t(part * double(blocks_)) + 1);
      close_row();
      for (Index i = share.first; i < share.last; ++i) {
        local.move_to(i);
        local.upper.find_pairs();
        find_groups<D>(local, scratch, [&](const Group& group) {
          chunk.groups.push_back({group.partners, std::int32_t(group.blocks.size())});
          chunk.blocks.insert(chunk.blocks.end(), group.blocks.begin(), group.blocks.end());
        });
        close_row();
      }
    }
  }
  chunks_ = std::move(chunks);
}

template class Interactions<Area>;
template class Interactions<Volume>;

}  // namespace peristat
