#include "solvers/formulations/specification/check_damage.hpp"

#include "solvers/formulations/specification/require.hpp"

namespace peristat {
namespace {

/// Refuses a law with too little or too much data to find its stretches.
void check_data(const DamageSpecification& damage, const std::string& table) {
  const auto is_given = [](double stretch) { return stretch != 0.0; };
  require_positive(damage.fracture_energy, table + "fracture_energy");
  require_positive(damage.strength, table + "strength");
  if (damage.law == DamageLaw::none) {
    require_absent(damage.fracture_energy.has_value(), table + "fracture_energy", "needs a law");
    require_absent(damage.strength.has_value(), table + "strength", "needs a law");
    require_absent(is_given(damage.critical), table + "critical", "needs a law");
    return;
  }
  if (damage.law == DamageLaw::energy_density) {
    require(damage.fracture_energy.has_value(), table + "fracture_energy", "", "is missing");
    const std::string of_stretches =
        "is for laws of stretches; energy_density needs fracture_energy";
    require_absent(damage.strength.has_value(), table + "strength", of_stretches);
    require_absent(is_given(damage.critical), table + "critical", of_stretches);
    require_absent(is_given(damage.onset), table + "onset", of_stretches);
    require_absent(is_given(damage.peak), table + "peak", of_stretches);
    return;
  }
  const bool is_blended = damage.law == DamageLaw::blended;
  const bool is_sized =
      damage.fracture_energy || (damage.law == DamageLaw::critical_stretch && damage.strength);
  require(is_given(damage.critical) != is_sized, table + "critical", "",
          is_sized
              ? "can't be given together with fracture_energy or strength: it follows from them"
              : "is missing; give it, or fracture_energy");
  require_absent(is_given(damage.peak) && (!is_blended || damage.strength), table + "peak",
                 is_blended ? "can't be given together with strength: it follows from it"
                            : "is for the law blended");
  if (!damage.softens()) {
    require_absent(is_given(damage.onset), table + "onset", "is for the laws that soften");
    return;
  }
  require_absent(is_given(damage.onset) && damage.strength && !is_blended, table + "onset",
                 "can't be given together with strength: it follows from it");
  require(is_given(damage.onset) || damage.is_by_data(), table + "onset", "",
          "is missing; give it, or strength");
  require(!is_blended || is_given(damage.peak) || damage.strength ||
              (damage.fracture_energy && !is_given(damage.onset)),
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
