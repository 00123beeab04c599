#include "solvers/formulations/materials/bond_potential.hpp"

#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "src/core/input_error.hpp"

namespace peristat {

namespace {

template <class Whole>
BondPotential with_damage(const Whole& whole, const DamageSpecification& damage) {
  if (damage.law == DamageLaw::none) return whole;
  return std::visit(
      [&]<class Law>(const Law& law) -> BondPotential {
        Degraded<Law, Whole> degraded{whole.modulus, law};
        degraded.closes = damage.compression == Compression::kept;
        return degraded;
      },
      law_of(damage).law);
}

}  // namespace

AnyLaw law_of(const DamageSpecification& damage) {
  const double onset = damage.onset, critical = damage.critical, rate = damage.rate;
  switch (damage.law) {
    case DamageLaw::energy_density:
      throw std::logic_error("bonds have no law of points");
    case DamageLaw::tanh:
      return {TanhDegradation{onset, critical, rate}};
    case DamageLaw::tanh_continuous:
      return {TanhDegradation::continuous(onset, critical, rate)};
    case DamageLaw::linear:
      return {ForceEnvelope{onset, critical}};
    case DamageLaw::exponential:
      return {ForceEnvelope{onset, critical, rate}};
    case DamageLaw::blended:
      return {ForceEnvelope{onset, critical, 0.0, damage.rise(), damage.hardening}};
    case DamageLaw::table:
      return {ForceTable{std::make_shared<const ForceCurve>(damage.stretches, damage.forces),
                         damage.stretches.back()}};
    case DamageLaw::bilinear:
    case DamageLaw::cornelissen:
      return {OpeningLaw{onset, critical, damage.opening_curve()}};
    case DamageLaw::critical_stretch:
    case DamageLaw::none:
      break;
  }
  return {CriticalStretch{critical}};
}

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

BondPotential with_laws(const BondPotential& failing, std::shared_ptr<const BondLaws> laws) {
  return std::visit(
      [&]<class P>(const P& potential) -> BondPotential {
        if constexpr (PotentialWithHistory<P>) {
          DegradedByBond by_bond{potential.modulus, std::move(laws), potential.shape};
          by_bond.closes = potential.closes;
          return by_bond;
        } else {
          throw std::logic_error("bonds that never fail have no laws of damage");
        }
      },
      failing);
}

std::vector<char> never_failing_bonds(const std::vector<PointMaterials::Material>& materials,
                                      const Points& points, const Bonds& bonds) {
  std::vector<char> of_point(std::size_t(points.count()));
  bool is_any = false;
  for (const auto& material : materials) {
    for (const std::string& set : material.of->damage.no_fail) {
      const auto members = points.sets.find(set);
      if (members == points.sets.end())
        throw InputError(material.key + ".damage.no_fail", '"' + set + '"', "no set of this name");
      for (const Index i : members->second) of_point[i] = 1;
      is_any = true;
    }
  }
  if (!is_any) return {};
  std::vector<char> of_bond(std::size_t(bonds.count()));
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      of_bond[bond] = of_point[points.source(i)] | of_point[points.source(bonds.partner(i, bond))];
    }
  }
  return of_bond;
}

}  // namespace peristat
