#include "solvers/formulations/specification/check_damage.hpp"

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "solvers/formulations/specification/require.hpp"
#include "src/potentials/force_table.hpp"

namespace peristat {
namespace {

/// True if a datum differs from its default.
bool is_given(const DamageSpecification& damage, std::string_view key) {
  if (key == "fracture_energy") return damage.fracture_energy.has_value();
  if (key == "fracture_toughness") return damage.fracture_toughness.has_value();
  if (key == "strength") return damage.strength.has_value();
  if (key == "strength_surface") return damage.has_surface();
  if (key == "compressive_strength") return damage.compressive_strength.has_value();
  if (key == "biaxial_strength") return damage.biaxial_strength.has_value();
  if (key == "strength_factor") return damage.strength_factor != usual_strength_factor;
  if (key == "critical") return damage.critical != 0.0;
  if (key == "onset") return damage.onset != 0.0;
  if (key == "stretches") return !damage.stretches.empty();
  if (key == "drive") return damage.drive.has_value();
  if (key == "struts") return damage.struts != StrutRemedy::keep;
  if (key == "compression") return damage.compression != Compression::lost;
  if (key == "forces") return !damage.forces.empty();
  return key == "peak" && damage.peak != 0.0;
}

/// Refuses curves of a force that are none of a bond that loses its stiffness for good.
void check_table(const DamageSpecification& damage, const std::string& table) {
  constexpr std::size_t most_pairs = 1000;
  const std::vector<double>&s = damage.stretches, &f = damage.forces;
  require(s.size() >= 2, table + "stretches", "",
          "needs at least two stretches: the end of the elastic part, and where the bond breaks");
  require(s.size() <= most_pairs, table + "stretches", std::to_string(s.size()),
          "may have at most " + std::to_string(most_pairs) + " stretches");
  require(f.size() == s.size(), table + "forces", "",
          "needs a force for each of the " + std::to_string(s.size()) + " stretches; there are " +
              std::to_string(f.size()));
  for (std::size_t k = 0; k < s.size(); ++k) {
    const std::string number = std::string("[") + std::to_string(k) + "]";
    require_within(s[k], 1e-9, 1e3, table + "stretches" + number);
    require(k == 0 || s[k] > s[k - 1], table + "stretches" + number, number_text(s[k]),
            "must be larger than the one before, " + number_text(k == 0 ? 0.0 : s[k - 1]));
    require(std::isfinite(f[k]) && f[k] >= 0.0, table + "forces" + number, number_text(f[k]),
            "must be 0 or positive");
    require(f[k] > 0.0 || k + 1 == s.size(), table + "forces" + number, number_text(f[k]),
            "is the last one: a bond without force is broken");
    // The integrity f/s, up to the round-off of a proportional part.
    constexpr double round_off = 1e-9;
    require(k == 0 || f[k] * s[k - 1] <= f[k - 1] * s[k] * (1.0 + round_off),
            table + "forces" + number, number_text(f[k]),
            "grows more than the stretch: a bond does not regain stiffness, so force over stretch "
            "must not grow; here the force may be at most " +
                number_text(k == 0 ? 0.0 : f[k - 1] / s[k - 1] * s[k]));
  }
  require(std::abs(f[0] - s[0]) <= round_off_of_elastic_pairs * s[0], table + "forces[0]",
          number_text(f[0]),
          "must be the first stretch, " + number_text(s[0]) +
              ": forces are divided by the constant c of the undamaged bond, and the first pair "
              "ends the elastic part");
  require(ForceCurve(s, f).onset() < 1.0 - 1e-9, table + "forces", "",
          "are never below the stretches, so the bond would not soften; for a bond that breaks at "
          "once take law \"critical_stretch\"");
}

/// Refuses a strength surface with too little data, or through points that it does not have.
void check_surface(const DamageSpecification& damage, const std::string& table) {
  require_positive(damage.compressive_strength, table + "compressive_strength");
  require_positive(damage.biaxial_strength, table + "biaxial_strength");
  if (!damage.has_surface()) return;
  require(damage.strength.has_value() || damage.strength_of_peak > 0.0, table + "strength", "",
          "is missing; a strength_surface needs it");
  require(damage.drive != DamageDrive::stretch, table + "drive", "stretch",
          "must be \"release\" with a strength_surface");
  const double tension = damage.strength.value_or(damage.strength_of_peak);
  const auto& [compression, biaxial] =
      std::pair(damage.compressive_strength, damage.biaxial_strength);
  require(damage.strength_surface == StrengthCriterion::rankine || compression || biaxial,
          table + "compressive_strength", "",
          damage.strength_surface == StrengthCriterion::drucker_prager
              ? "is missing; give it, or biaxial_strength"
              : "is missing");
  require(!compression || *compression > tension, table + "compressive_strength",
          number_text(compression.value_or(0.0)),
          "must be above strength, " + number_text(tension) + " Pa");
  require(!biaxial || *biaxial > 0.5 * tension * (1.0 + 1e-9), table + "biaxial_strength",
          number_text(biaxial.value_or(0.0)),
          "must be above half of strength, " + number_text(0.5 * tension) + " Pa");
  require_within(damage.strength_factor[0], 0.01, 1.0, table + "strength_factor[0]");
  require_within(damage.strength_factor[1], 1.0, 100.0, table + "strength_factor[1]");
}

/// Refuses a law with too little or too much data to find its stretches.
void check_data(const DamageSpecification& damage, const std::string& table) {
  require_positive(damage.fracture_energy, table + "fracture_energy");
  require_positive(damage.fracture_toughness, table + "fracture_toughness");
  require_positive(damage.strength, table + "strength");
  check_surface(damage, table);
  if (damage.law == DamageLaw::none) {
    for (const std::string key : {"fracture_energy", "fracture_toughness", "strength", "critical",
                                  "stretches", "drive", "struts", "compression", "strength_surface",
                                  "compressive_strength", "biaxial_strength", "strength_factor"}) {
      require_absent(is_given(damage, key), table + key, "needs a law");
    }
    return;
  }
  for (const auto& [key, is_idle, why] : damage_rules) {
    require_absent(is_given(damage, key) && is_idle(damage), table + key, why);
  }
  if (damage.law == DamageLaw::table) return check_table(damage, table);
  if (damage.law == DamageLaw::energy_density) {
    require(damage.has_fracture_energy(), table + "fracture_energy", "", "is missing");
    return;
  }
  require(is_given(damage, "critical") || is_sized(damage), table + "critical", "",
          "is missing; give it, fracture_energy or fracture_toughness");
  if (!damage.softens()) return;
  require(is_given(damage, "onset") || damage.is_by_data(), table + "onset", "",
          "is missing; give it, or strength");
  require(damage.law != DamageLaw::blended || is_given(damage, "peak") || damage.strength ||
              (damage.has_fracture_energy() && !is_given(damage, "onset")),
          table + "peak", "", "is missing; give it, or strength");
}

}  // namespace

void check_damage(const DamageSpecification& damage, const std::string& table) {
  check_data(damage, table);
  if (damage.law == DamageLaw::none) return;
  if (damage.law == DamageLaw::table) return;
  const auto check_stretch = [&](double stretch, const char* key) {
    if (stretch != 0.0) require_within(stretch, 1e-9, 1e3, table + key);
  };
  check_stretch(damage.critical, "critical");
  if (!damage.softens()) return;
  check_stretch(damage.onset, "onset");
  if (damage.has_rate()) require_within(damage.rate, 0.1, 50.0, table + "rate");
  if (damage.critical != 0.0) {
    require(damage.onset < damage.critical * damage.largest_onset(), table + "onset",
            number_text(damage.onset),
            damage.opens() ? fmt::format("must be smaller than {:.4g} of critical: with this law a "
                                         "bond would otherwise snap back as it opens",
                                         damage.largest_onset())
                           : "must be smaller than critical");
  }
  if (damage.law != DamageLaw::blended) return;
  require_within(damage.hardening, 0.0, 0.99, table + "hardening");
  if (damage.peak == 0.0) return;
  require(damage.onset <= damage.peak, table + "peak", number_text(damage.peak),
          "must be at least onset");
  require(damage.critical == 0.0 || damage.peak < damage.critical * (1.0 - 1e-9), table + "peak",
          number_text(damage.peak), "must be smaller than critical");
}

}  // namespace peristat
