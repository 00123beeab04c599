#include "cases/runner/cpd_model.hpp"

#include "cases/runner/bond_potential.hpp"
#include "src/input_error.hpp"

namespace peristat {
namespace {

/// @param bonds of the whole body, which the effective volumes belong to: a crack is no surface
/// @param left those that pre-cracks have not cut; an interaction with a cut bond is lost
template <class Measure>
InteractionTerm<Measure> make_term(const Case& from, const Points& points, const Bonds& bonds,
                                   const Bonds& left, const BulkNeighbourhood& bulk, double horizon,
                                   double constant, int threads) {
  Interactions<Measure> interactions(points, bonds, horizon, threads);
  const auto shares = weight_shares<Measure>(
      points, effective_volumes(interactions, neighbour_counts(bonds), bulk, from.weights));
  if (left.count() < bonds.count()) {
    interactions = Interactions<Measure>(points, left, horizon, threads);
  }
  interactions.set_shares(shares);
  return {std::move(interactions), Harmonic{constant}};
}

}  // namespace

CpdConstants cpd_constants_of(const Case& from, const Points& points, const BondSetting& setting) {
  const MaterialSpecification& material = from.material;
  if (material.c1) return {*material.c1, material.c2, material.c3};
  const int dimension = from.dimension;
  const CpdStiffness stiffness =
      material.calibration == Calibration::lattice
          ? lattice_stiffness(dimension, points.spacing, setting.horizon, setting.cross_section)
          : continuum_stiffness(dimension, setting.horizon, setting.cross_section);
  try {
    return stiffness.constants(
        lame_moduli(*material.youngs_modulus, *material.poisson_ratio, dimension), material.c2);
  } catch (const InputError& error) {
    throw InputError("material." + error.key(), error.value(), error.allowed());
  }
}

Model make_cpd_model(const Case& from, const Points& points, const BondSetting& setting,
                     Bonds bonds, CutBonds& cut, int threads) {
  const CpdConstants constants = cpd_constants_of(from, points, setting);
  const BulkNeighbourhood bulk =
      bulk_neighbourhood(from.dimension, points.spacing, setting.horizon, setting.cross_section);
  set_one_neighbour_weights(bonds, points, bulk);
  Model model{bonds, bond_potential(from.material.damage, constants.c1)};
  cut = cut_bonds(model.bonds, points, from.cracks);
  if (constants.c2 != 0.0) {
    model.triangles = make_term<Area>(from, points, bonds, model.bonds, bulk, setting.horizon,
                                      constants.c2, threads);
  }
  if (constants.c3 != 0.0) {
    model.tetrahedra = make_term<Volume>(from, points, bonds, model.bonds, bulk, setting.horizon,
                                         constants.c3, threads);
  }
  return model;
}

}  // namespace peristat
