#include "cases/runner/input/probe_fields.hpp"

#include <algorithm>

namespace peristat {
namespace {

using FieldKind = ProbeField::Kind;

const std::vector<ProbeField>& fields() {
  static const std::vector<ProbeField> all{
      {"displacement", "m", FieldKind::vector},
      {"force", "N", FieldKind::vector},
      {"damage", "1"},
      {"stretch", "1"},
      {"energy_density", "J/m3"},
      {"deformation_gradient", "1", FieldKind::tensor, true},
      {"strain", "1", FieldKind::symmetric, true},
      {"divergence", "1", FieldKind::scalar, true},
      {"first_piola_stress", "Pa", FieldKind::tensor, true},
      {"stress", "Pa", FieldKind::symmetric, true},
      {"von_mises", "Pa", FieldKind::scalar, true},
      {"principal_stress", "Pa", FieldKind::principal, true},
      {"missing_neighbourhood", "1", FieldKind::scalar, true},
      {"velocity", "m/s", FieldKind::vector, false, true},
      {"kinetic_energy_density", "J/m3", FieldKind::scalar, false, true}};
  return all;
}

std::string axes(int row, int column) { return {"xyz"[row], "xyz"[column]}; }

std::vector<std::string> symmetric(int dimension) {
  if (dimension == 1) return {"xx"};
  if (dimension == 2) return {"xx", "yy", "xy"};
  return {"xx", "yy", "zz", "xy", "yz", "xz"};
}

}  // namespace

std::vector<std::string> ProbeField::components(int dimension) const {
  if (kind == FieldKind::symmetric) return symmetric(dimension);
  std::vector<std::string> names;
  for (int r = 0; r < dimension && kind != FieldKind::scalar; ++r) {
    if (kind == FieldKind::vector) names.emplace_back(1, "xyz"[r]);
    if (kind == FieldKind::principal) names.emplace_back(1, "123"[r]);
    for (int c = 0; c < dimension && kind == FieldKind::tensor; ++c) names.push_back(axes(r, c));
  }
  return names;
}

const ProbeField* probe_field(const std::string& name) {
  const auto found =
      std::ranges::find_if(fields(), [&](const ProbeField& field) { return field.name == name; });
  return found == fields().end() ? nullptr : &*found;
}

std::vector<std::string> probe_field_names() {
  std::vector<std::string> names;
  for (const ProbeField& field : fields()) names.push_back(field.name);
  // Inserted here to keep the order of the reference.
  names.insert(names.begin() + 5,
               {"poisson_ratio", "opening", "crack_length", "crack_begin", "crack_end",
                "crack_angle", "crack_area", "work_of_fracture", "crack_resistance"});
  return names;
}

std::vector<std::string> probe_component_names() {
  std::vector<std::string> names{"x", "y", "z", "1", "2", "3"};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) names.push_back(axes(r, c));
  }
  return names;
}

}  // namespace peristat
