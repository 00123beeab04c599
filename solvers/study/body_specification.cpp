#include "solvers/study/body_specification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/materials/poisson_ratio_limits.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

void require(bool holds, const std::string& key, const std::string& value,
             const std::string& allowed) {
  if (!holds) throw InputError(key, value, allowed);
}

void require_positive(const std::optional<double>& value, const std::string& key) {
  if (!value) return;
  require(std::isfinite(*value) && *value > 0.0, key, number_text(*value),
          "must be positive and finite");
}

void require_absent(bool is_given, const std::string& key, const std::string& why) {
  require(!is_given, key, "", why);
}

void require_within(double value, double least, double most, const std::string& key) {
  require(value >= least && value <= most, key, number_text(value),
          "must be from " + number_text(least) + " to " + number_text(most));
}

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

void check_bond_material(const MaterialSpecification& material, const std::string& key) {
  const std::string for_cpd = "is for the model cpd";
  require(material.youngs_modulus.has_value() != material.micromodulus.has_value(), key, "",
          "needs a youngs_modulus or a micromodulus, and not both");
  require_absent(material.poisson_ratio.has_value(), key + ".poisson_ratio",
                 for_cpd + "; with bonds alone it is 1/4, in plane stress 1/3");
  require_absent(material.c1.has_value(), key + ".c1", for_cpd);
  require_absent(material.c2 != 0.0, key + ".c2", for_cpd);
  require_absent(material.c3 != 0.0, key + ".c3", for_cpd);
  require_absent(material.calibration && !material.youngs_modulus, key + ".calibration",
                 "goes with youngs_modulus");
}

void check_cpd_material(const MaterialSpecification& material, const std::string& key,
                        int dimension) {
  require(dimension > 1, key + ".model", "cpd", "needs dimension 2 or 3");
  require(material.youngs_modulus.has_value() != material.c1.has_value(), key, "",
          "needs a youngs_modulus with a poisson_ratio, or c1, and not both");
  require_absent(material.micromodulus.has_value(), key + ".micromodulus", "is for the model bond");
  require(material.poisson_ratio.has_value() == material.youngs_modulus.has_value(),
          key + ".poisson_ratio", "", "goes with youngs_modulus");
  require(std::isfinite(material.c2), key + ".c2", number_text(material.c2), "must be finite");
  require(std::isfinite(material.c3), key + ".c3", number_text(material.c3), "must be finite");
  const bool has_moduli = material.youngs_modulus.has_value();
  require_absent(has_moduli && dimension == 2 && material.c2 != 0.0, key + ".c2",
                 "follows from youngs_modulus and poisson_ratio in 2D");
  require_absent((has_moduli || dimension == 2) && material.c3 != 0.0, key + ".c3",
                 has_moduli ? "follows from youngs_modulus and poisson_ratio" : "must be 0 in 2D");
}

/// Checks a material of model lps or correspondence.
void check_solid_material(const MaterialSpecification& material, const std::string& key,
                          int dimension) {
  const std::string name = material.model == MaterialModel::lps ? "lps" : "correspondence";
  require(dimension > 1, key + ".model", name, "needs dimension 2 or 3");
  require(material.youngs_modulus.has_value(), key + ".youngs_modulus", "", "is missing");
  require(material.poisson_ratio.has_value(), key + ".poisson_ratio", "", "is missing");
  const double nu = *material.poisson_ratio;
  require(nu > -1.0 && nu < 0.5, key + ".poisson_ratio", number_text(nu),
          "must be above -1 and below 0.5");
  // In plane stress 1/2 is no incompressible limit.
  const bool is_plane_stress = dimension == 2 && material.plane == PlaneState::stress;
  require(1.0 + nu >= least_distance_of_poisson_ratio &&
              (is_plane_stress || 1.0 - 2.0 * nu >= least_distance_of_poisson_ratio),
          key + ".poisson_ratio", number_text(nu),
          "is so near its limit that too few digits of double precision are left: take at most "
          "0.49999995, and at least -0.9999999");
  const std::string has_own = "is not for the model " + name + ", whose constants are E and nu";
  require_absent(material.micromodulus.has_value(), key + ".micromodulus", has_own);
  require_absent(material.c1.has_value(), key + ".c1", has_own);
  require_absent(material.c2 != 0.0, key + ".c2", has_own);
  require_absent(material.c3 != 0.0, key + ".c3", has_own);
  require_absent(material.calibration.has_value(), key + ".calibration", has_own);
  require_absent(material.potential != Harmonic::name, key + ".potential",
                 "is not for the model " + name + ", whose energy is quadratic in strains");
  require(!material.damage.softens(), key + ".damage.law", "",
          material.model == MaterialModel::lps
              ? "must be \"critical_stretch\" with the model lps, or \"energy_density\" with "
                "operator \"fft\""
              : "must be \"energy_density\" with the model correspondence");
  require_absent(material.damage.strength.has_value(), key + ".damage.strength",
                 "is not for the model " + name + "; give fracture_energy" +
                     (material.model == MaterialModel::lps ? " or critical" : ""));
  require_absent(material.thermal_expansion.has_value(), key + ".thermal_expansion",
                 "is not for the model " + name);
}

/// Checks that a model for convolutions alone has its one potential and its one damage law.
void check_polynomial_material(const MaterialSpecification& material, const std::string& key) {
  const MaterialSpecification defaults;
  const bool is_stabilised = material.model == MaterialModel::correspondence;
  require_absent(!is_stabilised && material.stabilisation != defaults.stabilisation,
                 key + ".stabilisation", "is for the model correspondence");
  require(std::isfinite(material.stabilisation) && material.stabilisation > 0.0,
          key + ".stabilisation", number_text(material.stabilisation),
          "must be positive and finite");
  if (!is_polynomial(material.model)) return;
  require(material.kinematics == Kinematics::finite, key + ".kinematics", "linear",
          "is for the models bond and lps");
  require(material.potential == Harmonic::name, key + ".potential", material.potential,
          "is for the model bond");
  const DamageLaw law = material.damage.law;
  require(law == DamageLaw::none || law == DamageLaw::energy_density, key + ".damage.law", "",
          "must be \"energy_density\" with this model: bonds that break one by one are not "
          "convolutions");
}

void check_kinematics(const MaterialSpecification& material, const std::string& key) {
  const DamageLaw law = material.damage.law;
  if (material.kinematics == Kinematics::finite || material.model == MaterialModel::lps) {
    require(law != DamageLaw::energy_density || material.model == MaterialModel::lps ||
                is_polynomial(material.model),
            key + ".damage.law", "energy_density", "is for kinematics \"linear\"");
    return;
  }
  const std::string of_linear = "with kinematics \"linear\" it must be ";
  require(material.model == MaterialModel::bond, key + ".kinematics", "linear",
          "is for the models bond and lps");
  require(material.potential == Harmonic::name, key + ".potential", material.potential,
          of_linear + "\"harmonic\"");
  require(law == DamageLaw::none || law == DamageLaw::energy_density, key + ".damage.law", "",
          of_linear + "\"energy_density\": bonds that break one by one need kinematics \"finite\"");
}

void check_fibre(const MaterialSpecification& material, const std::string& key, int dimension) {
  if (!material.fibre) return;
  const FibreSpecification& fibre = *material.fibre;
  const std::string table = key + ".fibre";
  require_absent(material.model != MaterialModel::bond, table, "is for the model bond");
  require_absent(dimension == 1, table, "needs dimension 2 or 3");
  require_absent(!material.youngs_modulus, table,
                 "needs a youngs_modulus, the one along the fibres");
  require_absent(dimension == 2 && material.plane != PlaneState::stress, table,
                 "is for plane stress: in plane strain E_1, E_2 and the shear modulus do not "
                 "determine the constants");
  require(std::isfinite(fibre.angle), table + ".angle", number_text(fibre.angle), "must be finite");
  require_absent(dimension == 3 && fibre.angle != 0.0, table + ".angle",
                 "is for dimension 2; 3D has a direction");
  if (dimension == 3) {
    const auto& [x, y, z] = fibre.direction;
    const double length = std::hypot(x, y, z);
    require(std::isfinite(length) && length > 1e-100, table + ".direction",
            place_text(fibre.direction, 3), "must be finite, and not all zero");
  } else {
    require_absent(fibre.direction != Coordinates{}, table + ".direction",
                   "is for dimension 3; 2D has an angle");
  }
  require_positive(fibre.transverse_modulus, table + ".transverse_modulus");
  require_positive(fibre.shear_modulus, table + ".shear_modulus");
  require_absent(material.damage.is_by_data(), key + ".damage",
                 "with fibres toughness and strength depend on the direction; give critical and "
                 "fibre.transverse_critical");
  require_absent(material.calibration == Calibration::lattice, key + ".calibration",
                 "\"lattice\" is for materials without fibres");
  if (!fibre.transverse_critical) return;
  require_absent(!material.damage.breaks_bonds(), table + ".transverse_critical",
                 "needs a law of damage by stretches");
  require_within(*fibre.transverse_critical, 1e-9, 1e3, table + ".transverse_critical");
}

void check_scatter(const MaterialSpecification& material, const std::string& key) {
  using Quantity = ScatterSpecification::Quantity;
  bool is_known[2] = {false, false};
  for (std::size_t k = 0; k < material.scatter.size(); ++k) {
    const auto& [of, distribution, field] = material.scatter[k];
    const std::string table = key + ".scatter[" + std::to_string(k) + "]";
    require_absent(std::exchange(is_known[int(of)], true), table + ".of",
                   "another table of this material has the same quantity");
    require_absent(of == Quantity::strength && !material.damage.breaks_bonds(), table + ".of",
                   "strength needs a law of damage by stretches");
    require_within(field.modulus, 1.0, 1e3, table + ".weibull_modulus");
    require(std::isfinite(field.correlation_length) && field.correlation_length >= 0.0,
            table + ".correlation_length", number_text(field.correlation_length),
            "must be 0 or positive");
  }
}

void check_influence(const MaterialSpecification& material, const std::string& key) {
  const std::vector<std::string> names = influence_names();
  std::string listed;
  for (const std::string& name : names) listed += (listed.empty() ? "" : ", ") + name;
  require(std::ranges::find(names, material.influence) != names.end(), key + ".influence",
          '"' + material.influence + '"', "must be one of " + listed);
  require_absent(
      material.model == MaterialModel::cpd && material.calibration == Calibration::continuum &&
          material.influence != ConstantInfluence::name,
      key + ".calibration",
      "\"continuum\" is known for cpd with the constant influence function only; give \"lattice\"");
}

}  // namespace

void check_material(const MaterialSpecification& material, const std::string& key, int dimension) {
  check_influence(material, key);
  if (has_bonds(material.model))
    check_bond_material(material, key);
  else if (has_lame_constants(material.model))
    check_solid_material(material, key, dimension);
  else
    check_cpd_material(material, key, dimension);
  require_positive(material.youngs_modulus, key + ".youngs_modulus");
  require_positive(material.micromodulus, key + ".micromodulus");
  require_positive(material.c1, key + ".c1");
  require_positive(material.density, key + ".density");
  check_damage(material.damage, key + ".damage.");
  check_polynomial_material(material, key);
  check_kinematics(material, key);
  check_fibre(material, key, dimension);
  check_scatter(material, key);
}

namespace {

/// Requires that materials of regions and interfaces have the body's model.
void require_of_body(const MaterialSpecification& material, const std::string& key,
                     const BodySpecification& of) {
  const std::string same = "must be the same for all materials of a body";
  require(material.model == of.material.model, key + ".model", "", same);
  require(material.potential == of.material.potential, key + ".potential", "", same);
  require(material.plane == of.material.plane, key + ".plane", "", same);
  require(material.influence == of.material.influence, key + ".influence", "", same);
  require(material.kinematics == of.material.kinematics, key + ".kinematics", "", same);
}

bool is_material_of(const std::string& name, const BodySpecification& of) {
  if (name == rest_name) return of.material.has_constants();
  return std::any_of(of.regions.begin(), of.regions.end(),
                     [&](const RegionSpecification& region) { return region.set == name; });
}

bool is_same_pair(const InterfaceSpecification& one, const InterfaceSpecification& other) {
  const auto& [a, b] = one.between;
  return one.between == other.between || other.between == std::array{b, a};
}

void check_interface(const InterfaceSpecification& interface, const std::string& key,
                     const BodySpecification& of, int dimension) {
  const auto& [a, b] = interface.between;
  require_absent(of.regions.empty(), key, "needs regions");
  for (const std::string& name : interface.between) {
    require(interface.is_of_all() || is_material_of(name, of), key + ".between", '"' + name + '"',
            std::string("must be the set of a region, or \"") + rest_name +
                "\" for the points in no region");
  }
  require(interface.is_of_all() || a != b, key + ".between", '"' + a + '"',
          "must name two materials");
  if (!interface.material) return;
  const MaterialSpecification& material = *interface.material;
  require_of_body(material, key + ".material", of);
  check_material(material, key + ".material", dimension);
  require_absent(!material.scatter.empty(), key + ".material.scatter",
                 "belongs to points, so give it in the materials of the regions");
  require_absent(material.density.has_value(), key + ".material.density",
                 "belongs to points, so give it in the materials of the regions");
  require_absent(material.damage.law == DamageLaw::energy_density, key + ".material.damage",
                 "is a law of points that fail, so give it in the materials of the regions");
}

void check_regions(const BodySpecification& of, int dimension) {
  require(
      of.regions.size() + of.interfaces.size() <= most_materials, "regions", "",
      "there are at most " + std::to_string(most_materials) + " regions and interfaces together");
  for (std::size_t k = 0; k < of.regions.size(); ++k) {
    const std::string key = "regions[" + std::to_string(k) + "]";
    require(of.regions[k].set != rest_name, key + ".set", '"' + of.regions[k].set + '"',
            "is the name for the points in no region; give the set another name");
    require_of_body(of.regions[k].material, key + ".material", of);
    check_material(of.regions[k].material, key + ".material", dimension);
  }
  for (std::size_t k = 0; k < of.interfaces.size(); ++k) {
    const std::string key = "interfaces[" + std::to_string(k) + "]";
    check_interface(of.interfaces[k], key, of, dimension);
    for (std::size_t other = 0; other < k; ++other)
      require(!is_same_pair(of.interfaces[k], of.interfaces[other]), key + ".between", "",
              "another interface has the same pair of materials");
  }
}

/// Refuses settings that model lps does not support in its form.
void check_solid(const BodySpecification& of) {
  require_absent(of.weights != InteractionWeights::mean, "weights", "is for the model cpd");
  require_absent(of.eigenstrains.are_there(), "eigenstrains", "are not for the model lps");
  require_absent(of.surface_correction != SurfaceCorrection::none, "surface_correction",
                 "is for the model bond; the states of lps sum over the neighbours that are there");
  const CollocationSpecification defaults;
  if (of.form != SolidForm::collocation) {
    require_absent(of.collocation.degree != defaults.degree, "collocation.degree",
                   "is for the form collocation");
    require_absent(of.collocation.traction_form != defaults.traction_form,
                   "collocation.traction_form", "is for the form collocation");
    require_absent(of.collocation.normals != defaults.normals, "collocation.normals",
                   "is for the form collocation");
    require_absent(!of.interfaces.empty(), "interfaces",
                   "are not for the form energy, whose dilatations have constants per point");
    return;
  }
  require_absent(of.volume_correction != VolumeCorrection::none, "volume_correction",
                 "is for the model bond and the form energy; collocation has a quadrature of its "
                 "own");
  require_absent(of.material.influence != ConstantInfluence::name &&
                     of.material.influence != InverseInfluence::name,
                 "material.influence", "must be \"inverse\" with the model lps by collocation");
}

/// Refuses weights and corrections that belong to another model.
void check_weights(const BodySpecification& of, const Points& points) {
  require_absent(of.form != SolidForm::collocation && !of.has_states(), "form",
                 "is for the model lps");
  if (of.material.model == MaterialModel::lps) check_solid(of);
  if (of.material.model == MaterialModel::bond) {
    require_absent(of.weights != InteractionWeights::mean, "weights", "is for the model cpd");
  }
  if (of.material.model != MaterialModel::cpd) {
    require(points.spacing.is_square() || of.volume_correction != VolumeCorrection::linear,
            "volume_correction", "linear",
            "is for square or cubic cells; different spacings need \"none\" or \"exact\"");
    return;
  }
  require_whole_square_cells(points);
  const std::string needs_none = "is for the model bond; the effective volumes of cpd need none";
  require_absent(of.volume_correction != VolumeCorrection::none, "volume_correction", needs_none);
  require_absent(of.surface_correction != SurfaceCorrection::none, "surface_correction",
                 needs_none);
}

void check_horizon(const BodySpecification& of, const Points& points) {
  require_positive(of.horizon, "horizon");
  require(of.horizon >= points.spacing.largest() * (1.0 - horizon_tolerance), "horizon",
          number_text(of.horizon),
          points.spacing.is_square() ? "horizon smaller than the mean spacing of the points, " +
                                           number_text(points.spacing) + " m"
                                     : "the horizon, " + number_text(of.horizon) +
                                           " m, is smaller than the largest spacing, " +
                                           number_text(points.spacing.largest()) + " m");
  require_summable(of.material.model, points.dimension, "horizon", number_text(of.horizon),
                   of.horizon / points.spacing);
}

void check_horizon_shape(const BodySpecification& of, const Points& points) {
  if (of.horizon_shape == HorizonShape::ball) return;
  const auto refuse = [](const std::string& what) { throw InputError("horizon_shape", "", what); };
  if (of.material.model != MaterialModel::bond) refuse("is for the model bond");
  if (points.dimension == 1) refuse("is for 2D and 3D");
  const auto has_fibres = [](const RegionSpecification& region) {
    return region.material.fibre.has_value();
  };
  if (of.material.fibre || std::any_of(of.regions.begin(), of.regions.end(), has_fibres)) {
    refuse("must be \"ball\" with fibres: their moduli are harmonics of the bond's direction");
  }
  if (of.volume_correction != VolumeCorrection::none) {
    refuse("needs volume_correction \"none\": this shape takes no parts of cells");
  }
  if (!points.neighbours.empty()) refuse("is for neighbours found by the search");
}

/// Refuses settings that would come on top of given partial volumes, or have no effect on them.
void check_neighbours(const BodySpecification& of, const Points& points) {
  if (points.neighbours.empty()) return;
  require(of.material.model == MaterialModel::bond, "material.model", "cpd",
          "finds its own neighbours; given ones are for model \"bond\"");
  require_absent(of.volume_correction != VolumeCorrection::none, "volume_correction",
                 "is for neighbours found by the search; given neighbours have their own shares");
  require_absent(of.surface_correction == SurfaceCorrection::volume, "surface_correction",
                 "\"volume\" is for neighbours found by the search: for given neighbours the sum "
                 "of volumes inside a body is not known; give \"energy\" or \"none\"");
}

/// Checks the cross-section, which follows from volumes and spacing.
void check_cross_section(const BodySpecification& of, const Points& points) {
  const double has = points.cross_section();
  const double given = points.dimension == 3 ? 1.0 : of.cross_section;
  if (of.cross_section != 0.0) require_positive(of.cross_section, "cross_section");
  require(points.dimension < 3 || of.cross_section == 0.0 || of.cross_section == 1.0,
          "cross_section", number_text(of.cross_section), "must be 1 in 3D");
  // The points of a part of a cloud have a mean volume of their own.
  const bool is_known = !points.owned || points.cell_volume > 0.0;
  if (given == 0.0 || !is_known) return;
  // The volumes' sum has round-off; a wrong thickness or spacing is off by far more.
  require(std::abs(has / given - 1.0) < 1e-6, "cross_section", number_text(given),
          "does not fit the points, whose mean volume over spacing^" +
              std::to_string(points.dimension) + " is " + number_text(has));
}

void check_shares(const Points& points) {
  const NeighbourShares* before = nullptr;
  for (const NeighbourShares& pair : points.neighbours) {
    const bool ascends =
        before == nullptr || before->i < pair.i || (before->i == pair.i && before->j < pair.j);
    const bool are_points = pair.i >= 0 && pair.i < pair.j && pair.j < points.count();
    const bool are_shares = pair.of_i >= 0.0 && pair.of_j >= 0.0 && pair.of_i + pair.of_j > 0.0 &&
                            std::isfinite(pair.of_i + pair.of_j);
    require(ascends && are_points && are_shares, "points.neighbours", "",
            "must ascend; each entry needs two points of the body, and shares of at least 0, not "
            "both 0");
    before = &pair;
  }
}

void check_set(const std::string& name, const std::vector<Index>& members, Index points) {
  for (std::size_t k = 0; k < members.size(); ++k) {
    const bool ascends = k == 0 || members[k - 1] < members[k];
    require(ascends && members[k] >= 0 && members[k] < points, "points.sets", '"' + name + '"',
            "has a number that is not the number of a point, or numbers that do not ascend");
  }
}

}  // namespace

void check_points(const Points& points) {
  require(points.dimension >= 1 && points.dimension <= 3, "points.dimension",
          std::to_string(points.dimension), "must be 1, 2 or 3");
  require(points.count() > 0, "points", "", "there are no points");
  require(points.reference.size() == points.volume.size() * std::size_t(points.dimension),
          "points.reference", "", "must have as many entries as the dimension for every volume");
  require_positive(points.spacing, "points.spacing");
  for (const double at : points.reference)
    require(std::isfinite(at), "points.reference", number_text(at), "must be finite");
  for (const double volume : points.volume) require_positive(volume, "points.volume");
  check_shares(points);
  for (const auto& [name, members] : points.sets) check_set(name, members, points.count());
}

void require_whole_square_cells(const Points& points) {
  require(points.spacing.is_square(), "material.model", "cpd",
          "needs square or cubic cells: its constants and effective volumes are those of a cubic "
          "lattice; give one spacing, or model = \"bond\"");
  const auto is_cut = [&](double volume) {
    return points.cell_volume > 0.0 && std::abs(volume / points.cell_volume - 1.0) > 1e-9;
  };
  require(std::none_of(points.volume.begin(), points.volume.end(), is_cut), "material.model", "cpd",
          "needs whole cells: its effective volumes count neighbours, whatever their volume is; "
          "give points = \"lattice\" with volumes = \"cells\", or model = \"bond\"");
}

namespace {

/// Requires fibres along an axis beside planes of symmetry, which mirror them: beyond the plane
/// they would have another direction.
void check_mirrored_fibres(const BodySpecification& of, int dimension) {
  if (of.constraints.symmetries.empty()) return;
  const auto check = [&](const MaterialSpecification& material, const std::string& key) {
    if (!material.fibre) return;
    const Coordinates& along = material.fibre->direction;
    const bool is_along_axis = dimension == 3 ? std::count(along.begin(), along.end(), 0.0) == 2
                                              : std::remainder(material.fibre->angle, 90.0) == 0.0;
    require(is_along_axis, key + (dimension == 3 ? ".fibre.direction" : ".fibre.angle"), "",
            "must be along an axis if there are planes of symmetry, which mirror the fibres");
  };
  check(of.material, "material");
  for (std::size_t k = 0; k < of.regions.size(); ++k) {
    check(of.regions[k].material, "regions[" + std::to_string(k) + "].material");
  }
  for (std::size_t k = 0; k < of.interfaces.size(); ++k) {
    if (of.interfaces[k].material) {
      check(*of.interfaces[k].material, "interfaces[" + std::to_string(k) + "].material");
    }
  }
}

}  // namespace

namespace {

/// Refuses a calibration on the lattice for bonds of a cloud, which has none.
void require_lattice_to_calibrate_on(const BodySpecification& of, const Points& points) {
  const auto check = [&](const MaterialSpecification& material, const std::string& key) {
    require(material.model != MaterialModel::bond || material.calibration != Calibration::lattice ||
                points.lattice.has_value(),
            key + ".calibration", "\"lattice\"", "needs points on a lattice");
  };
  check(of.material, "material");
  for (std::size_t k = 0; k < of.regions.size(); ++k) {
    check(of.regions[k].material, "regions[" + std::to_string(k) + "].material");
  }
  for (std::size_t k = 0; k < of.interfaces.size(); ++k) {
    if (!of.interfaces[k].material) continue;
    check(*of.interfaces[k].material, "interfaces[" + std::to_string(k) + "].material");
  }
}

}  // namespace

namespace {

/// Checks a model that only convolutions can sum.
void check_convolved_body(const BodySpecification& of) {
  if (of.needs_convolutions()) {
    require(of.is_convolved(), "force_operator", "bonds",
            of.has_states()
                ? "does not go with the form \"printed\" of lps; take \"fft\""
                : "does not go with this model, which needs convolutions; take \"fft\"");
  }
  if (!is_polynomial(of.material.model)) return;
  require_absent(of.eigenstrains.are_there(), "eigenstrains",
                 "do not go with the models green_bond and correspondence");
}

void check_linear_body(const BodySpecification& of) {
  for (std::size_t k = 0; of.is_convolved() && k < of.loads.size(); ++k) {
    require_absent(of.loads[k].kind == LoadSpecification::Kind::pressure,
                   "loads[" + std::to_string(k) + "].pressure",
                   "turns with its faces, which couples points in a way that operator \"fft\" does "
                   "not support; take \"bonds\", or a traction");
  }
  if (is_polynomial(of.material.model)) return;
  if (!of.is_linear()) {
    require(!of.is_convolved() || of.has_states(), "force_operator", "fft",
            "is for bonds with kinematics \"linear\", for models \"green_bond\" and "
            "\"correspondence\", and for the forms \"energy\" and \"printed\" of lps: forces of "
            "other bonds that turn are not convolutions");
    const DamageLaw law = of.material.damage.law;
    require(!of.is_convolved() || law == DamageLaw::none || law == DamageLaw::energy_density,
            "material.damage.law", "",
            "must be \"energy_density\" with operator \"fft\": bonds that break one by one are not "
            "convolutions");
    require(of.is_convolved() || law != DamageLaw::energy_density, "material.damage.law",
            "energy_density", "is for kinematics \"linear\" and operator \"fft\"");
    return;
  }
  const std::string linear = "does not go with kinematics \"linear\"";
  require_absent(of.eigenstrains.are_there(), "eigenstrains", linear);
}

}  // namespace

void check_specification(const BodySpecification& of, const Points& points) {
  check_convolved_body(of);
  check_linear_body(of);
  check_horizon(of, points);
  check_cross_section(of, points);
  check_neighbours(of, points);
  check_horizon_shape(of, points);
  const bool has_rest = of.regions.empty() || of.material.has_constants();
  if (has_rest) check_material(of.material, "material", points.dimension);
  require_lattice_to_calibrate_on(of, points);
  check_weights(of, points);
  check_regions(of, points.dimension);
  check_mirrored_fibres(of, points.dimension);
  for (std::size_t k = 0; k < of.cracks.size(); ++k)
    check_crack(of.cracks[k], points.dimension, "cracks[" + std::to_string(k) + "]");
}

void require_summable(MaterialModel model, int dimension, const std::string& key,
                      const std::string& value, double ratio) {
  const bool counts_pairs = model == MaterialModel::cpd;
  const double largest = counts_pairs     ? largest_ratio_with_pairs(dimension)
                         : dimension == 3 ? 100.0
                                          : 1000.0;
  if (ratio <= inclusive_radius(largest)) return;
  throw InputError(key, value,
                   "the horizon is " + number_text(ratio) + " spacings; at most " +
                       number_text(largest) + (counts_pairs ? " with model \"cpd\"" : "") + " in " +
                       std::to_string(dimension) + "D");
}

void add_set(Points& points, const SetRule& rule) {
  if (points.sets.contains(rule.name)) {
    throw InputError("name", '"' + rule.name + '"',
                     "there is already a set of this name (sets, layers and the sets of a point "
                     "file share their names)");
  }
  std::vector<Index> members = select(points, rule);
  if (members.empty()) throw InputError("", '"' + rule.name + '"', "the set selects no point");
  points.sets[rule.name] = std::move(members);
}

}  // namespace peristat
