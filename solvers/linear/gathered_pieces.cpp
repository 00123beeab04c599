#include "solvers/linear/gathered_pieces.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

template <class T>
std::string packed(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

template <class T>
std::vector<T> unpacked(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::vector<Index> places_of(std::span<const std::int64_t> labels,
                             const std::vector<std::int64_t>& ascending) {
  std::vector<Index> places;
  places.reserve(labels.size());
  for (const std::int64_t label : labels) {
    const auto found = std::lower_bound(ascending.begin(), ascending.end(), label);
    places.push_back(Index(found - ascending.begin()));
  }
  return places;
}

}  // namespace

GatheredPieces::GatheredPieces(const Communicator& ranks, std::span<const std::int64_t> labels)
    : ranks_(&ranks) {
  std::vector<std::vector<std::int64_t>> of_ranks;
  std::vector<std::int64_t> all;
  ranks_->gather(packed(labels), [&](int, const std::string& bytes) {
    of_ranks.push_back(unpacked<std::int64_t>(bytes));
    all.insert(all.end(), of_ranks.back().begin(), of_ranks.back().end());
  });
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::string bytes = packed(std::span<const std::int64_t>(all));
  ranks_->broadcast(bytes);
  all = unpacked<std::int64_t>(bytes);
  count_ = Index(all.size());
  number_ = places_of(labels, all);
  for (const auto& of_rank : of_ranks) of_ranks_.push_back(places_of(of_rank, all));
}

std::vector<double> GatheredPieces::sum(std::vector<double> mine, int width) const {
  if (ranks_->count() == 1) return mine;
  const auto w = std::size_t(width);
  std::vector<double> all(gathers() ? std::size_t(count_) * w : 0);
  ranks_->gather(packed(std::span<const double>(mine)), [&](int rank, const std::string& bytes) {
    const std::vector<double> values = unpacked<double>(bytes);
    const std::vector<Index>& numbers = of_ranks_[std::size_t(rank)];
    for (std::size_t k = 0; k < values.size(); ++k) {
      all[std::size_t(numbers[k / w]) * w + k % w] += values[k];
    }
  });
  return all;
}

std::vector<double> GatheredPieces::share_out(std::vector<double> all, int width) const {
  if (ranks_->count() == 1) return all;
  const auto w = std::size_t(width);
  std::string bytes = gathers() ? packed(std::span<const double>(all)) : std::string();
  ranks_->broadcast(bytes);
  std::vector<double> mine(number_.size() * w);
  for (std::size_t p = 0; p < number_.size(); ++p) {
    std::memcpy(&mine[p * w], &bytes[std::size_t(number_[p]) * w * sizeof(double)],
                w * sizeof(double));
  }
  return mine;
}

void GatheredPieces::for_each_pair(Pairs pairs, int width, const VisitPair& visit) const {
  const auto w = std::size_t(width);
  for (Index& piece : pairs.row) piece = number_[std::size_t(piece)];
  for (Index& piece : pairs.column) piece = number_[std::size_t(piece)];
  const std::string mine = packed(std::span<const double>(pairs.values)) +
                           packed(std::span<const Index>(pairs.row)) +
                           packed(std::span<const Index>(pairs.column));
  ranks_->gather(mine, [&](int, const std::string& bytes) {
    const std::size_t count = bytes.size() / (w * sizeof(double) + 2 * sizeof(Index));
    const std::size_t end = count * w * sizeof(double);
    const auto values = unpacked<double>(bytes.substr(0, end));
    const auto pieces = unpacked<Index>(bytes.substr(end));
    for (std::size_t k = 0; k < count; ++k) {
      visit(pieces[k], pieces[count + k], values.data() + k * w);
    }
  });
}

std::vector<std::int64_t> labels_over_ranks(const IndexMap& index_map,
                                            std::span<const Index> joined) {
  const Communicator& ranks = index_map.ranks();
  const auto owned = std::size_t(index_map.owned());
  const auto [before, all] = ranks.count_all(std::int64_t(owned));
  const double first = double(before);
  constexpr double none = std::numeric_limits<double>::max();
  // Lowest number of the owned points that are joined here; ghosts then bring lower ones from other
  // ranks.
  std::vector<double> least(joined.size(), none), of_points(joined.size(), none);
  for (std::size_t i = owned; i-- > 0;) least[std::size_t(joined[i])] = first + double(i);
  const auto handles = std::size_t(index_map.count());  // handles follow all points of this rank
  for (std::size_t i = handles; i < joined.size(); ++i) {
    least[std::size_t(joined[i])] = double(all) + double(i - handles);
  }
  for (bool changed = true; changed;) {
    for (std::size_t i = 0; i < joined.size(); ++i) of_points[i] = least[std::size_t(joined[i])];
    index_map.update_ghost_values(of_points);
    changed = false;
    for (std::size_t i = owned; i < joined.size(); ++i) {
      double& here = least[std::size_t(joined[i])];
      if (of_points[i] >= here) continue;
      here = of_points[i];
      changed = true;
    }
    changed = ranks.max(double(changed)) > 0.0;
  }
  std::vector<std::int64_t> labels(joined.size());
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const double label = least[std::size_t(joined[i])];
    labels[i] = label == none ? -1 : std::int64_t(label);
  }
  return labels;
}

}  // namespace peristat
