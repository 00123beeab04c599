#include "src/constraints/constraints.hpp"

#include <stdexcept>
#include <utility>

#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

constexpr std::array<bool, 3> all_components{true, true, true};

Tensor scaled_unit(double factor) {
  Tensor block{};
  for (std::size_t c = 0; c < 3; ++c) block[c][c] = factor;
  return block;
}

}  // namespace

Constraints::Constraints(const Points& points)
    : body_(&points),
      dimension_(points.dimension),
      points_(points.count()),
      dependent_(points.reference.size(), 0),
      role_(std::size_t(points.count())) {
  for (Index i = points.own(); i < points_; ++i) {
    give_role(i, {Role::Kind::image, 0}, all_components);
  }
  for (int axis = 0; axis < dimension_; ++axis) {
    for (const ImageKind& kind : points.images.kinds) {
      if (kind.periods[std::size_t(axis)] == 0 || period_[std::size_t(axis)] >= 0) continue;
      period_[std::size_t(axis)] = add_handle({});
    }
  }
}

Index Constraints::add_handle(const Coordinates& place) {
  handles_.push_back(place);
  dependent_.resize(dofs(), 0);
  return rows() - 1;
}

void Constraints::give_role(Index point, Role role, const std::array<bool, 3>& follows) {
  if (!stands_alone(point)) throw std::logic_error("a point can follow in one way only");
  role_[std::size_t(point)] = role;
  for (int c = 0; c < dimension_; ++c) {
    dependent_[dof(point, c)] = static_cast<char>(follows[std::size_t(c)]);
  }
}

void Constraints::follow(Index point, const std::array<bool, 3>& follows,
                         std::vector<Dependence> masters) {
  give_role(point, {Role::Kind::follower, static_cast<Index>(followers_.size())}, follows);
  followers_.push_back({point, follows, std::move(masters)});
}

void Constraints::follow(RigidSet set) {
  for (const Index member : set.members) {
    give_role(member, {Role::Kind::rigid, static_cast<Index>(rigid_.size())}, all_components);
  }
  rigid_.push_back(std::move(set));
}

Coordinates Constraints::rotation(const RigidSet& set, std::span<const double> displacement) const {
  Coordinates theta{};
  for (int c = 0; dimension_ == 3 && c < 3; ++c) {
    theta[std::size_t(c)] = displacement[dof(set.rotation, c)] / set.size;
  }
  if (dimension_ == 2) theta[2] = displacement[dof(set.rotation)] / set.size;
  return theta;
}

Coordinates Constraints::arm(const RigidSet& set, Index member) const {
  return minus<3>(body_->position(member), set.centre);
}

Coordinates Constraints::moved_by(const std::vector<Dependence>& masters,
                                  std::span<const double> displacement) const {
  Coordinates sum{};
  for (const Dependence& on : masters) {
    for (int r = 0; r < dimension_; ++r) {
      for (int c = 0; c < dimension_; ++c) {
        sum[std::size_t(r)] +=
            on.block[std::size_t(r)][std::size_t(c)] * displacement[dof(on.master, c)];
      }
    }
  }
  return sum;
}

void Constraints::move_followers(std::span<double> displacement) const {
  for (const Follower& follower : followers_) {
    const Coordinates moved = moved_by(follower.masters, displacement);
    for (int c = 0; c < dimension_; ++c) {
      if (follower.follows[std::size_t(c)]) {
        displacement[dof(follower.point, c)] = moved[std::size_t(c)];
      }
    }
  }
}

void Constraints::move(std::span<double> displacement) const {
  move_followers(displacement);
  for (const RigidSet& set : rigid_) {
    const Rotation turned(rotation(set, displacement));
    for (const Index member : set.members) {
      const Coordinates moved = turned.moved(arm(set, member));
      for (int c = 0; c < dimension_; ++c) {
        displacement[dof(member, c)] =
            displacement[dof(set.translation, c)] + moved[std::size_t(c)];
      }
    }
  }
  move_images(displacement);
}

void Constraints::extend(std::span<const double> displacement, std::span<double> rate) const {
  move_followers(rate);
  for (const RigidSet& set : rigid_) {
    const Rotation turned(rotation(set, displacement));
    for (const Index member : set.members) {
      const Coordinates moved = moved_by(of_rigid(set, turned, member), rate);
      for (int c = 0; c < dimension_; ++c) rate[dof(member, c)] = moved[std::size_t(c)];
    }
  }
  move_images(rate);
}

void Constraints::move_images(std::span<double> displacement) const {
  for (Index image = body_->own(); image < points_; ++image) {
    const ImageKind& kind = body_->image_kind(image);
    const Index source = body_->source(image);
    for (int c = 0; c < dimension_; ++c) {
      double moved = kind.mirror[std::size_t(c)] * displacement[dof(source, c)];
      for (int axis = 0; axis < dimension_; ++axis) {
        const int periods = kind.periods[std::size_t(axis)];
        if (periods != 0) moved += periods * displacement[dof(period_handle(axis), c)];
      }
      displacement[dof(image, c)] = moved;
    }
  }
}

void Constraints::fold_images(std::span<double> force) const {
  for (Index image = body_->own(); image < points_; ++image) {
    const ImageKind& kind = body_->image_kind(image);
    const Index source = body_->source(image);
    for (int c = 0; c < dimension_; ++c) {
      const double of_image = force[dof(image, c)];
      force[dof(source, c)] += kind.mirror[std::size_t(c)] * of_image;
      for (int axis = 0; axis < dimension_; ++axis) {
        const int periods = kind.periods[std::size_t(axis)];
        if (periods != 0) force[dof(period_handle(axis), c)] += periods * of_image;
      }
    }
  }
}

void Constraints::fold_point(Index point, const std::vector<Dependence>& masters, double sign,
                             std::span<const double> external_force,
                             std::span<double> gradient) const {
  for (const Dependence& on : masters) {
    for (int c = 0; c < dimension_; ++c) {
      double sum = 0.0;
      for (int r = 0; r < dimension_; ++r) {
        sum += on.block[std::size_t(r)][std::size_t(c)] *
               (gradient[dof(point, r)] - external_force[dof(point, r)]);
      }
      gradient[dof(on.master, c)] += sign * sum;
    }
  }
}

void Constraints::unfold(std::span<const double> external_force, std::span<double> gradient) const {
  for (const Follower& follower : followers_) {
    fold_point(follower.point, follower.masters, -1.0, external_force, gradient);
  }
}

void Constraints::fold(std::span<const double> displacement, std::span<const double> external_force,
                       std::span<double> gradient) const {
  for (std::size_t k = dof(points_); k < dofs(); ++k) gradient[k] = 0.0;
  fold_images(gradient);
  for (const Follower& follower : followers_) {
    fold_point(follower.point, follower.masters, 1.0, external_force, gradient);
  }
  for (const RigidSet& set : rigid_) {
    const Rotation turned(rotation(set, displacement));
    for (const Index member : set.members)
      fold_point(member, of_rigid(set, turned, member), 1.0, external_force, gradient);
  }
}

std::vector<Dependence> Constraints::of_rigid(const RigidSet& set, const Rotation& turned,
                                              Index member) const {
  const std::array<Coordinates, 3> rates = turned.rates(arm(set, member));
  Dependence on_rotation{set.rotation, {}};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t k = 0; dimension_ == 3 && k < 3; ++k) {
      on_rotation.block[r][k] = rates[k][r] / set.size;
    }
    if (dimension_ == 2) on_rotation.block[r][0] = rates[2][r] / set.size;
  }
  return {{set.translation, scaled_unit(1.0)}, on_rotation};
}

std::vector<Dependence> Constraints::dependences(Index point,
                                                 std::span<const double> displacement) const {
  if (stands_alone(point)) return {{point, scaled_unit(1.0)}};
  const Role role = role_[std::size_t(point)];
  if (role.kind == Role::Kind::rigid) {
    const RigidSet& set = rigid_[std::size_t(role.number)];
    return of_rigid(set, Rotation(rotation(set, displacement)), point);
  }
  if (role.kind == Role::Kind::follower) {
    const Follower& follower = followers_[std::size_t(role.number)];
    std::vector<Dependence> result = follower.masters;
    Dependence own{point, {}};
    bool is_own = false;
    for (std::size_t c = 0; c < std::size_t(dimension_); ++c) {
      if (follower.follows[c]) continue;
      own.block[c][c] = 1.0;
      is_own = true;
    }
    if (is_own) result.push_back(own);
    return result;
  }
  const ImageKind& kind = body_->image_kind(point);
  std::vector<Dependence> result = dependences(body_->source(point), displacement);
  for (Dependence& on : result) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (double& entry : on.block[r]) entry *= kind.mirror[r];
    }
  }
  for (int axis = 0; axis < dimension_; ++axis) {
    const int periods = kind.periods[std::size_t(axis)];
    if (periods != 0) result.push_back({period_handle(axis), scaled_unit(periods)});
  }
  return result;
}

std::vector<Tensor> Constraints::curvature(std::span<const double> displacement,
                                           std::span<const double> external_force,
                                           std::span<const double> gradient) const {
  std::vector<Tensor> blocks;
  for (const RigidSet& set : rigid_) {
    Tensor moment{};
    for (const Index member : set.members) {
      const Coordinates from_centre = arm(set, member);
      for (int r = 0; r < dimension_; ++r) {
        const double force = gradient[dof(member, r)] - external_force[dof(member, r)];
        for (std::size_t c = 0; c < 3; ++c) moment[std::size_t(r)][c] += force * from_centre[c];
      }
    }
    Tensor block = Rotation(rotation(set, displacement)).curvature(moment);
    if (dimension_ == 2) block = {{{block[2][2], 0.0, 0.0}, {}, {}}};
    for (auto& row : block) {
      for (double& entry : row) entry /= set.size * set.size;
    }
    blocks.push_back(block);
  }
  return blocks;
}

}  // namespace peristat
