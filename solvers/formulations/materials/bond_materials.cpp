#include "solvers/formulations/materials/bond_materials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "solvers/formulations/materials/bond_potential.hpp"
#include "solvers/formulations/materials/fracture_data.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/materials/bulk_bonds.hpp"
#include "src/parallel/communicator.hpp"
#include "src/potentials/make_saw_tooth.hpp"

namespace peristat {
namespace {

Coordinates direction_of(const FibreSpecification& fibre, int dimension) {
  if (dimension == 2) {
    const double angle = fibre.angle * std::numbers::pi / 180.0;
    return {std::cos(angle), std::sin(angle), 0.0};
  }
  Coordinates direction = fibre.direction;
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  for (double& component : direction) component /= length;
  return direction;
}

[[noreturn]] void refuse_negative(const FibreModuli& moduli, const std::string& key,
                                  const BondSetting& setting) {
  const auto [least, most] = possible_shear(moduli, setting);
  throw InputError(
      key + ".fibre", "",
      "bonds of some directions would have a negative constant: with a fourth-order harmonic, "
      "youngs_modulus = " +
          number_text(moduli.along) + ", transverse_modulus = " + number_text(moduli.across) +
          " and shear_modulus = " + number_text(moduli.shear) + " are not possible together; " +
          (least > 0.0 ? "the first two allow a shear_modulus from about " +
                             fmt::format("{:.3g}", least) + " to " + fmt::format("{:.3g}", most)
                       : "no shear_modulus is possible with the first two"));
}

/// True if laws differ at most in their onset and critical stretch; blended ones must also have the
/// same relative peak.
bool same_law(const DamageSpecification& one, const DamageSpecification& other) {
  if (one.law != other.law) return false;
  switch (one.law) {
    case DamageLaw::tanh:
    case DamageLaw::tanh_continuous:
    case DamageLaw::exponential:
      return one.rate == other.rate;
    case DamageLaw::blended:
      // Values found from data have round-off, and the tolerance of a strength.
      return one.hardening == other.hardening && std::abs(one.rise() - other.rise()) < 1e-6;
    case DamageLaw::table:
      return one.stretches == other.stretches && one.forces == other.forces;
    case DamageLaw::critical_stretch:
    case DamageLaw::linear:
    case DamageLaw::bilinear:
    case DamageLaw::cornelissen:
    case DamageLaw::none:
    case DamageLaw::energy_density:
      break;
  }
  return true;
}

bool is_same(const DamageSpecification& one, const DamageSpecification& other) {
  return same_law(one, other) && one.onset == other.onset && one.critical == other.critical;
}

}  // namespace

DirectedConstant micromodulus_of(const MaterialSpecification& material, const std::string& key,
                                 const BondSetting& setting) {
  if (!material.fibre) {
    const bool is_of_lattice = material.calibration == Calibration::lattice;
    const double c = material.micromodulus ? *material.micromodulus
                     : is_of_lattice       ? bulk_micromodulus(*material.youngs_modulus, setting)
                                           : micromodulus(*material.youngs_modulus, setting);
    return {{c, 0.0, 0.0}, {}};
  }
  const FibreSpecification& fibre = *material.fibre;
  const double along = *material.youngs_modulus, across = fibre.transverse_modulus;
  const FibreModuli moduli{along, across,
                           fibre.shear_modulus.value_or(natural_shear(along, across, setting))};
  const DirectedConstant constant =
      directed_micromodulus(moduli, direction_of(fibre, setting.dimension), setting);
  // A bond without stiffness would connect points that it can't hold.
  if (!(constant.least() > 1e-6 * constant.at(1.0))) refuse_negative(moduli, key, setting);
  return constant;
}

std::vector<PointMaterials::Material> all_materials(const BodySpecification& from,
                                                    const PointMaterials& materials) {
  std::vector<PointMaterials::Material> all = materials.all();
  for (std::size_t k = 0; k < from.interfaces.size(); ++k) {
    const InterfaceSpecification& interface = from.interfaces[k];
    if (!interface.material) continue;
    const auto& [a, b] = interface.between;
    all.push_back({&*interface.material, "interfaces[" + std::to_string(k) + "].material",
                   interface.is_of_all() ? "interfaces" : a + " - " + b});
  }
  return all;
}

std::vector<DirectedConstant> micromoduli(const BodySpecification& from,
                                          const PointMaterials& materials,
                                          const BondSetting& setting) {
  std::vector<DirectedConstant> constants;
  for (const auto& material : all_materials(from, materials)) {
    constants.push_back(micromodulus_of(*material.of, material.key, setting));
  }
  return constants;
}

BondMaterials::BondMaterials(const BodySpecification& from, const PointMaterials& materials,
                             const PointFactors& factors, const Points& points,
                             std::vector<DirectedConstant> constants)
    : from_(from), materials_(materials), factors_(factors), points_(points) {
  const auto all = all_materials(from, materials);
  for (std::size_t k = 0; k < all.size(); ++k) kinds_.push_back({constants.at(k), all[k].of});
  modulus_ = kinds_.front().constant.at(1.0);
  const std::size_t count = materials.all().size();
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const InterfaceSpecification& interface = materials.between(a, b);
      const auto own = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& kind) {
        return interface.material && kind.material == &*interface.material;
      });
      pairs_.push_back({interface.rule, own == kinds_.end() ? -1 : own - kinds_.begin()});
    }
  }
}

Coordinates BondMaterials::direction(const Bonds& bonds, Index i, Offset bond) const {
  Coordinates n = points_.position(bonds.partner(i, bond));
  const Coordinates from = points_.position(i);
  for (std::size_t c = 0; c < 3; ++c) n[c] = (n[c] - from[c]) * bonds.inverse_length(bond);
  return n;
}

double BondMaterials::constant(std::size_t a, std::size_t b, const Coordinates& n) const {
  const auto of_kind = [&](std::size_t kind) {
    const DirectedConstant& constant = kinds_[kind].constant;
    return constant.at(constant.alignment(n));
  };
  if (a == b) return of_kind(a);
  const Pair& pair = pairs_[a * materials_.all().size() + b];
  if (pair.own >= 0) return of_kind(std::size_t(pair.own));
  return mean_by(pair.rule, std::array{of_kind(a), of_kind(b)});
}

void BondMaterials::weigh(Bonds& bonds) const {
  bonds.set_weights([&](Index i, Offset bond) {
    const Index j = bonds.partner(i, bond);
    const double stiffness =
        constant(materials_.of(i), materials_.of(j), direction(bonds, i, bond)) / modulus_;
    return bonds.weight(bond) * stiffness * PointFactors::of_bond(factors_.stiffness, i, j);
  });
}

std::optional<BondMaterials::Strength> BondMaterials::strength(std::size_t kind,
                                                               const Coordinates& n,
                                                               double fineness) const {
  const auto& [constant, material] = kinds_[kind];
  const DamageSpecification& damage = material->damage;
  if (damage.law == DamageLaw::none) return {};
  const auto [onset, critical] = damage.is_by_energy ? stretches_of(damage, fineness)
                                                     : LawStretches{damage.onset, damage.critical};
  double share = 1.0;  // relative to the stretches along the fibres
  if (material->fibre && material->fibre->transverse_critical) {
    const double t = constant.alignment(n);
    share = t + (1.0 - t) * *material->fibre->transverse_critical / damage.critical;
  }
  const bool is_brittle = damage.law == DamageLaw::critical_stretch;
  return Strength{kind, share * (is_brittle ? critical : onset), share * critical};
}

/// Bonds between equal laws have the mean of their stretches; between different ones the weaker law
/// decides. If one of the materials does not fail, the bond has the law of the other.
std::optional<BondMaterials::Strength> BondMaterials::strength(std::size_t a, std::size_t b,
                                                               const Coordinates& n,
                                                               double fineness) const {
  if (a == b) return strength(a, n, fineness);
  const Pair& pair = pairs_[a * materials_.all().size() + b];
  if (pair.own >= 0) return strength(std::size_t(pair.own), n, fineness);
  const auto one = strength(a, n, fineness), other = strength(b, n, fineness);
  if (!one || !other) return one ? one : other;
  if (!same_law(kinds_[a].material->damage, kinds_[b].material->damage)) {
    return one->critical <= other->critical ? one : other;
  }
  return Strength{one->law, mean_by(pair.rule, std::array{one->onset, other->onset}),
                  mean_by(pair.rule, std::array{one->critical, other->critical})};
}

bool BondMaterials::are_any_by_energy() const {
  return std::ranges::any_of(kinds_,
                             [](const Kind& kind) { return kind.material->damage.is_by_energy; });
}

bool BondMaterials::has_one_law() const {
  const DamageSpecification* first = nullptr;
  for (const auto& [constant, material] : kinds_) {
    if (material->damage.law == DamageLaw::none) continue;
    if (!first) first = &material->damage;
    if (!is_same(*first, material->damage) || material->damage.has_surface()) return false;
    if (material->fibre && material->fibre->transverse_critical) return false;
  }
  return factors_.strength.empty();
}

BondMaterials::Failing BondMaterials::potential(const Bonds& bonds,
                                                const std::vector<double>& fineness) const {
  Failing result = smooth_potential(bonds, fineness);
  if (from_.teeth == 0) return result;
  try {
    result.potential = with_teeth(result.potential, from_.teeth);
  } catch (const std::length_error& error) {
    throw InputError("loading.teeth", std::to_string(from_.teeth), error.what());
  }
  return result;
}

BondMaterials::Failing BondMaterials::smooth_potential(const Bonds& bonds,
                                                       const std::vector<double>& fineness) const {
  const auto fails = [](const Kind& kind) { return kind.material->damage.law != DamageLaw::none; };
  const auto failing = std::ranges::find_if(kinds_, fails);
  if (failing == kinds_.end()) return {bond_potential(*kinds_.front().material, modulus_), {}};

  Failing result{bond_potential(*failing->material, modulus_),
                 never_failing_bonds(all_materials(from_, materials_), points_, bonds)};
  const bool has_one = has_one_law() && (fineness.empty() || !are_any_by_energy());
  if (has_one && std::ranges::all_of(kinds_, fails)) return result;
  result.never_fails.resize(std::size_t(bonds.count()));
  std::vector<AnyBondLaw> laws;
  for (const Kind& kind : kinds_) laws.push_back(bond_law(law_of(kind.material->damage)));
  auto by_bond = std::make_shared<BondLaws>(laws, has_one ? 0 : std::size_t(bonds.count()));
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      const double of_horizons = fineness.empty() ? 1.0 : fineness[std::size_t(bond)];
      const auto own =
          strength(materials_.of(i), materials_.of(j), direction(bonds, i, bond), of_horizons);
      if (!own) {
        result.never_fails[std::size_t(bond)] = 1;
      } else if (!has_one) {
        const double factor = PointFactors::of_bond(factors_.strength, i, j);
        by_bond->set(bond, own->law, factor * own->onset, factor * own->critical);
      }
    }
  }
  if (!has_one) result.potential = with_laws(result.potential, std::move(by_bond));
  return result;
}

void refuse_idle_interfaces(const BodySpecification& from, const PointMaterials& materials,
                            const Bonds& bonds, const Communicator& ranks) {
  std::vector<double> is_met(from.interfaces.size());
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const std::size_t a = materials.of(i), b = materials.of(bonds.partner(i, bond));
      if (a == b) continue;
      const InterfaceSpecification* const met = &materials.between(a, b);
      for (std::size_t k = 0; k < is_met.size(); ++k) {
        if (met == &from.interfaces[k]) is_met[k] = 1.0;
      }
    }
  }
  is_met = ranks.max(is_met);
  for (std::size_t k = 0; k < is_met.size(); ++k) {
    if (is_met[k] > 0.0) continue;
    throw InputError("interfaces[" + std::to_string(k) + "]", "",
                     "no bond joins points of these materials: they are farther apart than the "
                     "horizon, or another interface has this pair");
  }
}

}  // namespace peristat
