#include "solvers/formulations/materials/fracture_data.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "solvers/formulations/materials/bond_potential.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// "2.35e-05": enough for a message.
std::string short_text(double value) { return fmt::format("{:.4g}", value); }

/// Argument at which an increasing function has a value, to the last bits; least or most if there
/// is none.
template <class Function>
double inverse(const Function& of, double value, double least, double most) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (least + most);
    if (middle <= least || middle >= most) break;
    (of(middle) < value ? least : most) = middle;
  }
  return 0.5 * (least + most);
}

/// The law with the critical stretch 1 and this onset: its shape, which stretches only scale.
DamageSpecification shape(DamageSpecification damage, double onset) {
  damage.onset = onset;
  damage.critical = 1.0;
  return damage;
}

/// Least onset over critical stretch for laws that soften, except the blended one.
constexpr double smallest_ratio = 1e-6;

DamageSpecification brittle_law(double critical) {
  DamageSpecification damage;
  damage.law = DamageLaw::critical_stretch;
  damage.critical = critical;
  return damage;
}

/// The law of the same kind and critical stretch that softens fastest: for most a brittle one.
DamageSpecification fastest_law(DamageSpecification damage, double critical) {
  if (!damage.opens()) return brittle_law(critical);
  damage.critical = critical;
  damage.onset = damage.largest_onset() * critical;
  return damage;
}

/// Finds the stretches of one law.
class Search {
 public:
  /// @param peak f_p of a law with a strength; 0: without one
  Search(const DamageSpecification& damage, std::string key, const FractureScale& scale,
         double peak)
      : result_(damage),
        key_(std::move(key)),
        scale_(scale),
        largest_ratio_(damage.largest_onset()),
        peak_(peak) {
    if (damage.fracture_energy) {
      work_ = *damage.fracture_energy / (scale.micromodulus * scale.crossing);
    }
    if (damage.strength) strength_ = *damage.strength;
    result_.fracture_energy.reset();
    result_.strength.reset();
  }

  [[nodiscard]] DamageSpecification found() {
    if (!result_.softens()) {
      brittle();
    } else if (result_.law == DamageLaw::blended) {
      blended();
    } else {
      softening();
    }
    return result_;
  }

 private:
  void brittle() { result_.critical = work_ > 0.0 ? std::sqrt(2.0 * work_) : peak_; }

  void softening() {
    if (work_ > 0.0 && peak_ == 0.0 && result_.onset == 0.0) {
      result_.onset = 0.5 * std::sqrt(2.0 * work_);
    }
    if (peak_ > 0.0) {
      strong();
    } else {
      begun();
    }
  }

  /// Finds the stretches from the strength.
  void strong() {
    const auto force = [this](double ratio) { return peak_force(shape(result_, ratio)); };
    if (work_ > 0.0) {
      const auto squared = [&](double ratio) {
        return force(ratio) * force(ratio) / total_work(shape(result_, ratio));
      };
      const double wanted = peak_ * peak_ / work_;
      if (!(wanted < squared(largest_ratio_))) refuse_unresolved("strength", least_work(peak_));
      if (!(wanted > squared(smallest_ratio))) refuse_round();
      const double ratio = ratio_at(squared, wanted);
      result_.critical = std::sqrt(work_ / total_work(shape(result_, ratio)));
      result_.onset = ratio * result_.critical;
      return;
    }
    const double wanted = peak_ / result_.critical;
    if (!(wanted < force(largest_ratio_))) {
      const double most = scale_.strength(fastest_law(result_, result_.critical));
      throw InputError(key_ + "strength", number_text(strength_),
                       "must be less than the strength of " +
                           std::string(result_.opens() ? "this law" : "brittle bonds") +
                           " with this critical stretch, " + short_text(most) + " Pa");
    }
    if (!(wanted > force(smallest_ratio))) refuse_round();
    result_.onset = ratio_at(force, wanted) * result_.critical;
  }

  /// Finds the critical stretch from the onset.
  void begun() {
    if (work_ == 0.0) return;
    const double onset = result_.onset, wanted = work_ / (onset * onset);
    const auto work = [this](double ratio) {
      return -total_work(shape(result_, ratio)) / (ratio * ratio);
    };
    if (!(-wanted < work(largest_ratio_))) refuse_unresolved("onset", least_work(onset));
    result_.critical = onset / ratio_at(work, -wanted);
  }

  /// Finds onset, peak and critical stretch one after the other.
  void blended() {
    if (peak_ == 0.0 && result_.peak == 0.0) peak_ = 0.5 * std::sqrt(2.0 * work_);
    if (result_.onset == 0.0) result_.onset = 0.5 * peak_;
    if (peak_ > 0.0) {
      if (!(peak_ >= result_.onset && result_.hardening > 0.0)) {
        const AnyLaw begins{ForceEnvelope{result_.onset, 2.0 * result_.onset}};
        throw InputError(
            key_ + "strength", number_text(strength_),
            result_.hardening > 0.0
                ? "must be above the stress at which bonds begin to soften with this onset, " +
                      short_text(scale_.pull->onset(Loading::tension, begins).mean) + " Pa"
                : "needs a hardening above 0: without hardening it follows from the onset; give "
                  "peak");
      }
      result_.peak = result_.onset + (peak_ - result_.onset) / result_.hardening;
    }
    const double highest = result_.onset + result_.hardening * (result_.peak - result_.onset);
    const double rising = 0.5 * result_.onset * result_.onset +
                          0.5 * (result_.onset + highest) * (result_.peak - result_.onset);
    if (work_ > 0.0) {
      result_.critical = result_.peak + 2.0 * (work_ - rising) / highest;
      if (!(result_.critical * (1.0 - 1e-9) > result_.peak)) {
        refuse_unresolved(peak_ > 0.0 ? "strength" : "peak", rising);
      }
    }
  }

  template <class Function>
  [[nodiscard]] double ratio_at(const Function& of, double value) const {
    return inverse(of, value, smallest_ratio, largest_ratio_);
  }

  /// Work of the law with this onset that softens fastest.
  [[nodiscard]] double least_work(double onset) const {
    const DamageSpecification fastest = fastest_law(result_, 1.0);
    return total_work(fastest) * std::pow(onset / peak_force(fastest), 2);
  }

  /// @param least work of the law that softens fastest
  [[noreturn]] void refuse_unresolved(const std::string& datum, double least) const {
    throw InputError(
        key_ + datum, "",
        std::string(result_.opens() ? "bonds of this horizon would snap back as they open: "
                                      "without that they take up at least "
                                    : "bonds of this horizon would break before they soften: up "
                                      "to the onset of softening they take up ") +
            short_text(least * scale_.micromodulus * scale_.crossing) +
            " J/m2, but the fracture energy is only " +
            short_text(work_ * scale_.micromodulus * scale_.crossing) +
            " J/m2. Take a finer lattice: at this horizon ratio a spacing below " +
            short_text(scale_.spacing * work_ / least) + " m resolves it" +
            remark_on_units(work_ / least));
  }

  /// A spacing far below the given one indicates other units, not a coarse lattice.
  [[nodiscard]] std::string remark_on_units(double refinement) const {
    constexpr double far = 1e-3;
    if (refinement > far) return "";
    return ". Check that all are in SI units: youngs_modulus is " +
           short_text(scale_.youngs_modulus) +
           " Pa (30 GPa is 30e9), strength is in Pa, fracture_energy in J/m2";
  }

  [[noreturn]] void refuse_round() const {
    throw InputError(key_ + "strength", number_text(strength_),
                     law_rounds()
                         ? "is too small for a tanh law, whose force keeps rising beyond the "
                           "onset: take law \"linear\" or \"exponential\""
                         : "is too small: bonds would begin to soften at a stretch of " +
                               short_text(peak_) + ", less than " + number_text(smallest_ratio) +
                               " of the critical one. The strength is in Pa: 3 MPa are 3e6");
  }

  [[nodiscard]] bool law_rounds() const {
    return result_.law == DamageLaw::tanh || result_.law == DamageLaw::tanh_continuous;
  }

  DamageSpecification result_;
  std::string key_;
  const FractureScale& scale_;
  double strength_ = 0.0;  // [Pa], for messages
  double work_ = 0.0;      // required W; 0: none
  double largest_ratio_;   // of onset over critical stretch
  double peak_;            // required f_p; 0: none
};

/// Finds the stretches with which a tear of cpd takes the fracture energy. A Search finds them if
/// the G/W per area is the same for every law; the G/W of a tear depends on the law itself.
class TearSearch {
 public:
  /// @param peak f_p of a law with a strength; 0: without one
  TearSearch(const DamageSpecification& damage, std::string key, const FractureScale& scale,
             double peak)
      : damage_(damage), key_(std::move(key)), scale_(scale), peak_(peak) {}

  /// Iterates by secants between a G/W that is too small, at first that of the bonds alone, and one
  /// that is too large or has no law.
  [[nodiscard]] DamageSpecification found() {
    double small = std::log(scale_.micromodulus * scale_.crossing), large = INFINITY;
    double last = small, last_excess = excess_at(small);
    double next = small + last_excess;
    if (std::isnan(last_excess)) refuse();
    for (int k = 0; k < most_trials && large - small > 1e-12; ++k) {
      if (std::abs(last_excess) <= tolerance) return *law_;
      const double excess = excess_at(next);
      (excess > 0.0 ? small : large) = next;
      double guess = next - excess * (next - last) / (excess - last_excess);
      if (!(guess > small && guess < large)) {
        guess = std::isfinite(large) ? 0.5 * (small + large) : small + excess;
      }
      if (!std::isnan(excess)) {
        last = next;
        last_excess = excess;
      }
      next = guess;
    }
    refuse();
  }

 private:
  static constexpr double tolerance = 1e-11;
  static constexpr int most_trials = 100;

  [[nodiscard]] FractureScale with_ratio(double log_ratio) const {
    FractureScale scale = scale_;
    scale.crossing = std::exp(log_ratio) / scale.micromodulus;
    return scale;
  }

  /// Logarithm of the tear's energy with the law of this G/W over the required one; NaN without a
  /// law.
  double excess_at(double log_ratio) {
    try {
      law_ = Search(damage_, key_, with_ratio(log_ratio), peak_).found();
    } catch (const InputError&) {
      return NAN;
    }
    return std::log(scale_.energy(*law_) / *damage_.fracture_energy);
  }

  /// Refuses with the message for bonds that have the G/W of brittle ones with this strength.
  [[noreturn]] void refuse() const {
    const double work = *damage_.fracture_energy / (scale_.micromodulus * scale_.crossing);
    const DamageSpecification brittle = brittle_law(peak_ > 0.0           ? peak_
                                                    : damage_.onset > 0.0 ? damage_.onset
                                                                          : std::sqrt(2.0 * work));
    const double ratio = scale_.energy(brittle) / total_work(brittle);
    static_cast<void>(Search(damage_, key_, with_ratio(std::log(ratio)), peak_).found());
    throw InputError(key_ + "fracture_energy", number_text(*damage_.fracture_energy),
                     "is not possible with this onset or strength; give other values");
  }

  const DamageSpecification& damage_;
  std::string key_;
  const FractureScale& scale_;
  double peak_;
  std::optional<DamageSpecification> law_;
};

/// The law whose bonds have this largest force; 0: no force is required.
DamageSpecification law_of_peak(const DamageSpecification& damage, const std::string& key,
                                const FractureScale& scale, double peak) {
  const bool is_torn = scale.tear && !scale.tear->is_of_bonds_alone();
  return is_torn && damage.fracture_energy ? TearSearch(damage, key, scale, peak).found()
                                           : Search(damage, key, scale, peak).found();
}

/// Finds the largest bond force with which a body has its strength under a pull: mostly below that
/// of a brittle bond, as bonds oblique to the pull soften later.
class StrengthSearch {
 public:
  StrengthSearch(const DamageSpecification& damage, std::string key, const FractureScale& scale)
      : damage_(damage), key_(std::move(key)), scale_(scale) {}

  [[nodiscard]] DamageSpecification found() {
    const double of_unit = scale_.strength(brittle_law(1.0));
    if (of_unit == 0.0) {
      throw InputError(key_ + "strength", number_text(*damage_.strength),
                       "needs a lattice that resists shear: at this horizon ratio bonds join "
                       "neighbours along the axes only; take a ratio of at least 1.5");
    }
    if (!std::isfinite(of_unit)) {
      throw InputError(key_ + "strength", number_text(*damage_.strength),
                       "needs a larger poisson_ratio: with this one no bond fails under a pull, "
                       "since the body would release no energy with it");
    }
    const double brittle = *damage_.strength / of_unit;
    if (!damage_.softens()) {
      if (damage_.fracture_energy) refuse_both(brittle, of_unit);
      return law_of_peak(damage_, key_, scale_, brittle);
    }
    const DamageSpecification fastest = fastest_law(damage_, 1.0);
    return below(*damage_.strength / scale_.strength(fastest) * peak_force(fastest));
  }

 private:
  static constexpr double tolerance = 1e-9;
  static constexpr int most_trials = 60;

  /// Iterates by secants of the logarithm between a force that is too small, also for the law, and
  /// one that is too large.
  /// @param most force of the law that softens fastest
  [[nodiscard]] DamageSpecification below(double most) {
    double small = -INFINITY, large = INFINITY, last = std::log(most);
    // A refusal here refuses the law.
    law_ = law_of_peak(damage_, key_, scale_, most);
    double last_excess = excess(), next = last - last_excess;
    if (std::abs(last_excess) <= tolerance) return *law_;
    (last_excess > 0.0 ? large : small) = last;
    for (int k = 0; k < most_trials && large - small > 1e-13; ++k) {
      const double found = excess_at(next);
      if (std::abs(found) <= tolerance) return *law_;
      // Without a law the force is too small for it, or, above the first one, too large.
      const bool is_large = std::isnan(found) ? next > std::log(most) : found > 0.0;
      (is_large ? large : small) = next;
      double guess = next - found * (next - last) / (found - last_excess);
      if (!(guess > small && guess < large)) {
        guess = std::isfinite(small) && std::isfinite(large) ? 0.5 * (small + large) : next - found;
      }
      if (!std::isnan(found)) {
        last = next;
        last_excess = found;
      }
      next = guess;
    }
    law_ = law_of_peak(damage_, key_, scale_, std::exp(std::isfinite(small) ? small : large));
    return accepted(excess());
  }

  [[nodiscard]] double excess() const {
    return std::log(scale_.strength(*law_) / *damage_.strength);
  }

  /// Excess for this largest force; NaN without a law.
  double excess_at(double log_peak) {
    try {
      law_ = law_of_peak(damage_, key_, scale_, std::exp(log_peak));
    } catch (const InputError&) {
      return NAN;
    }
    return excess();
  }

  /// Accepts a nearby strength, because the strength of laws that jump also jumps.
  [[nodiscard]] DamageSpecification accepted(double excess) const {
    constexpr double allowed = 0.01;
    if (std::abs(excess) <= allowed) return *law_;
    throw InputError(key_ + "strength", number_text(*damage_.strength),
                     "can't be reached by this law: the nearest strength is " +
                         short_text(scale_.strength(*law_)) + " Pa");
  }

  [[noreturn]] void refuse_both(double critical, double of_unit) const {
    DamageSpecification tough = damage_;
    tough.strength.reset();
    const double stretch = law_of_peak(tough, key_, scale_, 0.0).critical;
    throw InputError(
        key_ + "strength", number_text(*damage_.strength),
        "a brittle bond has one stretch for both: with this fracture_energy the strength is " +
            short_text(stretch * of_unit) + " Pa, with this strength the fracture energy is " +
            short_text(scale_.energy(brittle_law(critical))) +
            " J/m2. Give one of them, or a law that softens, such as \"linear\"");
  }

  const DamageSpecification& damage_;
  std::string key_;
  const FractureScale& scale_;
  std::optional<DamageSpecification> law_;
};

/// Refuses a law so steep that finding its stretches would take minutes.
void require_quick(const DamageSpecification& damage, const std::string& key, const CpdTear& tear) {
  const AnyLaw law =
      law_of(damage.softens() ? shape(damage, 0.5 * damage.largest_onset()) : damage);
  if (tear.quadrature_points(law) <= most_quadrature_points_of_tear) return;
  throw InputError(
      key + "fracture_energy", number_text(*damage.fracture_energy),
      "would take minutes to convert into stretches of cpd at this horizon ratio and rate, " +
          short_text(damage.rate) + "; give a lower rate, or critical");
}

void require_range(const DamageSpecification& found, const DamageSpecification& given,
                   const std::string& key) {
  const bool fits = found.critical >= 1e-9 && found.critical <= 1e3 &&
                    (!found.softens() || found.onset >= 1e-9) &&
                    (!found.softens() || found.onset < found.critical * (1.0 - 1e-9));
  if (fits) return;
  const char* datum = given.fracture_energy ? "fracture_energy" : "strength";
  throw InputError(
      key + datum, number_text(given.fracture_energy ? *given.fracture_energy : *given.strength),
      "gives bonds an onset of " + short_text(found.onset) + " and a critical stretch of " +
          short_text(found.critical) + "; stretches must be from 1e-09 to 1000");
}

}  // namespace

double FractureScale::energy(const DamageSpecification& damage) const {
  return tear ? tear->mean_energy(law_of(damage)) : micromodulus * crossing * total_work(damage);
}

double FractureScale::strength(const DamageSpecification& damage) const {
  return pull->peak(Loading::tension, law_of(damage)).mean;
}

DamageSpecification with_stretches(const DamageSpecification& damage, const std::string& key,
                                   const FractureScale& scale) {
  if (damage.law == DamageLaw::table) {
    const AnyLaw law = law_of(damage);
    DamageSpecification found = damage;
    found.onset = law.onset();
    found.critical = law.critical();
    return found;
  }
  if (!damage.is_by_data()) return damage;
  const std::string table = key + ".damage.";
  if (scale.tear && damage.fracture_energy) require_quick(damage, table, *scale.tear);
  DamageSpecification found = damage.strength ? StrengthSearch(damage, table, scale).found()
                                              : law_of_peak(damage, table, scale, 0.0);
  if (damage.has_surface()) found.strength_of_peak = *damage.strength;
  require_range(found, damage, key + ".damage.");
  return found;
}

LawStretches stretches_of(const DamageSpecification& damage, double fineness) {
  if (damage.of_horizons.empty()) {
    const double factor = std::sqrt(fineness);
    return {factor * damage.onset, factor * damage.critical};
  }
  const double place = horizon_steps * std::log2(std::max(fineness, 1.0));
  const std::size_t last = damage.of_horizons.size() - 1;
  const std::size_t low = std::min(std::size_t(place), last), high = std::min(low + 1, last);
  const double share = place - double(low);
  const LawStretches &from = damage.of_horizons[low], &to = damage.of_horizons[high];
  return {from.onset * std::pow(to.onset / from.onset, share),
          from.critical * std::pow(to.critical / from.critical, share)};
}

double total_work(const DamageSpecification& damage) {
  return law_of(damage).work(Harmonic{1.0}, damage.critical);
}

double peak_force(const DamageSpecification& damage) {
  if (!damage.softens()) return damage.critical;
  const AnyLaw law = law_of(damage);
  if (const auto* table = std::get_if<ForceTable>(&law.law)) return table->peak_force();
  if (const auto* envelope = std::get_if<ForceEnvelope>(&law.law)) return envelope->peak_force();
  if (damage.opens()) return damage.onset;
  // The force of a tanh law rises to one peak and falls; the peak is found by golden sections.
  const auto force = [&](double s) { return s * law.integrity(s); };
  double a = damage.onset, b = damage.critical;
  constexpr double section = 0.6180339887498949;
  for (int k = 0; k < 80; ++k) {
    const double left = b - section * (b - a), right = a + section * (b - a);
    (force(left) < force(right) ? a : b) = force(left) < force(right) ? left : right;
  }
  return std::max(damage.onset, force(0.5 * (a + b)));
}

double largest_spacing(const DamageSpecification& damage, double fracture_energy, double strength,
                       const FractureScale& scale) {
  const double critical = strength / scale.strength(fastest_law(damage, 1.0));
  return scale.spacing * fracture_energy / scale.energy(fastest_law(damage, critical));
}

double bearable_energy_density(const DamageSpecification& damage, double horizon) {
  return *damage.fracture_energy / (2.0 * horizon);
}

}  // namespace peristat
