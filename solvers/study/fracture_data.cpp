#include "solvers/study/fracture_data.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "solvers/study/bond_materials.hpp"
#include "solvers/study/bond_potential.hpp"
#include "solvers/study/collocation_model.hpp"
#include "solvers/study/cpd_model.hpp"
#include "solvers/study/state_model.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

/// "2.35e-05": enough for a message.
std::string short_text(double value) { return fmt::format("{:.4g}", value); }

/// Where an increasing function has a value, to the last bits; least or most if it has not.
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

/// Onset over critical stretch of laws that soften, but for the blended one.
constexpr double smallest_ratio = 1e-6, largest_ratio = 1.0 - 1e-9;

template <class Function>
double ratio_at(const Function& of, double value) {
  return inverse(of, value, smallest_ratio, largest_ratio);
}

/// Finds the stretches of one law.
class Search {
 public:
  Search(const DamageSpecification& damage, std::string key, const FractureScale& scale)
      : result_(damage), key_(std::move(key)), scale_(scale) {
    if (damage.fracture_energy) {
      work_ = *damage.fracture_energy / (scale.micromodulus * scale.crossing);
    }
    if (damage.strength) peak_ = *damage.strength / scale.youngs_modulus;
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
  void brittle() {
    if (work_ > 0.0 && peak_ > 0.0) {
      throw InputError(
          key_ + "strength", number_text(peak_ * scale_.youngs_modulus),
          "a brittle bond has one stretch for both: with this fracture_energy the strength is " +
              short_text(std::sqrt(2.0 * work_) * scale_.youngs_modulus) +
              " Pa, with this strength the fracture energy is " +
              short_text(0.5 * peak_ * peak_ * scale_.micromodulus * scale_.crossing) +
              " J/m2. Give one of them, or a law that softens, like \"linear\"");
    }
    result_.critical = work_ > 0.0 ? std::sqrt(2.0 * work_) : peak_;
  }

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

  /// By the strength.
  void strong() {
    const auto force = [this](double ratio) { return peak_force(shape(result_, ratio)); };
    if (work_ > 0.0) {
      const auto squared = [&](double ratio) {
        return force(ratio) * force(ratio) / total_work(shape(result_, ratio));
      };
      const double wanted = peak_ * peak_ / work_;
      if (!(wanted < squared(largest_ratio))) refuse_unresolved("strength", 0.5 * peak_ * peak_);
      if (!(wanted > squared(smallest_ratio))) refuse_round();
      const double ratio = ratio_at(squared, wanted);
      result_.critical = std::sqrt(work_ / total_work(shape(result_, ratio)));
      result_.onset = ratio * result_.critical;
      return;
    }
    const double wanted = peak_ / result_.critical;
    if (!(wanted < force(largest_ratio))) {
      throw InputError(key_ + "strength", number_text(peak_ * scale_.youngs_modulus),
                       "must be less than youngs_modulus times critical, " +
                           short_text(result_.critical * scale_.youngs_modulus) + " Pa");
    }
    if (!(wanted > force(smallest_ratio))) refuse_round();
    result_.onset = ratio_at(force, wanted) * result_.critical;
  }

  /// By the onset.
  void begun() {
    if (work_ == 0.0) return;
    const double onset = result_.onset, wanted = work_ / (onset * onset);
    const auto work = [this](double ratio) {
      return -total_work(shape(result_, ratio)) / (ratio * ratio);
    };
    if (!(-wanted < work(largest_ratio))) refuse_unresolved("onset", 0.5 * onset * onset);
    result_.critical = onset / ratio_at(work, -wanted);
  }

  /// Onset, peak and critical stretch one after the other.
  void blended() {
    if (peak_ == 0.0 && result_.peak == 0.0) peak_ = 0.5 * std::sqrt(2.0 * work_);
    if (result_.onset == 0.0) result_.onset = 0.5 * peak_;
    if (peak_ > 0.0) {
      if (!(peak_ >= result_.onset && result_.hardening > 0.0)) {
        throw InputError(key_ + "strength", number_text(peak_ * scale_.youngs_modulus),
                         result_.hardening > 0.0
                             ? "must be at least youngs_modulus times onset, " +
                                   short_text(result_.onset * scale_.youngs_modulus) + " Pa"
                             : "needs a hardening above 0: without, it is youngs_modulus times "
                               "onset; give peak");
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

  /// @param least work of the law that breaks as soon as it softens
  [[noreturn]] void refuse_unresolved(const std::string& datum, double least) const {
    throw InputError(key_ + datum, "",
                     "bonds of this horizon break before they soften: up to there they take " +
                         short_text(least * scale_.micromodulus * scale_.crossing) +
                         " J/m2, which leaves nothing of the fracture energy, " +
                         short_text(work_ * scale_.micromodulus * scale_.crossing) +
                         " J/m2. Refine: at this horizon ratio a spacing below " +
                         short_text(scale_.spacing * work_ / least) + " m resolves it" +
                         remark_on_units(work_ / least));
  }

  /// A spacing that is far below the one given tells of other units, not of a coarse lattice.
  [[nodiscard]] std::string remark_on_units(double refinement) const {
    constexpr double far = 1e-3;
    if (refinement > far) return "";
    return ". Are all in SI units? youngs_modulus is " + short_text(scale_.youngs_modulus) +
           " Pa (30 GPa is 30e9), strength is in Pa, fracture_energy in J/m2";
  }

  [[noreturn]] void refuse_round() const {
    throw InputError(key_ + "strength", number_text(peak_ * scale_.youngs_modulus),
                     "is too small for a tanh law, whose force goes on rising beyond the onset: "
                     "take law \"linear\" or \"exponential\"");
  }

  DamageSpecification result_;
  std::string key_;
  const FractureScale& scale_;
  double work_ = 0.0;  // W that is asked for; 0: it isn't
  double peak_ = 0.0;  // f_p that is asked for; 0: it isn't
};

/// Finds the stretches with which a tear of cpd takes the fracture energy. Bonds of which each took
/// G/W per area, whatever the law, would be those of a Search; the tear's G/W is that of the law
/// that it gives.
class TearSearch {
 public:
  TearSearch(const DamageSpecification& damage, std::string key, const FractureScale& scale)
      : damage_(damage), key_(std::move(key)), scale_(scale) {}

  /// Between a G/W that is too small, from that of the bonds alone on, and one that is too large or
  /// leaves no law, by secants.
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

  /// How much too much the tear takes with the law of this G/W, as a logarithm; NaN without a law.
  double excess_at(double log_ratio) {
    try {
      law_ = Search(damage_, key_, with_ratio(log_ratio)).found();
    } catch (const InputError&) {
      return NAN;
    }
    return std::log(scale_.energy(*law_) / *damage_.fracture_energy);
  }

  /// With what is told of bonds that have the G/W of brittle ones with this strength.
  [[noreturn]] void refuse() const {
    DamageSpecification brittle;
    brittle.law = DamageLaw::critical_stretch;
    const double work = *damage_.fracture_energy / (scale_.micromodulus * scale_.crossing);
    brittle.critical = damage_.strength      ? *damage_.strength / scale_.youngs_modulus
                       : damage_.onset > 0.0 ? damage_.onset
                                             : std::sqrt(2.0 * work);
    const double ratio = scale_.energy(brittle) / total_work(brittle);
    static_cast<void>(Search(damage_, key_, with_ratio(std::log(ratio))).found());
    throw InputError(key_ + "fracture_energy", number_text(*damage_.fracture_energy),
                     "gives no stretches with this onset or strength; give others");
  }

  const DamageSpecification& damage_;
  std::string key_;
  const FractureScale& scale_;
  std::optional<DamageSpecification> law_;
};

/// Refuses a law so steep that finding its stretches would take minutes.
void require_quick(const DamageSpecification& damage, const std::string& key, const CpdTear& tear) {
  const AnyLaw law = law_of(damage.softens() ? shape(damage, 0.5) : damage);
  if (tear.quadrature_points(law) <= most_quadrature_points_of_tear) return;
  throw InputError(key + "fracture_energy", number_text(*damage.fracture_energy),
                   "takes minutes to turn into stretches of cpd at this horizon ratio and rate, " +
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

FractureScale FractureScale::of(const MaterialSpecification& material, const std::string& key,
                                const BondSetting& setting, double spacing) {
  FractureScale scale;
  scale.spacing = spacing;
  if (material.model == MaterialModel::bond) {
    scale.micromodulus = micromodulus_of(material, key, setting).at(1.0);
    scale.crossing = mean_crossing(setting);
    scale.youngs_modulus =
        material.youngs_modulus.value_or(youngs_modulus_of(scale.micromodulus, setting));
    return scale;
  }
  if (material.damage.strength && !material.youngs_modulus) {
    throw InputError(key + ".damage.strength", number_text(*material.damage.strength),
                     "needs a youngs_modulus; give the stretches onset and critical");
  }
  scale.youngs_modulus = material.youngs_modulus.value_or(0.0);
  const CpdConstants constants = cpd_constants_of(material, key, setting, spacing);
  refuse_damage_of_negative_constants(material, key, constants, setting, spacing);
  scale.micromodulus = constants.c1;
  const double largest = largest_ratio_of_tear(setting.dimension);
  if (setting.horizon <= largest * spacing * (1.0 + horizon_tolerance)) {
    scale.tear = std::make_shared<CpdTear>(setting, spacing, constants);
    scale.crossing = scale.tear->mean_crossing();
  } else if (material.damage.fracture_energy) {
    throw InputError(
        key + ".damage.fracture_energy", number_text(*material.damage.fracture_energy),
        "is for horizon ratios up to " + number_text(largest) + " with cpd in " +
            std::to_string(setting.dimension) +
            "D: summing what a tear takes of longer ones takes minutes; give critical");
  }
  return scale;
}

double FractureScale::energy(const DamageSpecification& damage) const {
  return tear ? tear->mean_energy(law_of(damage)) : micromodulus * crossing * total_work(damage);
}

DamageSpecification with_stretches(const DamageSpecification& damage, const std::string& key,
                                   const FractureScale& scale) {
  if (!damage.is_by_data()) return damage;
  const std::string table = key + ".damage.";
  const bool by_tear = scale.tear && damage.fracture_energy;
  if (by_tear) require_quick(damage, table, *scale.tear);
  const DamageSpecification found =
      by_tear ? TearSearch(damage, table, scale).found() : Search(damage, table, scale).found();
  require_range(found, damage, key + ".damage.");
  return found;
}

BodySpecification with_stretches(BodySpecification of, const BondSetting& setting, double spacing) {
  const auto find = [&](MaterialSpecification& material, const std::string& key) {
    if (!material.damage.is_by_data()) return;
    if (material.model == MaterialModel::lps) {
      const double energy = *material.damage.fracture_energy;
      material.damage.critical = of.has_states() ? state_critical_stretch(material, setting, energy)
                                                 : lps_critical_stretch(material, setting, energy);
      material.damage.fracture_energy.reset();
      return;
    }
    const FractureScale scale = FractureScale::of(material, key, setting, spacing);
    material.damage = with_stretches(material.damage, key, scale);
  };
  find(of.material, "material");
  for (std::size_t k = 0; k < of.regions.size(); ++k) {
    find(of.regions[k].material, "regions[" + std::to_string(k) + "].material");
  }
  for (std::size_t k = 0; k < of.interfaces.size(); ++k) {
    if (!of.interfaces[k].material) continue;
    find(*of.interfaces[k].material, "interfaces[" + std::to_string(k) + "].material");
  }
  return of;
}

double total_work(const DamageSpecification& damage) {
  return law_of(damage).work(Harmonic{1.0}, damage.critical);
}

double peak_force(const DamageSpecification& damage) {
  if (!damage.softens()) return damage.critical;
  const AnyLaw law = law_of(damage);
  if (const auto* envelope = std::get_if<ForceEnvelope>(&law.law)) return envelope->peak_force();
  // The force of a tanh law rises to one peak and falls: by golden sections.
  const auto force = [&](double s) { return s * law.integrity(s); };
  double a = damage.onset, b = damage.critical;
  constexpr double section = 0.6180339887498949;
  for (int k = 0; k < 80; ++k) {
    const double left = b - section * (b - a), right = a + section * (b - a);
    (force(left) < force(right) ? a : b) = force(left) < force(right) ? left : right;
  }
  return std::max(damage.onset, force(0.5 * (a + b)));
}

double largest_spacing(double fracture_energy, double strength, const FractureScale& scale) {
  DamageSpecification brittle;
  brittle.law = DamageLaw::critical_stretch;
  brittle.critical = strength / scale.youngs_modulus;
  return scale.spacing * fracture_energy / scale.energy(brittle);
}

double bearable_energy_density(const DamageSpecification& damage, double horizon) {
  return *damage.fracture_energy / (2.0 * horizon);
}

}  // namespace peristat
