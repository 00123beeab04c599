#include "assembly/terms/contact/obstacle_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

using Pressed = Obstacles::Pressed;
using Rubbing = Obstacles::Rubbing;

class ObstaclePasses : public TermPasses, BlockTangent {
 public:
  ObstaclePasses(const Obstacles& obstacles, int dimension)
      : obstacles_(obstacles), dimension_(std::size_t(dimension)) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::fill(gradient.begin(), gradient.end(), 0.0);
    Evaluation found;
    for_each(at, [&](const Pressed& contact) {
      found.energy += contact.energy();
      found.degenerate |= !contact.is_foreseen && !(contact.depth.relative < 1.0);
      found.round_off += contact.force() * round_off_of_place(at, contact.point);
      if (gradient.empty()) return;
      double* const own = &gradient[std::size_t(contact.point) * dimension_];
      for (std::size_t c = 0; c < dimension_; ++c) {
        own[c] -= contact.force() * contact.depth.change.gradient[c];
      }
    });
    for_each_rubbing(at, [&](const Rubbing& friction) {
      found.energy += friction.energy;
      if (gradient.empty()) return;
      double* const own = &gradient[std::size_t(friction.point) * dimension_];
      for (std::size_t c = 0; c < dimension_; ++c) own[c] -= friction.force[c];
    });
    return found;
  }

  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override {
    double dissipated = 0.0;
    if (obstacles_.rub()) {
      Obstacles::CommittedSlips now =
          obstacles_.committed(displacement, environment, history.slips());
      dissipated = now.dissipated;
      history.replace_slips(std::move(now.slips));
    }
    Evaluation found =
        this->gradient({displacement, history, Damage::grows, environment}, gradient, how);
    found.released += dissipated;
    return found;
  }

  [[nodiscard]] bool has_friction() const override { return obstacles_.rub(); }

  void stick(const StateView& at, History& history) override {
    if (obstacles_.rub()) {
      history.replace_slips(obstacles_.stuck(at.displacement, at.environment, history.slips()));
    }
  }

  std::array<double, 2> lag_friction(const StateView& at, const StateView& start,
                                     History& history) override {
    if (!obstacles_.rub()) return {};
    Obstacles::LaggedSlips now = obstacles_.lagged(
        at.displacement, at.environment, start.displacement, start.environment, history.slips());
    history.replace_slips(std::move(now.slips));
    return {now.change, now.largest};
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }

  void tangent(const StateView& at, Tangent& tangent, double projection, Write how) override {
    if (how == Write::over) tangent.clear();
    for_each_block(at, projection, [&](Index point, const Tensor& block) {
      double* const own = &tangent.diagonal[std::size_t(point) * dimension_ * dimension_];
      for (std::size_t r = 0; r < dimension_; ++r) {
        for (std::size_t c = 0; c < dimension_; ++c) own[r * dimension_ + c] += block[r][c];
      }
    });
  }

  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override {
    if (how == Write::over) std::fill(product.begin(), product.end(), 0.0);
    for_each_block(at, projection, [&](Index point, const Tensor& block) {
      const std::size_t first = std::size_t(point) * dimension_;
      for (std::size_t r = 0; r < dimension_; ++r) {
        for (std::size_t c = 0; c < dimension_; ++c) {
          product[first + r] += block[r][c] * v[first + c];
        }
      }
    });
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (how == Write::over) std::fill(energies.begin(), energies.end(), 0.0);
    for_each(at, [&](const Pressed& contact) {
      energies[std::size_t(contact.point)] += contact.energy();
    });
    for_each_rubbing(at, [&](const Rubbing& friction) {
      energies[std::size_t(friction.point)] += friction.energy;
    });
  }

  [[nodiscard]] bool has_contacts() const override { return true; }

  [[nodiscard]] std::vector<Index> closed_contacts(const StateView& at) override {
    std::vector<Index> closed;
    for_each(at, [&](const Pressed& contact) { closed.push_back(Index(contact.contact)); });
    return closed;
  }

  /// Points within nine tenths of the largest depth go no deeper, with a tenth of the way to spare.
  [[nodiscard]] double longest_step(const StateView& at, std::span<const double> step) override {
    constexpr double share_of_depth = 0.9, share_of_way = 0.9;
    // A point that has almost reached the limit must not stall the search, which itself rejects
    // states beyond the largest depth.
    constexpr double least = 1e-3;
    double longest = 1.0 / share_of_way;
    obstacles_.for_each_place(
        at.displacement, at.environment,
        [&](std::size_t c, const Obstacles::Obstacle& of, const Coordinates& place) {
          const double level = level_of(of, c, share_of_depth);
          longest = std::min(longest, of.surface.share_to_level(place, step_of(c, step), level));
        });
    return std::clamp(share_of_way * longest, least, 1.0);
  }

  [[nodiscard]] double largest_closing(const StateView& from, const StateView& to) override {
    double largest = 0.0;
    for_each_way(from, to,
                 [&](std::size_t c, const Obstacles::Obstacle& of, const Coordinates& before,
                     const Coordinates& step) {
                   const double level = level_of(of, c, 1.0),
                                gap = of.surface.distance(before) - level;
                   const double closed = level + gap - of.surface.distance(plus(before, step));
                   if (closed > 0.0) {
                     largest = std::max(largest, closed / std::max(gap, 1e-3 * level));
                   }
                 });
    return largest;
  }

  [[nodiscard]] bool has_passed(const StateView& from, const StateView& to) override {
    bool passed = false;
    for_each_way(from, to,
                 [&](std::size_t c, const Obstacles::Obstacle& of, const Coordinates& before,
                     const Coordinates& step) {
                   passed |= of.surface.least_distance_passed(before, step) < level_of(of, c, 1.0);
                 });
    return passed;
  }

  void add_contact_stiffness(const StateView& at, double most_depth,
                             std::span<double> stiffness) override {
    constexpr double after_a_fifth = 1.0 / (0.8 * 0.8);  // growth of b'' when a fifth is closed
    obstacles_.for_each_place(
        at.displacement, at.environment,
        [&](std::size_t c, const Obstacles::Obstacle& of, const Coordinates& place) {
          const Obstacles::Contact& contact = obstacles_.contacts()[c];
          const double distance = of.surface.distance(place);
          if (distance > 3.0 * contact.distance) return;  // more than a spacing apart
          const double depth = (contact.distance - distance) / (of.depth * contact.distance);
          const double bent = std::max(1.0, of.law(std::min(depth, most_depth)).second);
          for (std::size_t k = 0; k < dimension_; ++k) {
            stiffness[std::size_t(contact.point) * dimension_ + k] +=
                after_a_fifth * (bent + of.tangential) * contact.stiffness;
          }
        });
  }

  [[nodiscard]] double work_of_obstacles(const StateView& from, const StateView& to) override {
    return obstacles_.work(from.displacement, from.environment, from.history.slips(),
                           to.displacement, to.environment, to.history.slips());
  }

 private:
  template <class Visit>
  void for_each(const StateView& at, const Visit& visit) const {
    if (!at.has_contacts) return;
    obstacles_.for_each_pressed(at.displacement, at.foreseen, at.environment, visit);
  }

  template <class Visit>
  void for_each_rubbing(const StateView& at, const Visit& visit) const {
    if (!at.has_contacts) return;
    obstacles_.for_each_rubbing(at.displacement, at.environment, at.history.slips(), visit);
  }

  /// Calls visit(point, its block of the tangent) for every contact, and for its friction.
  template <class Visit>
  void for_each_block(const StateView& at, double projection, const Visit& visit) const {
    for_each(at,
             [&](const Pressed& contact) { visit(contact.point, block_of(contact, projection)); });
    for_each_rubbing(at, [&](const Rubbing& friction) {
      visit(friction.point, block_of(friction, projection));
    });
  }

  /// k (P - s y y^T / |y|^2), s = 1 where the contact slides. The projection takes its share of the
  /// second part away: where all points slide nothing else resists.
  [[nodiscard]] static Tensor block_of(const Rubbing& friction, double projection) {
    const double share = (1.0 - projection) * friction.sliding;
    Tensor block{};
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        block[r][c] =
            friction.stiffness * ((r == c ? 1.0 : 0.0) - friction.normal[r] * friction.normal[c] -
                                  share * friction.direction[r] * friction.direction[c]);
      }
    }
    return block;
  }

  /// Calls visit(number, obstacle, place, step of the place relative to the obstacle).
  template <class Visit>
  void for_each_way(const StateView& from, const StateView& to, const Visit& visit) const {
    std::vector<Coordinates> after;
    after.reserve(obstacles_.contacts().size());
    obstacles_.for_each_place(to.displacement, to.environment,
                              [&](std::size_t, const Obstacles::Obstacle&,
                                  const Coordinates& place) { after.push_back(place); });
    obstacles_.for_each_place(
        from.displacement, from.environment,
        [&](std::size_t c, const Obstacles::Obstacle& of, const Coordinates& before) {
          visit(c, of, before, minus(after[c], before));
        });
  }

  /// Round-off of a point's displacement, and so of its depth [m].
  [[nodiscard]] double round_off_of_place(const StateView& at, Index point) const {
    double largest = 0.0;
    for (std::size_t c = 0; c < dimension_; ++c) {
      largest = std::max(largest, std::abs(at.displacement[std::size_t(point) * dimension_ + c]));
    }
    return std::numeric_limits<double>::epsilon() * largest;
  }

  /// Distance from the obstacle at a share of the largest depth [m].
  [[nodiscard]] double level_of(const Obstacles::Obstacle& of, std::size_t contact,
                                double share) const {
    return (1.0 - share * of.depth) * obstacles_.contacts()[contact].distance;
  }

  [[nodiscard]] Coordinates step_of(std::size_t contact, std::span<const double> step) const {
    const auto point = std::size_t(obstacles_.contacts()[contact].point);
    Coordinates own{};
    for (std::size_t c = 0; c < dimension_; ++c) own[c] = step[point * dimension_ + c];
    return own;
  }

  /// k b'' n n^T - f d2(phi)/dx2; the second part is negative for convex obstacles, and the
  /// projection takes its share away. A foreseen contact has no more of it than a depth that the
  /// body can bear would give.
  [[nodiscard]] static Tensor block_of(const Pressed& contact, double projection) {
    const RigidSurface::Distance& distance = contact.depth.change;
    double force = contact.force();
    if (contact.is_foreseen) {
      force = std::clamp(force, 0.0, contact.stiffness * contact.scale);
    }
    if (distance.curvature > 0.0) force *= 1.0 - projection;
    Tensor block = contact.obstacle.surface.second_derivative(distance);
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        block[r][c] =
            contact.stiffness * contact.law.second * distance.gradient[r] * distance.gradient[c] -
            force * block[r][c];
      }
    }
    return block;
  }

  const Obstacles& obstacles_;
  std::size_t dimension_;
};

}  // namespace

double ObstacleTerm::stored_bytes() const {
  return SpringTerm::stored_bytes() +
         double(obstacles_.contacts().size() * (sizeof(Obstacles::Contact) + sizeof(Coordinates)));
}

std::unique_ptr<TermPasses> ObstacleTerm::passes(const TermSetting& setting) const {
  return std::make_unique<ObstaclePasses>(obstacles_, setting.points.dimension);
}

}  // namespace peristat
