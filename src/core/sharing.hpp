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

/// Index map of a part: its relation to the parts on other ranks. The points of a part are ordered:
/// owned points, ghosts (copies of points that other ranks own), images of both, those of owned
/// points first. Arrays per degree of freedom may end with generalised degrees of freedom (handles)
/// of constraints: all ranks have these, and rank 0 owns them.
class Sharing {
 public:
  Sharing() = default;
  Sharing(const Sharing&) = delete;
  Sharing& operator=(const Sharing&) = delete;
  virtual ~Sharing() = default;

  [[nodiscard]] virtual const Communicator& ranks() const = 0;
  [[nodiscard]] virtual Index owned() const = 0;
  /// Number of points on this rank, with ghosts and images.
  [[nodiscard]] virtual Index count() const = 0;
  [[nodiscard]] virtual Index first_image() const = 0;
  /// Number of images of owned points, which come first among the images.
  [[nodiscard]] virtual Index owned_images() const = 0;
  /// Number of each owned point in the whole body, ascending.
  [[nodiscard]] virtual const std::vector<GlobalIndex>& number() const = 0;

  /// Copies the owners' values to ghosts and handles. Collective.
  /// @param values points x dimension, and handles where there are any
  virtual void update_ghosts(std::span<double> values) const = 0;
};

/// Replaces values of which each rank has a summand by their sums over all ranks. Collective.
inline void add_up(const Communicator& ranks, std::span<double> shares) {
  if (shares.empty()) return;
  const std::vector<double> all = ranks.sum(std::vector<double>(shares.begin(), shares.end()));
  std::copy(all.begin(), all.end(), shares.begin());
}

/// Returns the sum over all ranks; for a whole body (null) the argument itself.
[[nodiscard]] inline double sum_of_all(const Sharing* sharing, double share) {
  return sharing ? sharing->ranks().sum(share) : share;
}

/// True if the flag is set on any rank; for a whole body (null) the flag itself.
[[nodiscard]] inline bool any_of_all(const Sharing* sharing, bool is_here) {
  return sharing ? sharing->ranks().max(is_here ? 1.0 : 0.0) > 0.0 : is_here;
}

/// Copies the owners' one value per point to ghosts. Collective.
inline void update_ghost_values(const Sharing& sharing, int dimension, std::span<double> values) {
  const auto d = std::size_t(dimension);
  std::vector<double> vectors(values.size() * d);
  for (std::size_t i = 0; i < values.size(); ++i) vectors[i * d] = values[i];
  sharing.update_ghosts(vectors);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = vectors[i * d];
}

/// Returns the numbers in the whole body of owned points and ghosts. Collective.
[[nodiscard]] inline std::vector<double> whole_numbers(const Sharing& sharing, std::size_t points,
                                                       int dimension) {
  std::vector<double> numbers(sharing.number().begin(), sharing.number().end());
  numbers.resize(points, 0.0);
  update_ghost_values(sharing, dimension, numbers);
  return numbers;
}

/// Concatenates the numbers of all ranks, of any count each, at rank 0. Collective.
/// @return the bytes at rank 0, elsewhere nothing
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

/// Concatenates the numbers of all ranks at every rank. Collective.
[[nodiscard]] inline std::vector<double> all_together(const Communicator& ranks,
                                                      const std::vector<double>& mine) {
  std::string all = gathered(ranks, mine);
  ranks.broadcast(all);
  return numbers_of(all);
}

}  // namespace peristat
