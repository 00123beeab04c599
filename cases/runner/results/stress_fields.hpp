#pragma once

#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/stress.hpp"
#include "cases/runner/input/case.hpp"
#include "solvers/problem/records.hpp"
#include "solvers/study/body.hpp"

namespace peristat {

/// Strain and stress of a state as results tell them, of the points that stand for themselves.
struct StressFields {
  Stress found;
  std::vector<double> strain, stress;  ///< without what symmetry repeats: xx, yy, zz, xy, yz, xz
  /// Share of a neighbourhood inside the lattice that a point lacks; 1 where its bonds give no F.
  std::vector<double> missing_neighbourhood;

  void show_in(StepFields& fields) const;
};

/// Whether the results or a probe of the case tell any of it.
[[nodiscard]] bool is_stress_needed(const Case& from);

[[nodiscard]] StressFields make_stress_fields(const Body& body, Assembler& assembler,
                                              const StateView& at);

}  // namespace peristat
