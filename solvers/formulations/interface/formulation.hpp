#pragma once

#include <optional>
#include <string>
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

/// What the program asks of a formulation in the place of its name.
struct Capabilities {
  Options takes;
  /// Options with forces by convolutions; none: it has no such forces.
  std::optional<Options> takes_convolved{};
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
  /// Largest number of points of an interaction whose stiffness is known in closed form.
  int (*most_points)(int dimension) = [](int) { return 2; };
  /// The stress that follows from those in the plane by Poisson's ratio, in plane strain.
  AcrossPlane across_plane = AcrossPlane::cauchy_stress;
  /// True if `check` reports the error of its quadrature of bonds.
  bool has_quadrature_of_bonds = false;
  /// True if fracture energy and strength of a law are known without a search of minutes.
  bool has_quick_fracture_scale = false;
  /// True if it is measured when a crack of brittle bonds begins to run (see crack_trapping).
  bool has_measured_trapping = false;
  /// True if elastic bonds of another horizon can replace the body between damaging states.
  bool has_elastic_stand_in = false;
};

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

/// A line of `check` about a material: "constants", and their text.
struct MaterialLine {
  std::string topic, text;
};

/// A kind of peridynamics: which data it takes, and how it makes its model.
class Formulation {
 public:
  virtual ~Formulation() = default;

  [[nodiscard]] virtual MaterialModel model() const = 0;
  /// For messages: "\"lps\" by collocation".
  [[nodiscard]] virtual std::string label() const = 0;
  [[nodiscard]] virtual Capabilities capabilities() const = 0;

  /// Largest horizon over spacing whose neighbourhood in the bulk is summed in seconds.
  [[nodiscard]] virtual double largest_horizon_ratio(int dimension) const {
    return dimension == 3 ? 100.0 : 1000.0;
  }

  /// Refuses materials that are incomplete or contradict themselves, as far as Capabilities do not
  /// say so.
  /// @param key of the material
  /// @throws InputError
  virtual void check(const MaterialSpecification& material, const std::string& key,
                     int dimension) const = 0;
  /// Refuses bodies that it can't represent, likewise.
  virtual void check(const BodySpecification&, const Points&) const {}

  /// Setting with which the bonds of a body are made.
  [[nodiscard]] virtual BondSetting setting_of_bonds(BondSetting setting) const { return setting; }

  /// Makes the model of a body. Collective for a part.
  /// @param bonds with setting_of_bonds; with convolutions those of short_bonds
  /// @throws InputError
  [[nodiscard]] virtual MadeModel make_model(const ModelSetting& setting, Bonds bonds) const = 0;

  /// Scale of the fracture energy and strength of a material without fibres; none: they are no
  /// sums over bonds.
  /// @throws InputError as FractureScale says
  [[nodiscard]] virtual std::optional<FractureScale> fracture_scale(const MaterialSpecification&,
                                                                    const std::string& /*key*/,
                                                                    const BondSetting&,
                                                                    double /*spacing*/) const {
    return std::nullopt;
  }
  /// Energy that a plane crack takes under a uniform dilation, per squared critical stretch [J/m2];
  /// none: fracture_scale has it.
  [[nodiscard]] virtual std::optional<double> crack_energy_of_dilation(
      const MaterialSpecification&, const BondSetting&) const {
    return std::nullopt;
  }

  /// Key of a constant below zero, whose interactions store less energy the more they deform; empty
  /// if there is none.
  [[nodiscard]] virtual std::string negative_constant(const MaterialSpecification&,
                                                      const std::string& /*key*/,
                                                      const BondSetting&,
                                                      double /*spacing*/) const {
    return {};
  }

  [[nodiscard]] virtual Moduli moduli(const MaterialSpecification& material, const std::string& key,
                                      const BondSetting& setting, double spacing) const = 0;

  /// Describes a material's constants and moduli.
  [[nodiscard]] virtual std::vector<MaterialLine> describe(const PointMaterials::Material& material,
                                                           const BondSetting& setting,
                                                           double spacing) const = 0;
};

}  // namespace peristat
