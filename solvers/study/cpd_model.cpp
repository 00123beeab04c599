#include "solvers/study/cpd_model.hpp"

#include <optional>

#include "assembly/terms/simplices/simplex_term.hpp"
#include "solvers/study/bond_potential.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/neighbourhood/neighbour_counts.hpp"

namespace peristat {
namespace {

/// @param bonds of the whole body, which the effective volumes belong to: a crack is no surface
/// @param left those that pre-cracks have not cut; an interaction with a cut bond is lost
template <class Measure>
Simplices<Measure> make_simplices(const BodySpecification& from, const Points& points,
                                  const Bonds& bonds, const Bonds& left,
                                  const BulkNeighbourhood& bulk, double cross_section,
                                  double constant, int threads) {
  Interactions<Measure> interactions(points, bonds, cross_section, threads);
  if (interactions.count() == 0) {
    constexpr bool is_triangle = Measure::arms == 2;
    throw InputError(is_triangle ? "material.c2" : "material.c3", number_text(constant),
                     std::string("the body has no ") + (is_triangle ? "triangles" : "tetrahedra") +
                         ": no points within the horizon of each other span a quarter of the " +
                         (is_triangle ? "area" : "volume") +
                         " of a point's cell. The horizon is too short, or volumes of points are "
                         "too large");
  }
  const auto shares = weight_shares<Measure>(
      points, effective_volumes(interactions, neighbour_counts(bonds), bulk, from.weights));
  if (left.count() < bonds.count()) {
    interactions = Interactions<Measure>(points, left, cross_section, threads);
  }
  interactions.set_shares(shares);
  return {std::move(interactions), Harmonic{constant}};
}

CpdStiffness stiffness_of(const BodySpecification& from, const Points& points,
                          const BondSetting& setting) {
  return from.material.calibration == Calibration::lattice
             ? lattice_stiffness(points.dimension, points.spacing, setting.horizon,
                                 setting.cross_section)
             : continuum_stiffness(points.dimension, setting.horizon, setting.cross_section);
}

void refuse_damage_of_negative_constants(const BodySpecification& from, const Points& points,
                                         const BondSetting& setting,
                                         const CpdConstants& constants) {
  const std::string negative = negative_constant(constants);
  if (negative.empty() || from.material.damage.law == DamageLaw::none) return;
  const double value = negative == "c2" ? constants.c2 : constants.c3;
  std::string advice = "give " + negative + " = 0 or more";
  if (from.material.poisson_ratio) {
    const CpdStiffness stiffness = stiffness_of(from, points, setting);
    const double least = poisson_ratio_of(stiffness.moduli({1.0, 0.0, 0.0}), points.dimension);
    advice = "it is for a poisson_ratio below " + number_text(least) +
             (points.dimension == 3 ? " (with c2 = 0; a positive c2 needs a larger one)" : "") +
             ". Give a larger poisson_ratio, or model = \"bond\"";
  }
  throw InputError("material.damage.law", "",
                   "damage needs constants of at least 0, but " + negative + " is " +
                       number_text(value) +
                       ": interactions of negative energy that are lost with a "
                       "broken bond would set energy free from nothing; " +
                       advice);
}

}  // namespace

std::string negative_constant(const CpdConstants& constants) {
  return constants.c2 < 0.0 ? "c2" : constants.c3 < 0.0 ? "c3" : "";
}

CpdConstants cpd_constants_of(const BodySpecification& from, const Points& points,
                              const BondSetting& setting) {
  const MaterialSpecification& material = from.material;
  if (material.c1) return {*material.c1, material.c2, material.c3};
  try {
    return stiffness_of(from, points, setting)
        .constants(lame_moduli(*material.youngs_modulus, *material.poisson_ratio, points.dimension),
                   material.c2);
  } catch (const InputError& error) {
    throw InputError("material." + error.key(), error.value(), error.allowed());
  }
}

Model make_cpd_model(const BodySpecification& from, const Points& points,
                     const BondSetting& setting, Bonds bonds, CutBonds& cut, int threads) {
  const CpdConstants constants = cpd_constants_of(from, points, setting);
  refuse_damage_of_negative_constants(from, points, setting, constants);
  const BulkNeighbourhood bulk =
      bulk_neighbourhood(points.dimension, points.spacing, setting.horizon, setting.cross_section);
  set_one_neighbour_weights(bonds, points, bulk);
  Bonds left = bonds;
  cut = cut_bonds(left, points, from.cracks);
  std::vector<char> never_fails = never_failing_bonds(from, points, left);
  Model model(std::move(left), bond_potential(from.material, constants.c1), std::move(never_fails));
  std::optional<Simplices<Area>> triangles;
  std::optional<Simplices<Volume>> tetrahedra;
  if (constants.c2 != 0.0) {
    triangles = make_simplices<Area>(from, points, bonds, model.bonds(), bulk,
                                     setting.cross_section, constants.c2, threads);
  }
  if (constants.c3 != 0.0) {
    tetrahedra = make_simplices<Volume>(from, points, bonds, model.bonds(), bulk,
                                        setting.cross_section, constants.c3, threads);
  }
  if (triangles || tetrahedra) {
    model.add(std::make_shared<SimplexTerm>(model.bond_term(), std::move(triangles),
                                            std::move(tetrahedra)));
  }
  return model;
}

}  // namespace peristat
