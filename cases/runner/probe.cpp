#include "cases/runner/probe.hpp"

namespace peristat {
namespace {

struct ProbedField {
  const std::vector<double>* StepFields::*field;
  bool is_vector;
  const char* unit;
};

ProbedField field_of(const std::string& name) {
  if (name == "displacement") return {&StepFields::displacement, true, "m"};
  if (name == "force") return {&StepFields::force, true, "N"};
  if (name == "damage") return {&StepFields::damage, false, "1"};
  return {&StepFields::energy_density, false, "J/m3"};
}

}  // namespace

ProbeColumns columns_of(const ProbeSpecification& probe, int dimension) {
  const ProbedField field = field_of(probe.field);
  return {probe.name, field.is_vector ? dimension : 1, field.unit};
}

std::vector<double> probe_values(const ProbeSpecification& probe, const Points& points,
                                 const StepFields& fields) {
  const ProbedField field = field_of(probe.field);
  const std::vector<double>& values = *(fields.*(field.field));
  const std::vector<Index>& members = points.sets.at(probe.set);
  const int components = field.is_vector ? points.dimension : 1;
  std::vector<double> mean(components, 0.0);
  for (Index point : members) {
    for (int c = 0; c < components; ++c) mean[c] += values[std::size_t(point) * components + c];
  }
  for (double& value : mean) value /= double(members.size());
  return mean;
}

}  // namespace peristat
