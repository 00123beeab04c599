#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "assembly/energy/history.hpp"
#include "assembly/terms/contact/contact_faces.hpp"
#include "assembly/terms/contact/contact_pairs.hpp"
#include "assembly/terms/model.hpp"

namespace peristat {

/// By how much points may approach one another from a displacement before some could touch that
/// were not within d + skin where they were found [m]; 0: they are to be found anew.
[[nodiscard]] double room_left(const ContactPairs& pairs, std::span<const double> found_at,
                               std::span<const double> displacement, int threads);

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
  NearPairs(const ContactPairs& pairs, const ContactFaces& faces, const Model& model, int threads)
      : pairs_(pairs), faces_(faces), model_(model), threads_(threads) {}

  /// Those whose bond is not whole, by i and then j.
  /// @param displacement finite
  [[nodiscard]] std::span<const Open> at(std::span<const double> displacement,
                                         const History& history);
  /// The same, found anew: the same at any time.
  [[nodiscard]] std::span<const Open> found_at(std::span<const double> displacement,
                                               const History& history);

  /// See room_left.
  [[nodiscard]] double slack(std::span<const double> displacement) const;
  /// Share of a pair's contact.
  [[nodiscard]] double share(const ContactPair& pair, const History& history);

 private:
  [[nodiscard]] std::span<const Open> open_for(const History& history);
  void find_whole(const History& history);

  const ContactPairs& pairs_;
  const ContactFaces& faces_;
  const Model& model_;
  int threads_;
  std::vector<double> found_at_;
  std::vector<ContactPair> near_;
  std::vector<Open> open_;
  std::vector<char> whole_;  // facets
  std::optional<std::uint64_t> whole_for_;
  std::optional<std::uint64_t> version_;  // of the history that they are open for
};

}  // namespace peristat
