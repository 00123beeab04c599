#pragma once

#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/stress.hpp"
#include "solvers/problem/records.hpp"
#include "solvers/study/body.hpp"

namespace peristat {

/// Strain and stress of a state for the results, at the body's own points; in a part of a body at
/// owned points.
struct StressFields {
  Stress found;
  std::vector<double> strain, stress;  ///< upper halves: xx, yy, zz, xy, yz, xz
  /// Share of an interior point's neighbourhood that a point lacks; 1 where its bonds give no F.
  std::vector<double> missing_neighbourhood;

  void show_in(StepFields& fields) const;
};

[[nodiscard]] StressFields make_stress_fields(const Body& body, Assembler& assembler,
                                              const StateView& at);

}  // namespace peristat
