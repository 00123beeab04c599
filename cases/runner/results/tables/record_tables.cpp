#include "cases/runner/results/tables/record_tables.hpp"

#include <cmath>
#include <concepts>
#include <set>
#include <stdexcept>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

constexpr auto integer = Column::Kind::integer;
constexpr auto number = Column::Kind::number;
constexpr const char* axes[] = {"x", "y", "z"};

Row checked(const std::vector<Column>& columns, Row row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const double* value = std::get_if<double>(&row[i]);
    if (value && !std::isfinite(*value)) {
      throw std::logic_error("results: " + columns.at(i).name + " is " + number_text(*value));
    }
  }
  return row;
}

/// The cells of a row, one after the other.
class Cells {
 public:
  explicit Cells(const Row& row) : row_(row) {}

  Cells& operator>>(double& value) {
    value = std::get<double>(row_.at(next_++));
    return *this;
  }
  Cells& operator>>(std::string& words) {
    words = std::get<std::string>(row_.at(next_++));
    return *this;
  }
  template <std::integral Integer>
  Cells& operator>>(Integer& value) {
    value = static_cast<Integer>(std::get<std::int64_t>(row_.at(next_++)));
    return *this;
  }

 private:
  const Row& row_;
  std::size_t next_ = 0;
};

/// The fixed columns of the history; reactions and probes follow.
const std::vector<Column>& step_columns() {
  static const std::vector<Column> columns{
      {integer, "step", "1", "number of the accepted step"},
      {number, "load_factor", "1", "load factor of the step"},
      {Column::Kind::text, "mode", "none",
       "how equilibrium was found: newton, relaxation, arc_length or path; dynamics"},
      {integer, "newton_iterations", "1", "Newton iterations of the step"},
      {integer, "relaxation_iterations", "1",
       "iterations of relaxation of the step; for a flow, its solves"},
      {number, "stored_energy", "J", "energy stored in the interactions"},
      {number, "dissipated_energy", "J", "energy dissipated by damage since the start"},
      {number, "drained_energy", "J",
       "work that relaxation has removed by damping and by stopping motion"},
      {number, "external_work", "J",
       "work of supports and loads since the start, over the accepted steps: int P du"},
      {number, "balance_error", "J",
       "external + numerical work - stored - dissipated - drained energy"},
      {integer, "broken_bonds", "1", "number of broken bonds"},
      {number, "max_damage", "1", "largest damage of a point, 0 intact to 1"},
      {number, "max_stretch", "1",
       "largest stretch of an unbroken bond: current / reference length - 1"},
  };
  return columns;
}

/// Columns behind reactions and probes: scripts rely on the places of the others.
const std::vector<Column>& later_step_columns() {
  static const std::vector<Column> columns{
      {number, "numerical_work", "J",
       "work of relaxation since the start in addition to the external work: against its pseudo "
       "inertia, and on the path between two accepted steps"},
      {number, "pin_force", "N",
       "2-norm of the forces that hold pinned fragments; reactions do not include them"},
      {integer, "settled", "1",
       "1: the state was not required to be in equilibrium (moving load, displacement tolerance)"},
      {number, "stage", "1",
       "stage of the loading programme: number of entries of its tables that have been passed"},
      {number, "control", "m", "controlled displacement; 0 without a control"},
      {integer, "negative_pivots", "1",
       "control, arc_length: negative pivots of the tangent, 0 where the state is stable under "
       "fixed loads; -1: not counted"},
      {integer, "on_response", "1",
       "path: 1 where the state is reached under the given loads, 0 where they would have to be "
       "reduced"},
      {number, "released_energy", "J",
       "path: energy that has been released since the start under the given loads"},
      {integer, "stability", "1",
       "path: 1 stable, -1 unstable (breaking continues at the same load), -2 bifurcated (the "
       "tangent has negative pivots); other modes: 0, not judged"},
      {number, "strut_energy", "J",
       "energy that struts stored when they were cut, since the start: part of the dissipated "
       "energy"},
  };
  return columns;
}

}  // namespace

std::vector<Column> iteration_columns() {
  return {
      {integer, "step", "1", "number that the step has, or would have had"},
      {integer, "iteration", "1",
       "0 is the state right after the step's jump of supports and loads"},
      {number, "residual", "N", "2-norm of the residual over the free degrees of freedom"},
      {number, "relative_residual", "1", "residual over the norm that the tolerance refers to"},
      {number, "energy", "J", "stored energy minus work of the current dead loads"},
      {number, "step_length", "1", "step length of the line search"},
      {integer, "linear_iterations", "1", "iterations of the linear solver, 0 for a direct solve"},
      {integer, "changed_bonds", "1",
       "relaxation: bonds damaged since it began, each counted as often as it was damaged"},
      {number, "projection", "1",
       "share by which the tangent's interactions were projected to their positive semidefinite "
       "part; 0 is the exact tangent"},
      {integer, "negative_pivots", "1", "negative pivots of the exact tangent; -1: not counted"},
      {integer, "rejected_trials", "1", "line search: trial states whose energy was too high"},
      {integer, "degenerate_trials", "1", "line search: trial states without a gradient"},
      {number, "linear_tolerance", "1",
       "relative residual that the linear iterations had to reach, 0 for a direct solve"}};
}

std::vector<Column> decision_columns() {
  return {{integer, "step", "1", "number that the step has, or would have had"},
          {number, "load_factor", "1", "load factor that was attempted"},
          {number, "increment", "1", "increment of the stage that was attempted"},
          {Column::Kind::text, "outcome", "none", "outcome of the search for equilibrium"},
          {Column::Kind::text, "action", "none", "what load stepping did next"},
          {number, "next_increment", "1", "increment of the stage of the next attempt"},
          {Column::Kind::text, "reason", "none", "reason, as a sentence"},
          {number, "stage", "1", "stage of the loading programme that was attempted"}};
}

std::vector<Column> history_columns(const std::vector<std::string>& support_sets,
                                    const std::vector<ProbeColumns>& probes) {
  std::vector<Column> columns = step_columns();
  for (const std::string& set : support_sets) {
    for (const char* axis : axes) {
      columns.push_back(
          {number, std::string("reaction_") + axis + ":" + set, "N",
           std::string("force of the support on set ") + set + ", " + axis + " component"});
    }
  }
  std::set<std::string> names;
  for (const Column& column : columns) names.insert(column.name);
  for (const Column& column : later_step_columns()) names.insert(column.name);
  for (const ProbeColumns& probe : probes) {
    for (int c = 0; c < probe.components; ++c) {
      const std::string name = probe.components == 1 ? probe.name : probe.name + "_" + axes[c];
      if (!names.insert(name).second) {
        throw InputError(
            "probe", probe.name,
            "history.csv already has a column \"" + name + "\"; give the probe another name");
      }
      const std::string meaning =
          probe.meaning.empty() ? "probe " + probe.name + " of the case" : probe.meaning;
      columns.push_back({number, name, probe.unit, meaning});
    }
  }
  columns.insert(columns.end(), later_step_columns().begin(), later_step_columns().end());
  return columns;
}

Row make_row(const IterationRecord& record) {
  static const std::vector<Column> columns = iteration_columns();
  return checked(columns,
                 {std::int64_t{record.step}, std::int64_t{record.iteration}, record.residual,
                  record.relative_residual, record.energy, record.step_length,
                  std::int64_t{record.linear_iterations}, std::int64_t{record.changed_bonds},
                  record.projection, record.negative_pivots, std::int64_t{record.rejected_trials},
                  std::int64_t{record.degenerate_trials}, record.linear_tolerance});
}

Row make_row(const DecisionRecord& record) {
  static const std::vector<Column> columns = decision_columns();
  return checked(columns,
                 {std::int64_t{record.step}, record.load_factor, record.increment, record.outcome,
                  name(record.action), record.next_increment, record.reason, record.stage});
}

std::vector<Column> broken_bond_columns() {
  return {{integer, "step", "1", "step that broke the bond; path: step that the break led to"},
          {number, "load_factor", "1",
           "load factor of the step; path: load factor at which the bond broke"},
          {integer, "first_point", "1", "number of the bond's lower point"},
          {integer, "second_point", "1", "number of its other point"},
          {integer, "second_image", "1",
           "image of that point at which the bond ends, row of /points/images from 1; 0: the point "
           "itself"}};
}

Row make_row(const BrokenBondRecord& record) {
  return {std::int64_t{record.step}, record.load_factor, std::int64_t{record.first_point},
          std::int64_t{record.second_point}, std::int64_t{record.second_image}};
}

Row make_row(const StepRecord& record, const std::vector<std::string>& support_sets,
             const std::vector<ProbeColumns>& probes) {
  if (record.reactions.size() != support_sets.size() || record.probes.size() != probes.size()) {
    throw std::logic_error("results: a step needs the reactions and probes that were announced");
  }
  Row row =
      checked(step_columns(),
              {std::int64_t{record.step}, record.load_factor, record.mode,
               std::int64_t{record.newton_iterations}, std::int64_t{record.relaxation_iterations},
               record.stored_energy, record.dissipated_energy, record.drained_energy,
               record.external_work, record.balance_error, std::int64_t{record.broken_bonds},
               record.max_damage, record.max_stretch});
  const auto append = [&row](const std::string& name, double value) {
    if (!std::isfinite(value)) {
      throw std::logic_error("results: " + name + " is " + number_text(value));
    }
    row.emplace_back(value);
  };
  for (const std::string& set : support_sets) {
    const auto reaction = record.reactions.find(set);
    if (reaction == record.reactions.end()) {
      throw std::logic_error("results: a step has no reaction of set " + set);
    }
    for (const double component : reaction->second) append("the reaction of " + set, component);
  }
  for (const ProbeColumns& probe : probes) {
    const auto values = record.probes.find(probe.name);
    if (values == record.probes.end() ||
        values->second.size() != static_cast<std::size_t>(probe.components)) {
      throw std::logic_error("results: a step lacks components of probe " + probe.name);
    }
    for (const double value : values->second) append("probe " + probe.name, value);
  }
  append("numerical_work", record.numerical_work);
  append("pin_force", record.pin_force);
  row.emplace_back(std::int64_t{record.settled});
  append("stage", record.stage);
  append("control", record.control);
  row.emplace_back(record.negative_pivots);
  row.emplace_back(std::int64_t{record.is_on_response});
  append("released_energy", record.released_energy);
  row.emplace_back(static_cast<std::int64_t>(record.stability));
  append("strut_energy", record.strut_energy);
  return row;
}

IterationRecord read_iteration(const Row& row) {
  Cells cells(row);
  IterationRecord record;
  cells >> record.step >> record.iteration >> record.residual >> record.relative_residual >>
      record.energy >> record.step_length >> record.linear_iterations >> record.changed_bonds >>
      record.projection >> record.negative_pivots >> record.rejected_trials >>
      record.degenerate_trials >> record.linear_tolerance;
  return record;
}

DecisionRecord read_decision(const Row& row) {
  Cells cells(row);
  DecisionRecord record;
  std::string action;
  cells >> record.step >> record.load_factor >> record.increment >> record.outcome >> action >>
      record.next_increment >> record.reason >> record.stage;
  record.action = decision_named(action);
  return record;
}

StepRecord read_step(const Row& row, const std::vector<std::string>& support_sets,
                     const std::vector<ProbeColumns>& probes) {
  Cells cells(row);
  StepRecord record;
  cells >> record.step >> record.load_factor >> record.mode >> record.newton_iterations >>
      record.relaxation_iterations >> record.stored_energy >> record.dissipated_energy >>
      record.drained_energy >> record.external_work >> record.balance_error >>
      record.broken_bonds >> record.max_damage >> record.max_stretch;
  for (const std::string& set : support_sets) {
    for (double& component : record.reactions[set]) cells >> component;
  }
  for (const ProbeColumns& probe : probes) {
    std::vector<double>& values = record.probes[probe.name];
    values.resize(std::size_t(probe.components));
    for (double& value : values) cells >> value;
  }
  cells >> record.numerical_work >> record.pin_force >> record.settled >> record.stage >>
      record.control >> record.negative_pivots >> record.is_on_response >> record.released_energy;
  std::int64_t stability = 0;
  cells >> stability >> record.strut_energy;
  record.stability = Stability{static_cast<std::int8_t>(stability)};
  return record;
}

}  // namespace peristat
