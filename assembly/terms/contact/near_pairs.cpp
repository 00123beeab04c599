#include "assembly/terms/contact/near_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "assembly/terms/damage.hpp"

namespace peristat {
namespace {

/// Calls visit(pair, 1 - T) for each pair.
template <class Pairs, class Visit>
void for_each_share(const Model& model, const History& history, const Pairs& pairs,
                    const Visit& visit) {
  const std::span<const double> stretches = bond_stretches(model, history);
  const auto without_bonds = [&] {
    for (const ContactPair& pair : pairs) {
      if (pair.bond < 0) visit(pair, 1.0);
    }
  };
  const BondFailure* const failing = model.failing_bonds();
  if (!failing || stretches.empty()) return without_bonds();
  failing->with_damage_law(model.failure_history(history), [&](const auto& laws) {
    for (const ContactPair& pair : pairs) {
      if (pair.bond < 0) {
        visit(pair, 1.0);
        continue;
      }
      const double largest = stretches[std::size_t(pair.bond)];
      // A bond that has not been damaged has the stretch 0, and one that never fails -1.
      if (largest <= 0.0) continue;
      const double share = 1.0 - laws.of_bond(pair.bond).integrity_after(largest);
      if (share > 0.0) visit(pair, share);
    }
  });
}

}  // namespace

double NearPairs::slack(std::span<const double> displacement) const {
  if (found_at_.size() < displacement.size()) return 0.0;
  const int d = pairs_.points().dimension;
  const Index count = pairs_.points().count();
  double largest = 0.0;
#pragma omp parallel for num_threads(threads_) reduction(max : largest) schedule(static)
  for (Index i = 0; i < count; ++i) {
    double squared = 0.0;
    for (int c = 0; c < d; ++c) {
      const std::size_t dof = std::size_t(i) * d + c;
      const double step = displacement[dof] - found_at_[dof];
      squared += step * step;
    }
    largest = std::max(largest, squared);
  }
  return std::max(0.0, pairs_.skin() - 2.0 * std::sqrt(largest));
}

std::span<const NearPairs::Open> NearPairs::at(std::span<const double> displacement,
                                               const History& history) {
  if (!(slack(displacement) > 0.0)) return found_at(displacement, history);
  return open_for(history);
}

std::span<const NearPairs::Open> NearPairs::open_for(const History& history) {
  if (version_ == history.version()) return open_;
  version_ = history.version();
  open_.clear();
  for_each_share(model_, history, near_, [&](const ContactPair& pair, double share) {
    open_.push_back({pair, share});
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

double NearPairs::share(const ContactPair& pair, const History& history) const {
  double found = 0.0;
  for_each_share(model_, history, std::span(&pair, 1),
                 [&](const ContactPair&, double share) { found = share; });
  return found;
}

}  // namespace peristat
