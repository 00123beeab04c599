#include "assembly/terms/contact/swept_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "assembly/terms/contact/contact_limits.hpp"
#include "src/core/infinity.hpp"
#include "src/neighbourhood/cell_list.hpp"

namespace peristat {
namespace {

/// Points that are near one another, with the boxes of their places and of their steps.
template <int D>
struct Group {
  std::array<double, D> lower, upper, least_step, most_step;
  Index first, last;  // places in the cell list
};

/// First time at which two points that are farther apart are at a distance; `never`: not in this
/// step.
double time_until(const Points& points, Index i, Index j, const StateView& at,
                  std::span<const double> step, double distance) {
  double squared = -distance * distance, closing = 0.0, speed = 0.0;
  for (int c = 0; c < points.dimension; ++c) {
    const std::size_t of_i = std::size_t(i) * points.dimension + c,
                      of_j = std::size_t(j) * points.dimension + c;
    const double arm = points.reference[of_j] - points.reference[of_i] +
                       (at.displacement[of_j] - at.displacement[of_i]);
    const double v = step[of_j] - step[of_i];
    squared += arm * arm;
    closing -= arm * v;
    speed += v * v;
  }
  if (!(squared > 0.0) || !(closing > 0.0)) return never;
  const double under_root = closing * closing - speed * squared;
  return under_root >= 0.0 ? squared / (closing + std::sqrt(under_root)) : never;
}

/// First time at which a pair is at a share of its largest depth.
double time_of_contact(const ContactPairs& pairs, const ContactPair& pair, const StateView& at,
                       std::span<const double> step, double share) {
  const double depth = pairs.rules()[std::size_t(pair.rule)].depth;
  return time_until(pairs.points(), pair.i, pair.j, at, step,
                    (1.0 - share * depth) * pair.distance);
}

template <int D>
std::vector<Group<D>> groups_of(const CellList<D>& cells, std::span<const double> step) {
  std::vector<Group<D>> groups;
  for (std::size_t cell = 0; cell + 1 < cells.begin.size(); ++cell) {
    Group<D> group;
    group.first = cells.begin[cell];
    group.last = cells.begin[cell + 1];
    if (group.first == group.last) continue;
    group.lower.fill(infinity);
    group.least_step.fill(infinity);
    group.upper.fill(-infinity);
    group.most_step.fill(-infinity);
    for (Index slot = group.first; slot < group.last; ++slot) {
      for (int c = 0; c < D; ++c) {
        const double place = cells.position[slot][c];
        const double moved = step[std::size_t(cells.point[slot]) * D + c];
        group.lower[c] = std::min(group.lower[c], place);
        group.upper[c] = std::max(group.upper[c], place);
        group.least_step[c] = std::min(group.least_step[c], moved);
        group.most_step[c] = std::max(group.most_step[c], moved);
      }
    }
    groups.push_back(group);
  }
  return groups;
}

/// True if points of two groups may come as near as `reach` while they move by their steps.
template <int D>
bool may_meet(const Group<D>& a, const Group<D>& b, double reach) {
  for (int c = 0; c < D; ++c) {
    const double back = std::min(0.0, a.least_step[c] - b.most_step[c]),
                 forth = std::max(0.0, a.most_step[c] - b.least_step[c]);
    if (a.lower[c] + back - reach > b.upper[c] || a.upper[c] + forth + reach < b.lower[c]) {
      return false;
    }
  }
  return true;
}

/// Visits all pairs that reach a share of their largest depth in a step, with the time.
template <int D, class Visit>
void for_each_swept_pair(const ContactPairs& pairs, const StateView& at,
                         std::span<const double> step, NearPairs& near, double share,
                         const Visit& visit) {
  const Points& points = pairs.points();
  std::vector<double> place(points.reference);
  for (std::size_t k = 0; k < place.size(); ++k) place[k] += at.displacement[k];
  std::vector<Index> all(std::size_t(points.count()));
  std::iota(all.begin(), all.end(), Index(0));
  constexpr double reaches_per_cell = 2.0;
  const CellList<D> cells(place, all, reaches_per_cell * cells_per_radius * pairs.reach());
  std::vector<Group<D>> groups = groups_of<D>(cells, step);
  // By the ends of their ways along x, beyond which no later group begins.
  const auto begins = [&](const Group<D>& of) {
    return of.lower[0] + std::min(0.0, of.least_step[0]) - pairs.reach();
  };
  const auto ends = [&](const Group<D>& of) {
    return of.upper[0] + std::max(0.0, of.most_step[0]) + pairs.reach();
  };
  std::ranges::sort(groups, [&](const auto& a, const auto& b) { return begins(a) < begins(b); });
  const auto look_at = [&](Index one, Index other) {
    const auto [i, j] = std::minmax(cells.point[one], cells.point[other]);
    double squared = 0.0;
    for (int c = 0; c < D; ++c) {
      const double arm = cells.position[other][c] - cells.position[one][c];
      squared += arm * arm;
    }
    // Most pairs are not even within the longest distance of contact on their ways.
    const bool is_far = squared > pairs.reach() * pairs.reach();
    if (is_far && time_until(points, i, j, at, step, pairs.reach()) > 1.0) return;
    ContactPair pair;
    if (!pairs.find_pair(i, j, pair)) return;
    const double time = time_of_contact(pairs, pair, at, step, share);
    if (time <= 1.0 && near.share(pair, at.history) > 0.0) visit(pair, time);
  };
  for (std::size_t a = 0; a < groups.size(); ++a) {
    for (std::size_t b = a; b < groups.size() && begins(groups[b]) <= ends(groups[a]); ++b) {
      if (!may_meet<D>(groups[a], groups[b], pairs.reach())) continue;
      for (Index one = groups[a].first; one < groups[a].last; ++one) {
        for (Index other = a == b ? one + 1 : groups[b].first; other < groups[b].last; ++other) {
          look_at(one, other);
        }
      }
    }
  }
}

/// The same, by the pairs that are near where the step is short.
template <class Visit>
void visit_swept_pairs(const ContactPairs& pairs, const StateView& at, std::span<const double> step,
                       NearPairs& near, double share, const Visit& visit) {
  const Points& points = pairs.points();
  const double approach = longest_approach(points, step);
  if (approach <= pairs.skin()) {
    const bool are_found = approach <= near.slack(at.displacement);
    for (const NearPairs::Open& open : are_found ? near.at(at.displacement, at.history)
                                                 : near.found_at(at.displacement, at.history)) {
      const double time = time_of_contact(pairs, open.pair, at, step, share);
      if (time <= 1.0) visit(open.pair, time);
    }
  } else if (points.dimension == 1) {
    for_each_swept_pair<1>(pairs, at, step, near, share, visit);
  } else if (points.dimension == 2) {
    for_each_swept_pair<2>(pairs, at, step, near, share, visit);
  } else {
    for_each_swept_pair<3>(pairs, at, step, near, share, visit);
  }
}

}  // namespace

double longest_approach(const Points& points, std::span<const double> step) {
  double longest = 0.0;
  for (Index i = 0; i < points.count(); ++i) {
    double squared = 0.0;
    for (int c = 0; c < points.dimension; ++c) {
      const double component = step[std::size_t(i) * points.dimension + c];
      squared += component * component;
    }
    longest = std::max(longest, squared);
  }
  return 2.0 * std::sqrt(longest);
}

double longest_swept_share(const ContactPairs& pairs, const StateView& at,
                           std::span<const double> step, NearPairs& near) {
  double first = never;
  visit_swept_pairs(pairs, at, step, near, most_depth_of_step,
                    [&](const ContactPair&, double time) { first = std::min(first, time); });
  return first <= 1.0 ? most_time_of_step * first : 1.0;
}

bool passes_through(const ContactPairs& pairs, const StateView& at, std::span<const double> step,
                    NearPairs& near) {
  bool passes = false;
  visit_swept_pairs(pairs, at, step, near, 1.0, [&](const ContactPair& pair, double) {
    double squared = 0.0;
    const auto d = std::size_t(pairs.points().dimension);
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t i = std::size_t(pair.i) * d + c, j = std::size_t(pair.j) * d + c;
      const double arm = pairs.points().reference[j] - pairs.points().reference[i] +
                         (at.displacement[j] - at.displacement[i]) + (step[j] - step[i]);
      squared += arm * arm;
    }
    passes |= squared > pair.distance * pair.distance;
  });
  return passes;
}

}  // namespace peristat
