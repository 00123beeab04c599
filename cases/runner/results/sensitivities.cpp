#include "cases/runner/results/sensitivities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "assembly/terms/damage.hpp"
#include "cases/runner/input/quantity.hpp"
#include "cases/runner/input/toml_text.hpp"
#include "cases/runner/input/toml_value.hpp"
#include "cases/runner/results/state_values.hpp"
#include "cases/runner/results/tables/record_tables.hpp"
#include "cases/runner/setup/body.hpp"
#include "solvers/observe/internal_force.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// Relative change of a number. The differences lose its square to the third derivative, and the
/// unit round-off over it to round-off.
constexpr double relative_change = 0x1p-17;

std::string key_of(std::size_t k) { return indexed("sensitivity.over", k); }

/// The columns of a step of its own that have derivatives; those of reactions and probes have, too.
const std::set<std::string>& own_columns() {
  static const std::set<std::string> names{"load_factor", "stored_energy", "external_work",
                                           "dissipated_energy", "control"};
  return names;
}

/// True for probes whose value jumps with each bond that breaks.
bool is_of_cracks(const Case& from, const std::string& name) {
  return std::ranges::any_of(from.probes, [&](const ProbeSpecification& probe) {
    return probe.name == name && crack_measure(probe.field) != nullptr;
  });
}

/// The number at a key of the resolved case; nothing if there is none.
std::optional<double> number_at(const TomlValue& document, const std::string& key) {
  const TomlValue* value = &document;
  for (std::size_t at = 0; at < key.size() && value;) {
    if (key[at] == '[') {
      const std::size_t end = key.find(']', at);
      if (end == std::string::npos) return std::nullopt;
      const std::string digits = key.substr(at + 1, end - at - 1);
      if (digits.empty() || digits.size() > 8 ||
          digits.find_first_not_of("0123456789") != std::string::npos) {
        return std::nullopt;
      }
      const std::size_t index = std::stoul(digits);
      value = index < value->items.size() ? &value->items[index] : nullptr;
      at = end + 1;
    } else {
      at += key[at] == '.' ? 1 : 0;
      const std::size_t end = std::min(key.find_first_of(".[", at), key.size());
      const auto found = value->entries.find(key.substr(at, end - at));
      value = found == value->entries.end() ? nullptr : &found->second;
      at = end;
    }
  }
  if (!value) return std::nullopt;
  if (value->kind == TomlValue::Kind::real) return value->real;
  if (value->kind == TomlValue::Kind::integer) return double(value->integer);
  // Components of forces and displacements are expressions, also those that are numbers.
  const bool is_number = value->kind == TomlValue::Kind::string && !value->string.empty() &&
                         length_of_number(value->string) == value->string.size();
  return is_number ? std::optional(std::stod(value->string)) : std::nullopt;
}

/// Refuses bodies whose damage does not follow from one state to the next.
void refuse_bodies_without_derivatives(const Body& body) {
  const auto refuse = [](const std::string& why) { throw InputError("sensitivity.over", "", why); };
  const bool is_of_points = body.model.has_history() && !body.model.failing_bonds();
  if (is_of_points || body.model.struts()) {
    refuse("is for damage of bonds, without struts: points and struts that fail jump");
  }
  const bool is_bond = body.specification.material.model == MaterialModel::bond;
  if (body.model.has_history() && !is_bond && !body.model.fails_by_release()) {
    refuse("is for damage of this model by release, not by stretch (material.damage.drive)");
  }
  if (!body.model.balances().potential) refuse("is for models with an energy");
  if (!body.specification.contacts.empty() || !body.conditions->obstacles().none()) {
    refuse("is not for contact");
  }
}

}  // namespace

/// A number of the case with the bodies beside it.
struct Sensitivities::Parameter {
  Parameter(const Case& from, const TomlValue& resolved, const std::string& of, std::size_t number);

  [[nodiscard]] const Case& side(std::size_t k) const { return *cases[k]; }

  std::string key;
  double value = 0.0;
  double change = 0.0;
  std::array<std::unique_ptr<const Case>, 2> cases;
  std::array<std::unique_ptr<const Body>, 2> bodies;
  std::unique_ptr<Neighbours> neighbours;
  std::array<std::unique_ptr<RecordedPoints>, 2> points;
  std::array<std::unique_ptr<DrivenSets>, 2> driven;
  std::array<std::vector<CrackTip>, 2> tips;
};

Sensitivities::Parameter::Parameter(const Case& from, const TomlValue& resolved,
                                    const std::string& of, std::size_t number)
    : key(of) {
  const std::optional<double> found = number_at(resolved, key);
  if (!found || *found == 0.0) {
    throw InputError(key_of(number), '"' + key + '"',
                     found ? "is 0 in this case; a relative change of it changes nothing"
                           : "is no number of this case (an expression is none)");
  }
  value = *found;
  change = relative_change * std::abs(value);
  for (std::size_t side = 0; side < 2; ++side) {
    const double changed = value + (side == 0 ? -change : change);
    auto beside = std::make_unique<Case>(
        read_case(from.file, from.as_resolved, {{key, toml_number(changed)}}, from.givens));
    beside->sensitivity = {};  // it has no bodies beside it
    cases[side] = std::move(beside);
  }
}

Sensitivities::Sensitivities(const Case& from, Study& study,
                             const std::vector<std::string>& support_sets,
                             const std::vector<ProbeColumns>& probes)
    : from_(from), study_(study), support_sets_(support_sets), probes_(probes) {
  refuse_bodies_without_derivatives(study.body());
  columns_ = {{Column::Kind::integer, "step", "1", "number of the accepted step"},
              {Column::Kind::number, "load_factor", "1", "load factor of the step"},
              {Column::Kind::text, "parameter", "none", "key of the number"},
              {Column::Kind::number, "value", "SI", "of the number"}};
  const std::vector<Column> history = history_columns(support_sets, probes);
  const std::vector<Column> of_step = history_columns({}, {});
  for (std::size_t k = 0; k < history.size(); ++k) {
    const std::string& name = history[k].name;
    const bool is_own =
        std::ranges::any_of(of_step, [&](const Column& column) { return column.name == name; });
    if (is_own ? !own_columns().contains(name) : is_of_cracks(from, name)) continue;
    columns_.push_back({Column::Kind::number, "d_" + name, history[k].unit + " per unit of value",
                        "derivative of " + name});
    places_.push_back(k);
  }
  const TomlValue resolved = parse_toml(from.as_resolved, from.file);
  const int threads = study.options().threads;
  for (std::size_t k = 0; k < from.sensitivity.over.size(); ++k) {
    auto made = std::make_unique<Parameter>(from, resolved, from.sensitivity.over[k], k);
    for (std::size_t side = 0; side < 2; ++side) {
      const Case& its = made->side(side);
      made->bodies[side] = make_body(its, threads);
      const Body& body = *made->bodies[side];
      made->points[side] = std::make_unique<RecordedPoints>(body.points, *body.index_map);
      made->driven[side] = std::make_unique<DrivenSets>(its, body);
      made->tips[side] = make_crack_tips(body, its.crack_tips, study.options());
    }
    try {
      made->neighbours = std::make_unique<Neighbours>(
          *made->bodies[0], *made->bodies[1], study.equations().assembler(),
          *study.body().conditions, relative_change, threads);
    } catch (const InputError& error) {
      throw InputError(key_of(k), '"' + made->key + '"', error.allowed());
    }
    parameters_.push_back(std::move(made));
  }
}

Sensitivities::~Sensitivities() = default;

void Sensitivities::open(const std::filesystem::path& folder) {
  table_ = std::make_unique<CsvTable>(folder / file_name, columns_);
}

void Sensitivities::follow(const UncommittedState& state) {
  if (has_ended_) return;
  // Each attempt of a step begins with the history of the accepted state.
  const std::uint64_t version = state.trial.history.version();
  if (!version_of_start_) version_of_start_ = version;
  if (version == *version_of_start_ || !has_followed_) {
    fault_.clear();
    for (const auto& parameter : parameters_) parameter->neighbours->begin();
  }
  move_to(state, true);
  has_followed_ = true;
}

void Sensitivities::move_to(const UncommittedState& state, bool commits) {
  if (!fault_.empty()) return;
  const SolvedBody solved = study_.equations().solved();
  std::optional<LoadAnswer> answer;
  if (state.at.load && study_.body().conditions->control()) {
    answer = load_answer(solved, *study_.body().conditions, state);
    if (!answer) fault_ = "the linear solver has failed";
  }
  for (const auto& parameter : parameters_) {
    if (!fault_.empty()) return;
    Neighbours& neighbours = *parameter->neighbours;
    const std::string fault = neighbours.follow(solved, state, answer ? &*answer : nullptr);
    if (!fault.empty()) fault_ = parameter->key + ": " + fault;
    if (commits) neighbours.commit();
  }
}

std::string Sensitivities::add(const StepRecord& record, const AcceptedState& state) {
  if (has_ended_) return {};
  const bool is_preload = record.step == 0;
  if (!has_followed_) {
    fault_.clear();
    for (const auto& parameter : parameters_) parameter->neighbours->begin();
    LoadPoint at(record.stage);
    if (study_.body().conditions->control() && !is_preload) at.load = record.load_factor;
    move_to({state.trial, state.external_force, at}, false);
  }
  if (std::ranges::any_of(state.piece, [](std::int32_t piece) { return piece > 0; })) {
    fault_ = "a piece has come off";
  }
  for (const auto& parameter : parameters_) {
    if (!fault_.empty()) break;
    const std::string fault = parameter->neighbours->accept(state.trial.history, is_preload);
    if (!fault.empty()) fault_ = parameter->key + ": " + fault;
  }
  has_followed_ = false;
  version_of_start_ = state.trial.history.version();
  if (!fault_.empty()) {
    has_ended_ = true;
    return "sensitivities end before step " + std::to_string(record.step) + ": " + fault_;
  }
  for (const auto& parameter : parameters_) {
    table_->append(derivatives(*parameter, record, state));
  }
  return {};
}

StepRecord Sensitivities::record_of(const Parameter& parameter, std::size_t side,
                                    const StepRecord& accepted, const AcceptedState& state) const {
  Neighbours::Neighbour& of =
      side == 0 ? parameter.neighbours->less() : parameter.neighbours->more();
  const Conditions& conditions = *of.body.conditions;
  StepRecord record = accepted;
  record.load_factor = conditions.load_factor(of.at);
  record.stored_energy = of.state.stored_energy;
  record.external_work = of.external_work;
  std::vector<double> damage(std::size_t(of.body.points.count()));
  record.dissipated_energy = of.assembler.assess(of.state.history, {}, damage).dissipated_energy;
  if (const DisplacementControl* control = conditions.control()) {
    record.control = control->value(of.state.displacement);
  }
  record.reactions = conditions.reactions(of.state.gradient, of.external_force,
                                          of.state.displacement, of.state.environment);
  ObservedExtras extras{internal_force(of.body, of.state, of.external_force), state.piece};
  extras.count_cracks = from_.output.count_cracks;
  Observation observed(of.body, of.assembler, of.state.at(), std::move(extras));
  static_cast<void>(observed.values("displacement"));
  for (const ProbeSpecification& probe : from_.probes) {
    if (!probe.from && point_field(probe.field)) {
      static_cast<void>(observed.values(probe.field));
    }
  }
  record.probes.clear();
  static_cast<void>(add_state_values(
      {parameter.side(side), of.body, of.assembler, *parameter.points[side],
       *parameter.driven[side], parameter.tips[side]},
      of.state, of.external_force, observed.computed(),
      [](const std::string&) { return CrackState{}; }, record));
  return record;
}

Row Sensitivities::derivatives(const Parameter& parameter, const StepRecord& accepted,
                               const AcceptedState& state) const {
  const Row less = make_row(record_of(parameter, 0, accepted, state), support_sets_, probes_);
  const Row more = make_row(record_of(parameter, 1, accepted, state), support_sets_, probes_);
  Row row{std::int64_t(accepted.step), accepted.load_factor, parameter.key, parameter.value};
  for (const std::size_t place : places_) {
    row.emplace_back((std::get<double>(more[place]) - std::get<double>(less[place])) /
                     (2.0 * parameter.change));
  }
  return row;
}

}  // namespace peristat
