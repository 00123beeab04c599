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

void VelocityVerlet::note_dragged() {
  const auto& entries = drag_.entries();
  dragged_velocity_.resize(entries.size());
  dragged_acceleration_.resize(entries.size());
  for (std::size_t k = 0; k < entries.size(); ++k) {
    dragged_velocity_[k] = velocity_[entries[k].dof];
    dragged_acceleration_[k] = acceleration(entries[k].dof);
  }
}

void VelocityVerlet::begin_drag(double dt) {
  drag_.set_step(dt);
  for (std::size_t k = 0; k < drag_.entries().size(); ++k) {
    const auto& [dof, rate, factors] = drag_.entries()[k];
    velocity_[dof] =
        factors.phi1 * dragged_velocity_[k] + factors.phi2 * dt * dragged_acceleration_[k];
  }
}

void VelocityVerlet::end_drag(double dt) {
  for (std::size_t k = 0; k < drag_.entries().size(); ++k) {
    const auto& [dof, rate, factors] = drag_.entries()[k];
    const auto& [decay, phi1, phi2, lost] = factors;
    const double v = dragged_velocity_[k];
    const double kick = dt * dragged_acceleration_[k], next_kick = dt * acceleration(dof);
    const double travelled = phi1 * v + phi2 * kick;  // over dt
    velocity_[dof] = decay * v + (phi1 - phi2) * kick + phi2 * next_kick;
    const double work = 0.5 * (kick + next_kick) * travelled;
    const double kinetic = 0.5 * (velocity_[dof] - v) * (velocity_[dof] + v);
    const double of_scheme = 0.5 * phi2 * phi2 * (next_kick - kick) * (next_kick + kick);
    sums_.absorbed += setting_.mass[dof] * (work - kinetic + of_scheme);
  }
}

Outcome VelocityVerlet::step(double dt, double time) {
  if (!is_same_step(dt, last_dt_)) {
    complete_sums();
    last_dt_ = dt;
    energy_at_change_ = scheme_energy(dt);
  }
  note_before();
  note_dragged();
  kick(0.5 * dt);
  begin_drag(dt);
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
  end_drag(dt);
  return Outcome::converged;
}

void VelocityVerlet::complete_sums() {
  if (!has_moved_) return;
  const double now = scheme_energy(last_dt_);
  sums_.correction += now - energy_at_change_;
  energy_at_change_ = now;
}

double VelocityVerlet::scheme_energy(double dt) {
  drag_.set_step(dt);
  double sum = 0.0;
  drag_.for_each(problem_.free.dof, [&](Index dof, const DragFactors& drag) {
    const double kick = drag.phi2 * dt * acceleration(dof);
    sum += setting_.mass[dof] * kick * kick;
  });
  return 0.5 * problem_.sums().of_all(sum);
}

}  // namespace peristat
