#pragma once

#include <optional>
#include <vector>

#include "solvers/formulations/materials/point_materials.hpp"
#include "solvers/formulations/specification/body_specification.hpp"
#include "src/geometry/points.hpp"
#include "src/materials/directed_constant.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/communicator.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Micromodulus of the bonds of a material of model "bond", by their direction.
/// @param key of the material, for errors
/// @throws InputError for fibres whose constant would be negative in some direction
[[nodiscard]] DirectedConstant micromodulus_of(const MaterialSpecification& material,
                                               const std::string& key, const BondSetting& setting);

/// Random factors of points; empty: all 1.
struct PointFactors {
  std::vector<double> stiffness, strength;

  [[nodiscard]] static double of_bond(const std::vector<double>& factors, Index i, Index j) {
    return factors.empty() ? 1.0 : 0.5 * (factors[std::size_t(i)] + factors[std::size_t(j)]);
  }
};

/// Constants and laws of damage of the bonds of a body that has several of them: a body with
/// regions, fibres or random fields.
///
/// The stiffness of a bond is part of its weight, relative to that of the first material, because
/// kernels have one modulus. The law of damage is the potential's, the same for all bonds or one
/// for each (DegradedByBond).
class BondMaterials {
 public:
  /// @param constants per material, and per interface with constants of its own (see all_materials)
  BondMaterials(const BodySpecification& from, const PointMaterials& materials,
                const PointFactors& factors, const Points& points,
                std::vector<DirectedConstant> constants);

  /// Modulus of the potential of all bonds [N/m6].
  [[nodiscard]] double modulus() const { return modulus_; }

  /// Multiplies the weights of bonds by their stiffness over the modulus.
  void weigh(Bonds& bonds) const;

  /// The potential of bonds, and flags of those that never fail: bonds without a law, and those of
  /// the sets of no_fail.
  struct Failing {
    BondPotential potential;
    std::vector<char> never_fails;
  };
  /// @param fineness per bond, see fineness_of_bonds, for stretches that follow from a fracture
  ///        energy; empty: 1
  [[nodiscard]] Failing potential(const Bonds& bonds,
                                  const std::vector<double>& fineness = {}) const;

 private:
  /// The potential with smoothly falling laws, without a saw-tooth.
  [[nodiscard]] Failing smooth_potential(const Bonds& bonds,
                                         const std::vector<double>& fineness) const;

  /// Constants and law of one kind of bond.
  struct Kind {
    DirectedConstant constant;
    const MaterialSpecification* material;
  };
  struct Pair {
    InterfaceRule rule;
    std::ptrdiff_t own;  ///< kind of the pair itself; -1: by the rule
  };
  /// A law and its stretches.
  struct Strength {
    std::size_t law = 0;  ///< number of the kind whose law it is
    double onset = 0.0, critical = 0.0;
  };

  [[nodiscard]] Coordinates direction(const Bonds& bonds, Index i, Offset bond) const;
  [[nodiscard]] double constant(std::size_t a, std::size_t b, const Coordinates& n) const;
  /// @param fineness the body's horizon over the bond's
  [[nodiscard]] std::optional<Strength> strength(std::size_t kind, const Coordinates& n,
                                                 double fineness) const;
  [[nodiscard]] std::optional<Strength> strength(std::size_t a, std::size_t b, const Coordinates& n,
                                                 double fineness) const;
  /// True if all bonds that fail have the same law with the same stretches.
  [[nodiscard]] bool has_one_law() const;
  /// True if the stretches of a material follow from a fracture energy.
  [[nodiscard]] bool are_any_by_energy() const;

  const BodySpecification& from_;
  const PointMaterials& materials_;
  const PointFactors& factors_;
  const Points& points_;
  std::vector<Kind> kinds_;  // materials, then interfaces with constants of their own
  std::vector<Pair> pairs_;  // a * materials + b
  double modulus_ = 0.0;
};

/// Materials and interfaces with constants of their own, in the order of BondMaterials, with their
/// keys.
[[nodiscard]] std::vector<PointMaterials::Material> all_materials(const BodySpecification& from,
                                                                  const PointMaterials& materials);

/// Micromoduli of the bonds inside the materials and of interfaces with constants of their own.
[[nodiscard]] std::vector<DirectedConstant> micromoduli(const BodySpecification& from,
                                                        const PointMaterials& materials,
                                                        const BondSetting& setting);

/// Refuses an interface that no bond of any rank crosses: a name or a set must be wrong.
/// Collective.
/// @throws InputError ("interfaces[0].between")
void refuse_idle_interfaces(const BodySpecification& from, const PointMaterials& materials,
                            const Bonds& bonds, const Communicator& ranks);

}  // namespace peristat
