#include "cases/runner/input/loading_keys.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "cases/runner/input/key_kinds.hpp"
#include "src/conditions/loading_programme.hpp"
#include "src/core/expression.hpp"

namespace peristat {
namespace {

/// "table", "table2", …
std::string load_table_key(std::size_t k) {
  std::string key = "table";
  if (k > 0) key += std::to_string(k + 1);
  return key;
}

/// Entries of a table that is an expression: one for each step, and 0 before the first.
std::vector<double> entries_of(const Entry& at, const std::string& expression, int steps) {
  try {
    const Expression of_step(expression, 0, 0.0, {"step"}, at.so_far.columns,
                             at.so_far.givens->functions);
    std::vector<double> entries;
    for (int step = 0; step <= steps; ++step) {
      const std::array<double, 1> value{double(step)};
      entries.push_back(of_step({}, value));
    }
    return entries;
  } catch (const InputError& error) {
    at.refuse(error.allowed());
  }
}

/// Refuses tables over time that are none, whatever the end of the motion.
void check_tables_over_time(const Entry& at, const std::vector<LoadTable>& tables) {
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const Entry table{at.from, load_table_key(k), at.so_far};
    if (tables[k].over_time.empty())
      table.refuse("is missing, but a table with a higher number is given");
    try {
      const double end = std::max(1e-30, tables[k].over_time.back()[0]);
      static_cast<void>(LoadingProgramme::of_time(end, {tables[k].over_time}));
    } catch (const InputError& error) {
      table.refuse(error.allowed());
    }
  }
}

/// Finds the entries of all tables, and refuses tables that don't go together.
void resolve_tables(const Entry& at, LoadingSpecification& loading) {
  auto& tables = loading.tables;
  if (tables.empty()) return;
  if (at.so_far.dynamics.is_asked_for) return check_tables_over_time(at, tables);
  if (tables.front().entries.empty() && tables.front().expression.empty()) {
    tables.front().entries = {0.0, 1.0};
  }
  std::vector<std::vector<double>> entries;
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const Entry table{at.from, load_table_key(k), at.so_far};
    if (!tables[k].expression.empty()) {
      tables[k].entries = entries_of(table, tables[k].expression, loading.steps);
    }
    if (tables[k].entries.empty())
      table.refuse("is missing, but a table with a higher number is given");
    entries.push_back(tables[k].entries);
    try {
      static_cast<void>(LoadingProgramme(entries));
    } catch (const InputError& error) {
      table.refuse(error.allowed());
    }
  }
}

}  // namespace

Table<LoadingSpecification> loading_keys() {
  using Spec = LoadingSpecification;
  using K = Key<Spec>;
  constexpr const char* for_steps =
      "is not allowed with solver.mode = \"dynamics\", where [loading] has only tables over time";
  const auto moves = [](auto&, auto& from) { return from.dynamics.is_asked_for; };
  Table<Spec> keys{"loading",
                   {K("steps", &Spec::steps, integer(1, 1'000'000),
                      "number of equal steps from one entry of the tables to the next, or of a "
                      "table that is an expression; without a table from 0 to 1")
                        .unless(moves, for_steps)
                        .extends()
                        .on_ranks()}};
  for (std::size_t k = 0; k < LoadingProgramme::most_parameters; ++k) {
    const std::string parameter = LoadingProgramme::names(k + 1).back();
    const auto member = [k](auto& loading) -> auto& {
      if constexpr (!std::is_const_v<std::remove_reference_t<decltype(loading)>>) {
        if (loading.tables.size() <= k) loading.tables.resize(k + 1);
        return loading.tables[k];
      } else {
        static const LoadTable none;
        return loading.tables.size() > k ? loading.tables[k] : none;
      }
    };
    K key(load_table_key(k), member, load_table(),
          k == 0
              ? "values of `load` along the path, linear from one to the next. They may rise, fall "
                "and stay constant. With `[[control]]`: values of the controlled displacement in "
                "m. In mode `dynamics`: pairs of a time in s and the value of `load` at it"
              : "likewise for a further load parameter, `" + parameter + "`");
    key.written_if([k](auto& loading, auto&) { return loading.tables.size() > k; })
        .default_words(k == 0 ? "`[0, 1]`; required with `[[control]]`" : "no `" + parameter + "`")
        .extends();
    if (k < 2) key.on_ranks();  // as many as tests give there
    if (k + 1 == LoadingProgramme::most_parameters) key.then(resolve_tables);
    keys.add(key);
  }
  const auto follows_events = [](auto&, auto& from) { return from.solver.mode == Mode::path; };
  const auto takes_steps = [](auto&, auto& from) { return from.solver.mode != Mode::path; };
  for (K key :
       {K("adaptive", &Spec::adaptive, boolean(),
          "whether a step that does not converge is cut; steps then grow again. Otherwise such a "
          "step ends the run")
            .extends()
            .on_ranks(),
        K("smallest_step", &Spec::smallest_step, between(1e-12, 1.0),
          "smallest step of the stage (the load factor, without a table). The run ends when it "
          "needs a smaller one")
            .extends()
            .moreover("at most the first step")
            .on_ranks(),
        K("largest_step", &Spec::largest_step, between(1e-12, 1.0),
          "largest step of the stage, to which steps may grow")
            .extends()
            .otherwise(
                [](auto&loading, auto&) { loading.largest_step = 1.0 / loading.steps_to_entry(); },
                "the first step")
            .written_if([](auto&, auto&from) {
              return from.solver.mode != Mode::arc_length && from.solver.mode != Mode::path;
            })
            .then([](auto&at, auto&loading) {
              const double step = 1.0 / loading.steps_to_entry();
              if (loading.smallest_step > step)
                at.from.refuse("smallest_step",
                               "must not be larger than the first step, 1 / steps");
              if (loading.largest_step < step)
                at.refuse("must not be smaller than the first step, 1 / steps");
            })
            .moreover("at least the first step")
            .on_ranks(),
        K("max_broken_bonds", &Spec::max_broken_bonds, count_from(0, "bonds"),
          "mode `newton`: largest number of bonds that may break in one step. A step with more is "
          "cut. 0: no limit")
            .written_if(takes_steps)
            .extends()
            .on_ranks(),
        K("stop_below", &Spec::stop_below, between(0.0, 1.0),
          "the run is complete when the largest support reaction falls below this share of its "
          "maximum so far, as when a specimen tears. 0: only the end of the load ends the run")
            .extends()
            .on_ranks(),
        K("event_tolerance", in(&Spec::events, &EventOptions::tolerance), between(0.0, 0.5),
          "mode `path`: bonds whose utilisation is within this share of the largest one break "
          "together with it. 0: only bonds with equal utilisation")
            .written_if(follows_events),
        K("teeth", &Spec::teeth, integer(1, 1000),
          "mode `path`: largest number of teeth of the saw-tooth law that replaces a law of damage "
          "with smooth softening")
            .written_if(follows_events)}) {
    key.unless(moves, for_steps);
    keys.add(key);
  }
  return keys;
}

// ---- Motion in time

namespace {

constexpr const char *newmark_name = "newmark", *equilibrium_name = "equilibrium";

}  // namespace

Table<InitialSpecification> initial_keys() {
  using Spec = InitialSpecification;
  using K = Key<Spec>;
  return {"initial",
          {K("set", &Spec::set, known_set(), "set of points that begin with these values")
               .written_if([](auto& initial, auto&) { return !initial.set.empty(); })
               .default_words("all points"),
           K("displacement", &Spec::displacement, components_of_place("m"),
             "displacement at time 0, per component. Where a support prescribes another value, "
             "that value is used"),
           K("velocity", &Spec::velocity, components_of_place("m/s"),
             "velocity at time 0, per component, where no support prescribes the displacement")}};
}

Table<AbsorbingSpecification> absorbing_keys() {
  using Spec = AbsorbingSpecification;
  using K = Key<Spec>;
  return {"absorbing",
          {K("set", &Spec::set, known_set(), "set of points that absorb")
               .written_if([](auto& absorbing, auto&) { return !absorbing.set.empty(); })
               .default_words("all points"),
           K("rate", &Spec::rate, field_of_place("1/s"),
             "rate at which velocities decay, in addition to the effect of forces")
               .required()}};
}

void ask_for_dynamics(const Entry& at, Case& result) {
  if (!at.from.has("solver")) return;
  const TomlTable solver = at.from.table("solver");
  result.dynamics.is_asked_for = solver.has("mode") && solver.is_string("mode") &&
                                 solver.string("mode") == Mode::dynamics.name;
  if (!at.from.has("dynamics")) return;
  const TomlTable dynamics = at.from.table("dynamics");
  if (dynamics.has("scheme") && dynamics.is_string("scheme") &&
      dynamics.string("scheme") == newmark_name) {
    result.dynamics.scheme = MotionScheme::newmark;
  }
  if (dynamics.has("start") && dynamics.is_string("start") &&
      dynamics.string("start") == equilibrium_name) {
    result.dynamics.start = MotionStart::equilibrium;
  }
}

Table<DynamicsSpecification> dynamics_keys() {
  using Spec = DynamicsSpecification;
  using K = Key<Spec>;
  const auto is_given = [](auto& dynamics, auto&) { return dynamics.time_step > 0.0; };
  const auto is_implicit = [](auto& dynamics, auto&) { return dynamics.is_implicit(); };
  const auto has_no_share = [](auto& dynamics, auto&) {
    return dynamics.time_step > 0.0 || dynamics.is_implicit();
  };
  return {
      "dynamics",
      {K("end_time", &Spec::end_time, positive("s"),
         "time up to which the motion is followed, from 0")
           .required()
           .extends()
           .then([](auto& at, auto& dynamics) {
             for (const LoadTable& table : at.so_far.loading.tables) {
               try {
                 static_cast<void>(LoadingProgramme::of_time(dynamics.end_time, {table.over_time}));
               } catch (const InputError& error) {
                 at.refuse("a loading.table, whose last time is " + error.value() + " s, " +
                           error.allowed());
               }
             }
           }),
       K("scheme", &Spec::scheme,
         choice<MotionScheme>(
             {{"verlet", MotionScheme::verlet}, {newmark_name, MotionScheme::newmark}}),
         "`\"verlet\"`: explicit steps; `\"newmark\"`: implicit steps, each of which finds an "
         "equilibrium with inertia by Newton's method, for motions that are slow compared with the "
         "stable step")
           .early(),
       K("start", &Spec::start,
         choice<MotionStart>(
             {{"rest", MotionStart::rest}, {equilibrium_name, MotionStart::equilibrium}}),
         "`\"rest\"`: undeformed, except for initial displacements; `\"equilibrium\"`: in "
         "equilibrium with supports and loads at t = 0, which Newton's method finds; it must not "
         "damage anything")
           .early(),
       K("spectral_radius", &Spec::spectral_radius, between(0.0, 1.0),
         "implicit steps: factor by which a step multiplies the highest frequencies. 1: average "
         "acceleration, which conserves the energy; below 1: the generalised alpha method, which "
         "damps frequencies that the steps do not resolve")
           .written_if(is_implicit),
       K("time_step", &Spec::time_step, positive("s"),
         "constant time step. Explicit: the run ends if it is longer than the stable step. "
         "Implicit: a step that does not converge is halved, down to a thousandth. The last step "
         "is shorter if necessary")
           .written_if(is_given)
           .early()
           .moreover("explicit: at most the stable step")
           .default_words("a share of the stable step"),
       K("step_share", &Spec::step_share, between(1e-6, 0.99),
         "time step as a share of the stable one, which is updated as the stiffness changes")
           .unless(has_no_share, "is for explicit steps without a time_step; give time_step alone"),
       K("history_every", &Spec::history_every, count_from(1, "time steps"),
         "number of steps from one row of the history to the next")
           .written_if([](auto& dynamics, auto&) { return dynamics.history_every > 0; })
           .default_words("`output.every`")}};
}

void check_dynamics(const Entry& at, const Case& result) {
  const auto refuse = [&](const std::string& key, const std::string& why) {
    if (at.from.has(key)) at.from.refuse(key, why);
  };
  if (!result.dynamics.is_asked_for) {
    refuse("dynamics", "is for solver.mode = \"dynamics\"");
    refuse("initial", "is for solver.mode = \"dynamics\"");
    refuse("absorbing", "is for solver.mode = \"dynamics\"");
    return;
  }
  refuse("crack_tip",
         "is not allowed with solver.mode = \"dynamics\", because its integrals leave out the "
         "inertia");
  for (const char* key : {"control", "relaxation", "arc_length"}) {
    refuse(key,
           "is not allowed with solver.mode = \"dynamics\", whose supports and loads depend on the "
           "time t; give their values as expressions of t");
  }
  const TomlTable solver = at.from.table("solver");
  for (const char* key : {"fragments", "elastic_horizon_ratio"}) {
    if (solver.has(key)) solver.refuse(key, "has no effect in mode dynamics");
  }
  if (result.dynamics.is_implicit()) {
    const TomlTable dynamics = at.from.table("dynamics");
    if (!dynamics.has("time_step")) {
      dynamics.refuse("scheme",
                      "needs a time_step: implicit steps have no stable step to take a share of");
    }
    return;
  }
  if (at.from.has("dynamics") && at.from.table("dynamics").has("spectral_radius"))
    at.from.table("dynamics").refuse("spectral_radius", "is for scheme = \"newmark\"");
  if (result.dynamics.searches()) return;
  for (const char* key : {"linear", "preconditioner", "tangent", "predictor", "projection",
                          "relative_tolerance", "linear_tolerance", "max_iterations"}) {
    if (solver.has(key)) {
      solver.refuse(key,
                    "has no effect on explicit time steps, which do not search for an equilibrium; "
                    "it is for dynamics.scheme = \"newmark\" or dynamics.start = \"equilibrium\"");
    }
  }
}

}  // namespace peristat
