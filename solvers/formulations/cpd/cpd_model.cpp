#include "solvers/formulations/cpd/cpd_model.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "assembly/terms/simplices/simplex_term.hpp"
#include "solvers/formulations/materials/bond_potential.hpp"
#include "solvers/ranks/agree_on_kinds.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/image_number.hpp"
#include "src/neighbourhood/horizon.hpp"
#include "src/neighbourhood/neighbour_counts.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Constant of the triangles or tetrahedra of a body.
struct HigherConstant {
  double constant = 0.0;     ///< C2 or C3, multiplied by the factors; 0: there are none
  FactorsOfKinds factors{};  ///< by the kinds of points of several materials
};

/// Numbers in the whole body of the points of a part, followed by images as they are there.
PointNumbers numbers_of(const IndexMap& index_map, const Points& points) {
  PointNumbers numbers;
  for (Index point = 0; point < points.count(); ++point) {
    numbers.push_back(image_number(points, point) * index_map.whole() +
                      index_map.number_of(points.source(point)));
  }
  return numbers;
}

/// @param bonds of the body without cracks, to which the effective volumes belong: a crack is no
///        surface
/// @param left bonds that have an influence and that pre-cracks have not cut; interactions with
///        other bonds are lost
/// Collective: a ghost's interactions are counted by its owner.
template <class Measure>
Simplices<Measure> make_simplices(const BodySpecification& from, const Points& points,
                                  const Bonds& bonds, const Bonds& left,
                                  const BulkNeighbourhood& bulk, const Kernel& kernel,
                                  HigherConstant constant, const PointFactors& factors,
                                  const IndexMap& index_map, int threads) {
  Interactions<Measure> interactions(points, bonds, kernel.cross_section, threads);
  const auto found = double(interactions.count());
  if (index_map.ranks().max(found) == 0.0) {
    constexpr bool is_triangle = Measure::arms == 2;
    throw InputError(is_triangle ? "material.c2" : "material.c3", number_text(constant.constant),
                     std::string("the body has no ") + (is_triangle ? "triangles" : "tetrahedra") +
                         ": no points within the horizon of each other span a quarter of the " +
                         (is_triangle ? "area" : "volume") +
                         " of a point's cell. The horizon is too short, or volumes of points are "
                         "too large");
  }
  auto shares = weight_shares<Measure>(
      points, effective_volumes(interactions, neighbour_counts(bonds), bulk, from.weights));
  index_map.update_ghost_values(shares);
  for (std::size_t i = 0; i < factors.stiffness.size(); ++i) shares[i] *= factors.stiffness[i];
  if (left.count() < bonds.count()) {
    interactions = Interactions<Measure>(points, left, kernel.cross_section, threads);
  }
  interactions.set_shares(std::move(shares));
  interactions.set_influence(kernel);
  interactions.set_factors(std::move(constant.factors));
  return {std::move(interactions), Harmonic{constant.constant}};
}

/// Value of a constant for interactions between points of several materials.
class MixedConstant {
 public:
  /// @param of_kind value per material, and per interface with constants of its own
  MixedConstant(const PointMaterials& materials, const std::vector<PointMaterials::Material>& kinds,
                std::vector<double> of_kind, const std::string& name)
      : materials_(materials), kinds_(kinds), of_kind_(std::move(of_kind)) {
    const std::size_t count = materials.all().size();
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = 0; b < a; ++b) refuse_opposite_signs(a, b, name);
    }
  }

  /// Returns the constant with factors for interactions of so many points.
  [[nodiscard]] HigherConstant over(std::size_t points) const {
    const std::size_t count = materials_.all().size();
    HigherConstant result{*std::ranges::max_element(of_kind_), {}};
    if (result.constant == 0.0) result.constant = *std::ranges::min_element(of_kind_);
    if (count == 1 || result.constant == 0.0) return result;
    result.factors = {materials_.of_points(), count, {}};
    std::vector<std::size_t> of_points(points, 0);
    const auto entries = std::size_t(std::pow(double(count), double(points)) + 0.5);
    for (std::size_t entry = 0; entry < entries; ++entry) {
      std::size_t rest = entry;
      for (std::size_t& of : of_points) {
        of = rest % count;
        rest /= count;
      }
      std::ranges::sort(of_points);
      result.factors.factor.push_back(value(of_points) / result.constant);
    }
    return result;
  }

 private:
  void refuse_opposite_signs(std::size_t a, std::size_t b, const std::string& name) const {
    const InterfaceSpecification& interface = materials_.between(a, b);
    if (interface.material || interface.rule != InterfaceRule::harmonic) return;
    if (!(of_kind_[a] * of_kind_[b] < 0.0)) return;
    throw InputError(materials_.key_between(a, b), "",
                     "\"" + kinds_[a].name + "\" has " + name + " = " + number_text(of_kind_[a]) +
                         " and \"" + kinds_[b].name + "\" " + number_text(of_kind_[b]) +
                         ": numbers of opposite signs have no harmonic mean. Give the "
                         "[[interface]] rule = \"arithmetic\", or its own constants");
  }

  /// Value for points of two materials.
  [[nodiscard]] double value(std::size_t a, std::size_t b,
                             const std::vector<double>& of_points) const {
    const InterfaceSpecification& interface = materials_.between(a, b);
    if (!interface.material) return mean_by(interface.rule, of_points);
    const auto own = std::ranges::find_if(
        kinds_, [&](const auto& kind) { return kind.of == &*interface.material; });
    return of_kind_[std::size_t(own - kinds_.begin())];
  }

  /// Value for points of one material: its constant; of two: their mean by the rule; of more: the
  /// mean over all pairs of materials.
  [[nodiscard]] double value(const std::vector<std::size_t>& ascending) const {
    std::vector<std::size_t> present = ascending;
    present.erase(std::unique(present.begin(), present.end()), present.end());
    if (present.size() == 1) return of_kind_[present.front()];
    std::vector<double> values;
    for (const std::size_t a : present) {
      for (const std::size_t b : present) {
        if (b <= a) continue;
        std::vector<double> of_points;
        for (const std::size_t of : ascending) {
          if (of == a || of == b) of_points.push_back(of_kind_[of]);
        }
        values.push_back(value(a, b, of_points));
      }
    }
    return mean_by(InterfaceRule::arithmetic, values);
  }

  const PointMaterials& materials_;
  const std::vector<PointMaterials::Material>& kinds_;
  std::vector<double> of_kind_;
};

}  // namespace

CpdStiffness stiffness_of(const MaterialSpecification& material, const BondSetting& setting,
                          double spacing) {
  return material.calibration != Calibration::continuum
             ? lattice_stiffness(setting, spacing)
             : continuum_stiffness(setting.dimension, setting.horizon, setting.cross_section);
}

std::string negative_constant(const CpdConstants& constants) {
  return constants.c2 < 0.0 ? "c2" : constants.c3 < 0.0 ? "c3" : "";
}

void refuse_damage_of_negative_constants(const MaterialSpecification& material,
                                         const std::string& key, const CpdConstants& constants,
                                         const BondSetting& setting, double spacing,
                                         DamageDrive drive) {
  const std::string negative = negative_constant(constants);
  if (negative.empty()) return;
  const CpdStiffness stiffness = stiffness_of(material, setting, spacing);
  const int d = setting.dimension;
  const auto ratio_of = [&](const CpdConstants& of) {
    return poisson_ratio_of(stiffness.moduli(of), d);
  };
  if (drive == DamageDrive::release) {
    constexpr double round_off = 1e-9;
    const double ratio = ratio_of(constants);
    if (ratio >= -round_off) return;
    throw InputError(key + (material.poisson_ratio ? ".poisson_ratio" : "." + negative),
                     number_text(material.poisson_ratio.value_or(negative == "c2" ? constants.c2
                                                                                  : constants.c3)),
                     "damage of cpd needs a Poisson's ratio of at least 0; here it is " +
                         number_text(std::round(1e6 * ratio) / 1e6) +
                         ", at which a tear takes a multiple of the fracture energy");
  }
  const double value = negative == "c2" ? constants.c2 : constants.c3;
  std::string larger = "give " + negative + " of at least 0";
  if (material.poisson_ratio) {
    larger = "it is negative for a poisson_ratio below " + number_text(ratio_of({1.0, 0.0, 0.0})) +
             (d == 3 ? " (with c2 = 0; a positive c2 needs a larger one)" : "") +
             ". Give a larger poisson_ratio";
  }
  throw InputError(key + ".damage.law", "",
                   "damage by stretch needs constants of at least 0, but " + negative + " is " +
                       number_text(value) +
                       ": interactions of negative energy that are lost with a broken bond would "
                       "create energy; " +
                       larger + ", drive = \"release\" in this table, or model = \"bond\"");
}

CpdConstants cpd_constants_of(const MaterialSpecification& material, const std::string& key,
                              const BondSetting& setting, double spacing) {
  if (material.c1) return {*material.c1, material.c2, material.c3};
  try {
    return stiffness_of(material, setting, spacing)
        .constants(
            lame_moduli(*material.youngs_modulus, *material.poisson_ratio, setting.dimension),
            material.c2);
  } catch (const InputError& error) {
    throw InputError(key + "." + error.key(), error.value(), error.allowed());
  }
}

namespace {

/// True if a triangle or tetrahedron may have both a bond and its image: their energy is then not
/// linear in the integrity that both have. Triangles may where a plane continues along a short
/// period; tetrahedra also about the line in which two planes meet.
bool may_have_bonds_twice(const ModelSetting& of, bool has_tetrahedra) {
  return std::ranges::any_of(of.points.images.kinds, [&](const ImageKind& kind) {
    int flips = 0;
    double squared = 0.0;  // of the shift along what is not mirrored
    for (std::size_t c = 0; c < 3; ++c) {
      flips += kind.mirror[c] < 0.0;
      if (kind.mirror[c] > 0.0) squared += kind.shift[c] * kind.shift[c];
    }
    const double shift = std::sqrt(squared), reach = inclusive_radius(of.bonds.horizon);
    const bool glides = flips > 0 && shift > 1e-6 * of.points.spacing.largest();
    if (glides && 2.0 * shift <= reach) return true;
    return has_tetrahedra && shift <= reach && (flips == 2 || glides);
  });
}

/// Refuses bodies in which damage by release is not known.
void refuse_release(const ModelSetting& of, const std::string& key, bool has_tetrahedra) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(key + ".damage.drive", "release",
                     why + " with model \"cpd\"; give drive = \"stretch\"");
  };
  if (may_have_bonds_twice(of, has_tetrahedra))
    refuse("is not for a plane of symmetry beside a period shorter than the horizon" +
           std::string(has_tetrahedra ? ", nor for two planes that meet in 3D with c3," : ""));
  // A part lacks some of the bonds that are one.
  if (!of.index_map.is_whole() && !of.points.images.kinds.empty())
    refuse("is for one rank with planes of symmetry and periods");
}

}  // namespace

MadeModel make_cpd_model(const ModelSetting& of_model, Bonds bonds) {
  const auto& [from, materials, factors, points, setting, index_map, threads] = of_model;
  // Tables have entries for the materials of four points.
  constexpr std::size_t most = 24;
  if (materials.all().size() > most) {
    throw InputError("regions", "",
                     "there are " + std::to_string(materials.all().size()) +
                         " materials; at most " + std::to_string(most) + " with model \"cpd\"");
  }
  const std::vector<PointMaterials::Material> kinds = all_materials(from, materials);
  const auto failing = std::ranges::find_if(
      kinds, [](const auto& kind) { return kind.of->damage.law != DamageLaw::none; });
  const bool fails = failing != kinds.end();
  DamageDrive drive =
      fails ? failing->of->damage.drive.value_or(DamageDrive::stretch) : DamageDrive::stretch;
  std::vector<DirectedConstant> c1;
  std::vector<double> c2, c3;
  for (const auto& kind : kinds) {
    const CpdConstants constants = cpd_constants_of(*kind.of, kind.key, setting, points.spacing);
    if (fails) {
      refuse_damage_of_negative_constants(*kind.of, kind.key, constants, setting, points.spacing,
                                          drive);
    }
    c1.push_back({{constants.c1, 0.0, 0.0}, {}});
    c2.push_back(constants.c2);
    c3.push_back(constants.c3);
  }
  const HigherConstant of_triangles = MixedConstant(materials, kinds, c2, "c2").over(3);
  const HigherConstant of_tetrahedra = MixedConstant(materials, kinds, c3, "c3").over(4);

  // Bonds alone set free what they hold: then both drives are one.
  if (of_triangles.constant == 0.0 && of_tetrahedra.constant == 0.0) drive = DamageDrive::stretch;
  if (drive == DamageDrive::release)
    refuse_release(of_model, failing->key, of_tetrahedra.constant != 0.0);

  const BulkNeighbourhood bulk =
      bulk_neighbourhood(points.dimension, points.spacing, setting.horizon, setting.cross_section);
  set_one_neighbour_weights(bonds, points, bulk);
  const BondMaterials mixed(from, materials, factors, points, std::move(c1));
  if (!from.is_uniform()) {
    refuse_idle_interfaces(from, materials, bonds, index_map.ranks());
    mixed.weigh(bonds);
  }
  Bonds left = bonds;
  if (setting.influence) {
    left.set_weights([&](Index, Offset bond) {
      return left.weight(bond) * setting.influence_at(left.length(bond));
    });
    left.remove_if(
        [&](Index, Offset bond) { return setting.influence_at(left.length(bond)) == 0.0; });
  }
  const bool is_whole = index_map.is_whole();
  if (!is_whole) agree_on_kinds(left, points, index_map.numbered(), index_map.ranks());
  CutBonds cut = cut_bonds(left, points, from.cracks);
  auto [potential, never_fails] = mixed.potential(left);
  Model model(std::move(left), std::move(potential), std::move(never_fails), drive);
  std::optional<Simplices<Area>> triangles;
  std::optional<Simplices<Volume>> tetrahedra;
  if (of_triangles.constant != 0.0) {
    triangles = make_simplices<Area>(from, points, bonds, model.bonds(), bulk, setting,
                                     of_triangles, factors, index_map, threads);
  }
  if (of_tetrahedra.constant != 0.0) {
    tetrahedra = make_simplices<Volume>(from, points, bonds, model.bonds(), bulk, setting,
                                        of_tetrahedra, factors, index_map, threads);
  }
  if (triangles || tetrahedra) {
    model.add(std::make_shared<SimplexTerm>(
        model.bond_failure(), std::move(triangles), std::move(tetrahedra),
        is_whole ? PointNumbers() : numbers_of(index_map, points),
        is_whole ? AlikeBonds(points, model.bonds()) : AlikeBonds()));
  }
  return {std::move(model), std::move(cut)};
}

}  // namespace peristat
