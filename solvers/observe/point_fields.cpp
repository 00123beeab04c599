#include "solvers/observe/point_fields.hpp"

#include <algorithm>
#include <cstddef>

namespace peristat {
namespace {

std::string pair_of_axes(int row, int column) { return {"xyz"[row], "xyz"[column]}; }

/// tr F - d.
double divergence(const std::vector<double>& gradients, std::size_t d, Index point) {
  const double* const of_point = &gradients[std::size_t(point) * d * d];
  double sum = 0.0;
  for (std::size_t c = 0; c < d; ++c) sum += of_point[c * (d + 1)] - 1.0;
  return sum;
}

}  // namespace

const std::vector<PointField>& point_fields() {
  using enum FieldRank;
  using enum FieldNeeds;
  using S = StepFields;
  constexpr ShownBy steps = ShownBy::steps, both = ShownBy::both;
  static const std::vector<PointField> fields{
      {"displacement", "m", "displacement of each point", vector, &S::displacement},
      {"force", "N", "internal force on each point: minus the derivative of the stored energy",
       vector, &S::force},
      {"damage", "1", "damage of each point, 0 intact to 1", scalar, &S::damage},
      {"energy_density", "J/m3", "stored energy per volume of each point", scalar,
       &S::energy_density},
      {"stretch", "1",
       "largest stretch of the unbroken bonds of each point: current / reference length - 1",
       scalar, &S::stretch},
      {"fragment", "1",
       "number of the floating piece that the point belongs to; 0: held by the supports", scalar,
       &S::fragment, nothing, steps},
      {"deformation_gradient", "1",
       "deformation gradient F from the unbroken bonds of each point, least squares; identity "
       "where they give none",
       tensor, &S::deformation_gradient, stress, both},
      {"divergence", "1", "trace of F - I", scalar, &S::deformation_gradient, stress,
       ShownBy::probes},
      {"green_lagrange_strain", "1", "strain E = (F^T F - I) / 2", tensor,
       &S::green_lagrange_strain, stress, steps},
      {"first_piola_stress", "Pa",
       "first Piola-Kirchhoff stress P, the virial of each point over its volume", tensor,
       &S::first_piola_stress, stress, both},
      {"cauchy_stress", "Pa", "Cauchy stress P F^T / det F; 0 where the unbroken bonds give no F",
       tensor, &S::cauchy_stress, stress, steps},
      {"strain", "1", "green_lagrange_strain: xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz",
       symmetric, &S::strain, stress, both},
      {"stress", "Pa",
       "symmetric part of cauchy_stress: xx, or xx, yy, xy, or xx, yy, zz, xy, yz, xz", symmetric,
       &S::stress, stress, both},
      {"von_mises", "Pa", "von Mises stress", scalar, &S::von_mises, stress, both},
      {"principal_stress", "Pa", "principal values of the Cauchy stress, the largest first",
       principal, &S::principal_stress, stress, both},
      {"principal_direction", "1", "unit vectors of the principal stresses, one per row", tensor,
       &S::principal_direction, stress, steps},
      {"missing_neighbourhood", "1",
       "share of a neighbourhood inside the lattice that each point lacks, by surfaces, cracks "
       "and broken bonds; 1 where the unbroken bonds give no F",
       scalar, &S::missing_neighbourhood, stress, both},
      {"velocity", "m/s", "velocity of each point", vector, &S::velocity, motion, both},
      {"kinetic_energy_density", "J/m3", "kinetic energy per volume of each point", scalar,
       &S::kinetic_energy_density, motion, both}};
  return fields;
}

const PointField* point_field(const std::string& name) {
  const auto found = std::ranges::find(point_fields(), name, &PointField::name);
  return found == point_fields().end() ? nullptr : &*found;
}

std::vector<std::string> PointField::components(int dimension) const {
  if (rank == FieldRank::symmetric) {
    if (dimension == 1) return {"xx"};
    if (dimension == 2) return {"xx", "yy", "xy"};
    return {"xx", "yy", "zz", "xy", "yz", "xz"};
  }
  std::vector<std::string> names;
  for (int r = 0; r < dimension && rank != FieldRank::scalar; ++r) {
    if (rank == FieldRank::vector) names.emplace_back(1, "xyz"[r]);
    if (rank == FieldRank::principal) names.emplace_back(1, "123"[r]);
    for (int c = 0; c < dimension && rank == FieldRank::tensor; ++c) {
      names.push_back(pair_of_axes(r, c));
    }
  }
  return names;
}

std::vector<std::uint64_t> PointField::extents(int dimension) const {
  const auto d = static_cast<std::uint64_t>(dimension);
  if (rank == FieldRank::scalar) return {};
  if (rank == FieldRank::tensor) return {d, d};
  if (rank == FieldRank::symmetric) return {d * (d + 1) / 2};
  return {d};
}

std::vector<double> PointField::at(const StepFields& fields, int dimension, Index point) const {
  const std::vector<double>& all = *(fields.*values);
  if (name == "divergence") return {divergence(all, std::size_t(dimension), point)};
  std::size_t width = 1;
  for (const std::uint64_t extent : extents(dimension)) width *= extent;
  const auto first = all.begin() + std::ptrdiff_t(std::size_t(point) * width);
  return {first, first + std::ptrdiff_t(width)};
}

std::vector<std::string> component_names() {
  std::vector<std::string> names{"x", "y", "z", "1", "2", "3"};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) names.push_back(pair_of_axes(r, c));
  }
  return names;
}

}  // namespace peristat
