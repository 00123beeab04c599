#include "assembly/terms/contact/contact_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "src/neighbourhood/cell_list.hpp"

namespace peristat {
namespace {

/// Rows that are searched together, whatever the number of threads.
constexpr Index rows_per_part = 4096;

/// Points of a lattice within one and a half spacings of another, each pair once.
std::size_t pairs_of_point(int dimension) { return dimension == 3 ? 9 : dimension == 2 ? 4 : 1; }

}  // namespace

ContactPairs::ContactPairs(const Points& points, const Bonds& bonds,
                           std::vector<PairContactRule> rules, std::vector<double> size,
                           std::vector<double> modulus, double cross_section, bool bonds_fail,
                           const Communicator& ranks)
    : points_(points),
      bonds_(bonds),
      rules_(std::move(rules)),
      size_(std::move(size)),
      modulus_(std::move(modulus)),
      cross_section_(cross_section),
      bonds_fail_(bonds_fail) {
  for (const double of_point : size_) largest_size_ = std::max(largest_size_, of_point);
  largest_size_ = ranks.max(largest_size_);
  for (const PairContactRule& rule : rules_) {
    reach_ = std::max(reach_, rule.distance > 0.0 ? rule.distance : largest_size_);
  }
}

double ContactPairs::bytes() const {
  const auto near = double(pairs_of_point(points_.dimension));  // twice, for a predictor
  double bytes = double(size_.size() + modulus_.size()) * sizeof(double);
  if (bonds_fail_) bytes += 2.0 * near * double(size_.size()) * sizeof(ContactPair);
  for (const PairContactRule& rule : rules_) bytes += double(rule.side.size());
  return bytes;
}

bool ContactPairs::find_pair(Index i, Index j, ContactPair& pair) const {
  if (points_.is_image(i) || (!points_.owns(i) && !points_.owns(j))) return false;
  const auto rule =
      std::ranges::find_if(rules_, [&](const PairContactRule& of) { return of.holds_for(i, j); });
  if (rule == rules_.end()) return false;
  const std::optional<Offset> bond = bonds_.find(i, j);
  if (bond && !bonds_fail_) return false;
  const double mean = 0.5 * (size_[std::size_t(i)] + size_[std::size_t(j)]);
  double squared = 0.0;
  for (int c = 0; c < points_.dimension; ++c) {
    const double step = points_.reference[std::size_t(j) * points_.dimension + c] -
                        points_.reference[std::size_t(i) * points_.dimension + c];
    squared += step * step;
  }
  const double one = modulus_[std::size_t(i)], other = modulus_[std::size_t(j)];
  pair.i = i;
  pair.j = j;
  pair.rule = std::int32_t(rule - rules_.begin());
  pair.reference = std::sqrt(squared);
  pair.distance = std::min(pair.reference, rule->distance > 0.0 ? rule->distance : mean);
  pair.stiffness =
      rule->stiffness * 2.0 * one * other / (one + other) * section(mean) / pair.distance;
  if (points_.is_image(j)) pair.stiffness *= 0.5;
  pair.bond = bond.value_or(-1);
  return true;
}

std::vector<ContactPair> ContactPairs::near(std::span<const double> displacement,
                                            int threads) const {
  if (points_.count() == 0) return {};
  switch (points_.dimension) {
    case 1:
      return near_in<1>(displacement, threads);
    case 2:
      return near_in<2>(displacement, threads);
    default:
      return near_in<3>(displacement, threads);
  }
}

template <int D>
std::vector<ContactPair> ContactPairs::near_in(std::span<const double> displacement,
                                               int threads) const {
  std::vector<double> place(points_.reference);
  for (std::size_t k = 0; k < place.size(); ++k) place[k] += displacement[k];
  std::vector<Index> all(std::size_t(points_.count()));
  std::iota(all.begin(), all.end(), Index(0));
  const double radius = reach_ + skin();
  const CellList<D> cells(place, all, radius);
  const Index count = points_.own();
  const Index parts = (count + rows_per_part - 1) / rows_per_part;
  std::vector<std::vector<ContactPair>> found(static_cast<std::size_t>(parts));
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (Index part = 0; part < parts; ++part) {
    const Index last = std::min(count, (part + 1) * rows_per_part);
    std::vector<ContactPair>& mine = found[std::size_t(part)];
    if (bonds_fail_) mine.reserve(pairs_of_point(D) * std::size_t(last - part * rows_per_part));
    for (Index i = part * rows_per_part; i < last; ++i) {
      const auto first = std::ptrdiff_t(mine.size());
      std::array<double, D> at;
      for (int c = 0; c < D; ++c) at[c] = place[std::size_t(i) * D + c];
      cells.for_each_run(at, radius, [&](Index begin, Index end) {
        for (Index slot = begin; slot < end; ++slot) {
          if (cells.point[slot] <= i) continue;
          double squared = 0.0;
          for (int c = 0; c < D; ++c) {
            const double step = cells.position[slot][c] - at[c];
            squared += step * step;
          }
          if (squared > radius * radius) continue;
          ContactPair pair;
          if (!find_pair(i, cells.point[slot], pair)) continue;
          const double near_enough = pair.distance + skin();
          if (squared <= near_enough * near_enough) mine.push_back(pair);
        }
      });
      std::sort(mine.begin() + first, mine.end(),
                [](const ContactPair& a, const ContactPair& b) { return a.j < b.j; });
    }
  }
  std::size_t total = 0;
  for (const std::vector<ContactPair>& part : found) total += part.size();
  std::vector<ContactPair> pairs;
  pairs.reserve(total);
  for (const std::vector<ContactPair>& part : found) {
    pairs.insert(pairs.end(), part.begin(), part.end());
  }
  return pairs;
}

}  // namespace peristat
