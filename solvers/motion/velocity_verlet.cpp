#include "solvers/motion/velocity_verlet.hpp"

#include <cmath>

#include "src/core/threads.hpp"

namespace peristat {
namespace {

constexpr bool is_same_step(double a, double b) { return std::abs(a - b) <= 1e-9 * b; }

}  // namespace

/// v += dt/2 M^-1 F
void VelocityVerlet::kick(double half_step) {
  const auto count = static_cast<Index>(velocity_.size());
  double* const velocity = velocity_.data();
  const double *const inverse_mass = inverse_mass_.data(), *const load = external_force_.data(),
                      *const gradient = at_.gradient.data();
  run_on_threads(problem_.assembler.threads(), [&](int) {
#pragma omp for simd schedule(static) nowait
    for (Index k = 0; k < count; ++k) {
      velocity[k] += half_step * inverse_mass[k] * (load[k] - gradient[k]);
    }
  });
}

/// u += dt v
void VelocityVerlet::drift(double dt) {
  const auto count = static_cast<Index>(velocity_.size());
  double* const displacement = at_.displacement.data();
  const double* const velocity = velocity_.data();
  run_on_threads(problem_.assembler.threads(), [&](int) {
#pragma omp for simd schedule(static) nowait
    for (Index k = 0; k < count; ++k) displacement[k] += dt * velocity[k];
  });
}

Outcome VelocityVerlet::step(double dt, double time) {
  if (!is_same_step(dt, last_dt_)) {
    complete_sums();
    last_dt_ = dt;
  }
  note_before();
  absorb(0.5 * dt);
  kick(0.5 * dt);
  time_ = time;
  has_moved_ = true;
  change_environment();
  drift(dt);
  change_supports_and_loads(at_.displacement);
  move_followers(problem_, at_);
  complete_heating();
  if (!find_forces()) return Outcome::degenerate;
  add_work([&](Index dof) { return dt * velocity_[dof]; });
  kick(0.5 * dt);
  absorb(0.5 * dt);
  return Outcome::converged;
}

void VelocityVerlet::complete_sums() {
  const double now = squared_force();
  if (has_moved_) sums_.correction += last_dt_ * last_dt_ / 8.0 * (now - force_at_change_);
  force_at_change_ = now;
}

}  // namespace peristat
