#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/constraints/rotation.hpp"
#include "src/core/communicator.hpp"
#include "src/core/types.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// A share of a point's displacement: `block` (row major, in the corner of 3 x 3) times the
/// components of another point or handle.
struct Dependence {
  Index master = 0;
  Tensor block{};
};

/// Degrees of freedom that follow others, which leave the equations (master and slave elimination):
///
///   u = phi(q),   R_q = J^T (f - dE/du),   K_q = J^T K J + (dE/du - f) . d2 phi / dq2
///
/// with J = d phi / dq, so that the tangent keeps its symmetry and, where it had it, its
/// definiteness. Arrays have, after the body's points, one more entry of `dimension` numbers per
/// handle: generalised coordinates that stand for no point, like the rotation of a rigid set.
///
/// A dependent component is a function of others that depend on nothing, with one exception: images
/// follow sources that may themselves follow.
///
/// Of a part of a body handles are the same on all ranks, and rank 0's. Where points follow others
/// of several ranks, what moves, extends, folds, unfolds or shares out is a call that all ranks
/// make.
class Constraints {
 public:
  /// With what the points' images follow. Each period has a handle, the jump of the displacement
  /// over it [m].
  /// @param ranks that have parts of the body; they outlive it. Null: it is whole
  explicit Constraints(const Points& points, const Communicator* ranks = nullptr);

  /// Of parts of a body the same on all ranks, which have all handles and kinds of images.
  [[nodiscard]] bool none() const {
    const Images& images = body_->images;
    if (body_->owned) return handles_.empty() && images.kinds.empty();
    return followers_.empty() && rigid_.empty() && images.source.empty();
  }

  /// Whether points follow others directly, as of rollers and linear constraints: not as images or
  /// in rigid sets. Of a part of a body those that are here count.
  [[nodiscard]] bool couples_points() const { return !followers_.empty() || !shared_.empty(); }

  /// Points and handles.
  [[nodiscard]] Index rows() const { return points_ + static_cast<Index>(handles_.size()); }
  [[nodiscard]] std::size_t dofs() const { return std::size_t(rows()) * std::size_t(dimension_); }
  /// Where handles stand, for what asks for places [m].
  [[nodiscard]] const std::vector<Coordinates>& handles() const { return handles_; }
  /// Handle of the period across an axis; -1: none.
  [[nodiscard]] Index period_handle(int axis) const { return period_[std::size_t(axis)]; }
  /// Per degree of freedom, handles included: 1 where it follows others.
  [[nodiscard]] const std::vector<char>& dependent() const { return dependent_; }

  Index add_handle(const Coordinates& place);

  /// Lets components of a point follow.
  /// @param follows per component
  /// @param masters rows of other components are zero
  /// @throws std::logic_error if one of them follows already
  void follow(Index point, const std::array<bool, 3>& follows, std::vector<Dependence> masters);

  /// A point that follows masters of several ranks, as each of them knows it.
  struct SharedFollower {
    std::optional<Index> point;  ///< nothing: it is not here
    std::array<bool, 3> follows;
    std::vector<Dependence> masters;  ///< that this rank owns
  };
  /// Lets components of a point follow masters of several ranks; a call that all of them make, in
  /// the same order.
  /// @throws std::logic_error if one of them follows already
  void follow(SharedFollower follower);

  [[nodiscard]] const std::vector<SharedFollower>& shared_followers() const { return shared_; }

  /// The share of a shared follower in a point that is one, or in an image of it.
  struct SharedDependence {
    std::size_t follower;  ///< its number
    Coordinates factor;    ///< of each component; 0: the point's own
  };
  [[nodiscard]] std::optional<SharedDependence> shared_dependence(Index point) const;

  /// Lets points follow a rigid motion about a centre: u = c + (R(theta) - I)(X - centre), c the
  /// components of one handle and theta those of another, divided by `size` [m] (2D: its first
  /// one).
  struct RigidSet {
    std::vector<Index> members;
    Coordinates centre{};
    double size = 1.0;
    Index translation = 0, rotation = 0;  ///< handles
  };
  void follow(RigidSet set);

  [[nodiscard]] const std::vector<RigidSet>& rigid_sets() const { return rigid_; }

  /// Rotation vector of a rigid set [rad].
  [[nodiscard]] Coordinates rotation(const RigidSet& set,
                                     std::span<const double> displacement) const;

  /// Moves whatever follows.
  void move(std::span<double> displacement) const;

  /// Shares out what handles have moved since `from` among all points that a follower's equation
  /// names, each by its coefficient, in the place of leaving it to the follower: one point of many
  /// would jump by as many times the displacement that their mean is given.
  /// @param stays per degree of freedom, whether it is none that can take a share
  void share_out_jump(std::span<const double> from, std::span<const char> stays,
                      std::span<double> displacement) const;

  /// Lets a rate of displacements include what follows: J times that of the others.
  void extend(std::span<const double> displacement, std::span<double> rate) const;

  /// Takes derivatives by all displacements to those that nothing prescribes: adds J^T (dE/du - f)
  /// of what follows to the gradient's entries of its masters. Entries of what follows keep the
  /// whole force that acts there.
  void fold(std::span<const double> displacement, std::span<const double> external_force,
            std::span<double> gradient) const;

  /// Internal forces again from a folded gradient, where points follow others directly; forces on
  /// images stay with their sources.
  void unfold(std::span<const double> external_force, std::span<double> gradient) const;

  /// Adds forces on images to their sources and the jumps over periods.
  void fold_images(std::span<double> force) const;

  /// The rows of J of a point: itself as far as it does not follow, and its masters but those that
  /// shared_dependence tells.
  [[nodiscard]] std::vector<Dependence> dependences(Index point,
                                                    std::span<const double> displacement) const;
  /// Whether a point or handle follows nothing.
  [[nodiscard]] bool stands_alone(Index row) const {
    return row >= points_ || role_[std::size_t(row)].kind == Role::Kind::alone;
  }

  /// What the curvature of phi adds to K_q: for each rigid set the block of its rotation [N/m].
  /// @param gradient folded
  [[nodiscard]] std::vector<Tensor> curvature(std::span<const double> displacement,
                                              std::span<const double> external_force,
                                              std::span<const double> gradient) const;

 private:
  struct Role {
    enum class Kind : char { alone, follower, shared, rigid, image } kind = Kind::alone;
    Index number = 0;  ///< in followers_, shared_ or rigid_
  };
  struct Follower {
    Index point;
    std::array<bool, 3> follows;
    std::vector<Dependence> masters;
  };
  [[nodiscard]] Coordinates arm(const RigidSet& set, Index member) const;
  [[nodiscard]] std::size_t dof(Index row, int component = 0) const {
    return std::size_t(row) * std::size_t(dimension_) + std::size_t(component);
  }
  void give_role(Index point, Role role, const std::array<bool, 3>& follows);
  [[nodiscard]] std::vector<Dependence> of_rigid(const RigidSet& set, const Rotation& turned,
                                                 Index member) const;
  [[nodiscard]] Coordinates moved_by(const std::vector<Dependence>& masters,
                                     std::span<const double> displacement) const;
  void move_followers(std::span<double> displacement) const;
  void move_shared_followers(std::span<double> displacement) const;
  void share_out_among_ranks(std::span<const double> from, std::span<const char> stays,
                             std::span<double> displacement) const;
  /// dE/du - f of a point.
  [[nodiscard]] Coordinates unbalanced(Index point, std::span<const double> external_force,
                                       std::span<const double> gradient) const;
  void fold_point(const Coordinates& force, const std::vector<Dependence>& masters, double sign,
                  std::span<double> gradient) const;
  void fold_shared_followers(double sign, std::span<const double> external_force,
                             std::span<double> gradient) const;
  void add_own_components(Index point, const std::array<bool, 3>& follows,
                          std::vector<Dependence>& dependences) const;
  void move_images(std::span<double> displacement) const;

  const Points* body_;
  const Communicator* ranks_;
  int dimension_;
  Index points_;
  std::vector<Coordinates> handles_;
  std::array<Index, 3> period_{-1, -1, -1};
  std::vector<char> dependent_;
  std::vector<Follower> followers_;
  std::vector<SharedFollower> shared_;
  std::vector<RigidSet> rigid_;
  std::vector<Role> role_;  ///< per point
};

}  // namespace peristat
