#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "assembly/energy/history.hpp"
#include "assembly/terms/contact/contact_pairs.hpp"
#include "assembly/terms/model.hpp"

namespace peristat {

/// Pairs that can touch near a displacement, kept until a point has moved by half the skin. Pairs
/// farther apart than d have no energy, so that no result depends on when they are found.
class NearPairs {
 public:
  /// A pair with the share 1 - T of its contact.
  struct Open {
    ContactPair pair;
    double share = 1.0;
  };

  /// All arguments outlive it.
  NearPairs(const ContactPairs& pairs, const Model& model, int threads)
      : pairs_(pairs), model_(model), threads_(threads) {}

  /// Those whose bond is not whole, by i and then j.
  /// @param displacement finite
  [[nodiscard]] std::span<const Open> at(std::span<const double> displacement,
                                         const History& history);
  /// The same, found anew: the same at any time.
  [[nodiscard]] std::span<const Open> found_at(std::span<const double> displacement,
                                               const History& history);

  /// By how much pairs may approach one another from a displacement before they could touch and not
  /// be among those of `at` [m]; 0: they are to be found anew.
  [[nodiscard]] double slack(std::span<const double> displacement) const;
  /// Share of a pair's contact.
  [[nodiscard]] double share(const ContactPair& pair, const History& history) const;

 private:
  [[nodiscard]] std::span<const Open> open_for(const History& history);

  const ContactPairs& pairs_;
  const Model& model_;
  int threads_;
  std::vector<double> found_at_;
  std::vector<ContactPair> near_;
  std::vector<Open> open_;
  std::optional<std::uint64_t> version_;  // of the history that they are open for
};

}  // namespace peristat
