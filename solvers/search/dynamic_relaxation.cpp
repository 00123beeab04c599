#include "solvers/search/dynamic_relaxation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "solvers/search/way_of_load.hpp"
#include "src/core/threads.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

constexpr double largest_damping = 1.9;

/// Velocity, relative to the root mean square of all, below which a component counts as standing
/// still: round-off would decide its contribution to c_n.
constexpr double standing = 1e-8;
constexpr int iterations_per_record = 100;

/// Iterations between two checks of the bonds that a state would break.
constexpr int iterations_per_look = 10;

/// Sums over the equations; those of the threads are added in order.
using FourSums = std::array<double, 4>;

class Relaxation {
 public:
  Relaxation(const EquilibriumProblem& problem, const WayOfLoad& way,
             const RelaxationOptions& options, std::vector<double>& velocity,
             RelaxationResult& result)
      : problem_(problem),
        of_body_(problem.sums()),
        equations_(of_body_.of_all(double(problem.free.dof.size()))),
        way_(way),
        options_(options),
        dofs_(problem.free.dof),
        velocity_(velocity),
        result_(result),
        at_(result.state),
        start_(problem.assembler.has_friction() ? result.state.displacement
                                                : std::vector<double>()),
        start_environment_(result.state.environment),
        density_(dofs_.size()),
        inverse_density_(dofs_.size()),
        residual_(dofs_.size()),
        last_residual_(dofs_.size()) {
    std::vector<char> counts_here(at_.displacement.size(), 0);
    of_body_.for_each_entry(counts_here.size(), [&](std::size_t dof) { counts_here[dof] = 1; });
    for (const Index dof : way.prescribed()) {
      if (!counts_here[std::size_t(dof)]) continue;
      held_.push_back(dof);
      last_reaction_.push_back(at_.gradient[dof]);
    }
  }

  void find_density(TangentOperator& tangent) {
    StateView view = at_.at();
    view.has_contacts = false;
    tangent.linearise(problem_.assembler, view, 0.0);
    std::vector<double> sums(at_.displacement.size());
    tangent.absolute_row_sums(sums);
    if (problem_.assembler.has_contacts()) {
      row_sums_ = sums;
      add_contacts(sums);
    }
    for (std::size_t e = 0; e < dofs_.size(); ++e) {
      density_[e] = density_of(sums[dofs_[e]]);
      // A point without an unbroken bond stays where it is.
      inverse_density_[e] = density_[e] > 0.0 ? 1.0 / density_[e] : 0.0;
    }
  }

  /// Computes forces, residual and damage at the present displacement.
  void evaluate() {
    Assembler& assembler = problem_.assembler;
    add_work_on_followers();
    if (assembler.has_friction()) {
      const StateView start(start_, at_.history, Damage::held, start_environment_);
      static_cast<void>(assembler.lag_friction(at_.at(), start, at_.history));
    }
    const Evaluation found = find_forces();
    result_.growth += found.growth;
    result_.released_energy += found.released;
    // The work of forces on obstacles is what heating counts, which is of the whole energy, less
    // the change of their potential.
    const double potential = potential_under(at_.environment);
    if (has_potential_) add_work_of_body(potential_ - potential);
    has_potential_ = true;
    potential_ = potential;
    if (!at_.follower_force.empty()) {
      last_follower_force_.swap(at_.follower_force);
      at_.follower_force.resize(last_follower_force_.size());
      assembler.follower_force(at_.at(), at_.follower_force);
    }
    make_room_for_contacts();
    residual_.swap(last_residual_);
    const std::vector<double>& force = result_.external_force;
    fold_followers(problem_, force, at_);
    // [0] F.F, [1] U.K1 U, [2] U.U
    const FourSums sums = sum([&](std::size_t e, FourSums& s) {
      const double residual = force[dofs_[e]] - at_.gradient[dofs_[e]];
      residual_[e] = residual;
      s[0] += residual * residual;
      const double squared = at_.displacement[dofs_[e]] * at_.displacement[dofs_[e]];
      s[2] += squared;
      if (std::abs(velocity_[e]) <= standing * mean_speed_) return;
      s[1] -= squared * (residual - last_residual_[e]) * inverse_density_[e] / velocity_[e];
    });
    at_.residual_norm = std::sqrt(sums[0]);
    at_.degenerate = found.degenerate || !std::isfinite(sums[0]);
    quotient_ = sums[2] > 0.0 ? sums[1] / sums[2] : 0.0;
  }

  /// Computes V^(1/2), from rest.
  void set_off() {
    const FourSums sums = sum([&](std::size_t e, FourSums& s) {
      velocity_[e] = 0.5 * residual_[e] * inverse_density_[e];
      s[0] += 0.25 * residual_[e] * velocity_[e];
    });
    kinetic_energy_ = sums[0];
    result_.damped_energy += sums[0];
  }

  /// Computes V^(n+1/2) from V^(n-1/2).
  void accelerate() {
    const double c = damping_coefficient();
    const double keep = (2.0 - c) / (2.0 + c), gain = 2.0 / (2.0 + c);
    // [0] damping, [1] kinetic energy
    const FourSums sums = sum([&](std::size_t e, FourSums& s) {
      if (inverse_density_[e] == 0.0) return;
      const double before = velocity_[e];
      const double after = keep * before + gain * residual_[e] * inverse_density_[e];
      const double mean = 0.5 * (before + after);
      velocity_[e] = after;
      s[0] += c * density_[e] * mean * mean;
      s[1] += 0.5 * density_[e] * after * after;
    });
    if (options_.damping == Damping::kinetic && sums[1] < kinetic_energy_) {
      // The kinetic energy has passed its peak: the motion before this acceleration stops, and a
      // new one starts from rest.
      for (std::size_t e = 0; e < dofs_.size(); ++e) {
        velocity_[e] -= residual_[e] * inverse_density_[e];
      }
      result_.damped_energy += energy_of_motion();
      set_off();
      return;
    }
    result_.damped_energy += sums[0];
    kinetic_energy_ = sums[1];
  }

  /// Energy of the motion that has led here: 1/2 V.lambda V + 1/2 F.V at V^(n-1/2).
  double energy_of_motion() {
    return sum([&](std::size_t e, FourSums& s) {
      if (inverse_density_[e] == 0.0) return;
      s[0] += 0.5 * velocity_[e] * (velocity_[e] * density_[e] + residual_[e]);
    })[0];
  }

  /// Computes U^(n+1), with supports and loads at a fraction of their path. The work of the step is
  /// complete once `complete_work` is called after the next evaluation.
  void move(double share) {
    heat_up(share);
    if (!at_.follower_force.empty()) last_displacement_ = at_.displacement;
    const FourSums sums = sum([&](std::size_t e, FourSums& s) {
      double& displacement = at_.displacement[dofs_[e]];
      displacement += velocity_[e];
      s[0] += velocity_[e] * velocity_[e];
      s[1] += displacement * displacement;
    });
    mean_speed_ = std::sqrt(sums[0] / std::max(1.0, equations_));
    relative_change_ = sums[1] > 0.0 ? std::sqrt(sums[0] / sums[1]) : 1.0;
    add_half_work_of_loads();
    if (share != share_) {
      way_.load(share, result_.external_force);
      share_change_ = share - share_;
      share_ = share;
      for (const Index dof : way_.prescribed()) {
        at_.displacement[dof] = way_.displacement(dof, share);
      }
    } else {
      share_change_ = 0.0;
    }
    add_half_work_of_loads();
  }

  void complete_work() {
    of_body_.for_each_entry(at_.follower_force.size(), [&](std::size_t k) {
      result_.external_work += 0.5 * (last_follower_force_[k] + at_.follower_force[k]) *
                               (at_.displacement[k] - last_displacement_[k]);
    });
    if (last_environment_ != at_.environment) {
      add_work_of_body(0.5 * (at_.stored_energy + potential_ - energy_under(last_environment_)));
      last_environment_ = at_.environment;
    }
    for (std::size_t k = 0; k < held_.size(); ++k) {
      const Index dof = held_[k];
      const double now = at_.gradient[dof];
      if (share_change_ != 0.0) {
        const double moved =
            share_change_ * (way_.displacement(dof, 1.0) - way_.displacement(dof, 0.0));
        result_.external_work += 0.5 * (last_reaction_[k] + now) * moved;
      }
      last_reaction_[k] = now;
    }
  }

  [[nodiscard]] bool is_in_equilibrium() const {
    return at_.residual_norm <= options_.relative_tolerance * result_.scale;
  }
  [[nodiscard]] bool stands_still() const {
    return relative_change_ < options_.displacement_tolerance;
  }

  /// Computes the energy of the present state.
  void find_energy() {
    const Evaluation found = problem_.assembler.energy(at_.at());
    at_.stored_energy = found.energy;
    at_.energy_round_off = found.round_off;
    at_.degenerate |= found.degenerate;
  }

  /// Needs the energy, see find_energy.
  [[nodiscard]] IterationRecord record() const {
    IterationRecord row;
    row.iteration = result_.iterations;
    row.residual = at_.residual_norm;
    row.relative_residual = result_.scale > 0.0 ? at_.residual_norm / result_.scale : 0.0;
    row.energy =
        at_.stored_energy + potential_ - of_body_.dot(result_.external_force, at_.displacement);
    row.step_length = 1.0;
    row.changed_bonds = result_.growth.degrading;
    return row;
  }

 private:
  /// Computes the forces and, where bonds break on the way, the damage. Iterations read the energy
  /// only where it changes with the environment.
  Evaluation find_forces() {
    Assembler& assembler = problem_.assembler;
    const bool commits = options_.breaking == Breaking::transient;
    if (commits && !way_.end_environment()) {
      return assembler.commit_forces(at_.displacement, at_.history, at_.gradient, at_.environment);
    }
    const Evaluation found =
        commits ? assembler.commit(at_.displacement, at_.history, at_.gradient, at_.environment)
                : assembler.gradient(at_.at(), at_.gradient);
    at_.stored_energy = found.energy;
    at_.energy_round_off = found.round_off;
    return found;
  }

  [[nodiscard]] double density_of(double row_sum) const {
    return 0.25 * options_.mass_factor * row_sum;
  }

  /// Raises the densities of points whose contacts press, which are stiffer than the bonds.
  void make_room_for_contacts() {
    if (row_sums_.empty()) return;
    of_contacts_.assign(row_sums_.size(), 0.0);
    add_contact_stiffness(problem_, at_.at(), 1.0, of_contacts_);
    for (std::size_t e = 0; e < dofs_.size(); ++e) {
      const double of_contacts = of_contacts_[dofs_[e]];
      if (!(of_contacts > 0.0)) continue;
      const double density = density_of(row_sums_[dofs_[e]] + of_contacts);
      if (!(density > density_[e])) continue;
      density_[e] = density;
      inverse_density_[e] = 1.0 / density;
    }
  }

  /// Adds the stiffness of contacts that touch, or will where obstacles are in the end.
  void add_contacts(std::vector<double>& row_sums) {
    constexpr double usual_depth = 0.2;  // strains of a hundredth press as deep
    std::vector<double> here(row_sums.size(), 0.0), there(row_sums.size(), 0.0);
    StateView view = at_.at();
    add_contact_stiffness(problem_, view, usual_depth, here);
    view.environment = way_.end_environment();
    add_contact_stiffness(problem_, view, usual_depth, there);
    for (std::size_t k = 0; k < row_sums.size(); ++k) row_sums[k] += std::max(here[k], there[k]);
  }

  /// Moves the environment to a fraction of the path and adds half of its work; the other half is
  /// added in the next state.
  void heat_up(double share) {
    last_environment_ = at_.environment;
    if (share == share_ || !way_.end_environment()) return;
    at_.environment = way_.environment(share);
    add_work_of_body(0.5 * (energy_under(at_.environment) - at_.stored_energy - potential_));
  }

  /// Adds work that all ranks know, at rank 0 alone: contributions of the ranks are summed at the
  /// end.
  void add_work_of_body(double work) {
    if (problem_.assembler.index_map().is_first_rank()) result_.external_work += work;
  }

  [[nodiscard]] double potential_under(const SharedEnvironment& environment) const {
    return problem_.conditions.obstacles().potential(at_.displacement, environment);
  }

  [[nodiscard]] double energy_under(const SharedEnvironment& environment) {
    const Evaluation found =
        problem_.assembler.energy({at_.displacement, at_.history, Damage::grows, environment});
    return found.energy + potential_under(environment);
  }

  /// Sums over the equations of all ranks.
  template <class Body>
  FourSums sum(const Body& body) {
    FourSums total = sum_here(body);
    const std::vector<double> all =
        of_body_.of_all(std::vector<double>(total.begin(), total.end()));
    std::copy(all.begin(), all.end(), total.begin());
    return total;
  }

  template <class Body>
  FourSums sum_here(const Body& body) {
    constexpr std::size_t strip = 2048;  // the same on any number of threads, as are the sums
    const std::size_t count = dofs_.size();
    partial_.assign((count + strip - 1) / strip, FourSums{});
    run_on_threads(problem_.assembler.threads(), [&](int) {
#pragma omp for schedule(static) nowait
      for (std::size_t s = 0; s < partial_.size(); ++s) {
        FourSums own{};
        const std::size_t last = std::min(count, (s + 1) * strip);
        for (std::size_t e = s * strip; e < last; ++e) body(e, own);
        partial_[s] = own;
      }
    });
    FourSums total{};
    for (const FourSums& part : partial_) {
      for (std::size_t k = 0; k < total.size(); ++k) total[k] += part[k];
    }
    return total;
  }

  [[nodiscard]] double damping_coefficient() const {
    if (options_.damping == Damping::kinetic || !(quotient_ > 0.0)) return 0.0;
    const double c = 2.0 * std::sqrt(quotient_);
    return c > 2.0 ? largest_damping : c;
  }

  /// Moves degrees of freedom that follow others, and adds the work of their loads.
  void add_work_on_followers() {
    const std::vector<Index>& loaded = way_.loaded_followers();
    std::vector<double> before;
    for (const Index dof : loaded) before.push_back(at_.displacement[dof]);
    move_followers(problem_, at_);
    last_load_on_followers_.resize(loaded.size(), 0.0);
    for (std::size_t k = 0; k < loaded.size(); ++k) {
      const double load = result_.external_force[loaded[k]];
      result_.external_work +=
          0.5 * (last_load_on_followers_[k] + load) * (at_.displacement[loaded[k]] - before[k]);
      last_load_on_followers_[k] = load;
    }
  }

  void add_half_work_of_loads() {
    if (!way_.has_loads()) return;
    const std::vector<double>& force = result_.external_force;
    result_.external_work += 0.5 * sum_here([&](std::size_t e, FourSums& s) {
                               s[0] += force[dofs_[e]] * velocity_[e];
                             })[0];
  }

  const EquilibriumProblem& problem_;
  const Sums of_body_;
  const double equations_;  // of all ranks
  const WayOfLoad& way_;
  const RelaxationOptions& options_;
  const std::vector<Index>& dofs_;
  std::vector<double>& velocity_;  // V^(n-1/2), and after `accelerate` V^(n+1/2)
  RelaxationResult& result_;
  Trial& at_;
  const std::vector<double> start_;  // displacement; empty without friction
  const SharedEnvironment start_environment_;
  std::vector<FourSums> partial_;                  // per strip of equations
  std::vector<double> density_, inverse_density_;  // lambda and 1/lambda; 0 where nothing resists
  std::vector<double> row_sums_;                   // of the bonds; empty: there are no contacts
  std::vector<double> of_contacts_;  // row sums of contacts at the present displacement
  std::vector<double> residual_, last_residual_;  // F^n, F^(n-1)
  std::vector<Index> held_;                       // prescribed ones that count on this rank
  std::vector<double> last_reaction_;             // dE/dx there
  SharedEnvironment last_environment_;
  std::vector<double> last_follower_force_, last_displacement_;  // before the last move
  std::vector<double> last_load_on_followers_;
  double quotient_ = 0.0;  // U.K1 U / U.U
  double kinetic_energy_ = 0.0, relative_change_ = 1.0;
  double mean_speed_ = 0.0;  // root mean square of the velocities of the last move
  bool has_potential_ = false;
  double potential_ = 0.0;  // Obstacles::potential [J]
  double share_ = 0.0, share_change_ = 0.0;
};

}  // namespace

RelaxationResult relax(const EquilibriumProblem& problem, TangentOperator& tangent,
                       const State& from, const LoadPoint& to, const RelaxationOptions& options,
                       RelaxationMotion& motion, const RelaxationObserver& observer) {
  RelaxationResult result;
  result.state.displacement = from.displacement;
  result.state.history = from.history;
  result.state.environment = from.environment;
  result.external_force.resize(from.displacement.size());
  const WayOfLoad way(problem, from, to);
  way.load(0.0, result.external_force);
  evaluate(problem, result.external_force, result.state);
  result.scale = options.scale > 0.0 ? options.scale
                                     : relaxation_scale(problem, result.state, to, options.holds);

  const double taken_up_at_start = taken_up(problem, options.breaking, result.state);

  const Sums sums = problem.sums();
  const bool is_of_equations = motion.velocity.size() == std::size_t(problem.free.count());
  const bool goes_on = sums.largest_of_all(double(!is_of_equations)) == 0.0;
  if (!goes_on) motion.velocity.assign(std::size_t(problem.free.count()), 0.0);
  Relaxation relaxation(problem, way, options, motion.velocity, result);
  relaxation.find_density(tangent);
  relaxation.evaluate();
  if (!goes_on) relaxation.set_off();

  const int ramp = std::max(options.ramp, 1);
  const int last = options.holds ? ramp + options.max_iterations : ramp;
  const auto would_break = [&] { return problem.assembler.growth(result.state.at()).breaking; };
  Index breaking = 0;
  int quiet = 0;
  result.outcome = options.holds ? Outcome::iteration_limit : Outcome::converged;
  result.largest_residual = -1.0;
  for (int n = 1; n <= last; ++n) {
    relaxation.move(std::min(double(n) / ramp, 1.0));
    relaxation.evaluate();
    relaxation.complete_work();
    result.iterations = n;
    if (result.state.degenerate) {
      result.outcome = Outcome::degenerate;
      break;
    }
    ++quiet;
    if (options.breaking == Breaking::transient || n % iterations_per_look == 0) {
      const Index now =
          options.breaking == Breaking::transient ? result.growth.breaking : would_break();
      if (now != breaking) quiet = 0;
      breaking = now;
    }
    const bool balanced = relaxation.is_in_equilibrium();
    const bool still = balanced || relaxation.stands_still();
    if (n >= ramp && options.holds && still && quiet >= options.quiet_iterations) {
      result.outcome = Outcome::converged;
      if (balanced) result.largest_residual = options.relative_tolerance * result.scale;
      break;
    }
    if (n % iterations_per_record == 0 && observer) {
      relaxation.find_energy();
      if (observer(relaxation.record())) {
        result.outcome = Outcome::interrupted;
        break;
      }
    }
    if (n < last) relaxation.accelerate();
  }
  result.external_work = sums.of_all(result.external_work);
  relaxation.find_energy();
  Trial& state = result.state;
  state.total_energy = state.stored_energy - sums.dot(result.external_force, state.displacement);
  const double moving = relaxation.energy_of_motion();
  if (options.holds) {
    result.damped_energy += moving;
    motion.velocity.clear();
  } else {
    relaxation.accelerate();
  }
  result.drained_energy = result.external_work - result.released_energy -
                          (taken_up(problem, options.breaking, state) - taken_up_at_start);
  if (observer && !state.degenerate) static_cast<void>(observer(relaxation.record()));
  return result;
}

}  // namespace peristat
