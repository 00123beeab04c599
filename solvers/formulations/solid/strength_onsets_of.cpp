#include "solvers/formulations/solid/strength_onsets_of.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "solvers/formulations/specification/require.hpp"

namespace peristat {

MaterialStrength material_strength(const DamageSpecification& damage, const Moduli& moduli,
                                   int dimension) {
  const PlaneState plane = moduli.is_thin ? PlaneState::stress : PlaneState::strain;
  return {damage.surface(), dimension,
          lame_constants(moduli.youngs_modulus, moduli.poisson_ratio, dimension, plane),
          dimension == 2 && !moduli.is_thin ? moduli.poisson_ratio : 0.0, damage.strength_factor};
}

std::shared_ptr<const StrengthOnsets> strength_onsets_of(const ModelSetting& setting,
                                                         Formulation::OfMaterial<Moduli> moduli) {
  std::vector<std::optional<PointStrength>> strengths;
  bool is_any = false;
  for (const auto& [material, key, name] : setting.materials.all()) {
    strengths.emplace_back();
    const DamageSpecification& damage = material->damage;
    if (!damage.has_surface()) continue;
    const std::string of_key = key + ".damage.strength_surface";
    require(setting.index_map.is_whole(), of_key, "", "is for one rank");
    require(setting.of.teeth == 0, of_key, "", "is not for mode \"path\"");
    const Moduli found = moduli(*material, key, setting.bonds, setting.points.spacing);
    strengths.back() = {material_strength(damage, found, setting.points.dimension),
                        damage.peak_factors};
    is_any = true;
  }
  if (!is_any) return nullptr;
  return std::make_shared<const StrengthOnsets>(std::move(strengths), setting.materials.of_points(),
                                                setting.factors.strength);
}

}  // namespace peristat
