#include "solvers/study/bond_potential.hpp"

#include <optional>
#include <tuple>

#include "src/core/input_error.hpp"

namespace peristat {

namespace {

template <class Whole>
BondPotential with_damage(const Whole& whole, const DamageSpecification& damage) {
  const auto [onset, critical, rate] = std::tuple(damage.onset, damage.critical, damage.rate);
  switch (damage.law) {
    case DamageLaw::none:
      return whole;
    case DamageLaw::critical_stretch:
      return Degraded<CriticalStretch, Whole>{whole.modulus, {critical}};
    case DamageLaw::tanh:
      return Degraded<TanhDegradation, Whole>{whole.modulus, {onset, critical, rate}};
    case DamageLaw::tanh_continuous:
      break;
  }
  return Degraded<TanhDegradation, Whole>{whole.modulus,
                                          TanhDegradation::continuous(onset, critical, rate)};
}

}  // namespace

BondPotential bond_potential(const MaterialSpecification& material, double micromodulus) {
  std::optional<BondPotential> result;
  WholeBondPotentials::for_each([&](auto whole) {
    if (material.potential != whole.name) return;
    whole.modulus = micromodulus;
    result = with_damage(whole, material.damage);
  });
  if (!result) {
    throw InputError("material.potential", '"' + material.potential + '"',
                     "bonds have no potential of this name");
  }
  return *result;
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
      of_bond[bond] = of_point[points.source(i)] | of_point[points.source(bonds.partner[bond])];
    }
  }
  return of_bond;
}

}  // namespace peristat
