#include "cases/runner/input/case_keys.hpp"

#include <filesystem>
#include <variant>

#include "cases/runner/input/body_keys.hpp"
#include "cases/runner/input/constraint_keys.hpp"
#include "cases/runner/input/contact_keys.hpp"
#include "cases/runner/input/fatigue_keys.hpp"
#include "cases/runner/input/key_kinds.hpp"
#include "cases/runner/input/load_keys.hpp"
#include "cases/runner/input/loading_keys.hpp"
#include "cases/runner/input/material_keys.hpp"
#include "cases/runner/input/output_keys.hpp"
#include "cases/runner/input/shape_keys.hpp"
#include "cases/runner/input/solver_keys.hpp"
#include "cases/runner/input/unit_system.hpp"

namespace peristat {
namespace {

template <class Body>
constexpr auto body_is =
    [](auto&, const Case& from) { return std::holds_alternative<Body>(from.body); };

constexpr auto itself = [](auto& spec) -> auto& { return spec; };

Table<Case> all_keys() {
  using K = Key<Case>;
  const auto searches = [](auto& result, auto&) { return !result.dynamics.is_asked_for; };
  return {
      "",
      {K("title", &Case::title, text(), "one line that describes the case")
           .moreover("any text")
           .otherwise(
               [](auto& result, auto&) {
                 result.title = std::filesystem::path(result.file).stem().string();
               },
               "name of the file without its ending")
           .early()
           .on_ranks(),
       K("dimension", &Case::dimension, integer(1, 3), "dimension of the body")
           .required()
           .early()
           .on_ranks(),
       K("units", &Case::units, unit_keys(),
         "table: [units](#units) of the plain numbers and expressions of the file")
           .written_if([](auto&, auto&) { return false; })
           .default_words("SI units")
           .early()
           .on_ranks(),
       K("lattice", itself, lattice_keys(), "table: points on a lattice")
           .written_if(body_is<Lattice>)
           .unless(
               [](auto&, const Case& from) { return from.givens->points.has_value(); },
               "cannot be combined with points that a program gives; these need the table [points]")
           .one_of(),
       K("points", itself, points_keys(), "table: points from a file")
           .written_if(body_is<PointSource>)
           .one_of(),
       K("set", &Case::sets, set_keys(), "tables: named sets of points").on_ranks(),
       K("crack", &Case::cracks, crack_keys(), "tables: initial cracks").on_ranks(),
       K("quadrature", itself, quadrature_keys(), "table: corrections of the weights"),
       K("material", &Case::material, material_keys("material"),
         "table: model, constants and damage of the points that are in no region")
           .otherwise([](auto&, auto&) {}, "required without `[[region]]`")
           .written_if([](auto& result, auto&) { return result.material.has_constants(); }),
       K("region", &Case::regions, region_keys(),
         "tables: sets of points with materials of their own")
           .then(check_regions)
           .on_ranks(),
       K("interface", &Case::interfaces, interface_keys(),
         "tables: interactions between points of two materials")
           .then([](auto& at, auto& result) {
             if (!result.interfaces.empty() && result.regions.empty()) at.refuse("needs regions");
           })
           .on_ranks(),
       K("support", &Case::supports, support_keys(), "tables: prescribed displacements").on_ranks(),
       K("rigid", in(&Case::constraints, &ConstraintSpecification::rigid_sets), rigid_set_keys(),
         "tables: sets that move as rigid bodies")
           .on_ranks(),
       K("roller", in(&Case::constraints, &ConstraintSpecification::rollers), roller_keys(),
         "tables: points that slide along a plane at any angle")
           .on_ranks(),
       K("constraint", in(&Case::constraints, &ConstraintSpecification::linear),
         linear_constraint_keys(), "tables: linear constraints between sets")
           .on_ranks(),
       K("symmetry", in(&Case::constraints, &ConstraintSpecification::symmetries), symmetry_keys(),
         "tables: planes of symmetry, with the bonds across them")
           .on_ranks(),
       K("period", in(&Case::constraints, &ConstraintSpecification::periods), period_keys(),
         "tables: sides across which the body repeats")
           .on_ranks(),
       K("load", &Case::loads, load_keys(), "tables: forces"),
       K("foundation", &Case::foundations, foundation_keys(),
         "tables: springs between a part of the body and the ground")
           .on_ranks(),
       K("contact", &Case::contacts, contact_keys(),
         "tables: contact of points that no whole bond joins")
           .on_ranks(),
       K("obstacle", &Case::obstacles, obstacle_keys(), "tables: rigid bodies that press on points")
           .on_ranks(),
       K("eigenstrain", in(&Case::eigenstrains, &Eigenstrains::given), eigenstrain_keys(),
         "tables: strains without stored energy, such as growth or drying")
           .on_ranks(),
       K("temperature", &Case::eigenstrains, temperature_keys(), "table: change of temperature")
           .then(check_temperature)
           .written_if([](auto& result, auto&) {
             return result.eigenstrains.temperature_change.has_value();
           })
           .on_ranks(),
       K("control", &Case::controls, control_keys(),
         "tables: the displacement that is prescribed instead of `load`"),
       K("initial", &Case::initial, initial_keys(),
         "tables: displacements and velocities at time 0")
           .on_ranks(),
       K("absorbing", &Case::absorbing, absorbing_keys(), "tables: layers that absorb waves")
           .on_ranks(),
       K("loading", &Case::loading, loading_keys(), "table: the path of the loads, and its steps")
           .written_if([](auto& result, auto&) {
             return !result.dynamics.is_asked_for || !result.loading.tables.empty();
           })
           .early(),
       K("solver", &Case::solver, solver_keys(), "table: search for equilibrium"),
       K("relaxation", &Case::relaxation, relaxation_keys(), "table: steps by dynamic relaxation")
           .written_if(searches)
           .on_ranks(),
       K("arc_length", &Case::solver, arc_length_keys(), "table: steps in mode `arc_length`")
           .written_if(searches)
           .then(check_found_loads),
       K("dynamics", &Case::dynamics, dynamics_keys(), "table: the motion in time")
           .early()
           .unless([](auto& result, auto&) { return !result.dynamics.is_asked_for; }, "")
           .default_words("required in mode `dynamics`")
           .on_ranks(),
       K("fatigue", &Case::fatigue, fatigue_keys(), "table: cycles of the load")
           .written_if([](auto& result, auto&) { return result.solver.mode == Mode::fatigue; })
           .then(check_fatigue_table)
           .default_words("required in mode `fatigue`"),
       K("output", &Case::output, output_keys(), "table: results folder"),
       K("probe", &Case::probes, probe_keys(), "tables: values that are recorded in the history")
           .on_ranks(),
       K("crack_tip", &Case::crack_tips, crack_tip_keys(),
         "tables: J, stress intensity factors and T-stress in the history")
           .on_ranks(),
       K("sensitivity", &Case::sensitivity, sensitivity_keys(),
         "table: derivatives of the history with respect to numbers of the case")
           .written_if([](auto& result, auto&) { return !result.sensitivity.over.empty(); })},
      [](auto& at, auto& result) {
        ask_for_dynamics(at, result);
        check_dynamics(at, result);
      }};
}

}  // namespace

const Table<Case>& document_keys() {
  static const Table<Case> keys = all_keys();
  return keys;
}

const std::vector<TableDescription>& table_descriptions() {
  static const auto tables = [] {
    std::vector<TableDescription> all;
    document_keys().describe(all);
    for (auto& table : all)
      if (table.name == "lattice.shape" || table.name == "lattice.refine") add_shapes(all, table);
    return all;
  }();
  return tables;
}

bool repeats_another(const std::string& table) {
  return table.starts_with("set.shape") || table.starts_with("region.material") ||
         table.starts_with("interface.material");
}

const std::map<std::string, std::vector<std::string>>& case_keys() {
  static const auto keys = [] {
    std::map<std::string, std::vector<std::string>> by_table;
    for (const auto& table : table_descriptions()) by_table[table.name] = table.listed;
    return by_table;
  }();
  return keys;
}

namespace {

/// Dotted names of the keys with a mark.
std::vector<std::string> marked_keys(bool KeyDescription::*mark) {
  std::vector<std::string> marked;
  for (const auto& table : table_descriptions())
    for (const auto& key : table.keys)
      if (key.*mark) marked.push_back(table.name + (table.name.empty() ? "" : ".") + key.name);
  return marked;
}

}  // namespace

const std::vector<std::string>& extending_keys() {
  static const auto keys = marked_keys(&KeyDescription::extends);
  return keys;
}

const std::vector<std::string>& keys_on_ranks() {
  static const auto keys = marked_keys(&KeyDescription::on_ranks);
  return keys;
}

}  // namespace peristat
