#include "assembly/terms/contact/obstacle_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "assembly/terms/contact/contact_rows.hpp"
#include "src/core/coordinates.hpp"

namespace peristat {
namespace {

using Pressed = Obstacles::Pressed;
using Rubbing = Obstacles::Rubbing;

/// Points that press on an obstacle that a force drives, with what its motion adds to the forces on
/// them.
struct DrivenTogether {
  std::vector<Index> points;
  std::vector<Coordinates> stiffness;  ///< B e of each [N/m]
  double whole = 0.0;                  ///< sum of e.B e [N/m]
};

class ObstaclePasses : public TermPasses, BlockTangent {
 public:
  ObstaclePasses(const Obstacles& obstacles, const TermSetting& setting)
      : obstacles_(obstacles),
        pattern_(setting.pattern),
        dimension_(std::size_t(setting.points.dimension)),
        coupled_(obstacles.all().size()),
        rows_(setting.points.count()) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::fill(gradient.begin(), gradient.end(), 0.0);
    Evaluation found;
    const Obstacles::Driving driving = for_each(at, [&](const Pressed& contact) {
      found.energy += contact.energy();
      found.degenerate |= !contact.is_foreseen && !(contact.depth.relative < 1.0);
      found.round_off += contact.force() * round_off_of_place(at, contact.point);
      if (gradient.empty()) return;
      double* const own = &gradient[std::size_t(contact.point) * dimension_];
      for (std::size_t c = 0; c < dimension_; ++c) {
        own[c] -= contact.force() * contact.depth.change.gradient[c];
      }
    });
    found.round_off += driving.round_off;
    found.degenerate |= !driving.is_borne;
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
    for_each_driven(at, projection, [&](const DrivenTogether& driven) { add(driven, tangent); });
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
    for_each_driven(at, projection, [&](const DrivenTogether& driven) {
      double force = 0.0;
      for_each_entry(driven, [&](std::size_t dof, double entry) { force += entry * v[dof]; });
      for_each_entry(driven, [&](std::size_t dof, double entry) {
        product[dof] -= entry * force / driven.whole;
      });
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
          if (of.free_axis) return;  // it gives way until the points bear its force
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

  /// Points that press on the same driven obstacle. A predictor, which begins a search, looks anew,
  /// so that what follows does not depend on earlier searches.
  std::optional<Couplings> contact_couplings(const StateView& at) override {
    if (!obstacles_.are_driven()) return std::nullopt;
    bool are_covered = at.foreseen.empty();
    if (!are_covered) coupled_.assign(coupled_.size(), {});
    for_each(at, [&](const Pressed& contact) {
      if (!contact.obstacle.free_axis) return;
      std::vector<Index>& of = coupled_[std::size_t(&contact.obstacle - obstacles_.all().data())];
      const auto next = std::ranges::lower_bound(of, contact.point);
      if (next != of.end() && *next == contact.point) return;
      of.insert(next, contact.point);
      are_covered = false;
    });
    if (!are_covered) take_rows();
    return rows_.couplings();
  }

  [[nodiscard]] double work_of_obstacles(const StateView& from, const StateView& to) override {
    return obstacles_.work(from.displacement, from.environment, from.history.slips(),
                           to.displacement, to.environment, to.history.slips());
  }

 private:
  template <class Visit>
  Obstacles::Driving for_each(const StateView& at, const Visit& visit) const {
    if (!at.has_contacts) return {};
    return obstacles_.for_each_pressed(at.displacement, at.foreseen, at.environment, visit);
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

  /// Calls visit(DrivenTogether) for every obstacle that a force drives and points press on.
  template <class Visit>
  void for_each_driven(const StateView& at, double projection, const Visit& visit) const {
    if (!obstacles_.are_driven()) return;
    std::vector<DrivenTogether> all(obstacles_.all().size());
    for_each(at, [&](const Pressed& contact) {
      const auto& axis = contact.obstacle.free_axis;
      if (!axis) return;
      DrivenTogether& of = all[std::size_t(&contact.obstacle - obstacles_.all().data())];
      const Tensor block = block_of(contact, projection);
      of.points.push_back(contact.point);
      of.stiffness.push_back({block[0][*axis], block[1][*axis], block[2][*axis]});
      of.whole += block[*axis][*axis];
    });
    for (const DrivenTogether& of : all) {
      if (of.whole > 0.0) visit(of);
    }
  }

  template <class Visit>
  void for_each_entry(const DrivenTogether& driven, const Visit& visit) const {
    for (std::size_t k = 0; k < driven.points.size(); ++k) {
      for (std::size_t c = 0; c < dimension_; ++c) {
        visit(std::size_t(driven.points[k]) * dimension_ + c, driven.stiffness[k][c]);
      }
    }
  }

  /// Adds the second part of d2E/du2, see Obstacles.
  void add(const DrivenTogether& driven, Tangent& tangent) const {
    std::vector<double> block(dimension_ * dimension_);
    for (std::size_t a = 0; a < driven.points.size(); ++a) {
      for (std::size_t b = a; b < driven.points.size(); ++b) {
        const bool is_ordered = driven.points[a] <= driven.points[b];
        const std::size_t one = is_ordered ? a : b, other = is_ordered ? b : a;
        const Index i = driven.points[one], j = driven.points[other];
        for (std::size_t r = 0; r < dimension_; ++r) {
          for (std::size_t c = 0; c < dimension_; ++c) {
            block[r * dimension_ + c] =
                -driven.stiffness[one][r] * driven.stiffness[other][c] / driven.whole;
          }
        }
        if (i != j) {
          tangent.add_to_block(place_of_contact(pattern_, i, j), block);
          continue;
        }
        double* const own = &tangent.diagonal[std::size_t(i) * block.size()];
        for (std::size_t k = 0; k < block.size(); ++k) own[k] += block[k];
      }
    }
  }

  /// Rows of contact_couplings from the points that are coupled.
  void take_rows() {
    std::vector<ContactRows::Pair> pairs;
    for (const std::vector<Index>& of : coupled_) {
      for (std::size_t a = 0; a < of.size(); ++a) {
        for (std::size_t b = a + 1; b < of.size(); ++b) pairs.emplace_back(of[a], of[b]);
      }
    }
    rows_.take(std::move(pairs));
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

  /// Calls visit(number, obstacle, place, step of the place relative to the obstacle). Forces act
  /// as in the end: what they do at once is no way of the body.
  template <class Visit>
  void for_each_way(const StateView& from, const StateView& to, const Visit& visit) const {
    std::vector<Coordinates> after;
    after.reserve(obstacles_.contacts().size());
    obstacles_.for_each_place(to.displacement, to.environment,
                              [&](std::size_t, const Obstacles::Obstacle&,
                                  const Coordinates& place) { after.push_back(place); });
    obstacles_.for_each_place(
        from.displacement, obstacles_.under_forces_of(to.environment, from.environment),
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
  const BlockPattern& pattern_;
  std::size_t dimension_;
  std::vector<std::vector<Index>> coupled_;  // per obstacle, ascending
  ContactRows rows_;                         // of contact_couplings
};

}  // namespace

double ObstacleTerm::stored_bytes() const {
  return SpringTerm::stored_bytes() +
         double(obstacles_.contacts().size() * (sizeof(Obstacles::Contact) + sizeof(Coordinates)));
}

bool ObstacleTerm::has_symmetric_blocks() const {
  return std::ranges::none_of(obstacles_.all(), [](const Obstacles::Obstacle& of) {
    return of.free_axis && of.surface.kind != RigidSurface::Kind::plane;
  });
}

std::unique_ptr<TermPasses> ObstacleTerm::passes(const TermSetting& setting) const {
  return std::make_unique<ObstaclePasses>(obstacles_, setting);
}

}  // namespace peristat
