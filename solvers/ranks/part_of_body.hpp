#pragma once

#include <memory>
#include <vector>

#include "assembly/energy/sharing.hpp"
#include "solvers/ranks/ghost_exchange.hpp"
#include "src/geometry/part.hpp"

namespace peristat {

/// A part of a body among those of the other ranks. Every interaction that an owned point takes
/// part in is computed by its rank, so that the rows of owned points are whole and nothing but what
/// ghosts have ever comes from others.
class PartOfBody : public Sharing {
 public:
  /// The ranks outlive it. A call that all make.
  PartOfBody(const Part& part, const Communicator& ranks);

  [[nodiscard]] const Communicator& ranks() const override { return ranks_; }
  [[nodiscard]] Index owned() const override { return Index(number_.size()); }
  void update_ghosts(std::span<double> values) const override { ghosts_->update(values.data()); }

  /// Of each owned point in the whole body, ascending.
  [[nodiscard]] const std::vector<GlobalIndex>& number() const { return number_; }
  [[nodiscard]] GlobalIndex whole() const { return whole_; }  ///< points of the whole body
  [[nodiscard]] Traffic traffic() const { return ghosts_->traffic(); }

 private:
  const Communicator& ranks_;
  std::vector<GlobalIndex> number_;
  GlobalIndex whole_;
  std::unique_ptr<GhostExchange> ghosts_;
};

}  // namespace peristat
