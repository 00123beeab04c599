#include "assembly/terms/contact/pair_contact_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "assembly/terms/contact/image_cover.hpp"
#include "assembly/terms/contact/near_pairs.hpp"
#include "assembly/terms/contact/swept_pairs.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Depth over the largest from which a contact counts as touching: rest is at 0 to round-off.
constexpr double touching = -1e-9;

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
  double depth = 0.0;        ///< x
  double energy = 0.0;       ///< [J]
  double force = 0.0;        ///< that presses [N]; below 0 only where it is foreseen
  double stiffness = 0.0;    ///< along the normal [N/m]
  bool is_foreseen = false;  ///< a spring of a predictor
};

class PairContactPasses : public TermPasses, BlockTangent {
 public:
  PairContactPasses(const PairContactTerm& term, const TermSetting& setting)
      : pairs_(term.pairs()),
        points_(setting.points),
        pattern_(setting.pattern),
        threads_(setting.workspace.threads()),
        near_(pairs_, setting.model, threads_),
        near_foreseen_(pairs_, setting.model, threads_),
        cover_(points_, pairs_.reach()),
        offset_(std::size_t(points_.count()) + 1, 0) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::ranges::fill(gradient, 0.0);
    Evaluation found;
    if (at.has_contacts && is_finite(at.displacement) && !cover_.holds(at.displacement)) {
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
    return found;
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
      tangent.add_to_block(place(contact.pair), block);
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
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (how == Write::over) std::ranges::fill(energies, 0.0);
    for_each_touching(at, [&](const TouchingPair& contact) {
      energies[std::size_t(contact.pair.i)] += 0.5 * contact.energy;
      energies[std::size_t(contact.pair.j)] += 0.5 * contact.energy;
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
    return passes_through(pairs_, from, step, near_);
  }

  /// With the depths after a fifth of the gaps has closed. A row of k b'' n n^T has the sum
  /// 2 k b'' |n_c| sum |n|. Contact with an image is one half of two alike, of which the other one
  /// adds as much to the point itself.
  void add_contact_stiffness(const StateView& at, double most_depth,
                             std::span<double> stiffness) override {
    constexpr double closes = 0.2;
    if (!at.has_contacts || !is_finite(at.displacement)) return;
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
    if (!is_finite(at.displacement)) return rows();
    std::vector<std::pair<Index, Index>> wanted;
    const auto want = [&](std::span<const NearPairs::Open> open) {
      for (const NearPairs::Open& one : open) {
        if (one.pair.bond < 0) wanted.emplace_back(one.pair.i, one.pair.j);
      }
    };
    const bool is_new = !at.foreseen.empty();
    if (!is_new) {
      bool are_covered = true;
      for_each_touching(at, [&](const TouchingPair& contact) {
        are_covered &= contact.pair.bond >= 0 || has_row(contact.pair);
      });
      if (are_covered) return rows();
      for (Index i = 0; i < points_.count(); ++i) {
        for (Offset k = offset_[std::size_t(i)]; k < offset_[std::size_t(i) + 1]; ++k) {
          wanted.emplace_back(i, partner_[std::size_t(k)]);
        }
      }
    }
    want(near_.found_at(at.displacement, at.history));
    if (is_new && is_finite(at.foreseen)) {
      want(near_foreseen_.found_at(at.foreseen, at.history));
    }
    take_rows(std::move(wanted));
    return rows();
  }

 private:
  /// Calls visit(TouchingPair) for all contacts that have an energy; a predictor's are springs.
  /// @return false if the displacement is not finite
  template <class Visit>
  bool for_each_touching(const StateView& at, const Visit& visit) {
    if (!at.has_contacts) return true;
    const bool foresees = !at.foreseen.empty();
    const std::span<const double> deciding = foresees ? at.foreseen : at.displacement;
    if (!is_finite(at.displacement) || (foresees && !is_finite(deciding))) return false;
    NearPairs& near = foresees ? near_foreseen_ : near_;
    for (const NearPairs::Open& open : near.at(deciding, at.history)) {
      const ContactPair& pair = open.pair;
      const double most = deepest(pair);
      const Gap decides = gap(pair, deciding);
      const double depth = decides.overlap / most;
      if (foresees ? !(depth > touching) : !(depth > 0.0)) continue;
      TouchingPair contact{pair, foresees ? gap(pair, at.displacement) : decides};
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

  [[nodiscard]] bool is_finite(std::span<const double> displacement) const {
    const auto of_points = displacement.first(points_.reference.size());
    return std::ranges::all_of(of_points, [](double u) { return std::isfinite(u); });
  }

  [[nodiscard]] Offset place(const ContactPair& pair) const {
    const std::span<const Index> row = pattern_.of(pair.i);
    const auto found = std::lower_bound(row.begin(), row.end(), pair.j);
    if (found == row.end() || *found != pair.j) {
      throw std::logic_error("the pattern of the tangent lacks points in contact");
    }
    return pattern_.offset[std::size_t(pair.i)] + (found - row.begin());
  }

  [[nodiscard]] std::optional<Couplings> rows() const {
    if (partner_.empty()) return std::nullopt;
    return Couplings(offset_, partner_);
  }
  [[nodiscard]] bool has_row(const ContactPair& pair) const {
    const auto first = partner_.begin() + offset_[std::size_t(pair.i)],
               last = partner_.begin() + offset_[std::size_t(pair.i) + 1];
    return std::binary_search(first, last, pair.j);
  }
  void take_rows(std::vector<std::pair<Index, Index>> wanted) {
    std::ranges::sort(wanted);
    wanted.erase(std::ranges::unique(wanted).begin(), wanted.end());
    offset_.assign(std::size_t(points_.count()) + 1, 0);
    partner_.clear();
    for (const auto& [i, j] : wanted) {
      ++offset_[std::size_t(i) + 1];
      partner_.push_back(j);
    }
    for (std::size_t i = 1; i < offset_.size(); ++i) offset_[i] += offset_[i - 1];
  }

  const ContactPairs& pairs_;
  const Points& points_;
  const BlockPattern& pattern_;
  int threads_;
  NearPairs near_, near_foreseen_;
  ImageCover cover_;
  std::vector<Offset> offset_;  // rows of contact_couplings
  std::vector<Index> partner_;
};

}  // namespace

std::unique_ptr<TermPasses> PairContactTerm::passes(const TermSetting& setting) const {
  return std::make_unique<PairContactPasses>(*this, setting);
}

}  // namespace peristat
