#include "solvers/study/bond_potential.hpp"

#include "src/core/input_error.hpp"

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

double micromodulus_of(const BodySpecification& from, const BondSetting& setting) {
  const MaterialSpecification& material = from.material;
  return material.micromodulus ? *material.micromodulus
                               : micromodulus(*material.youngs_modulus, setting);
}

std::vector<char> never_failing_bonds(const BodySpecification& from, const Points& points,
                                      const Bonds& bonds) {
  const std::vector<std::string>& sets = from.material.damage.no_fail;
  if (sets.empty()) return {};
  std::vector<char> of_point(std::size_t(points.count())), of_bond(std::size_t(bonds.count()));
  for (const std::string& set : sets) {
    const auto members = points.sets.find(set);
    if (members == points.sets.end())
      throw InputError("material.damage.no_fail", '"' + set + '"', "no set of this name");
    for (const Index i : members->second) of_point[i] = 1;
  }
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      of_bond[bond] = of_point[i] | of_point[bonds.partner[bond]];
    }
  }
  return of_bond;
}

}  // namespace peristat
