#include "solvers/formulations/lps_energy/convolved_solid.hpp"

#include <memory>
#include <utility>

#include "assembly/terms/linear/linear_term.hpp"
#include "solvers/formulations/convolved/convolved_lattice.hpp"
#include "solvers/formulations/lps_energy/state_model.hpp"
#include "solvers/formulations/materials/bearable_energies.hpp"
#include "solvers/formulations/solid/solid_constants.hpp"

namespace peristat {

Model make_convolved_solid(const ModelSetting& setting, Bonds bonds, CutBonds& cut) {
  cut_short_bonds(bonds, setting);
  const Points& points = setting.points;
  const MaterialSpecification& material = *setting.materials.all().front().of;
  const BondSetting of_springs = state_setting(setting.bonds);
  const double modulus = micromodulus(*material.youngs_modulus, of_springs);
  const double volume = points.volume.front();
  const SolidForces form =
      setting.of.form == SolidForm::printed ? SolidForces::printed : SolidForces::energy;
  return Model(std::make_shared<LinearTerm>(
      std::make_shared<const Bonds>(std::move(bonds)), modulus,
      bearable_energies(setting.materials, points, setting.bonds.horizon),
      make_convolved_lattice(setting, of_springs, modulus, cut, form == SolidForces::printed ? OtherOperator::none : OtherOperator::bonds), setting.threads,
      ConvolvedSolid{
          lattice_arms(setting.bonds, points.spacing, points.angle, volume),
          {lame_constants(material, points.dimension), volume, form, std::size_t(points.own())}}));
}

}  // namespace peristat
