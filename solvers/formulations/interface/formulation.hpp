#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assembly/stress.hpp"
#include "assembly/terms/model.hpp"
#include "solvers/formulations/interface/options.hpp"
#include "solvers/formulations/materials/bond_materials.hpp"
#include "solvers/formulations/materials/fracture_data.hpp"
#include "solvers/formulations/materials/point_materials.hpp"
#include "solvers/formulations/specification/body_specification.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "src/connectivity/crack.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// What a model is made of, beside its bonds. All of it outlives the call.
struct ModelSetting {
  const BodySpecification& of;
  const PointMaterials& materials;
  const PointFactors& factors;
  const Points& points;
  const BondSetting& bonds;  ///< of the body, without what Formulation::setting_of_bonds changes
  const IndexMap& index_map;
  int threads;
};

struct MadeModel {
  Model model;
  CutBonds cut{};                      ///< bonds that pre-cracks have cut
  std::vector<std::string> remarks{};  ///< lines for `check`
};

/// Isotropic moduli of a material.
struct Moduli {
  double youngs_modulus = 0.0;  ///< [Pa]
  double poisson_ratio = 0.0;
  bool is_thin = false;  ///< in plane stress
};

/// By release, so that the fracture energy is known in closed form, where one is given.
[[nodiscard]] inline DamageDrive release_by_energy(const DamageSpecification& damage) {
  return damage.has_fracture_energy() ? DamageDrive::release : DamageDrive::stretch;
}

/// A line of `check` about a material: "constants", and their text.
struct MaterialLine {
  std::string topic, text;
};

/// A setting of bonds whose weights leave the influence function to something else.
[[nodiscard]] inline BondSetting without_influence(BondSetting setting) {
  setting.influence = {};
  return setting;
}

/// A kind of peridynamics: what the program asks of it in the place of its name, the data that it
/// takes, and how it makes its model. Functions that are null have nothing to do.
struct Formulation {
  MaterialModel model;
  const char* label;  ///< for messages: "\"lps\" by collocation"
  OptionSet takes;
  /// Options with forces by convolutions; none: it has no such forces.
  std::optional<OptionSet> takes_convolved{};
  bool needs_convolutions = false;
  int least_dimension = 1;
  const char* default_influence = ConstantInfluence::name;
  /// True if forces are minus the derivative of an energy, so that the tangent is symmetric.
  bool has_potential = true;
  /// Bonds that a part of a body has.
  PartBonds part_bonds = PartBonds::of_owned;
  /// True if parts of a body need a lattice, whose neighbours' volumes are whole or linear.
  bool part_needs_lattice = true;
  /// True if lattice sites beyond the surface take part.
  bool has_ghost_sites = false;
  /// True if points couple that have a neighbour in common, unless forces are convolutions.
  bool couples_second_neighbours = false;
  /// Largest number of points of an interaction of a body of that dimension.
  int (*most_points)(int dimension) = [](int) { return 2; };
  /// Largest horizon over spacing whose neighbourhood in the bulk is summed in seconds.
  double (*largest_horizon_ratio)(int dimension) = [](int d) { return d == 3 ? 100.0 : 1000.0; };
  /// The stress that follows from those in the plane by Poisson's ratio, in plane strain.
  AcrossPlane across_plane = AcrossPlane::cauchy_stress;
  /// True if `check` reports the error of its quadrature of bonds.
  bool has_quadrature_of_bonds = false;
  /// True if fracture energy and strength of every law are known without a search of minutes.
  bool has_quick_fracture_scale = false;
  /// True if it is measured when a crack of brittle bonds begins to run (see crack_trapping).
  bool has_measured_trapping = false;
  /// True if elastic bonds of another horizon can replace the body between damaging states.
  bool has_elastic_stand_in = false;

  /// Refuses materials that are incomplete or contradict themselves, beyond what `takes` says.
  /// @param key of the material
  /// @throws InputError
  void (*check_material)(const MaterialSpecification&, const std::string& key, int dimension);
  /// Refuses bodies that it can't represent, likewise.
  void (*check_body)(const BodySpecification&, const Points&) = nullptr;
  /// Setting with which the bonds of a body are made; null: that of the body.
  BondSetting (*setting_of_bonds)(BondSetting) = nullptr;
  /// Makes the model of a body. Collective for a part.
  /// @param bonds with setting_of_bonds; with convolutions those of setting_of_short_bonds
  /// @throws InputError
  MadeModel (*make_model)(const ModelSetting&, Bonds bonds);

  /// Of a material, its key for errors, the body's setting and the spacing:
  template <class Result>
  using OfMaterial = Result (*)(const MaterialSpecification&, const std::string& key,
                                const BondSetting&, double spacing);
  OfMaterial<Moduli> moduli;
  /// Describes its constants and moduli.
  OfMaterial<std::vector<MaterialLine>> describe;
  /// Scale of the fracture energy and strength of a material without fibres; null: they are no sums
  /// over bonds.
  OfMaterial<FractureScale> fracture_scale = nullptr;
  /// Energy that a plane crack takes under a uniform dilation, per squared critical stretch [J/m2],
  /// if stretch drives damage; null: fracture_scale has it.
  OfMaterial<double> crack_energy_of_dilation = nullptr;
  /// What drives damage whose material does not say; null: stretch alone can.
  DamageDrive (*default_drive)(const DamageSpecification&) = nullptr;
  /// A sentence that warns of the fracture data of a material; empty: nothing to warn of.
  OfMaterial<std::string> fracture_warning = nullptr;
  /// Key of a constant below zero, whose interactions store less energy the more they deform; empty
  /// if there is none.
  OfMaterial<std::string> negative_constant = nullptr;
};

/// Setting with which the bonds of a body are made.
[[nodiscard]] inline BondSetting setting_of_bonds(const Formulation& of, BondSetting setting) {
  return of.setting_of_bonds ? of.setting_of_bonds(std::move(setting)) : setting;
}

}  // namespace peristat
