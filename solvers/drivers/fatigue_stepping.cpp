#include "solvers/drivers/fatigue_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "assembly/terms/bonds/stretches_along.hpp"
#include "assembly/terms/damage.hpp"

namespace peristat {
namespace {

/// More cycles than these are never counted.
constexpr double most_cycles = 1e18;

/// Largest number of equilibria in which bonds break by their stretch within a block.
constexpr int most_equilibria = 100'000;

std::string cycles_text(double cycles) { return fmt::format("{:.9g} cycles", cycles); }

}  // namespace

Advance FatigueStepping::next() {
  if (path_.has_fallen()) return Advance::ended;
  const State& accepted = path_.state().accepted;
  if (path_.setting().conditions.programme().has_rest(accepted.stage)) return implicit_.advance();
  if (path_.state().fatigue.lives.life.empty()) begin_cycles();
  return has_made_cycles() || has_made_blocks() ? Advance::ended : take_block();
}

void FatigueStepping::begin_cycles() {
  const auto bonds = std::size_t(path_.damaged().model().bonds().count());
  path_.state().fatigue.lives = {std::vector<double>(bonds, 1.0), std::vector<char>(bonds, 0)};
  note_cracks(path_.state().accepted.history);
}

void FatigueStepping::note_cracks(const History& history) {
  if (!fatigue().growth.acts()) return;
  const Assembler& body = path_.damaged();
  const InitialCuts& cuts = path_.setting().cuts;
  std::vector<double> damage(std::size_t(body.points().count()));
  static_cast<void>(body.assess(history, cuts.weight, damage));
  peristat::note_cracks(body.model().bonds(), cuts.bonds, damage, fatigue().crack_damage,
                        broken_bonds(body.model(), history), path_.state().fatigue.lives);
}

bool FatigueStepping::has_made_cycles() const {
  return fatigue().cycles > 0.0 && path_.state().fatigue.cycles >= fatigue().cycles;
}

bool FatigueStepping::has_made_blocks() const {
  return fatigue().blocks > 0 && path_.state().fatigue.blocks >= fatigue().blocks;
}

std::vector<double> FatigueStepping::life_rates() const {
  const Assembler& body = path_.damaged();
  const Model& model = body.model();
  const State& accepted = path_.state().accepted;
  const std::vector<char>& near_crack = path_.state().fatigue.lives.near_crack;
  const std::vector<double> borne = borne_stretches(model, accepted.history);
  const std::vector<BondDrive> at = stretches_along(
      body.points(), model.bonds(), StateView(accepted, Damage::held), {}, body.threads());
  std::vector<double> rates(borne.size(), 0.0);
  for (std::size_t bond = 0; bond < rates.size(); ++bond) {
    if (!std::isfinite(borne[bond])) continue;  // broken, or never fails
    rates[bond] = fatigue().law(near_crack[bond]).rate(fatigue().range(at[bond].stretch));
  }
  return rates;
}

void FatigueStepping::age(const std::vector<double>& rates, double cycles) {
  std::vector<double>& life = path_.state().fatigue.lives.life;
  for (std::size_t bond = 0; bond < life.size(); ++bond) {
    if (rates[bond] > 0.0) life[bond] = std::max(0.0, life[bond] - rates[bond] * cycles);
  }
}

Advance FatigueStepping::take_block() {
  PathState::Fatigue& state = path_.state().fatigue;
  const std::vector<double> rates = life_rates();
  const double next = cycles_to_first(state.lives.life, rates);
  const double rest = fatigue().cycles > 0.0 ? fatigue().cycles - state.cycles : most_cycles;
  if (!(next <= rest)) {
    if (fatigue().cycles == 0.0) {
      return end("after " + cycles_text(state.cycles) + " no bond ages any more");
    }
    age(rates, rest);
    state.cycles = fatigue().cycles;
    return accept_unbroken("no bond reaches the end of its life");
  }
  PathState before = path_.state();
  age(rates, next);
  state.cycles += next;
  ++state.blocks;
  Block block = break_bonds(worn_bonds(state.lives.life, rates, fatigue().life_tolerance));
  return block.attempt.has_converged() ? accept(std::move(block))
                                       : fail(std::move(block), std::move(before));
}

NewtonOptions FatigueStepping::held() const {
  NewtonOptions options = path_.setting().newton_options;
  options.damage = Damage::held;
  return options;
}

State FatigueStepping::without(const std::vector<Offset>& worn, Block& block) {
  Assembler& body = path_.damaged();
  const State& accepted = path_.state().accepted;
  const Bonds& bonds = body.model().bonds();
  const StateView at(accepted, Damage::held);
  const std::vector<BondDrive> stretches =
      stretches_along(body.points(), bonds, at, {}, body.threads());
  std::vector<UtilisedBond> breaking;
  for (const Offset bond : worn) {
    path_.state().fatigue.lives.life[std::size_t(bond)] = 0.0;
    const auto above = std::upper_bound(bonds.offset.begin(), bonds.offset.end(), bond);
    const auto first = Index(above - bonds.offset.begin() - 1);
    breaking.push_back({bond, first, 0.0, stretches[std::size_t(bond)].stretch});
  }
  const std::vector<double> borne = borne_stretches(body.model(), accepted.history);
  const BondDrops dropped = drop(body, at, borne, breaking);
  block.worn = dropped.breaking;
  block.found.growth.degrading = block.found.growth.breaking = dropped.breaking;
  block.found.energies.released = dropped.energy_lost - dropped.dissipated;
  State left = accepted;
  left.history = body.history_of(dropped.histories, accepted.history);
  return left;
}

bool FatigueStepping::pin_loose(const State& at, Block& block) {
  FragmentPins& pins = path_.state().pins;
  const FragmentRemedy remedy = path_.options().fragments;
  pins.find(path_.body().assembler, at, path_.setting().conditions, remedy);
  if (!pins.are_outdated(path_.problem().sums())) return true;
  if (remedy == FragmentRemedy::stop && pins.found.count > 0) {
    block.fault = pins.described(path_.problem().sums());
    block.attempt = undefined_attempt(at, load_point(at));
    block.attempt.outcome = Outcome::fragmented;
    return false;
  }
  block.has_pinned = true;
  if (path_.pin() == Advance::goes_on) return true;
  block.attempt = undefined_attempt(at, load_point(at));
  block.attempt.outcome = Outcome::out_of_memory;
  return false;
}

FatigueStepping::Block FatigueStepping::break_bonds(const std::vector<Offset>& worn) {
  Block block;
  equilibrate(without(worn, block), block);
  if (!block.attempt.has_converged()) return block;
  block.found.record.mode = Mode::fatigue.name;
  block.found.record.newton_iterations = block.attempt.iterations;
  block.found.energies.is_avalanche = true;  // what the body releases is drained
  block.fault = complete(path_, block.attempt, block.found);
  block.has_failed = block.attempt.outcome == Outcome::limit_point;  // loads are lost: see complete
  return block;
}

void FatigueStepping::equilibrate(State from, Block& block) {
  Attempt& attempt = block.attempt;
  NewtonOptions options = held();
  int iterations = 0;
  for (int pass = 0; pin_loose(from, block); ++pass) {
    attempt = path_.search(from, load_point(from), options);
    attempt.iterations = iterations += attempt.iterations;
    if (!attempt.has_converged()) {
      const bool is_other =
          attempt.outcome == Outcome::interrupted || attempt.outcome == Outcome::out_of_memory;
      block.has_failed = block.overstretched > 0 && !is_other;
      return;
    }
    const Evaluation committed = path_.damaged().commit(
        attempt.state.displacement, attempt.state.history, {}, attempt.state.environment);
    attempt.state.stored_energy = committed.energy;
    attempt.state.energy_round_off = committed.round_off;
    block.found.growth += committed.growth;
    block.found.energies.released += committed.released;
    block.overstretched += committed.growth.breaking;
    if (committed.growth.degrading == 0) return;
    if (pass == most_equilibria) {
      attempt.outcome = Outcome::iteration_limit;
      return;
    }
    from = state_of(attempt);
    options.scale = attempt.scale;
  }
}

Advance FatigueStepping::accept(Block block) {
  std::string how = fmt::format("after {} {} at the end of their life",
                                cycles_text(path_.state().fatigue.cycles), bonds_text(block.worn));
  if (block.overstretched > 0) {
    how += fmt::format(", and {} broke by their stretch", bonds_text(block.overstretched));
  }
  path_.tell(
      block.attempt.at,
      {.outcome = name(Outcome::converged),
       .action = block.attempt.note.empty() ? Decision::accept : Decision::accept_at_round_off,
       .reason = std::move(how)});
  const bool has_pinned = block.has_pinned;
  note_cracks(block.attempt.state.history);
  const Advance advance =
      peristat::accept(path_, std::move(block.attempt), std::move(block.found), 0.0);
  if (has_pinned && advance == Advance::goes_on) tell_of_fragments(path_, 0.0);
  if (advance == Advance::goes_on && has_made_blocks() && !has_made_cycles()) {
    return end(fmt::format("the run ends with block {}, after {}", path_.state().fatigue.blocks,
                           cycles_text(path_.state().fatigue.cycles)));
  }
  return advance;
}

Advance FatigueStepping::accept_unbroken(const std::string& how) {
  const State accepted = path_.state().accepted;
  Block block;
  block.attempt = path_.search(accepted, load_point(accepted), held());
  if (block.attempt.has_converged()) {
    block.found.record.mode = Mode::fatigue.name;
    block.found.record.newton_iterations = block.attempt.iterations;
    block.fault = complete(path_, block.attempt, block.found);
  }
  if (!block.attempt.has_converged()) {
    const std::string reason = reason_of(block.attempt, block.fault);
    return path_.stop(std::move(block.attempt), 0.0, reason);
  }
  path_.tell(block.attempt.at,
             {.outcome = name(Outcome::converged),
              .action = Decision::accept,
              .reason = "after " + cycles_text(path_.state().fatigue.cycles) + ": " + how});
  return peristat::accept(path_, std::move(block.attempt), std::move(block.found), 0.0);
}

Advance FatigueStepping::fail(Block block, PathState before) {
  PathState& state = path_.state();
  PathState::Fatigue aged = std::move(state.fatigue);
  const bool has_other_pins = state.pins.pinned != before.pins.pinned;
  const std::string when = "after " + cycles_text(aged.cycles);
  const std::string reason = reason_of(block.attempt, block.fault);
  state = std::move(before);
  if (has_other_pins && path_.pin_as_before(state.pins) != Advance::goes_on) {
    return Advance::ended;
  }
  if (!block.has_failed) {
    return path_.stop(std::move(block.attempt), 0.0, when + ": " + reason);
  }
  const std::string why = fmt::format(
      "final failure {}: the body does not bear the largest load of a cycle once {} have broken "
      "({})",
      when, bonds_text(block.worn + block.overstretched), reason);
  // A resumed run comes here again, without further cycles.
  const bool has_aged = aged.cycles > state.fatigue.cycles;
  if (has_aged) {
    state.fatigue = std::move(aged);
    if (accept_unbroken("the state before the final failure") == Advance::ended) {
      return Advance::ended;
    }
  }
  return end(why);
}

Advance FatigueStepping::end(const std::string& why) {
  Attempt attempt;
  attempt.at = load_point(path_.state().accepted);
  return path_.stop(std::move(attempt), 0.0, why);
}

}  // namespace peristat
