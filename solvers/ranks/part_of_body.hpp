#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "solvers/ranks/ghost_exchange.hpp"
#include "src/core/sharing.hpp"
#include "src/geometry/numbered_points.hpp"
#include "src/geometry/part.hpp"

namespace peristat {

/// A part of a distributed body. A rank computes every interaction of its owned points, so that
/// their rows are complete and only the values of ghosts come from other ranks.
class PartOfBody : public Sharing {
 public:
  /// The ranks must outlive it. Collective.
  PartOfBody(const Part& part, const Communicator& ranks);

  [[nodiscard]] const Communicator& ranks() const override { return ranks_; }
  [[nodiscard]] Index owned() const override { return Index(number_.size()); }
  [[nodiscard]] Index count() const override { return count_; }
  [[nodiscard]] Index first_image() const override { return owned() + Index(ghost_number_.size()); }
  [[nodiscard]] Index owned_images() const override { return owned_images_; }
  void update_ghosts(std::span<double> values) const override;

  [[nodiscard]] const std::vector<GlobalIndex>& number() const override { return number_; }
  /// Number in the whole body of a local point, perhaps a ghost.
  [[nodiscard]] GlobalIndex number_of(Index point) const { return numbered().number_of(point); }
  /// Local point with this number in the whole body, if it is here.
  [[nodiscard]] std::optional<Index> find(GlobalIndex number) const {
    return numbered().find(number);
  }
  [[nodiscard]] NumberedPoints numbered() const { return {number_, ghost_number_, ghost_owner_}; }
  [[nodiscard]] GlobalIndex whole() const { return whole_; }  ///< points of the whole body
  [[nodiscard]] Traffic traffic() const { return ghosts_->traffic(); }

 private:
  const Communicator& ranks_;
  std::vector<GlobalIndex> number_, ghost_number_;
  std::vector<int> ghost_owner_;
  Index count_, owned_images_;
  std::size_t dimension_;
  GlobalIndex whole_;
  std::unique_ptr<GhostExchange> ghosts_;
};

}  // namespace peristat
