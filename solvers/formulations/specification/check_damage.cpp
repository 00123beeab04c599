#include "solvers/formulations/specification/check_damage.hpp"

#include <string_view>

#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

/// True if a datum differs from its default.
bool is_given(const DamageSpecification& damage, std::string_view key) {
  if (key == "fracture_energy") return damage.fracture_energy.has_value();
  if (key == "fracture_toughness") return damage.fracture_toughness.has_value();
  if (key == "strength") return damage.strength.has_value();
  if (key == "critical") return damage.critical != 0.0;
  if (key == "onset") return damage.onset != 0.0;
  return key == "peak" && damage.peak != 0.0;
}

/// Refuses a law with too little or too much data to find its stretches.
void check_data(const DamageSpecification& damage, const std::string& table) {
  require_positive(damage.fracture_energy, table + "fracture_energy");
  require_positive(damage.fracture_toughness, table + "fracture_toughness");
  require_positive(damage.strength, table + "strength");
  if (damage.law == DamageLaw::none) {
    for (const std::string key :
         {"fracture_energy", "fracture_toughness", "strength", "critical"}) {
      require_absent(is_given(damage, key), table + key, "needs a law");
    }
    return;
  }
  for (const auto& [key, is_idle, why] : damage_rules) {
    require_absent(is_given(damage, key) && is_idle(damage), table + key, why);
  }
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
  const auto check_stretch = [&](double stretch, const char* key) {
    if (stretch != 0.0) require_within(stretch, 1e-9, 1e3, table + key);
  };
  check_stretch(damage.critical, "critical");
  if (!damage.softens()) return;
  check_stretch(damage.onset, "onset");
  if (damage.has_rate()) require_within(damage.rate, 0.1, 50.0, table + "rate");
  if (damage.critical != 0.0) {
    require(damage.onset < damage.critical * (1.0 - 1e-9), table + "onset",
            number_text(damage.onset), "must be smaller than critical");
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
