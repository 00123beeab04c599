#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

class BondFailure;

/// What a history has rows of.
enum class FailingParts { bonds, points };

/// Bonds that a history has taken from a body.
struct BondLosses {
  double dissipated_energy = 0.0;  ///< by what has failed or degraded [J]
  Index broken_bonds = 0;
  double round_off = 0.0;  ///< of the weights that are left, relative
};

/// What fails of a body, by which law, and what a history of it means. It belongs to a term, whose
/// passes commit the history, and is constant during a solve.
class FailureModel {
 public:
  /// @param bonds network of the body
  explicit FailureModel(std::shared_ptr<const Bonds> bonds) : bonds_(std::move(bonds)) {}
  virtual ~FailureModel() = default;

  [[nodiscard]] const Bonds& bonds() const { return *bonds_; }
  [[nodiscard]] const std::shared_ptr<const Bonds>& shared_bonds() const { return bonds_; }
  /// All bonds of the body, of which the network may have only some; these are found anew in each
  /// call.
  [[nodiscard]] virtual std::shared_ptr<const Bonds> whole_network() const { return bonds_; }
  /// Number of all bonds, whether stored or not.
  [[nodiscard]] virtual Offset count_of_bonds() const { return bonds_->count(); }

  /// Otherwise states do no damage, and there is no history.
  [[nodiscard]] virtual bool can_fail() const = 0;
  [[nodiscard]] virtual FailingParts parts() const = 0;
  /// True if implicit steps damage all that exceeds what it bears at one load, and find equilibria
  /// in turns with that. Mode path goes from drop to drop where fails_by_steps.
  [[nodiscard]] virtual bool fails_in_avalanches() const = 0;
  /// History before any load; empty if nothing can fail.
  [[nodiscard]] virtual std::vector<double> initial_history() const = 0;

  /// True for each of these bonds, the network's or all, that is broken; empty if none can break.
  [[nodiscard]] virtual std::vector<char> broken(const Bonds& bonds,
                                                 std::span<const double> history) const = 0;

  /// Adds the weights of each point's bonds to `whole`, and what the history leaves of them, by the
  /// integrity of each bond, to `left` [m6].
  /// @param points null: the body is whole. On a part of a body losses are of the bonds that it
  ///        counts, except that the dissipation of failing points is that of the whole body
  [[nodiscard]] virtual BondLosses weigh(std::span<const double> history, const Points* points,
                                         std::span<double> whole, std::span<double> left) const = 0;

  /// This model if bonds fail by their stretch, otherwise null.
  [[nodiscard]] virtual const BondFailure* as_bond_failure() const { return nullptr; }

 private:
  std::shared_ptr<const Bonds> bonds_;
};

}  // namespace peristat
