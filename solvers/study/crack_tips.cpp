#include "solvers/study/crack_tips.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/point_materials.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/sums.hpp"

namespace peristat {
namespace {

TipElasticity elasticity_of(const PointMaterials::Material& material, const Body& body) {
  const Moduli of = formulation_of(body.specification)
                        .moduli(*material.of, material.key, body.setting, body.points.spacing);
  return of.is_thin ? TipElasticity::plane_stress(of.youngs_modulus, of.poisson_ratio)
                    : TipElasticity::plane_strain(of.youngs_modulus, of.poisson_ratio);
}

/// Returns the material of the points about a tip; refuses a ring with two.
std::size_t material_about(const Body& body, const PointMaterials& materials,
                           const CrackTipIntegrals& tip, const std::string& key) {
  const Sums of_body(*body.index_map, body.points.dimension);
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const Index point : tip.points()) {
    const auto of = double(materials.of(body.points.source(point)));
    first = std::min(first, of);
    last = std::max(last, of);
  }
  first = -of_body.largest_of_all(-first);
  if (of_body.largest_of_all(last) != first) {
    throw InputError(key + ".outer", "",
                     "the ring contains two materials, so the energy flux through it is not that "
                     "of the tip alone");
  }
  return std::size_t(first);
}

/// Refuses evaluations of a tip that have no sum over ranks.
void refuse_without_ranks(const CrackTipSpecification& tip, const std::string& key) {
  if (tip.cut > 0.0) {
    throw InputError(key + ".cut", number_text(tip.cut),
                     "is for one rank; on several ranks use J, which needs no cut");
  }
}

/// Refuses rings with supports, whose effect would count as the tip's.
void refuse_held_rings(const Body& body, const CrackTipIntegrals& tip, const std::string& key) {
  const Conditions& conditions = *body.conditions;
  const auto d = std::size_t(body.points.dimension);
  for (const Index point : tip.points()) {
    for (std::size_t dof = std::size_t(point) * d; dof < (std::size_t(point) + 1) * d; ++dof) {
      if (body.points.is_image(point) || !conditions.prescribed()[dof]) continue;
      throw InputError(key + ".outer", "",
                       "a support or constraint holds a point within the ring, at " +
                           place_text(body.points.position(point), body.points.dimension) + " m");
    }
  }
}

}  // namespace

bool has_isotropic_materials(const BodySpecification& of) {
  const auto is_isotropic = [](const MaterialSpecification& material) {
    return !material.fibre &&
           std::none_of(material.scatter.begin(), material.scatter.end(), [](const auto& scatter) {
             return scatter.of == ScatterSpecification::Quantity::stiffness;
           });
  };
  return of.horizon_shape == HorizonShape::ball && is_isotropic(of.material) &&
         std::all_of(of.regions.begin(), of.regions.end(), [&](const RegionSpecification& region) {
           return is_isotropic(region.material);
         });
}

std::vector<CrackTip> make_crack_tips(const Body& body,
                                      const std::vector<CrackTipSpecification>& tips,
                                      const StudyOptions& options) {
  std::vector<CrackTip> made;
  if (tips.empty()) return made;
  const PointMaterials materials(body.specification, body.points);
  for (std::size_t k = 0; k < tips.size(); ++k) {
    const std::string key = indexed("crack_tips", k);
    if (body.specification.eigenstrains.are_there()) {
      throw InputError(key, "", "is not allowed with eigenstrains or a temperature");
    }
    if (!body.index_map->is_whole()) refuse_without_ranks(tips[k], key);
    CrackTip tip{{body.points,
                  tips[k],
                  {body.setting.reach(), body.setting.cross_section, *body.index_map},
                  key},
                 nullptr};
    refuse_held_rings(body, tip.integrals, key);
    const std::size_t material = material_about(body, materials, tip.integrals, key);
    if (has_isotropic_materials(body.specification)) {
      tip.integrals.set_elasticity(elasticity_of(materials.all()[material], body));
    }
    if (tips[k].cut > 0.0) {
      tip.release =
          std::make_unique<CutRelease>(body, tips[k], tip.integrals.share(), options, key + ".cut");
    }
    made.push_back(std::move(tip));
  }
  return made;
}

}  // namespace peristat
