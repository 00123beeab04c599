#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "assembly/terms/contact/contact_faces.hpp"

namespace peristat {

/// Points with the facets that they can touch near a displacement, kept as those of NearPairs.
class NearFaces {
 public:
  /// All arguments outlive it.
  NearFaces(const ContactPairs& pairs, const ContactFaces& faces, int threads)
      : pairs_(pairs), faces_(faces), threads_(threads) {}

  /// @param displacement finite
  [[nodiscard]] const FacingPoints& at(std::span<const double> displacement,
                                       const History& history);
  /// The same, found anew: the same at any time.
  [[nodiscard]] const FacingPoints& found_at(std::span<const double> displacement,
                                             const History& history);

  /// Largest share of a step, from 0 to 1, within which no point comes nearer to a facet than
  /// (1 - 0.9 a) d: 0.9 of the first time at which one does, on straight ways.
  [[nodiscard]] double longest_share(const StateView& at, std::span<const double> step);
  /// True if a point that is off a facet at both ends of a step, on straight ways, comes nearer
  /// than (1 - a) d between them.
  [[nodiscard]] bool passes_through(const StateView& at, std::span<const double> step);

 private:
  void find_whole(const History& history);
  [[nodiscard]] std::vector<ContactFaces::Meeting> meetings(const StateView& at,
                                                            std::span<const double> step);
  [[nodiscard]] double level(const ContactFaces::Meeting& of, double share) const;
  /// First time at which a point that is farther from a facet is at a distance; 2: not in this
  /// step.
  [[nodiscard]] double time_until(const ContactFaces::Meeting& of, const StateView& at,
                                  std::span<const double> step, double distance) const;

  const ContactPairs& pairs_;
  const ContactFaces& faces_;
  int threads_;
  std::vector<double> found_at_;
  FacingPoints near_;
  std::vector<char> whole_;
  std::optional<std::uint64_t> version_;  // of the history that whole_ is for
};

}  // namespace peristat
