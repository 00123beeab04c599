#include "assembly/terms/contact/face_contact_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "assembly/terms/contact/contact_limits.hpp"
#include "assembly/terms/contact/contact_rows.hpp"
#include "assembly/terms/contact/local_block.hpp"
#include "assembly/terms/contact/near_faces.hpp"
#include "assembly/terms/contact/point_friction.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// A part of the surface that a point is near, with what it adds to the point's contact.
struct TouchedPart {
  const FacingPart& part;
  FacetArms arms;
  FacetApproach at;
  double depth = 0.0;      ///< x
  double energy = 0.0;     ///< [J]
  double force = 0.0;      ///< that presses [N]
  double stiffness = 0.0;  ///< along the normal [N/m]
};

class FaceContactPasses : public TermPasses, BlockTangent {
 public:
  FaceContactPasses(const FaceContactTerm& term, const TermSetting& setting)
      : pairs_(term.contacts().pairs),
        faces_(term.contacts().faces),
        points_(setting.points),
        pattern_(setting.pattern),
        model_(setting.model),
        near_(pairs_, faces_, setting.workspace.threads()),
        near_foreseen_(pairs_, faces_, setting.workspace.threads()),
        friction_(points_.dimension),
        rows_(points_.count()) {
    for (const PairContactRule& rule : pairs_.rules()) {
      rubs_ |= rule.has_faces && rule.friction > 0.0;
    }
  }

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::ranges::fill(gradient, 0.0);
    Evaluation found;
    const bool foresees = !at.foreseen.empty();
    found.degenerate = !for_each_touched(at, [&](const FacingPoint& of,
                                                 std::span<const TouchedPart> parts) {
      for (const TouchedPart& touched : parts) {
        found.energy += touched.energy;
        found.round_off += std::abs(touched.force) * touched.at.round_off;
        found.degenerate |= !foresees && !(touched.depth < 1.0);
        if (!gradient.empty()) {
          add(of.point, touched, scaled(touched.force, touched.at.normal), gradient);
        }
      }
    }) || found.degenerate;
    for_each_rubbing(at, [&](const PointFriction::Rubbing& rubbing) {
      found.energy += rubbing.energy;
      found.round_off += rubbing.round_off;
      if (gradient.empty()) return;
      add_to(rubbing.slip.point, 1.0, rubbing.force, gradient);
      for (const auto& [partner, share] : rubbing.slip.partners) {
        add_to(partner, -share, rubbing.force, gradient);
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
          friction_.committed(history.slips(Rub::faces), presses(at), displacement);
      dissipated = now.dissipated;
      history.replace_slips(std::move(now.slips), Rub::faces);
    }
    std::vector<Index> torn = faces_.torn(model_, history);
    const bool tears = torn.size() > history.torn_facets().size();
    if (tears) {  // pairs of points take the place of the facets: what these stored is set free
      dissipated += this->gradient(at, {}, Write::over).energy;
      history.replace_torn_facets(std::move(torn));
    }
    Evaluation found = this->gradient(at, gradient, how);
    if (tears) dissipated -= found.energy;
    found.released += dissipated;
    found.moves_equilibrium = tears;
    return found;
  }

  [[nodiscard]] bool has_friction() const override { return rubs_; }

  void stick(const StateView& at, History& history) override {
    if (!rubs_) return;
    StateView touches = at;  // as a predictor sees them: contacts at rest count
    touches.foreseen = at.displacement;
    history.replace_slips(
        friction_.stuck(history.slips(Rub::faces), presses(touches), at.displacement), Rub::faces);
  }

  std::array<double, 2> lag_friction(const StateView& at, const StateView& start,
                                     History& history) override {
    if (!rubs_ || !is_finite_at(points_, at.displacement)) return {};
    PointFriction::Lagged now = friction_.lagged(history.slips(Rub::faces), presses(at),
                                                 at.displacement, start.displacement);
    history.replace_slips(std::move(now.slips), Rub::faces);
    return {now.change, now.largest};
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }

  void tangent(const StateView& at, Tangent& tangent, double projection, Write how) override {
    if (how == Write::over) tangent.clear();
    for_each_local(at, projection,
                   [&](const LocalBlock& local) { local.add_to(tangent, pattern_); });
  }

  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override {
    if (how == Write::over) std::ranges::fill(product, 0.0);
    for_each_local(at, projection, [&](const LocalBlock& local) { local.add_product(v, product); });
  }

  /// Half for the point, half for the corners by the place that is pressed.
  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (how == Write::over) std::ranges::fill(energies, 0.0);
    for_each_touched(at, [&](const FacingPoint& of, std::span<const TouchedPart> parts) {
      for (const TouchedPart& touched : parts) {
        energies[std::size_t(of.point)] += 0.5 * touched.energy;
        for (int k = 0; k < touched.part.corners; ++k) {
          energies[std::size_t(touched.part.corner[std::size_t(k)])] +=
              0.5 * touched.at.weight[std::size_t(k)] * touched.energy;
        }
      }
    });
    for_each_rubbing(at, [&](const PointFriction::Rubbing& rubbing) {
      energies[std::size_t(rubbing.slip.point)] += rubbing.energy;
    });
  }

  /// As of PairContactTerm, with the arm from the place that is pressed.
  void add_virials(const StateView& at, std::span<double> virials) override {
    for_each_touched(at, [&](const FacingPoint& of, std::span<const TouchedPart> parts) {
      for (const TouchedPart& touched : parts) {
        const Coordinates force = scaled(touched.force, touched.at.normal);
        Coordinates arm{};
        for (std::size_t k = 0; k < 3; ++k) {
          arm = minus(arm, scaled(touched.at.weight[k], touched.arms.reference[k]));
        }
        if (length(arm) > 2.0 * pairs_.reach()) {
          arm = scaled(touched.at.distance, touched.at.normal);
        }
        add_virial(of.point, 0.5, force, arm, virials);
        for (int k = 0; k < touched.part.corners; ++k) {
          add_virial(touched.part.corner[std::size_t(k)], 0.5 * touched.at.weight[std::size_t(k)],
                     force, arm, virials);
        }
      }
    });
  }

  [[nodiscard]] bool has_contacts() const override { return true; }

  std::vector<Index> closed_contacts(const StateView& at) override {
    std::vector<Index> closed;
    for_each_touched(at, [&](const FacingPoint& of, std::span<const TouchedPart>) {
      closed.push_back(of.point);
    });
    return closed;
  }

  double longest_step(const StateView& at, std::span<const double> step) override {
    return near_.longest_share(at, step);
  }

  double largest_closing(const StateView& from, const StateView& to) override {
    double largest = 0.0;
    for (const FacingPoint& of : near_.at(from.displacement, from.history).points) {
      const double most = deepest(of),
                   before =
                       nearest(of, near_.at(from.displacement, from.history), from.displacement),
                   after = nearest(of, near_.at(from.displacement, from.history), to.displacement);
      const double left = before - (of.distance - most);
      if (before > after && left > 0.0) largest = std::max(largest, (before - after) / left);
    }
    return largest;
  }

  bool has_passed(const StateView& from, const StateView& to) override {
    std::vector<double> step(to.displacement.begin(), to.displacement.end());
    add_scaled(step, -1.0, from.displacement);
    return near_.passes_through(from, step);
  }

  /// With the depth after a fifth of the gap has closed, at the point and each corner.
  void add_contact_stiffness(const StateView& at, double most_depth,
                             std::span<double> stiffness) override {
    constexpr double closes = 0.2;
    if (!at.has_contacts || !is_finite_at(points_, at.displacement)) return;
    const auto d = std::size_t(points_.dimension);
    const FacingPoints& near = near_.at(at.displacement, at.history);
    for (const FacingPoint& of : near.points) {
      const double most = deepest(of), overlap = of.distance - nearest(of, near, at.displacement);
      const double depth = std::min(most_depth, (overlap + closes * (most - overlap)) / most);
      if (!(depth > 0.0)) continue;
      const ContactLaw::Value of_law = rule_of(of).law(depth);
      const double bound = of.stiffness * (2.0 * of_law.second * std::sqrt(double(d)) +
                                           2.0 * double(d) * most * of_law.first / of.distance +
                                           2.0 * rule_of(of).tangential);
      std::vector<Index> mine{of.point};
      for (const FacingPart& part : near.parts_of(of)) {
        mine.insert(mine.end(), part.corner.begin(), part.corner.begin() + part.corners);
      }
      std::ranges::sort(mine);
      mine.erase(std::ranges::unique(mine).begin(), mine.end());
      for (const Index point : mine) {
        for (std::size_t c = 0; c < d; ++c) stiffness[std::size_t(point) * d + c] += bound;
      }
    }
  }

  /// As of PairContactTerm.
  std::optional<Couplings> contact_couplings(const StateView& at) override {
    if (!is_finite_at(points_, at.displacement)) return rows_.couplings();
    std::vector<ContactRows::Pair> wanted;
    const bool is_new = !at.foreseen.empty();
    if (!is_new) {
      std::vector<ContactRows::Pair> needed;
      for_each_local(at, 0.0,
                     [&](const LocalBlock& local) { add_all_pairs(local.points(), needed); });
      const bool are_covered = std::ranges::all_of(
          needed, [&](const auto& pair) { return rows_.has(pair.first, pair.second); });
      if (are_covered) return rows_.couplings();
      rows_.add_to(wanted);
      wanted.insert(wanted.end(), needed.begin(), needed.end());
    }
    const auto want = [&](const FacingPoints& near) {
      for (const FacingPoint& of : near.points) {
        std::vector<Index> mine{of.point};
        for (const FacingPart& part : near.parts_of(of)) {
          mine.insert(mine.end(), part.corner.begin(), part.corner.begin() + part.corners);
        }
        add_all_pairs(mine, wanted);
      }
    };
    want(near_.found_at(at.displacement, at.history));
    if (is_new && is_finite_at(points_, at.foreseen)) {
      want(near_foreseen_.found_at(at.foreseen, at.history));
    }
    rows_.take(std::move(wanted));
    return rows_.couplings();
  }

 private:
  static void add_all_pairs(std::span<const Index> of, std::vector<ContactRows::Pair>& to) {
    for (std::size_t a = 0; a < of.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (of[a] != of[b]) to.emplace_back(std::min(of[a], of[b]), std::max(of[a], of[b]));
      }
    }
  }

  [[nodiscard]] const PairContactRule& rule_of(const FacingPoint& of) const {
    return pairs_.rules()[std::size_t(of.rule)];
  }
  /// Largest depth of a contact [m].
  [[nodiscard]] double deepest(const FacingPoint& of) const {
    return rule_of(of).depth * of.distance;
  }
  [[nodiscard]] double nearest(const FacingPoint& of, const FacingPoints& near,
                               std::span<const double> displacement) const {
    double least = std::numeric_limits<double>::infinity();
    for (const FacingPart& part : near.parts_of(of)) {
      if (part.corners < faces_.corners()) continue;
      least = std::min(
          least, facet_distance(faces_.arms(of.point, part.corner, part.corners, displacement)));
    }
    return least;
  }

  [[nodiscard]] TouchedPart touched(const FacingPoint& of, const FacingPart& part,
                                    std::span<const double> displacement, bool is_spring) const {
    TouchedPart found{part, faces_.arms(of.point, part.corner, part.corners, displacement), {}};
    found.at = approach(found.arms, of.distance);
    const double most = deepest(of);
    found.depth = found.at.overlap / most;
    const ContactLaw::Value of_law =
        is_spring ? closed_contact(found.depth) : rule_of(of).law(found.depth);
    const double stiffness = (is_spring ? 1.0 : part.coefficient) * of.stiffness;
    found.energy = stiffness * most * most * of_law.value;
    found.force = stiffness * most * of_law.first;
    found.stiffness = stiffness * of_law.second;
    return found;
  }

  /// Calls visit(point, parts) for all contacts that have an energy. One that a predictor foresees
  /// is a spring to the nearest part.
  /// @return false if the displacement is not finite
  template <class Visit>
  bool for_each_touched(const StateView& at, const Visit& visit) {
    if (!at.has_contacts) return true;
    const bool foresees = !at.foreseen.empty();
    const std::span<const double> deciding = foresees ? at.foreseen : at.displacement;
    if (!is_finite_at(points_, at.displacement)) return false;
    if (foresees && !is_finite_at(points_, deciding)) return false;
    const FacingPoints& near = (foresees ? near_foreseen_ : near_).at(deciding, at.history);
    std::vector<TouchedPart> parts;
    for (const FacingPoint& of : near.points) {
      parts.clear();
      for (const FacingPart& part : near.parts_of(of)) {
        if (foresees && part.corners < faces_.corners()) continue;
        TouchedPart found = touched(of, part, deciding, foresees);
        if (found.depth > (foresees ? touching_depth : 0.0)) parts.push_back(found);
      }
      if (parts.empty()) continue;
      if (foresees) {
        const auto deepest_part = std::ranges::max_element(parts, {}, &TouchedPart::depth);
        const TouchedPart spring = touched(of, deepest_part->part, at.displacement, true);
        visit(of, std::span<const TouchedPart>(&spring, 1));
      } else {
        visit(of, std::span<const TouchedPart>(parts));
      }
    }
    return true;
  }

  template <class Visit>
  void for_each_rubbing(const StateView& at, const Visit& visit) const {
    if (!at.has_contacts || !rubs_) return;
    friction_.for_each(at.history.slips(Rub::faces), at.displacement, visit);
  }

  /// Contacts with friction at a state.
  [[nodiscard]] std::vector<Press> presses(const StateView& at) {
    std::vector<Press> found;
    for_each_touched(at, [&](const FacingPoint& of, std::span<const TouchedPart> parts) {
      const PairContactRule& rule = rule_of(of);
      if (rule.friction == 0.0) return;
      Press press;
      press.contact = std::size_t(of.rule) * std::size_t(points_.count()) + std::size_t(of.point);
      press.point = of.point;
      press.friction = rule.friction;
      press.stiffness = rule.tangential * of.stiffness;
      Coordinates force{};
      double sum = 0.0;
      for (const TouchedPart& part : parts) {
        // A contact at rest has no force, but a place.
        const double weight = parts.size() == 1 ? 1.0 : part.force;
        sum += weight;
        force = plus(force, scaled(part.force, part.at.normal));
        for (int k = 0; k < part.part.corners; ++k) {
          const Index corner = part.part.corner[std::size_t(k)];
          const double share = weight * part.at.weight[std::size_t(k)];
          const auto same = std::ranges::find(press.partners, corner, &Slip::Partner::point);
          if (same == press.partners.end()) {
            press.partners.push_back({corner, share});
          } else {
            same->share += share;
          }
        }
      }
      press.force = length(force);
      if (!(std::abs(sum) > 0.0)) return;
      for (Slip::Partner& partner : press.partners) partner.share /= sum;
      std::erase_if(press.partners, [](const auto& of_one) { return of_one.share == 0.0; });
      press.normal = press.force > 0.0 && at.foreseen.empty() ? scaled(1.0 / press.force, force)
                                                              : parts.front().at.normal;
      found.push_back(std::move(press));
    });
    return found;
  }

  /// Calls visit(its matrix) for every contact, and for its friction.
  template <class Visit>
  void for_each_local(const StateView& at, double projection, const Visit& visit) {
    LocalBlock local(points_.dimension);
    const bool foresees = !at.foreseen.empty();
    for_each_touched(at, [&](const FacingPoint& of, std::span<const TouchedPart> parts) {
      local.clear();
      for (const TouchedPart& part : parts) add_second_derivative(of, part, foresees, local);
      // Above a corner of less than a hair, a point sees a concave energy in an equally small
      // region, which any projection must bridge.
      local.project(projection > 0.0 ? 1.0 : 0.0);
      visit(std::as_const(local));
    });
    for_each_rubbing(at, [&](const PointFriction::Rubbing& rubbing) {
      local.clear();
      add_second_derivative(rubbing, projection, local);
      visit(std::as_const(local));
    });
  }

  /// k b'' r' r'^T - k a d b' r''; a foreseen spring is straight, so that its predictor is a linear
  /// problem.
  void add_second_derivative(const FacingPoint& of, const TouchedPart& part, bool is_straight,
                             LocalBlock& local) const {
    const auto d = std::size_t(points_.dimension);
    const DistanceDerivatives of_distance = derivatives(part.arms, part.at, points_.dimension);
    std::array<std::size_t, 4> place{local.place(of.point), 0, 0, 0};
    for (int k = 0; k < part.part.corners; ++k) {
      place[std::size_t(k) + 1] = local.place(part.part.corner[std::size_t(k)]);
    }
    const std::size_t places = 1 + std::size_t(part.part.corners);
    for (std::size_t r = 0; r < places * d; ++r) {
      for (std::size_t c = 0; c < places * d; ++c) {
        double entry = part.stiffness * of_distance.first[r] * of_distance.first[c];
        if (!is_straight) entry -= part.force * of_distance.second[r][c];
        local.entry(place[r / d] * d + r % d, place[c / d] * d + c % d) += entry;
      }
    }
  }

  /// Couples the point and its partners, by their shares.
  void add_second_derivative(const PointFriction::Rubbing& rubbing, double projection,
                             LocalBlock& local) const {
    const auto d = std::size_t(points_.dimension);
    std::vector<std::pair<std::size_t, double>> places{{local.place(rubbing.slip.point), 1.0}};
    for (const auto& [partner, share] : rubbing.slip.partners) {
      places.emplace_back(local.place(partner), -share);
    }
    for (const auto& [a, of_a] : places) {
      for (const auto& [b, of_b] : places) {
        for (std::size_t r = 0; r < d; ++r) {
          for (std::size_t c = 0; c < d; ++c) {
            local.entry(a * d + r, b * d + c) +=
                of_a * of_b * rubbing.second_derivative(r, c, projection);
          }
        }
      }
    }
  }

  /// Adds -dE of a force on a point of the surface, and its opposite on the part.
  void add(Index point, const TouchedPart& touched, const Coordinates& force,
           std::span<double> gradient) const {
    add_to(point, 1.0, force, gradient);
    for (int k = 0; k < touched.part.corners; ++k) {
      add_to(touched.part.corner[std::size_t(k)], -touched.at.weight[std::size_t(k)], force,
             gradient);
    }
  }
  void add_to(Index point, double share, const Coordinates& force,
              std::span<double> gradient) const {
    const auto d = std::size_t(points_.dimension);
    for (std::size_t c = 0; c < d; ++c) gradient[std::size_t(point) * d + c] -= share * force[c];
  }
  void add_virial(Index point, double share, const Coordinates& force, const Coordinates& arm,
                  std::span<double> virials) const {
    const auto d = std::size_t(points_.dimension);
    for (std::size_t r = 0; r < d; ++r) {
      for (std::size_t c = 0; c < d; ++c) {
        virials[(std::size_t(point) * d + r) * d + c] -= share * force[r] * arm[c];
      }
    }
  }

  const ContactPairs& pairs_;
  const ContactFaces& faces_;
  const Points& points_;
  const BlockPattern& pattern_;
  const Model& model_;
  NearFaces near_, near_foreseen_;
  PointFriction friction_;
  ContactRows rows_;
  bool rubs_ = false;
};

}  // namespace

std::unique_ptr<TermPasses> FaceContactTerm::passes(const TermSetting& setting) const {
  return std::make_unique<FaceContactPasses>(*this, setting);
}

bool tear_faces(const Model& model, History& history) {
  const auto* const term = model.find<FaceContactTerm>();
  if (term == nullptr) return false;
  std::vector<Index> torn = term->contacts().faces.torn(model, history);
  if (torn.size() <= history.torn_facets().size()) return false;
  history.replace_torn_facets(std::move(torn));
  return true;
}

}  // namespace peristat
