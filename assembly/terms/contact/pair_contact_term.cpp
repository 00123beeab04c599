#include "assembly/terms/contact/pair_contact_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "assembly/terms/contact/contact_cover.hpp"
#include "assembly/terms/contact/contact_limits.hpp"
#include "assembly/terms/contact/contact_rows.hpp"
#include "assembly/terms/contact/near_pairs.hpp"
#include "assembly/terms/contact/point_friction.hpp"
#include "assembly/terms/contact/swept_pairs.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// How two points stand to each other.
struct Gap {
  double distance = 0.0;   ///< r [m]
  Coordinates normal{};    ///< from i to j
  double overlap = 0.0;    ///< d - r [m]
  double round_off = 0.0;  ///< of that [m]
};

/// A contact at a state.
struct TouchingPair {
  const ContactPair& pair;
  Gap gap{};
  double share = 1.0;        ///< 1 - T
  double depth = 0.0;        ///< x
  double energy = 0.0;       ///< [J]
  double force = 0.0;        ///< that presses [N]; below 0 only where it is foreseen
  double stiffness = 0.0;    ///< along the normal [N/m]
  bool is_foreseen = false;  ///< a spring of a predictor
};

class PairContactPasses : public TermPasses, BlockTangent {
 public:
  PairContactPasses(const PairContactTerm& term, const TermSetting& setting)
      : pairs_(term.contacts().pairs),
        points_(setting.points),
        pattern_(setting.pattern),
        near_(pairs_, term.contacts().faces, setting.model, setting.workspace.threads()),
        near_foreseen_(pairs_, term.contacts().faces, setting.model, setting.workspace.threads()),
        cover_(points_, setting.index_map, pairs_.reach(), 4.0 * pairs_.skin()),
        friction_(points_.dimension),
        rows_(points_.count()),
        rubs_(std::ranges::any_of(pairs_.rules(),
                                  [](const auto& rule) { return rule.friction > 0.0; })) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::ranges::fill(gradient, 0.0);
    Evaluation found;
    if (at.has_contacts && !cover_.holds(at.displacement)) {
      // Explicit steps look at the forces alone.
      if (!gradient.empty()) gradient[0] = std::numeric_limits<double>::quiet_NaN();
      found.degenerate = true;
      return found;
    }
    found.degenerate = !for_each_touching(at, [&](const TouchingPair& contact) {
      found.energy += contact.energy;
      found.round_off += std::abs(contact.force) * contact.gap.round_off;
      found.degenerate |= !contact.is_foreseen && !(contact.depth < 1.0);
      if (!gradient.empty()) add(contact, contact.force, gradient);
    }) || found.degenerate;
    for_each_rubbing(at, [&](const PointFriction::Rubbing& rubbing) {
      found.energy += rubbing.energy;
      found.round_off += rubbing.round_off;
      for (std::size_t c = 0; c < std::size_t(points_.dimension) && !gradient.empty(); ++c) {
        gradient[place_of(rubbing.slip.point) + c] -= rubbing.force[c];
        gradient[place_of(partner(rubbing)) + c] += rubbing.force[c];
      }
    });
    return found;
  }

  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override {
    double dissipated = 0.0;
    const StateView at(displacement, history, Damage::grows, environment);
    if (rubs_ && is_finite_at(points_, displacement)) {
      PointFriction::Committed now =
          friction_.committed(history.slips(Rub::pairs), presses(at), displacement);
      dissipated = now.dissipated;
      history.replace_slips(std::move(now.slips), Rub::pairs);
    }
    Evaluation found = this->gradient(at, gradient, how);
    found.released += dissipated;
    return found;
  }

  [[nodiscard]] bool has_friction() const override { return rubs_; }

  void stick(const StateView& at, History& history) override {
    if (!rubs_) return;
    StateView touches = at;  // as a predictor sees them: contacts at rest count
    touches.foreseen = at.displacement;
    history.replace_slips(
        friction_.stuck(history.slips(Rub::pairs), presses(touches), at.displacement), Rub::pairs);
  }

  std::array<double, 2> lag_friction(const StateView& at, const StateView& start,
                                     History& history) override {
    if (!rubs_ || !is_finite_at(points_, at.displacement)) return {};
    PointFriction::Lagged now = friction_.lagged(history.slips(Rub::pairs), presses(at),
                                                 at.displacement, start.displacement);
    history.replace_slips(std::move(now.slips), Rub::pairs);
    return {now.change, now.largest};
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }

  /// Projection drops the pull across the normal, -f / r.
  void tangent(const StateView& at, Tangent& tangent, double projection, Write how) override {
    if (how == Write::over) tangent.clear();
    const auto d = std::size_t(points_.dimension);
    std::vector<double> block(d * d);
    for_each_touching(at, [&](const TouchingPair& contact) {
      const double across = stiffness_across(contact, projection);
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          const double along = contact.gap.normal[r] * contact.gap.normal[c];
          const double entry = contact.stiffness * along + across * ((r == c ? 1.0 : 0.0) - along);
          block[r * d + c] = -entry;
          tangent.diagonal[std::size_t(contact.pair.i) * d * d + r * d + c] += entry;
          tangent.diagonal[std::size_t(contact.pair.j) * d * d + r * d + c] += entry;
        }
      }
      tangent.add_to_block(place_of_contact(pattern_, contact.pair.i, contact.pair.j), block);
    });
    for_each_rubbing(at, [&](const PointFriction::Rubbing& rubbing) {
      const Index i = std::min(rubbing.slip.point, partner(rubbing)),
                  j = std::max(rubbing.slip.point, partner(rubbing));
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          const double entry = rubbing.second_derivative(r, c, projection);
          block[r * d + c] = -entry;
          tangent.diagonal[std::size_t(i) * d * d + r * d + c] += entry;
          tangent.diagonal[std::size_t(j) * d * d + r * d + c] += entry;
        }
      }
      tangent.add_to_block(place_of_contact(pattern_, i, j), block);
    });
  }

  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override {
    if (how == Write::over) std::ranges::fill(product, 0.0);
    const auto d = std::size_t(points_.dimension);
    for_each_touching(at, [&](const TouchingPair& contact) {
      const std::size_t i = std::size_t(contact.pair.i) * d, j = std::size_t(contact.pair.j) * d;
      const double across = stiffness_across(contact, projection);
      double closing = 0.0;
      for (std::size_t c = 0; c < d; ++c) closing += contact.gap.normal[c] * (v[j + c] - v[i + c]);
      for (std::size_t c = 0; c < d; ++c) {
        const double force = across * (v[j + c] - v[i + c]) +
                             (contact.stiffness - across) * closing * contact.gap.normal[c];
        product[i + c] -= force;
        product[j + c] += force;
      }
    });
    for_each_rubbing(at, [&](const PointFriction::Rubbing& rubbing) {
      const std::size_t i = place_of(rubbing.slip.point), j = place_of(partner(rubbing));
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          const double force = rubbing.second_derivative(r, c, projection) * (v[i + c] - v[j + c]);
          product[i + r] += force;
          product[j + r] -= force;
        }
      }
    });
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (how == Write::over) std::ranges::fill(energies, 0.0);
    for_each_touching(at, [&](const TouchingPair& contact) {
      energies[std::size_t(contact.pair.i)] += 0.5 * contact.energy;
      energies[std::size_t(contact.pair.j)] += 0.5 * contact.energy;
    });
    for_each_rubbing(at, [&](const PointFriction::Rubbing& rubbing) {
      energies[std::size_t(rubbing.slip.point)] += 0.5 * rubbing.energy;
      energies[std::size_t(partner(rubbing))] += 0.5 * rubbing.energy;
    });
  }

  /// The arm of two points that were no neighbours in the reference is the present one.
  void add_virials(const StateView& at, std::span<double> virials) override {
    const auto d = std::size_t(points_.dimension);
    for_each_touching(at, [&](const TouchingPair& contact) {
      const Coordinates one = points_.position(contact.pair.i),
                        other = points_.position(contact.pair.j);
      Coordinates arm{};
      double squared = 0.0;
      for (std::size_t c = 0; c < d; ++c) {
        arm[c] = other[c] - one[c];
        squared += arm[c] * arm[c];
      }
      const double longest = 2.0 * pairs_.reach();
      for (std::size_t c = 0; c < d && squared > longest * longest; ++c) {
        arm[c] = contact.gap.distance * contact.gap.normal[c];
      }
      for (const Index point : {contact.pair.i, contact.pair.j}) {
        for (std::size_t r = 0; r < d; ++r) {
          for (std::size_t c = 0; c < d; ++c) {
            virials[(std::size_t(point) * d + r) * d + c] -=
                0.5 * contact.force * contact.gap.normal[r] * arm[c];
          }
        }
      }
    });
  }

  [[nodiscard]] bool has_contacts() const override { return true; }

  std::vector<Index> closed_contacts(const StateView& at) override {
    std::vector<Index> closed;
    for_each_touching(at, [&](const TouchingPair& contact) {
      closed.push_back(contact.pair.i);
      closed.push_back(contact.pair.j);
    });
    return closed;
  }

  double longest_step(const StateView& at, std::span<const double> step) override {
    return longest_swept_share(pairs_, at, step, near_);
  }

  double largest_closing(const StateView& from, const StateView& to) override {
    std::vector<double> step(to.displacement.begin(), to.displacement.end());
    add_scaled(step, -1.0, from.displacement);
    const double approach = longest_approach(points_, step);
    // Pairs that are not near have at least the skin left.
    double largest = approach / pairs_.skin();
    for (const NearPairs::Open& open : near_.at(from.displacement, from.history)) {
      const Gap before = gap(open.pair, from.displacement), after = gap(open.pair, to.displacement);
      const double left = deepest(open.pair) - before.overlap;
      const double closed = after.overlap - before.overlap;
      if (closed > 0.0 && left > 0.0) largest = std::max(largest, closed / left);
    }
    return largest;
  }

  bool has_passed(const StateView& from, const StateView& to) override {
    std::vector<double> step(to.displacement.begin(), to.displacement.end());
    add_scaled(step, -1.0, from.displacement);
    const bool is_left = cover_.is_left_by(from.displacement, step);  // on all ranks
    return is_left || passes_through(pairs_, from, step, near_);
  }

  /// With the depths after a fifth of the gaps has closed. A row of k b'' n n^T has the sum
  /// 2 k b'' |n_c| sum |n|. Contact with an image is one half of two alike, of which the other one
  /// adds as much to the point itself.
  void add_contact_stiffness(const StateView& at, double most_depth,
                             std::span<double> stiffness) override {
    constexpr double closes = 0.2;
    if (!at.has_contacts || !is_finite_at(points_, at.displacement)) return;
    const auto d = std::size_t(points_.dimension);
    for (const NearPairs::Open& open : near_.at(at.displacement, at.history)) {
      const Gap now = gap(open.pair, at.displacement);
      const double most = deepest(open.pair);
      const double depth =
          std::min(most_depth, (now.overlap + closes * (most - now.overlap)) / most);
      if (!(depth > 0.0)) continue;
      const ContactLaw::Value of_law = rule_of(open.pair).law(depth);
      const double along = open.share * open.pair.stiffness * of_law.second;
      const double across =
          open.share * open.pair.stiffness * most * of_law.first / open.pair.distance;
      const double halves = points_.is_image(open.pair.j) ? 2.0 : 1.0;
      double of_normal = 0.0;
      for (std::size_t c = 0; c < d; ++c) of_normal += std::abs(now.normal[c]);
      for (const Index point : {open.pair.i, open.pair.j}) {
        for (std::size_t c = 0; c < d; ++c) {
          stiffness[std::size_t(point) * d + c] +=
              2.0 * halves * (along * std::abs(now.normal[c]) * of_normal + across * double(d));
        }
      }
    }
  }

  /// A predictor, which begins a search, looks anew, so that what follows does not depend on
  /// earlier searches; later states keep what covers them.
  std::optional<Couplings> contact_couplings(const StateView& at) override {
    if (!is_finite_at(points_, at.displacement)) return rows_.couplings();
    std::vector<ContactRows::Pair> wanted;
    const auto want = [&](std::span<const NearPairs::Open> open) {
      for (const NearPairs::Open& one : open) {
        if (one.pair.bond < 0) wanted.emplace_back(one.pair.i, one.pair.j);
      }
    };
    const bool is_new = !at.foreseen.empty();
    if (!is_new) {
      bool are_covered = true;
      for_each_touching(at, [&](const TouchingPair& contact) {
        are_covered &= contact.pair.bond >= 0 || rows_.has(contact.pair.i, contact.pair.j);
      });
      if (are_covered) return rows_.couplings();
      rows_.add_to(wanted);
    }
    want(near_.found_at(at.displacement, at.history));
    if (is_new && is_finite_at(points_, at.foreseen)) {
      want(near_foreseen_.found_at(at.foreseen, at.history));
    }
    rows_.take(std::move(wanted));
    return rows_.couplings();
  }

 private:
  /// Calls visit(TouchingPair) for all contacts that have an energy; a predictor's are springs.
  /// @return false if the displacement is not finite
  template <class Visit>
  bool for_each_touching(const StateView& at, const Visit& visit) {
    if (!at.has_contacts) return true;
    const bool foresees = !at.foreseen.empty();
    const std::span<const double> deciding = foresees ? at.foreseen : at.displacement;
    if (!is_finite_at(points_, at.displacement)) return false;
    if (foresees && !is_finite_at(points_, deciding)) return false;
    NearPairs& near = foresees ? near_foreseen_ : near_;
    for (const NearPairs::Open& open : near.at(deciding, at.history)) {
      const ContactPair& pair = open.pair;
      const double most = deepest(pair);
      const Gap decides = gap(pair, deciding);
      const double depth = decides.overlap / most;
      if (foresees ? !(depth > touching_depth) : !(depth > 0.0)) continue;
      TouchingPair contact{pair, foresees ? gap(pair, at.displacement) : decides};
      contact.share = open.share;
      contact.depth = contact.gap.overlap / most;
      contact.is_foreseen = foresees;
      const ContactLaw::Value of_law =
          foresees ? closed_contact(contact.depth) : rule_of(pair).law(contact.depth);
      const double stiffness = open.share * pair.stiffness;
      contact.energy = stiffness * most * most * of_law.value;
      contact.force = stiffness * most * of_law.first;
      contact.stiffness = stiffness * of_law.second;
      visit(std::as_const(contact));
    }
    return true;
  }

  template <class Visit>
  void for_each_rubbing(const StateView& at, const Visit& visit) const {
    if (!at.has_contacts || !rubs_) return;
    friction_.for_each(at.history.slips(Rub::pairs), at.displacement, visit);
  }
  /// The point that a rubbing point is pressed on.
  [[nodiscard]] static Index partner(const PointFriction::Rubbing& of) {
    return of.slip.partners.front().point;
  }
  [[nodiscard]] std::size_t place_of(Index point) const {
    return std::size_t(point) * std::size_t(points_.dimension);
  }

  /// Contacts with friction at a state.
  [[nodiscard]] std::vector<Press> presses(const StateView& at) {
    std::vector<Press> found;
    for_each_touching(at, [&](const TouchingPair& contact) {
      const ContactPair& pair = contact.pair;
      const PairContactRule& rule = rule_of(pair);
      if (rule.friction == 0.0) return;
      found.push_back({std::size_t(pair.i) * std::size_t(points_.count()) + std::size_t(pair.j),
                       pair.j,
                       {{pair.i, 1.0}},
                       std::max(0.0, contact.force),
                       contact.gap.normal,
                       rule.friction,
                       rule.tangential * contact.share * pair.stiffness});
    });
    return found;
  }

  [[nodiscard]] const PairContactRule& rule_of(const ContactPair& pair) const {
    return pairs_.rules()[std::size_t(pair.rule)];
  }
  /// Largest depth of a pair [m].
  [[nodiscard]] double deepest(const ContactPair& pair) const {
    return rule_of(pair).depth * pair.distance;
  }

  /// Gap of a pair. d - r follows from the change of the squared distance, whose difference from
  /// L^2 is exact for small displacements: energies of light contacts would drown in round-off.
  [[nodiscard]] Gap gap(const ContactPair& pair, std::span<const double> displacement) const {
    const auto d = std::size_t(points_.dimension);
    Gap found;
    double squared = 0.0, length = 0.0, change = 0.0;
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t i = std::size_t(pair.i) * d + c, j = std::size_t(pair.j) * d + c;
      const double arm = points_.reference[j] - points_.reference[i];
      const double moved = displacement[j] - displacement[i];
      found.normal[c] = arm + moved;
      squared += found.normal[c] * found.normal[c];
      length += arm * arm;
      change += moved * (2.0 * arm + moved);
    }
    found.distance = std::sqrt(squared);
    const double excess = pair.distance * pair.distance - length;
    found.overlap = (excess - change) / (pair.distance + found.distance);
    found.round_off = std::numeric_limits<double>::epsilon() * std::abs(change) / pair.distance;
    if (found.distance > 0.0) {
      for (double& component : found.normal) component /= found.distance;
    } else {  // the state is rejected: x = 1 / a
      found.normal = {1.0, 0.0, 0.0};
    }
    return found;
  }

  /// A foreseen spring is straight: its predictor is a linear problem.
  [[nodiscard]] static double stiffness_across(const TouchingPair& contact, double projection) {
    if (contact.is_foreseen || !(contact.gap.distance > 0.0)) return 0.0;
    return -(1.0 - projection) * contact.force / contact.gap.distance;
  }

  void add(const TouchingPair& contact, double force, std::span<double> gradient) const {
    const auto d = std::size_t(points_.dimension);
    for (std::size_t c = 0; c < d; ++c) {
      gradient[std::size_t(contact.pair.i) * d + c] += force * contact.gap.normal[c];
      gradient[std::size_t(contact.pair.j) * d + c] -= force * contact.gap.normal[c];
    }
  }

  const ContactPairs& pairs_;
  const Points& points_;
  const BlockPattern& pattern_;
  NearPairs near_, near_foreseen_;
  ContactCover cover_;
  PointFriction friction_;
  ContactRows rows_;
  bool rubs_;
};

}  // namespace

std::unique_ptr<TermPasses> PairContactTerm::passes(const TermSetting& setting) const {
  return std::make_unique<PairContactPasses>(*this, setting);
}

}  // namespace peristat
