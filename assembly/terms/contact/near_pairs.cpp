#include "assembly/terms/contact/near_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "assembly/terms/contact/bond_shares.hpp"

namespace peristat {

double room_left(const ContactPairs& pairs, std::span<const double> found_at,
                 std::span<const double> displacement, int threads) {
  if (found_at.size() < displacement.size()) return 0.0;
  const int d = pairs.points().dimension;
  const Index count = pairs.points().count();
  double largest = 0.0;
#pragma omp parallel for num_threads(threads) reduction(max : largest) schedule(static)
  for (Index i = 0; i < count; ++i) {
    double squared = 0.0;
    for (int c = 0; c < d; ++c) {
      const std::size_t dof = std::size_t(i) * d + c;
      const double step = displacement[dof] - found_at[dof];
      squared += step * step;
    }
    largest = std::max(largest, squared);
  }
  return std::max(0.0, pairs.skin() - 2.0 * std::sqrt(largest));
}

double NearPairs::slack(std::span<const double> displacement) const {
  return room_left(pairs_, found_at_, displacement, threads_);
}

std::span<const NearPairs::Open> NearPairs::at(std::span<const double> displacement,
                                               const History& history) {
  if (!(slack(displacement) > 0.0)) return found_at(displacement, history);
  return open_for(history);
}

std::span<const NearPairs::Open> NearPairs::open_for(const History& history) {
  if (version_ == history.version()) return open_;
  version_ = history.version();
  find_whole(history);
  open_.clear();
  for_each_lost_share(model_, history, near_, [&](const ContactPair& pair, double share) {
    share *= faces_.left_to_pair(pair, whole_);
    if (share > 0.0) open_.push_back({pair, share});
  });
  return open_;
}

std::span<const NearPairs::Open> NearPairs::found_at(std::span<const double> displacement,
                                                     const History& history) {
  found_at_.assign(displacement.begin(), displacement.end());
  near_ = pairs_.near(displacement, threads_);
  version_.reset();
  return open_for(history);
}

void NearPairs::find_whole(const History& history) {
  if (whole_for_ == history.version()) return;
  whole_for_ = history.version();
  whole_ = faces_.whole(history);
}

double NearPairs::share(const ContactPair& pair, const History& history) {
  double found = 0.0;
  for_each_lost_share(model_, history, std::span(&pair, 1),
                      [&](const ContactPair&, double share) { found = share; });
  if (found == 0.0 || faces_.none()) return found;
  find_whole(history);
  return found * faces_.left_to_pair(pair, whole_);
}

}  // namespace peristat
