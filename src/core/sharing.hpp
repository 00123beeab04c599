#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "src/core/communicator.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// What a part of a body shares with the parts that other ranks have. Its points are those that the
/// rank owns, then ghosts, which follow their owners, then images of both, first those of owned
/// points. Arrays per degree of freedom may have handles of constraints after them: all ranks have
/// these, and rank 0 owns them.
class Sharing {
 public:
  Sharing() = default;
  Sharing(const Sharing&) = delete;
  Sharing& operator=(const Sharing&) = delete;
  virtual ~Sharing() = default;

  [[nodiscard]] virtual const Communicator& ranks() const = 0;
  [[nodiscard]] virtual Index owned() const = 0;
  /// That are here, ghosts and images too.
  [[nodiscard]] virtual Index count() const = 0;
  [[nodiscard]] virtual Index first_image() const = 0;
  /// How many images of owned points there are, the first ones.
  [[nodiscard]] virtual Index owned_images() const = 0;
  /// Of each owned point in the whole body, ascending.
  [[nodiscard]] virtual const std::vector<GlobalIndex>& number() const = 0;

  /// Gives ghosts, and handles, what their owners have; a call that all ranks make.
  /// @param values points x dimension, and handles where there are any
  virtual void update_ghosts(std::span<double> values) const = 0;
};

/// Replaces values of which each rank has a share by their sums; a call that all ranks make.
inline void add_up(const Communicator& ranks, std::span<double> shares) {
  if (shares.empty()) return;
  const std::vector<double> all = ranks.sum(std::vector<double>(shares.begin(), shares.end()));
  std::copy(all.begin(), all.end(), shares.begin());
}

/// The sum of what ranks have a share of; of a whole body (null) what is given.
[[nodiscard]] inline double sum_of_all(const Sharing* sharing, double share) {
  return sharing ? sharing->ranks().sum(share) : share;
}

/// Whether it is so on any rank; of a whole body (null) what is given.
[[nodiscard]] inline bool any_of_all(const Sharing* sharing, bool is_here) {
  return sharing ? sharing->ranks().max(is_here ? 1.0 : 0.0) > 0.0 : is_here;
}

/// Gives ghosts the one value per point that their owners have; a call that all ranks make.
inline void update_ghost_values(const Sharing& sharing, int dimension, std::span<double> values) {
  const auto d = std::size_t(dimension);
  std::vector<double> vectors(values.size() * d);
  for (std::size_t i = 0; i < values.size(); ++i) vectors[i * d] = values[i];
  sharing.update_ghosts(vectors);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = vectors[i * d];
}

/// Numbers of points in the whole body, those of ghosts too. A call that all ranks make.
[[nodiscard]] inline std::vector<double> whole_numbers(const Sharing& sharing, std::size_t points,
                                                       int dimension) {
  std::vector<double> numbers(sharing.number().begin(), sharing.number().end());
  numbers.resize(points, 0.0);
  update_ghost_values(sharing, dimension, numbers);
  return numbers;
}

/// What the ranks give one after the other; each gives as many numbers as it wants. A call that all
/// make.
/// @return at rank 0 what all give, elsewhere nothing
[[nodiscard]] inline std::string gathered(const Communicator& ranks,
                                          const std::vector<double>& mine) {
  std::string all, bytes(mine.size() * sizeof(double), '\0');
  if (!mine.empty()) std::memcpy(bytes.data(), mine.data(), bytes.size());
  ranks.gather(bytes, [&](int, const std::string& theirs) { all += theirs; });
  return all;
}

[[nodiscard]] inline std::vector<double> numbers_of(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

/// The same at all ranks.
[[nodiscard]] inline std::vector<double> all_together(const Communicator& ranks,
                                                      const std::vector<double>& mine) {
  std::string all = gathered(ranks, mine);
  ranks.broadcast(all);
  return numbers_of(all);
}

}  // namespace peristat
