#include "solvers/observe/stress_fields.hpp"

#include <array>

#include "assembly/terms/damage.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/point_materials.hpp"
#include "src/materials/bond_constants.hpp"
#include "src/materials/quadrature.hpp"

namespace peristat {
namespace {

/// Entries of the upper half of a tensor, in the order of results: xx, yy, zz, xy, yz, xz.
std::vector<std::array<std::size_t, 2>> upper_half(std::size_t dimension) {
  if (dimension == 1) return {{0, 0}};
  if (dimension == 2) return {{0, 0}, {1, 1}, {0, 1}};
  return {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
}

/// Ratio of the stress across a plane body to the sum of the in-plane normal stresses. Model "cpd"
/// is purely two-dimensional: 0.
std::vector<double> out_of_plane(const Body& body) {
  const bool is_plane_strain =
      body.points.dimension == 2 && body.setting.plane == PlaneState::strain;
  if (!is_plane_strain) return {0.0};
  if (!takes(body.specification, Option::poisson_ratio)) return {poisson_ratio(body.setting)};
  const PointMaterials materials(body.specification, body.points);
  const auto& all = materials.all();
  std::vector<double> ratios;
  for (Index i = 0; i < body.points.own(); ++i) {
    ratios.push_back(*all[materials.of(i)].of->poisson_ratio);
  }
  return ratios;
}

}  // namespace

Stress stress_of(const Body& body, Assembler& assembler, const StateView& at) {
  return find_stress(assembler, at, out_of_plane(body),
                     formulation_of(body.specification).across_plane);
}

std::vector<double> symmetric_parts(const std::vector<double>& tensors, std::size_t d) {
  const auto entries = upper_half(d);
  std::vector<double> halves;
  halves.reserve(tensors.size() / (d * d) * entries.size());
  for (std::size_t at = 0; at < tensors.size(); at += d * d) {
    for (const auto& [r, c] : entries) {
      halves.push_back(0.5 * (tensors[at + r * d + c] + tensors[at + c * d + r]));
    }
  }
  return halves;
}

std::vector<double> missing_neighbourhood(const Body& body, const StateView& at,
                                          const std::vector<char>& is_determined) {
  const std::vector<double> whole = whole_volumes(body.points, body.setting);
  const DamagedNetwork network = damaged_network(body.model, at.history);
  std::vector<double> missing =
      seen_volumes(body.points, *network.bonds, body.setting, network.broken);
  missing.resize(is_determined.size());
  for (std::size_t i = 0; i < missing.size(); ++i) {
    missing[i] = is_determined[i] ? 1.0 - missing[i] / whole[i] : 1.0;
  }
  return missing;
}

}  // namespace peristat
