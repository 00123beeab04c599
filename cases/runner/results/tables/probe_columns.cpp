#include "cases/runner/results/tables/probe_columns.hpp"

#include "solvers/observe/probe.hpp"

namespace peristat {

ProbeColumns columns_of(const ProbeSpecification& probe, int dimension) {
  if (probe.field == "poisson_ratio") return {probe.name, 1, "1"};
  if (const CrackMeasure* measure = crack_measure(probe.field)) {
    return {probe.name, 1, measure->unit};
  }
  if (probe.field == "opening") return {probe.name, dimension, "m"};
  if (is_of_error(probe.statistic)) return {probe.name, 1, point_field(probe.field)->unit};
  return {probe.name, int(chosen_components(probe, dimension).size()),
          point_field(probe.field)->unit};
}

}  // namespace peristat
