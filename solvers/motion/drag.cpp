#include "solvers/motion/drag.hpp"

#include <cmath>

namespace peristat {
namespace {

/// Below this x 1 - phi1 loses digits, and six terms of the series of phi2 leave an error of 1e-16.
constexpr double small = 1e-2;

double series_of_phi2(double x) {
  double sum = 0.0;
  for (const double term : {5040.0, 720.0, 120.0, 24.0, 6.0, 2.0}) sum = 1.0 / term - x * sum;
  return sum;
}

}  // namespace

DragFactors::DragFactors(double x) {
  if (x == 0.0) return;
  decay = std::exp(-x);
  lost = -std::expm1(-x);
  phi1 = lost / x;
  phi2 = x < small ? series_of_phi2(x) : (1.0 - phi1) / x;
}

Drag::Drag(const MotionSetting& setting, const std::vector<Index>& dofs) {
  if (setting.absorption.empty()) return;
  for (const Index dof : dofs) {
    if (setting.absorption[dof] > 0.0) entries_.push_back({dof, setting.absorption[dof]});
  }
}

void Drag::set_step(double dt) {
  if (dt == dt_) return;
  dt_ = dt;
  for (Entry& entry : entries_) entry.factors = DragFactors(entry.rate * dt);
}

}  // namespace peristat
