#include "solvers/body/youngs_moduli.hpp"

#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/point_materials.hpp"

namespace peristat {

std::vector<double> youngs_moduli(const Body& body) {
  const PointMaterials materials(body.specification, body.points);
  const Formulation& formulation = formulation_of(body.specification);
  std::vector<double> of_materials, of_points;
  for (const PointMaterials::Material& material : materials.all()) {
    of_materials.push_back(
        formulation.moduli(*material.of, material.key, body.setting, body.points.spacing)
            .youngs_modulus);
  }
  for (Index i = 0; i < body.points.count(); ++i) {
    of_points.push_back(of_materials[materials.of(i)]);
  }
  return of_points;
}

}  // namespace peristat
