#include "src/constraints/constraints.hpp"

#include <stdexcept>
#include <utility>

#include "src/measures/small_algebra.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

constexpr std::array<bool, 3> all_components{true, true, true};

Tensor scaled_unit(double factor) {
  Tensor block{};
  for (std::size_t c = 0; c < 3; ++c) block[c][c] = factor;
  return block;
}

}  // namespace

Constraints::Constraints(const Points& points, const Communicator& ranks)
    : body_(&points),
      ranks_(&ranks),
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
  if (!stands_alone(point)) throw std::logic_error("a point can follow only one constraint");
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

void Constraints::follow(SharedFollower follower) {
  if (ranks_->count() == 1) {
    return follow(follower.point.value(), follower.follows, std::move(follower.masters));
  }
  if (follower.point) {
    give_role(*follower.point, {Role::Kind::shared, static_cast<Index>(shared_.size())},
              follower.follows);
  }
  shared_.push_back(std::move(follower));
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
  if (!shared_.empty()) move_shared_followers(displacement);
}

void Constraints::move_shared_followers(std::span<double> displacement) const {
  std::vector<double> moved;
  for (const SharedFollower& follower : shared_) {
    const Coordinates mine = moved_by(follower.masters, displacement);
    moved.insert(moved.end(), mine.begin(), mine.end());
  }
  add_up(*ranks_, moved);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    const auto& [point, follows, masters] = shared_[k];
    for (int c = 0; point && c < dimension_; ++c) {
      const auto component = std::size_t(c);
      if (follows[component]) displacement[dof(*point, c)] = moved[3 * k + component];
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

void Constraints::share_out_jump(std::span<const double> from, std::span<const char> stays,
                                 std::span<double> displacement) const {
  const auto for_each = [&](const Follower& follower, std::size_t component, const auto& visit) {
    for (const Dependence& on : follower.masters) {
      for (int c = 0; c < dimension_; ++c) {
        visit(on.master, dof(on.master, c), on.block[component][std::size_t(c)]);
      }
    }
  };
  for (const Follower& follower : followers_) {
    for (std::size_t component = 0; component < std::size_t(dimension_); ++component) {
      if (!follower.follows[component]) continue;
      double jump = 0.0, squares = 1.0;
      for_each(follower, component, [&](Index master, std::size_t at, double coefficient) {
        if (master >= points_) {
          jump += coefficient * (displacement[at] - from[at]);
        } else if (!stays[at]) {
          squares += coefficient * coefficient;
        }
      });
      if (jump == 0.0) continue;
      for_each(follower, component, [&](Index master, std::size_t at, double coefficient) {
        if (master < points_ && !stays[at]) displacement[at] -= coefficient * jump / squares;
      });
    }
  }
  if (!shared_.empty()) share_out_among_ranks(from, stays, displacement);
}

void Constraints::share_out_among_ranks(std::span<const double> from, std::span<const char> stays,
                                        std::span<double> displacement) const {
  const auto for_each = [&](const auto& visit) {
    for (std::size_t k = 0; k < shared_.size(); ++k) {
      for (const Dependence& on : shared_[k].masters) {
        for (int r = 0; r < dimension_; ++r) {
          for (int c = 0; c < dimension_; ++c) {
            visit(3 * k + std::size_t(r), on.master, dof(on.master, c),
                  on.block[std::size_t(r)][std::size_t(c)]);
          }
        }
      }
    }
  };
  std::vector<double> jump(3 * shared_.size(), 0.0), squares = jump;
  for_each([&](std::size_t row, Index master, std::size_t at, double coefficient) {
    if (master >= points_) {
      jump[row] += coefficient * (displacement[at] - from[at]);
    } else if (!stays[at]) {
      squares[row] += coefficient * coefficient;
    }
  });
  add_up(*ranks_, jump);
  add_up(*ranks_, squares);
  for_each([&](std::size_t row, Index master, std::size_t at, double coefficient) {
    if (master < points_ && !stays[at]) {
      displacement[at] -= coefficient * jump[row] / (1.0 + squares[row]);
    }
  });
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

Coordinates Constraints::unbalanced(Index point, std::span<const double> external_force,
                                    std::span<const double> gradient) const {
  Coordinates force{};
  for (int c = 0; c < dimension_; ++c) {
    force[std::size_t(c)] = gradient[dof(point, c)] - external_force[dof(point, c)];
  }
  return force;
}

void Constraints::fold_point(const Coordinates& force, const std::vector<Dependence>& masters,
                             double sign, std::span<double> gradient) const {
  for (const Dependence& on : masters) {
    for (int c = 0; c < dimension_; ++c) {
      double sum = 0.0;
      for (int r = 0; r < dimension_; ++r) {
        sum += on.block[std::size_t(r)][std::size_t(c)] * force[std::size_t(r)];
      }
      gradient[dof(on.master, c)] += sign * sum;
    }
  }
}

void Constraints::fold_shared_followers(double sign, std::span<const double> external_force,
                                        std::span<double> gradient) const {
  std::vector<double> forces;
  for (const SharedFollower& follower : shared_) {
    Coordinates force{};
    if (follower.point && body_->owns(*follower.point)) {
      force = unbalanced(*follower.point, external_force, gradient);
    }
    forces.insert(forces.end(), force.begin(), force.end());
  }
  add_up(*ranks_, forces);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    fold_point({forces[3 * k], forces[3 * k + 1], forces[3 * k + 2]}, shared_[k].masters, sign,
               gradient);
  }
}

void Constraints::unfold(std::span<const double> external_force, std::span<double> gradient) const {
  for (const Follower& follower : followers_) {
    fold_point(unbalanced(follower.point, external_force, gradient), follower.masters, -1.0,
               gradient);
  }
  if (!shared_.empty()) fold_shared_followers(-1.0, external_force, gradient);
}

void Constraints::fold(std::span<const double> displacement, std::span<const double> external_force,
                       std::span<double> gradient) const {
  for (std::size_t k = dof(points_); k < dofs(); ++k) gradient[k] = 0.0;
  fold_images(gradient);
  for (const Follower& follower : followers_) {
    fold_point(unbalanced(follower.point, external_force, gradient), follower.masters, 1.0,
               gradient);
  }
  if (!shared_.empty()) fold_shared_followers(1.0, external_force, gradient);
  for (const RigidSet& set : rigid_) {
    const Rotation turned(rotation(set, displacement));
    for (const Index member : set.members) {
      fold_point(unbalanced(member, external_force, gradient), of_rigid(set, turned, member), 1.0,
                 gradient);
    }
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

void Constraints::add_own_components(Index point, const std::array<bool, 3>& follows,
                                     std::vector<Dependence>& dependences) const {
  Dependence own{point, {}};
  bool is_own = false;
  for (std::size_t c = 0; c < std::size_t(dimension_); ++c) {
    if (follows[c]) continue;
    own.block[c][c] = 1.0;
    is_own = true;
  }
  if (is_own) dependences.push_back(own);
}

std::optional<Constraints::SharedDependence> Constraints::shared_dependence(Index point) const {
  const Role role = role_[std::size_t(body_->source(point))];
  if (role.kind != Role::Kind::shared) return std::nullopt;
  const auto number = std::size_t(role.number);
  SharedDependence on{number, {}};
  for (std::size_t c = 0; c < std::size_t(dimension_); ++c) {
    const double mirror = body_->is_image(point) ? body_->image_kind(point).mirror[c] : 1.0;
    if (shared_[number].follows[c]) on.factor[c] = mirror;
  }
  return on;
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
    add_own_components(point, follower.follows, result);
    return result;
  }
  if (role.kind == Role::Kind::shared) {
    std::vector<Dependence> result;
    add_own_components(point, shared_[std::size_t(role.number)].follows, result);
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
