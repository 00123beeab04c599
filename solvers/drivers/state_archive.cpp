#include "solvers/drivers/state_archive.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

namespace peristat {
namespace {

void transfer_optional(StateArchive& archive, const std::string& name,
                       std::optional<double>& value) {
  bool is_there = value.has_value();
  double held = value.value_or(0.0);
  archive.transfer(name + "_is_there", is_there);
  archive.transfer(name, held);
  value = is_there ? std::optional(held) : std::nullopt;
}

std::vector<double> numbers_of(const Slips& slips) {
  std::vector<double> numbers;
  for (const Slip& slip : slips) {
    numbers.insert(numbers.end(), {double(slip.contact), slip.normal_force, slip.friction,
                                   slip.stiffness, double(slip.point)});
    for (const Coordinates& vector : {slip.normal, slip.elastic, slip.start}) {
      numbers.insert(numbers.end(), vector.begin(), vector.end());
    }
    numbers.push_back(double(slip.partners.size()));
    for (const auto& [point, share] : slip.partners) {
      numbers.insert(numbers.end(), {double(point), share});
    }
  }
  return numbers;
}

Slips slips_of(std::span<const double> numbers) {
  Slips slips;
  auto next = numbers.begin();
  const auto take_vector = [&](Coordinates& vector) {
    for (double& component : vector) component = *next++;
  };
  while (next != numbers.end()) {
    Slip slip;
    slip.contact = std::size_t(*next++);
    slip.normal_force = *next++;
    slip.friction = *next++;
    slip.stiffness = *next++;
    slip.point = Index(*next++);
    take_vector(slip.normal);
    take_vector(slip.elastic);
    take_vector(slip.start);
    slip.partners.resize(std::size_t(*next++));
    for (auto& [point, share] : slip.partners) {
      point = Index(*next++);
      share = *next++;
    }
    slips.push_back(std::move(slip));
  }
  return slips;
}

void transfer_contacts(StateArchive& archive, const std::string& name, History& history) {
  for (const Rub rub : all_rubs) {
    std::vector<double> numbers = numbers_of(history.slips(rub));
    archive.transfer(name + "/slips_" + std::to_string(int(rub)), numbers, Rows::whole);
    if (!numbers.empty()) history.replace_slips(slips_of(numbers), rub);
  }
  std::vector<double> torn(history.torn_facets().begin(), history.torn_facets().end());
  archive.transfer(name + "/torn_facets", torn, Rows::whole);
  if (!torn.empty()) history.replace_torn_facets({torn.begin(), torn.end()});
}

void transfer_history(StateArchive& archive, const std::string& name, History& history) {
  int terms = static_cast<int>(history.terms());
  archive.transfer(name + "/terms", terms);
  for (int k = 0; k < terms; ++k) {
    const auto term = static_cast<std::size_t>(k);
    std::vector<double> values(history.of(term).begin(), history.of(term).end());
    archive.transfer(name + "/history_" + std::to_string(k), values, Rows::histories);
    history.replace(term, std::move(values));
  }
  transfer_contacts(archive, name, history);
}

void transfer_ledger(StateArchive& archive, PathLedger& ledger) {
  auto& [entries, released, struts, force] = ledger;
  auto& [stored, dissipated, drained, external_work, numerical_work, kinetic] = entries;
  archive.transfer("ledger/stored", stored);
  archive.transfer("ledger/dissipated", dissipated);
  archive.transfer("ledger/drained", drained);
  archive.transfer("ledger/external_work", external_work);
  archive.transfer("ledger/numerical_work", numerical_work);
  archive.transfer("ledger/kinetic", kinetic);
  archive.transfer("ledger/released", released);
  archive.transfer("ledger/struts", struts);
  archive.transfer("ledger/force", force, Rows::dofs);
}

void transfer_pins(StateArchive& archive, FragmentPins& pins) {
  auto& [found, pinned] = pins;
  auto& [piece, count, loose, found_pinned] = found;
  archive.transfer("pins/found/piece", piece, Rows::points);
  archive.transfer("pins/found/count", count);
  archive.transfer("pins/found/loose", loose, Rows::list_of_points);
  archive.transfer("pins/found/pinned", found_pinned, Rows::dofs);
  archive.transfer("pins/pinned", pinned, Rows::dofs);
}

/// Transfers their bits, two in the place of one number in double precision.
void transfer_floats(StateArchive& archive, const std::string& name, std::vector<float>& values) {
  static_assert(sizeof(double) == 2 * sizeof(float));
  std::int64_t size = std::int64_t(values.size());
  std::vector<double> pairs((values.size() + 1) / 2, 0.0);
  std::memcpy(pairs.data(), values.data(), values.size() * sizeof(float));
  archive.transfer(name + "_size", size);
  archive.transfer(name, pairs, Rows::whole);
  values.resize(std::min(std::size_t(size), 2 * pairs.size()));
  std::memcpy(values.data(), pairs.data(), values.size() * sizeof(float));
}

void transfer_known(StateArchive& archive, const std::string& name, KnownCorrections& known) {
  std::vector<KnownCorrections::Known> all = known.take_all();
  int count = int(all.size());
  archive.transfer(name + "/count", count);
  all.resize(std::size_t(count));
  for (std::size_t k = 0; k < all.size(); ++k) {
    transfer_floats(archive, name + "/correction_" + std::to_string(k), all[k].correction);
    transfer_floats(archive, name + "/change_" + std::to_string(k), all[k].change);
  }
  known.restore(std::move(all));
}

void transfer_tangent(StateArchive& archive, TangentReference& tangent) {
  auto& [at, lost, known] = tangent;
  [[maybe_unused]] auto& [displacement, stage, history, load, environment, preload] = at;
  const std::string name = "events/tangent";
  archive.transfer(name + "/displacement", displacement, Rows::dofs);
  archive.transfer(name + "/stage", stage);
  transfer_optional(archive, name + "/load", load);
  transfer_history(archive, name, history);
  std::vector<double> bond, direction, stiffness;
  std::vector<Index> first, second;
  for (const LostStiffness& one : lost) {
    bond.push_back(double(one.bond));
    first.push_back(one.first);
    second.push_back(one.second);
    direction.insert(direction.end(), one.direction.begin(), one.direction.end());
    stiffness.push_back(one.stiffness);
  }
  archive.transfer(name + "/bond", bond, Rows::whole);
  archive.transfer(name + "/first", first, Rows::whole);
  archive.transfer(name + "/second", second, Rows::whole);
  archive.transfer(name + "/direction", direction, Rows::whole);
  archive.transfer(name + "/stiffness", stiffness, Rows::whole);
  lost.clear();
  for (std::size_t k = 0; k < bond.size(); ++k) {
    const double* const along = &direction[3 * k];
    lost.push_back(
        {Offset(bond[k]), first[k], second[k], {along[0], along[1], along[2]}, stiffness[k]});
  }
  transfer_known(archive, name + "/known", known);
}

}  // namespace

// The bindings name every member, so that none can be forgotten.
void transfer(StateArchive& archive, PathState& state) {
  auto& [accepted, steps, ledger, pins, force, stands_in, rungs, relaxation_seconds, implicit,
         relaxed, control_sign, control_at_load_zero, arc, hand_over, events, dynamics, fatigue] =
      state;
  // The environment is recomputed from the load point, see Path.
  [[maybe_unused]] auto& [displacement, stage, history, load, environment, preload] = accepted;
  archive.transfer("accepted/displacement", displacement, Rows::dofs);
  archive.transfer("accepted/stage", stage);
  transfer_optional(archive, "accepted/load", load);
  archive.transfer("accepted/preload", preload);
  transfer_history(archive, "accepted", history);
  archive.transfer("steps", steps);
  transfer_ledger(archive, ledger);
  transfer_pins(archive, pins);
  auto& [present_force, largest_force, top_stage] = force;
  archive.transfer("force/present", present_force);
  archive.transfer("force/largest", largest_force);
  archive.transfer("force/top", top_stage);
  archive.transfer("stands_in", stands_in);
  auto& [body_rung, stand_in_rung] = rungs;
  archive.transfer("rungs/body", body_rung);
  archive.transfer("rungs/stand_in", stand_in_rung);
  archive.transfer("relaxation_seconds", relaxation_seconds);
  auto& [implicit_increment] = implicit;
  archive.transfer("implicit/increment", implicit_increment);
  auto& [relaxed_increment, motion] = relaxed;
  auto& [velocity] = motion;
  archive.transfer("relaxed/increment", relaxed_increment);
  archive.number_free_dofs(pins);
  archive.transfer("relaxed/velocity", velocity, Rows::free_dofs);
  archive.transfer("control_sign", control_sign);
  archive.transfer("control_at_load_zero", control_at_load_zero);
  auto& [arc_increment, direction, stage_direction, displacement_scale, negative_pivots,
         passes_critical_point] = arc;
  archive.transfer("arc/increment", arc_increment);
  archive.transfer("arc/direction", direction, Rows::dofs);
  archive.transfer("arc/stage_direction", stage_direction);
  archive.transfer("arc/displacement_scale", displacement_scale);
  archive.transfer("arc/negative_pivots", negative_pivots);
  archive.transfer("arc/passes_critical_point", passes_critical_point);
  auto& [relaxes, is_near_onset, force_falls, peak_before] = hand_over;
  archive.transfer("hand_over/relaxes", relaxes);
  archive.transfer("hand_over/is_near_onset", is_near_onset);
  archive.transfer("hand_over/force_falls", force_falls);
  archive.transfer("hand_over/peak_before", peak_before);
  auto& [at_strength, top, longest, largest_scale, broke_at, batch_work, released, response_energy,
         response_drained, count, tangent] = events;
  archive.transfer("events/at_strength", at_strength);
  archive.transfer("events/top", top);
  archive.transfer("events/longest", longest);
  archive.transfer("events/largest_scale", largest_scale);
  archive.transfer("events/broke_at", broke_at);
  archive.transfer("events/batch_work", batch_work);
  archive.transfer("events/released", released);
  archive.transfer("events/response_energy", response_energy);
  archive.transfer("events/response_drained", response_drained);
  archive.transfer("events/count", count);
  transfer_tangent(archive, tangent);
  auto& [has_begun, time_velocity, acceleration, time_step, correction_at_start, correction,
         largest_energy, stiffness, last_bound, look_interval, next_look] = dynamics;
  auto& [bound, eigenvalue] = stiffness;
  archive.transfer("dynamics/has_begun", has_begun);
  archive.transfer("dynamics/velocity", time_velocity, Rows::dofs);
  archive.transfer("dynamics/acceleration", acceleration, Rows::dofs);
  archive.transfer("dynamics/step", time_step);
  archive.transfer("dynamics/correction_at_start", correction_at_start);
  archive.transfer("dynamics/correction", correction);
  archive.transfer("dynamics/largest_energy", largest_energy);
  archive.transfer("dynamics/last_bound", last_bound);
  archive.transfer("dynamics/look_interval", look_interval);
  archive.transfer("dynamics/next_look", next_look);
  archive.transfer("dynamics/stiffness/bound", bound);
  archive.transfer("dynamics/stiffness/eigenvalue", eigenvalue);
  auto& [cycles, blocks, lives] = fatigue;
  auto& [life, near_crack] = lives;
  archive.transfer("fatigue/cycles", cycles);
  archive.transfer("fatigue/blocks", blocks);
  archive.transfer("fatigue/life", life, Rows::bonds);
  archive.transfer("fatigue/near_crack", near_crack, Rows::bonds);
}

}  // namespace peristat
