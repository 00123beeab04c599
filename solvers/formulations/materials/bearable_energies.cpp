#include "solvers/formulations/materials/bearable_energies.hpp"

#include <algorithm>
#include <limits>

#include "solvers/formulations/materials/fracture_data.hpp"
#include "src/core/input_error.hpp"

namespace peristat {

BearableEnergies bearable_energies(const PointMaterials& materials, const Points& points,
                                   double horizon) {
  const auto& all = materials.all();
  if (std::ranges::none_of(all, [](const auto& material) {
        return material.of->damage.law == DamageLaw::energy_density;
      })) {
    return {};
  }
  std::vector<double> bearable(std::size_t(points.count()),
                               std::numeric_limits<double>::infinity());
  for (Index i = 0; i < points.count(); ++i) {
    const DamageSpecification& damage = all[materials.of(i)].of->damage;
    if (damage.law != DamageLaw::energy_density) continue;
    bearable[std::size_t(i)] =
        bearable_energy_density(damage, horizon) * points.volume[std::size_t(i)];
  }
  for (const auto& material : all) {
    for (const std::string& set : material.of->damage.no_fail) {
      const auto found = points.sets.find(set);
      if (found == points.sets.end()) {
        throw InputError(material.key + ".damage.no_fail", '"' + set + '"', "no set of this name");
      }
      for (const Index i : found->second) {
        bearable[std::size_t(i)] = std::numeric_limits<double>::infinity();
      }
    }
  }
  return bearable;
}

}  // namespace peristat
