#include "solvers/formulations/check_specification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/specification/check_contacts.hpp"
#include "solvers/formulations/specification/check_damage.hpp"
#include "solvers/formulations/specification/for_each_material.hpp"
#include "solvers/formulations/specification/require.hpp"
#include "src/geometry/point_sizes.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

/// Refuses points and an operator that the formulation does not take.
void check_points_and_operator(const BodySpecification& of, const Points& points) {
  const OptionSet options = options_of(of);
  const std::string model = name_of(of.material.model);
  require_absent(!points.neighbours.empty() && !options.has(Option::given_neighbours),
                 "points.neighbours", is_for(Option::given_neighbours));
  require_absent(!points.horizons.empty() && !options.has(Option::horizons), "points.horizons",
                 is_for(Option::horizons));
  const bool has_images = !of.constraints.symmetries.empty() || !of.constraints.periods.empty();
  if (has_images && !options.has(Option::images)) {
    throw InputError(
        "material.model", model,
        "is not allowed with planes of symmetry and periods, which are for other models");
  }
  for (std::size_t k = 0; !options.has(Option::pressures) && k < of.loads.size(); ++k) {
    require_absent(of.loads[k].kind == LoadSpecification::Kind::pressure,
                   "loads[" + std::to_string(k) + "].pressure",
                   "rotates with its faces, which couples points in a way that operator \"fft\" "
                   "does not support; take \"bonds\", or a traction");
  }
  require(of.is_convolved() || !formulation_of(of).needs_convolutions, "force_operator", "bonds",
          "is not allowed with model \"" + model + "\", which needs convolutions; take \"fft\"");
}

/// Refuses laws of damage that a formulation does not take.
void check_law(const DamageSpecification& damage, const std::string& key,
               const OptionSet& options) {
  if (damage.law == DamageLaw::none) return;
  const std::array<std::pair<Option, std::string>, 3> kinds{
      {{Option::softening, "a law that softens"},
       {Option::critical_stretch, "\"critical_stretch\""},
       {Option::energy_density, "\"energy_density\""}}};
  const Option needed = damage.law == DamageLaw::energy_density ? Option::energy_density
                        : damage.softens()                      ? Option::softening
                                                                : Option::critical_stretch;
  std::string allowed;
  for (const auto& [option, name] : kinds) {
    if (options.has(option)) allowed += (allowed.empty() ? "" : " or ") + name;
  }
  require_absent(!options.has(needed), key + ".damage.law",
                 "must be " + allowed + " with this model; the given one " + is_for(needed));
}

void check_fibre(const MaterialSpecification& material, const std::string& key, int dimension) {
  if (!material.fibre) return;
  const FibreSpecification& fibre = *material.fibre;
  const std::string table = key + ".fibre";
  require_absent(dimension == 1, table, "needs dimension 2 or 3");
  require_absent(!material.youngs_modulus, table,
                 "needs a youngs_modulus, the one along the fibres");
  require_absent(dimension == 2 && material.plane != PlaneState::stress, table,
                 "is for plane stress: in plane strain E_1, E_2 and the shear modulus do not "
                 "determine the constants");
  require(std::isfinite(fibre.angle), table + ".angle", number_text(fibre.angle), "must be finite");
  require_absent(dimension == 3 && fibre.angle != 0.0, table + ".angle",
                 "is for dimension 2; in 3D give direction");
  if (dimension == 3) {
    const auto& [x, y, z] = fibre.direction;
    const double length = std::hypot(x, y, z);
    require(std::isfinite(length) && length > 1e-100, table + ".direction",
            place_text(fibre.direction, 3), "must be finite, and not all zero");
  } else {
    require_absent(fibre.direction != Coordinates{}, table + ".direction",
                   "is for dimension 3; in 2D give angle");
  }
  require_positive(fibre.transverse_modulus, table + ".transverse_modulus");
  require_positive(fibre.shear_modulus, table + ".shear_modulus");
  require_absent(material.damage.is_by_data() || material.damage.fracture_toughness,
                 key + ".damage",
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
    const auto& [of, distribution, field, factor] = material.scatter[k];
    const std::string table = key + ".scatter[" + std::to_string(k) + "]";
    require_absent(std::exchange(is_known[int(of)], true), table + ".of",
                   "another table of this material has the same quantity");
    require_absent(of == Quantity::strength && !material.damage.breaks_bonds(), table + ".of",
                   "strength needs a law of damage by stretches");
    if (!factor.empty()) continue;
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
}

/// @param formulation of the body, or one of the material's model
/// @param options     those of the body, or all that the model takes
void check_material_of(const MaterialSpecification& material, const std::string& key, int dimension,
                       const Formulation& formulation, const OptionSet& options) {
  check_influence(material, key);
  require(dimension >= formulation.least_dimension, key + ".model", name_of(material.model),
          "needs dimension 2 or 3");
  for (const auto& [option, name, is_given] : options_of_material) {
    require_absent(is_given(material) && !options.has(option), key + "." + name, is_for(option));
  }
  check_law(material.damage, key, options);
  formulation.check_material(material, key, dimension);
  require_positive(material.youngs_modulus, key + ".youngs_modulus");
  require_positive(material.micromodulus, key + ".micromodulus");
  require_positive(material.c1, key + ".c1");
  require_positive(material.density, key + ".density");
  check_damage(material.damage, key + ".damage.");
  require_absent(dimension == 1 && material.damage.fracture_toughness,
                 key + ".damage.fracture_toughness",
                 "is for dimension 2 and 3; give fracture_energy");
  check_fibre(material, key, dimension);
  check_scatter(material, key);
}

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
                     const BodySpecification& of, int dimension, const OptionSet& options) {
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
  check_material_of(material, key + ".material", dimension, formulation_of(of), options);
  require_absent(!material.scatter.empty(), key + ".material.scatter",
                 "belongs to points, so give it in the materials of the regions");
  require_absent(material.density.has_value(), key + ".material.density",
                 "belongs to points, so give it in the materials of the regions");
  require_absent(material.damage.law == DamageLaw::energy_density, key + ".material.damage",
                 "is a law of points that fail, so give it in the materials of the regions");
}

void check_regions(const BodySpecification& of, int dimension, const OptionSet& options) {
  require(
      of.regions.size() + of.interfaces.size() <= most_materials, "regions", "",
      "there are at most " + std::to_string(most_materials) + " regions and interfaces together");
  for (std::size_t k = 0; k < of.regions.size(); ++k) {
    const std::string key = "regions[" + std::to_string(k) + "]";
    require(of.regions[k].set != rest_name, key + ".set", '"' + of.regions[k].set + '"',
            "is the name for the points in no region; give the set another name");
    require_of_body(of.regions[k].material, key + ".material", of);
    check_material_of(of.regions[k].material, key + ".material", dimension, formulation_of(of),
                      options);
  }
  for (std::size_t k = 0; k < of.interfaces.size(); ++k) {
    const std::string key = "interfaces[" + std::to_string(k) + "]";
    check_interface(of.interfaces[k], key, of, dimension, options);
    for (std::size_t other = 0; other < k; ++other)
      require(!is_same_pair(of.interfaces[k], of.interfaces[other]), key + ".between", "",
              "another interface has the same pair of materials");
  }
}

/// Refuses corrections that the cells or neighbours of the points do not have.
void check_corrections(const BodySpecification& of, const Points& points) {
  require(points.spacing.is_square() || of.volume_correction != VolumeCorrection::linear,
          "volume_correction", "linear",
          "is for square or cubic cells; different spacings need \"none\" or \"exact\"");
  if (points.neighbours.empty()) return;
  require_absent(of.volume_correction != VolumeCorrection::none, "volume_correction",
                 "is for neighbours found by the search; given neighbours have their own shares");
  require_absent(of.surface_correction == SurfaceCorrection::volume, "surface_correction",
                 "\"volume\" is for neighbours found by the search: for given neighbours the sum "
                 "of volumes inside a body is not known; give \"energy\" or \"none\"");
}

/// Refuses settings that have one horizon only, for a body whose points have their own.
void check_for_horizons(const BodySpecification& of) {
  const std::string with = " with a horizon per point";
  for_each_material(of, [&](const MaterialSpecification& material, const std::string& key) {
    const DamageSpecification& damage = material.damage;
    const std::string table = key + ".damage.";
    require_absent(material.micromodulus.has_value(), key + ".micromodulus",
                   "belongs to one horizon; give youngs_modulus" + with);
    require_absent(damage.law == DamageLaw::energy_density, table + "law",
                   "\"energy_density\" belongs to one horizon, that of its band of failed points; "
                   "take a law of stretches" +
                       with);
    if (damage.law != DamageLaw::blended || !damage.fracture_energy) return;
    const std::string alone = "would change the shape of \"blended\" from horizon to horizon;" +
                              with +
                              " give fracture_energy alone, another law, or strength or stretches";
    require_absent(damage.strength.has_value(), table + "strength", alone);
    require_absent(damage.onset != 0.0, table + "onset", alone);
    require_absent(damage.peak != 0.0, table + "peak", alone);
  });
  for (std::size_t k = 0; k < of.loads.size(); ++k) {
    require_absent(of.loads[k].depth == Depth::horizon, "loads[" + std::to_string(k) + "].depth",
                   "\"horizon\" is one depth for all points; take \"row\"" + with);
  }
  require_absent(of.is_convolved(), "force_operator", "\"fft\" has one; take \"bonds\"" + with);
  require_absent(of.horizon_shape != HorizonShape::ball, "horizon_shape",
                 "must be \"ball\"" + with);
  require_absent(Kernel{.volume_correction = of.volume_correction}.has_exact_shares(),
                 "volume_correction", "must be \"none\" or \"linear\"" + with);
  if (of.horizon_per_size != 0.0) require_within(of.horizon_per_size, 1.0, 1000.0, "horizon");
}

/// Refuses horizons of points that are no horizons of a cloud, or too small or large for its sizes.
void check_horizons_of_points(const BodySpecification& of, const Points& points) {
  const std::string key = "points.horizons";
  require_absent(points.lattice.has_value(), key, "is for points of a file; a lattice has one");
  require_absent(!points.neighbours.empty(), key,
                 "is for neighbours found by the search, but the points' neighbours are given");
  const double largest = largest_horizon(points);
  // A part of a body may lack the point with the largest one.
  const bool is_largest = points.owned
                              ? largest <= inclusive_radius(of.horizon)
                              : std::abs(largest - of.horizon) <= horizon_tolerance * largest;
  require(is_largest, "horizon", number_text(of.horizon),
          "must be the largest of the points' horizons, " + number_text(largest) + " m");
  const double cross_section = cross_section_of(of, points);
  for (Index i = 0; i < points.count(); ++i) {
    const double horizon = points.horizons[std::size_t(i)];
    const double size = size_of_point(points, i, cross_section);
    require(horizon >= size * (1.0 - horizon_tolerance), key, number_text(horizon),
            "is smaller than the size of its point at " +
                place_text(points.position(i), points.dimension) + " m, " + number_text(size) +
                " m");
    require_summable(of.material, points.dimension, key, number_text(horizon), horizon / size);
  }
}

void check_horizon(const BodySpecification& of, const Points& points) {
  require_positive(of.horizon, "horizon");
  if (!points.horizons.empty()) return check_horizons_of_points(of, points);
  require(of.horizon >= points.spacing.largest() * (1.0 - horizon_tolerance), "horizon",
          number_text(of.horizon),
          points.spacing.is_square() ? "horizon smaller than the mean spacing of the points, " +
                                           number_text(points.spacing) + " m"
                                     : "the horizon, " + number_text(of.horizon) +
                                           " m, is smaller than the largest spacing, " +
                                           number_text(points.spacing.largest()) + " m");
  require_summable(of.material, points.dimension, "horizon", number_text(of.horizon),
                   of.horizon / points.spacing);
}

void check_horizon_shape(const BodySpecification& of, const Points& points) {
  if (of.horizon_shape == HorizonShape::ball) return;
  const auto refuse = [](const std::string& what) { throw InputError("horizon_shape", "", what); };
  if (points.dimension == 1) refuse("is for 2D and 3D");
  const auto has_fibres = [](const RegionSpecification& region) {
    return region.material.fibre.has_value();
  };
  if (of.material.fibre || std::any_of(of.regions.begin(), of.regions.end(), has_fibres)) {
    refuse("must be \"ball\" with fibres: their moduli are harmonics of the bond's direction");
  }
  if (of.volume_correction != VolumeCorrection::none) {
    refuse("needs volume_correction \"none\": parts of cells are not computed for this shape");
  }
  if (!points.neighbours.empty()) refuse("is for neighbours found by the search");
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
  for_each_material(of, check);
}

}  // namespace

void check_material(const MaterialSpecification& material, const std::string& key, int dimension) {
  const Formulation& formulation = formulation_of(material);
  check_material_of(material, key, dimension, formulation, all_options_of(formulation));
}

namespace {

/// Refuses materials whose damage is driven differently: bonds between them would have no rule.
void check_drives(const BodySpecification& of) {
  std::optional<DamageDrive> first;
  for_each_material(of, [&](const MaterialSpecification& material, const std::string& key) {
    if (!material.damage.breaks_bonds()) return;
    const DamageDrive drive = drive_of(formulation_of(of), material.damage);
    require(!first || drive == *first, key + ".damage.drive",
            drive == DamageDrive::release ? "release" : "stretch",
            "must be the same for all materials of a body, but another one has the other drive; "
            "without this key a fracture energy means release, and stretches mean stretch");
    first = drive;
  });
}

/// Refuses materials with different rules for struts and for compression, which bonds between them
/// would have to choose from.
void check_same_rules(const BodySpecification& of) {
  const DamageSpecification* first = nullptr;
  for_each_material(of, [&](const MaterialSpecification& material, const std::string& key) {
    const DamageSpecification& damage = material.damage;
    if (!damage.breaks_bonds()) return;
    if (!first) first = &damage;
    const std::string same = "must be the same for all materials of a body that can be damaged";
    require(damage.struts == first->struts, key + ".damage.struts",
            damage.struts == StrutRemedy::cut ? "cut" : "keep", same);
    require(damage.compression == first->compression, key + ".damage.compression",
            damage.compression == Compression::kept ? "kept" : "lost", same);
    require_absent(
        damage.compression == Compression::kept && !of.contacts.empty(), "contacts",
        "press where bonds with damage.compression = \"kept\" press already; give one of "
        "the two");
  });
}

void check_all_materials(const BodySpecification& of, int dimension, const OptionSet& options) {
  for (const auto& [option, key, is_given] : options_of_body) {
    require_absent(is_given(of) && !options.has(option), key, is_for(option));
  }
  if (of.regions.empty() || of.material.has_constants()) {
    check_material_of(of.material, "material", dimension, formulation_of(of), options);
  }
  check_regions(of, dimension, options);
  check_drives(of);
  check_same_rules(of);
  check_mirrored_fibres(of, dimension);
  if (of.horizon_per_size != 0.0) check_for_horizons(of);
}

}  // namespace

void check_materials(const BodySpecification& of, int dimension) {
  check_all_materials(of, dimension, all_options_of(formulation_of(of)));
}

void check_specification(const BodySpecification& of, const Points& points) {
  if (points.functions) check_functions(*points.functions);
  check_points_and_operator(of, points);
  check_all_materials(of, points.dimension, options_of(of));
  check_cross_section(of, points);
  if (!points.horizons.empty()) check_for_horizons(of);
  check_horizon(of, points);
  check_corrections(of, points);
  check_horizon_shape(of, points);
  check_contacts(of, points);
  const Formulation& formulation = formulation_of(of);
  if (formulation.check_body) formulation.check_body(of, points);
  for (std::size_t k = 0; k < of.cracks.size(); ++k)
    check_crack(of.cracks[k], points.dimension, "cracks[" + std::to_string(k) + "]");
}

void require_summable(const MaterialSpecification& material, int dimension, const std::string& key,
                      const std::string& value, double ratio) {
  const double largest = formulation_of(material).largest_horizon_ratio(dimension);
  if (ratio <= inclusive_radius(largest)) return;
  throw InputError(key, value,
                   "the horizon is " + number_text(ratio) + " spacings; at most " +
                       number_text(largest) + " with model \"" + name_of(material.model) +
                       "\" in " + std::to_string(dimension) + "D");
}

}  // namespace peristat
