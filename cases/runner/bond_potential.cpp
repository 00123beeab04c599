#include "cases/runner/bond_potential.hpp"

namespace peristat {

BondPotential bond_potential(const DamageSpecification& damage, double micromodulus) {
  switch (damage.law) {
    case DamageLaw::none:
      return Harmonic{micromodulus};
    case DamageLaw::critical_stretch:
      return Degraded<CriticalStretch>{micromodulus, {damage.critical}};
    case DamageLaw::tanh:
      return Degraded<TanhDegradation>{micromodulus, {damage.onset, damage.critical, damage.rate}};
    case DamageLaw::tanh_continuous:
      break;
  }
  return Degraded<TanhDegradation>{
      micromodulus, TanhDegradation::continuous(damage.onset, damage.critical, damage.rate)};
}

}  // namespace peristat
