#include "cases/runner/results/probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <Eigen/QR>

#include "cases/runner/input/probe_fields.hpp"
#include "cases/runner/results/crack_measures.hpp"
#include "src/core/expression.hpp"
#include "src/geometry/nearest_point.hpp"

namespace peristat {
namespace {

/// Values of a field, as many per point as it has components.
const std::vector<double>& values_of(const ProbeField& field, const StepFields& fields) {
  static const std::map<std::string, const std::vector<double> * StepFields::*> members{
      {"displacement", &StepFields::displacement},
      {"force", &StepFields::force},
      {"damage", &StepFields::damage},
      {"stretch", &StepFields::stretch},
      {"energy_density", &StepFields::energy_density},
      {"deformation_gradient", &StepFields::deformation_gradient},
      {"strain", &StepFields::strain},
      {"first_piola_stress", &StepFields::first_piola_stress},
      {"stress", &StepFields::stress},
      {"von_mises", &StepFields::von_mises},
      {"principal_stress", &StepFields::principal_stress},
      {"missing_neighbourhood", &StepFields::missing_neighbourhood},
      {"velocity", &StepFields::velocity},
      {"kinetic_energy_density", &StepFields::kinetic_energy_density}};
  return *(fields.*members.at(field.name));
}

/// Poisson's ratio of the homogeneous deformation that fits the displacements of a set best (least
/// squares), -(mean lateral strain) / (strain along the axis); 0 while there is no strain along it.
double fitted_poisson_ratio(const ProbeSpecification& probe, const Points& points,
                            const std::vector<double>& displacement) {
  const std::vector<Index>& members = points.sets.at(probe.set);
  const int d = points.dimension;
  Eigen::MatrixXd positions(members.size(), d + 1), displacements(members.size(), d);
  for (std::size_t k = 0; k < members.size(); ++k) {
    for (int c = 0; c < d; ++c) {
      positions(k, c) = points.reference[std::size_t(members[k]) * d + c];
      displacements(k, c) = displacement[std::size_t(members[k]) * d + c];
    }
    positions(k, d) = 1.0;
  }
  // Of full rank for any set of two or more points in every direction, by the smallest solution for
  // others.
  const Eigen::MatrixXd gradient = positions.completeOrthogonalDecomposition().solve(displacements);
  double lateral = 0.0;
  for (int c = 0; c < d; ++c) {
    if (c != probe.axis) lateral += gradient(c, c) / (d - 1);
  }
  const double axial = gradient(probe.axis, probe.axis);
  return axial == 0.0 ? 0.0 : -lateral / axial;
}

std::vector<double> mean_of(const std::vector<double>& values, const std::vector<Index>& members,
                            int components) {
  std::vector<double> mean(components, 0.0);
  for (const Index point : members) {
    for (int c = 0; c < components; ++c) mean[c] += values[std::size_t(point) * components + c];
  }
  for (double& value : mean) value /= double(members.size());
  return mean;
}

/// tr F - d of a point.
double divergence_at(const std::vector<double>& gradients, int dimension, Index point) {
  const auto d = std::size_t(dimension);
  double divergence = 0.0;
  for (std::size_t c = 0; c < d; ++c) {
    divergence += gradients[std::size_t(point) * d * d + c * d + c] - 1.0;
  }
  return divergence;
}

/// Root mean square, or the largest, of the lengths of what separates a set from expected values.
double error_over_set(const ProbeSpecification& probe, const Points& points,
                      const StepFields& fields, const LoadValues& loads) {
  std::vector<Expression> expected;
  for (const std::string& text : probe.expected) {
    expected.emplace_back(text, points.dimension, points.spacing, loads.names);
  }
  const std::vector<Index>& members = points.sets.at(probe.set);
  double sum = 0.0, largest = 0.0;
  for (const Index point : members) {
    const std::vector<double> values = values_at(probe, points.dimension, fields, point);
    double squared = 0.0;
    for (std::size_t c = 0; c < values.size(); ++c) {
      const double difference = values[c] - expected[c](points.position(point), loads.values);
      squared += difference * difference;
    }
    sum += squared;
    largest = std::max(largest, std::sqrt(squared));
  }
  return probe.statistic == Statistic::max_error ? largest
                                                 : std::sqrt(sum / double(members.size()));
}

std::vector<double> over_set(const ProbeSpecification& probe, const Points& points,
                             const StepFields& fields) {
  const std::vector<Index>& members = points.sets.at(probe.set);
  std::vector<double> total = values_at(probe, points.dimension, fields, members.front());
  for (auto member = members.begin() + 1; member != members.end(); ++member) {
    const std::vector<double> more = values_at(probe, points.dimension, fields, *member);
    for (std::size_t c = 0; c < total.size(); ++c) {
      total[c] = probe.statistic == Statistic::mean  ? total[c] + more[c]
                 : probe.statistic == Statistic::max ? std::max(total[c], more[c])
                                                     : std::min(total[c], more[c]);
    }
  }
  if (probe.statistic != Statistic::mean) return total;
  for (double& value : total) value /= double(members.size());
  return total;
}

}  // namespace

std::vector<std::string> chosen_components(const ProbeSpecification& probe, int dimension) {
  const auto components = probe_field(probe.field)->components(dimension);
  if (components.empty()) return {""};
  return probe.component.empty() ? components : std::vector<std::string>{probe.component};
}

std::vector<double> values_at(const ProbeSpecification& probe, int dimension,
                              const StepFields& fields, Index point) {
  const ProbeField& field = *probe_field(probe.field);
  if (field.name == "divergence")
    return {divergence_at(*fields.deformation_gradient, dimension, point)};
  const std::vector<double>& values = values_of(field, fields);
  const auto components = field.components(dimension);
  const std::size_t width = std::max<std::size_t>(components.size(), 1);
  const double* const of_point = &values[std::size_t(point) * width];
  if (probe.component.empty()) return {of_point, of_point + width};
  return {of_point[std::ranges::find(components, probe.component) - components.begin()]};
}

ProbeColumns columns_of(const ProbeSpecification& probe, int dimension) {
  if (probe.field == "poisson_ratio") return {probe.name, 1, "1"};
  if (const CrackMeasure* measure = crack_measure(probe.field)) {
    return {probe.name, 1, measure->unit};
  }
  if (probe.field == "opening") return {probe.name, dimension, "m"};
  if (is_of_error(probe.statistic)) return {probe.name, 1, probe_field(probe.field)->unit};
  return {probe.name, int(chosen_components(probe, dimension).size()),
          probe_field(probe.field)->unit};
}

std::vector<double> probe_values(const ProbeSpecification& probe, const Points& points,
                                 const StepFields& fields, const CrackState& crack,
                                 const LoadValues& loads) {
  if (probe.field == "poisson_ratio") {
    return {fitted_poisson_ratio(probe, points, *fields.displacement)};
  }
  if (const CrackMeasure* measure = crack_measure(probe.field)) {
    return {measure->value(points, points.sets.at(probe.set), probe.axis, crack)};
  }
  if (probe.at) {
    return values_at(probe, points.dimension, fields, nearest_point(points, *probe.at).point);
  }
  const std::vector<Index>& members = points.sets.at(probe.set);
  if (probe.field == "opening") {
    std::vector<double> opening = mean_of(*fields.displacement, members, points.dimension);
    const std::vector<double> other =
        mean_of(*fields.displacement, points.sets.at(probe.other), points.dimension);
    for (std::size_t c = 0; c < opening.size(); ++c) opening[c] -= other[c];
    return opening;
  }
  if (is_of_error(probe.statistic)) return {error_over_set(probe, points, fields, loads)};
  return over_set(probe, points, fields);
}

}  // namespace peristat
