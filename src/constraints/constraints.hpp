#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/constraints/rotation.hpp"
#include "src/core/types.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Part of a follower's displacement: `block` (row major, in the corner of 3 x 3) times the
/// displacement of another point or handle, its master.
struct Dependence {
  Index master = 0;
  Tensor block{};
};

/// Master-slave elimination of degrees of freedom that follow others:
///
///   u = phi(q),   R_q = J^T (f - dE/du),   K_q = J^T K J + (dE/du - f) . d2 phi / dq2
///
/// with J = d phi / dq, so that the tangent keeps its symmetry and, where it had it, its
/// definiteness. After the body's points arrays have one more entry of `dimension` numbers per
/// handle: a generalised degree of freedom that belongs to no point, such as the rotation of a
/// rigid set.
///
/// A dependent component is a function of independent ones, with one exception: images follow
/// sources that may themselves follow.
///
/// For a part of a body all ranks have the same handles, which rank 0 owns. If followers have
/// masters on several ranks, functions that move, extend, fold, unfold or share out are collective.
class Constraints {
 public:
  /// Constraints of the points' images alone. Each period has a handle, the jump of the
  /// displacement across it [m].
  /// @param ranks that have parts of the body; they outlive it
  explicit Constraints(const Points& points, const Communicator& ranks = sole_rank());

  /// True without constraints. The same on all ranks, which have all handles and kinds of images.
  [[nodiscard]] bool none() const {
    const Images& images = body_->images;
    if (body_->owned) return handles_.empty() && images.kinds.empty();
    return followers_.empty() && rigid_.empty() && images.source.empty();
  }

  /// True if points follow others directly, as for rollers and linear constraints: not as images or
  /// in rigid sets. For a part of a body: those on this rank, and the shared followers of all
  /// ranks.
  [[nodiscard]] bool couples_points() const { return !followers_.empty() || !shared_.empty(); }

  /// Number of points and handles.
  [[nodiscard]] Index rows() const { return points_ + static_cast<Index>(handles_.size()); }
  [[nodiscard]] std::size_t dofs() const { return std::size_t(rows()) * std::size_t(dimension_); }
  /// Places of the handles [m].
  [[nodiscard]] const std::vector<Coordinates>& handles() const { return handles_; }
  /// Handle of the period across an axis; -1: none.
  [[nodiscard]] Index period_handle(int axis) const { return period_[std::size_t(axis)]; }
  /// Per degree of freedom, handles included: 1 where it follows others.
  [[nodiscard]] const std::vector<char>& dependent() const { return dependent_; }

  Index add_handle(const Coordinates& place);

  /// Makes components of a point follow masters.
  /// @param follows per component
  /// @param masters whose rows of other components are zero
  /// @throws std::logic_error if one of them follows already
  void follow(Index point, const std::array<bool, 3>& follows, std::vector<Dependence> masters);

  /// A follower with masters on several ranks, as each of them knows it.
  struct SharedFollower {
    std::optional<Index> point;  ///< nothing: it is not on this rank
    std::array<bool, 3> follows;
    std::vector<Dependence> masters;  ///< that this rank owns
  };
  /// Makes components of a point follow masters of several ranks. Collective, in the same order on
  /// all ranks.
  /// @throws std::logic_error if one of them follows already
  void follow(SharedFollower follower);

  [[nodiscard]] const std::vector<SharedFollower>& shared_followers() const { return shared_; }

  /// Dependence of a point, or of an image of it, on a shared follower.
  struct SharedDependence {
    std::size_t follower;  ///< its number in shared_followers()
    Coordinates factor;    ///< per component: ±1 (an image's mirror), or 0 if it does not follow
  };
  [[nodiscard]] std::optional<SharedDependence> shared_dependence(Index point) const;

  /// Makes points follow a rigid motion about a centre: u = c + (R(theta) - I)(X - centre), c the
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

  /// Sets the displacements of all followers.
  void move(std::span<double> displacement) const;

  /// Distributes the change of handles since `from` over all points in a follower's equation, in
  /// proportion to their coefficients, instead of leaving it to the follower alone: where a mean of
  /// many points is prescribed, one point would jump by as many times the mean's change.
  /// @param stays per degree of freedom: it takes no share
  void share_out_jump(std::span<const double> from, std::span<const char> stays,
                      std::span<double> displacement) const;

  /// Extends a rate of displacements to the followers: J times that of their masters.
  void extend(std::span<const double> displacement, std::span<double> rate) const;

  /// Reduces derivatives by all displacements to those by the independent ones: adds J^T (dE/du -
  /// f) of followers to the gradient's entries of their masters. Entries of followers keep the
  /// whole force that acts there.
  void fold(std::span<const double> displacement, std::span<const double> external_force,
            std::span<double> gradient) const;

  /// Recovers internal forces from a folded gradient where points follow others directly; forces on
  /// images stay with their sources.
  void unfold(std::span<const double> external_force, std::span<double> gradient) const;

  /// Adds forces on images to their sources and the jumps over periods.
  void fold_images(std::span<double> force) const;

  /// The rows of J of a point: itself in components that do not follow, and its masters, without
  /// those of shared_dependence.
  [[nodiscard]] std::vector<Dependence> dependences(Index point,
                                                    std::span<const double> displacement) const;
  /// True if a point or handle follows nothing.
  [[nodiscard]] bool stands_alone(Index row) const {
    return row >= points_ || role_[std::size_t(row)].kind == Role::Kind::alone;
  }

  /// Contribution of the curvature of phi to K_q: for each rigid set the block of its rotation
  /// [N/m].
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
