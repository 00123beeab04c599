#include "cases/runner/input/output_keys.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <variant>

#include "cases/runner/input/key_kinds.hpp"
#include "solvers/observe/point_fields.hpp"
#include "solvers/observe/probe.hpp"

namespace peristat {
namespace {

/// results/FOLDER_STEM, so that shipped cases of one name in several folders don't collide.
std::filesystem::path default_directory(const std::filesystem::path& case_file) {
  const auto absolute = std::filesystem::absolute(case_file).lexically_normal();
  const std::string folder = absolute.parent_path().filename().string();
  const std::string stem = absolute.stem().string();
  return std::filesystem::path("results") / (folder.empty() ? stem : folder + "_" + stem);
}

}  // namespace

Table<OutputSpecification> output_keys() {
  using Spec = OutputSpecification;
  using K = Key<Spec>;
  return {
      "output",
      {K("directory", &Spec::directory, text(),
         "results folder, relative to the current folder; `--output` on the command line sets it, "
         "too")
           .otherwise(
               [](auto& output, auto& from) { output.directory = default_directory(from.file); },
               "`results/FOLDER_NAME` of the case file: `results/bar_tension` for "
               "`cases/bar/tension.toml`")
           .then([](auto& at, auto& output) {
             if (output.directory.empty()) at.refuse("is empty");
           })
           .on_ranks(),
       K("every", &Spec::every, count_from(1, "steps"),
         "fields are written at every n-th accepted step (in mode `dynamics` every n-th time "
         "step), and at the last one")
           .otherwise(
               [](auto& output, auto& from) {
                 if (from.dynamics.is_asked_for)
                   output.every = std::max(1, 100 / std::max(1, from.dynamics.history_every)) *
                                  std::max(1, from.dynamics.history_every);
               },
               "1; in mode `dynamics` about 100 time steps")
           .then([](auto& at, auto& output) {
             const int rows = at.so_far.dynamics.history_every;
             if (rows > 0 && output.every % rows != 0)
               at.refuse("must be a multiple of dynamics.history_every, " + std::to_string(rows));
           })
           .extends()
           .on_ranks(),
       K("count_cracks", &Spec::count_cracks, boolean(),
         "whether `damage` and `max_damage` count the bonds that a `[[crack]]` has cut. If they "
         "do, pictures show the crack from the start")
           .on_ranks(),
       K("stress", &Spec::stress, boolean(),
         "whether strain and stress are among the fields: deformation gradient, strain, first "
         "Piola–Kirchhoff and Cauchy stress, von Mises' stress, principal values and directions "
         "([theory](theory.md#strain-and-stress)); they take several times the space of the other "
         "fields")
           .on_ranks()}};
}

namespace {

/// Fields of points, and quantities of a whole set, which single points don't have.
std::vector<std::string> quantities() {
  std::vector<std::string> names;
  for (const PointField& field : point_fields()) {
    if (field.shown_by != ShownBy::steps) names.push_back(field.name);
  }
  const std::vector<std::string>& whole = fields_of_whole_sets();
  names.insert(names.end(), whole.begin(), whole.end());
  return names;
}

/// True for quantities of a whole set, which single points don't have.
bool is_whole(const ProbeSpecification& probe, const Case&) {
  return point_field(probe.field) == nullptr;
}

/// Checks that a probe's component is one of its field's, and is given where it is needed.
void check_component_of_probe(const Entry& at, const ProbeSpecification& probe) {
  const PointField* field = point_field(probe.field);
  if (field == nullptr) return;
  const auto components = field->components(at.so_far.dimension);
  if (probe.component.empty()) {
    const bool must_choose =
        field->rank != FieldRank::scalar && field->rank != FieldRank::vector && !probe.from;
    if (must_choose)
      at.from.refuse("", "needs a component of " + probe.field + ": one of " + listed(components));
    return;
  }
  if (components.empty()) at.refuse(probe.field + " has no components");
  if (std::ranges::find(components, probe.component) == components.end())
    at.refuse("must be a component of " + probe.field + ", which has " + listed(components));
}

/// Checks that there is an expression for each component.
void check_expected(const Entry& at, const ProbeSpecification& probe) {
  const PointField* const field = point_field(probe.field);
  const std::size_t all = std::max<std::size_t>(1, field->components(at.so_far.dimension).size());
  const std::size_t components = probe.component.empty() ? all : 1;
  if (probe.expected.size() != components)
    at.refuse("needs as many expressions as there are components: " + std::to_string(components));
}

}  // namespace

Table<CrackTipSpecification> crack_tip_keys() {
  using Spec = CrackTipSpecification;
  using K = Key<Spec>;
  return {"crack_tip",
          {K("name", &Spec::name, name(), "first part of the names of its columns")
               .then([](auto& at, auto& tip) {
                 for (const auto& other : at.so_far.crack_tips)
                   if (other.name == tip.name) at.refuse("another crack tip has this name");
               })
               .moreover("no other crack tip has it")
               .required(),
           K("at", &Spec::at, coordinates(),
             "position of the tip; 3D: any position on its straight front")
               .required(),
           K("direction", &Spec::direction, coordinates(""),
             "direction in which the crack would continue, a vector of any length")
               .moreover("not all zero")
               .required(),
           K("front", &Spec::front, coordinates(""),
             "3D: direction of the front, a vector of any length. The front extends through the "
             "whole body")
               .moreover("at a right angle to `direction`")
               .unless(in_dimension<2>, "is for dimension 3")
               .default_words("`[0, 0, 1]`"),
           K("inner", &Spec::inner, positive("m"), "inner radius of the ring of the integrals")
               .moreover("at least 2 horizons")
               .written_if([](auto& tip, auto&) { return tip.inner > 0.0; })
               .default_words("2 horizons, of points with their own the largest within the ring"),
           K("outer", &Spec::outer, positive("m"), "outer radius of the ring")
               .moreover("at least a horizon more than `inner`")
               .written_if([](auto& tip, auto&) { return tip.outer > 0.0; })
               .default_words("4 horizons, or twice `inner`"),
           K("cut", &Spec::cut, positive("m"),
             "length of a cut ahead of the tip, from which energy release rates follow. Every step "
             "then solves one more system of equations")
               .moreover("at least a horizon")
               .written_if([](auto& tip, auto&) { return tip.cut > 0.0; })
               .default_words("none")}};
}

Table<ProbeSpecification> probe_keys() {
  using Spec = ProbeSpecification;
  using K = Key<Spec>;
  const auto has_no_axis = [](auto& probe, auto&) {
    return probe.field != "poisson_ratio" && probe.field != "crack_length" &&
           probe.field != "crack_begin" && probe.field != "crack_end" &&
           probe.field != "crack_angle";
  };
  const auto has_no_other = [](auto& probe, auto&) { return probe.field != "opening"; };
  return {
      "probe",
      {K("name", &Spec::name, name(), "name of the column")
           .then([](auto& at, auto& probe) {
             for (const auto& other : at.so_far.probes)
               if (other.name == probe.name) at.refuse("another probe has this name");
           })
           .moreover("no other probe has it")
           .required()
           .early(),
       K("set", &Spec::set, known_set(), "set whose points give the value")
           .written_if([](auto& probe, auto&) { return !probe.set.empty(); })
           .one_of(),
       K("at", &Spec::at, coordinates(), "position; the nearest point gives the value")
           .unless(is_whole, "is for a field with a value at every point")
           .one_of(),
       K("from", &Spec::from, coordinates(),
         "start of a line. The points within half a spacing of the line are written to "
         "`line_NAME.csv`")
           .unless(is_whole, "is for a field with a value at every point")
           .one_of(),
       K("field", &Spec::field, one_of(quantities()),
         "field. Units: displacement, opening, length and position in m, area in m², force in N, "
         "energy densities in J/m³, velocity in m/s, stress in Pa, angles in degrees, work of "
         "fracture and crack resistance in J/m²; `stress` is the Cauchy stress, `strain` the "
         "Green–Lagrange strain")
           .then([](auto& at, auto& probe) {
             if (probe.field == "poisson_ratio" && at.so_far.dimension == 1)
               at.refuse("there is no Poisson's ratio in dimension 1");
             if (probe.field == "crack_angle" && at.so_far.dimension != 2)
               at.refuse("is for dimension 2");
             const bool has_area = probe.field == "crack_area" || probe.field == "crack_angle" ||
                                   probe.field == "work_of_fracture" ||
                                   probe.field == "crack_resistance";
             const Lattice* const cells = std::get_if<Lattice>(&at.so_far.body);
             if (has_area && (cells == nullptr || cells->arrangement == Arrangement::blue_noise))
               at.refuse("is for points on a lattice, which have faces between them");
             const bool fails_in_bands = at.so_far.material.damage.law == DamageLaw::energy_density;
             if (has_area && fails_in_bands && probe.field != "crack_angle")
               at.refuse("is for bonds that break: points that fail make a band of many faces");
             const PointField* const field = point_field(probe.field);
             if (field != nullptr && field->needs == FieldNeeds::motion &&
                 !at.so_far.dynamics.is_asked_for)
               at.refuse("is for solver.mode = \"dynamics\"");
             if (field != nullptr && field->needs == FieldNeeds::fatigue &&
                 at.so_far.solver.mode != Mode::fatigue)
               at.refuse("is for solver.mode = \"fatigue\"");
           })
           .early(),
       K("to", &Spec::to, coordinates(), "end of the line")
           .default_words("required with `from`")
           .then([](auto& at, auto& probe) {
             if (probe.to && !probe.from) at.refuse("needs the key from");
             if (probe.from && !probe.to)
               at.from.refuse("", "a line needs the key to, where it ends");
             if (probe.from && *probe.to == *probe.from)
               at.refuse("must not be the same place as from");
           }),
       K("component", &Spec::component, one_of(component_names()),
         "component of a vector (`x`), of a tensor (`xy`; for a stress or a deformation gradient "
         "first the component, then the reference direction) or of `principal_stress` (`1`: the "
         "largest)")
           .unless(is_whole, "is for a field with a value at every point")
           .default_words(
               "all components of a vector; for other fields required with `set` and `at`")
           .written_if([](auto& probe, auto&) { return !probe.component.empty(); })
           .then(check_component_of_probe),
       K("statistic", &Spec::statistic,
         choice<Statistic>({{"mean", Statistic::mean},
                            {"max", Statistic::max},
                            {"min", Statistic::min},
                            {"rms_error", Statistic::rms_error},
                            {"max_error", Statistic::max_error}}),
         "statistic over the points of the set. `\"mean\"`: per component, with the same weight "
         "for all "
         "points; `\"max\"`: largest value per component; `\"min\"`: smallest value per component; "
         "`\"rms_error\"`: one number, the root mean square of the lengths of the differences from "
         "`expected`; `\"max_error\"`: the maximum of these lengths")
           .written_if(
               [](auto& probe, auto& from) { return !probe.set.empty() && !is_whole(probe, from); })
           .then([](auto& at, auto& probe) {
             if (at.from.has(at.key) && (probe.set.empty() || is_whole(probe, at.so_far)))
               at.refuse("is for a field over a set");
           }),
       K("expected", &Spec::expected, expected_components(),
         "expected values of the components at a point's reference position")
           .written_if([](auto& probe, auto&) { return is_of_error(probe.statistic); })
           .default_words("required with `rms_error` and `max_error`")
           .then([](auto& at, auto& probe) {
             const bool is_given = at.from.has(at.key);
             if (is_given && !is_of_error(probe.statistic))
               at.refuse("needs statistic \"rms_error\" or \"max_error\"");
             if (!is_given && is_of_error(probe.statistic))
               at.from.refuse("", "this statistic needs expected");
             if (is_given) check_expected(at, probe);
           }),
       K("axis", &Spec::axis, axis(),
         "`poisson_ratio`: direction of the pull; `crack_length`, `crack_begin`, `crack_end`: "
         "direction in which the crack runs; `crack_angle`: axis from which the angle is measured")
           .unless(has_no_axis,
                   "is for fields \"poisson_ratio\", \"crack_length\", \"crack_begin\", "
                   "\"crack_end\" and \"crack_angle\""),
       K("other", &Spec::other, known_set(), "`opening`: the set on the other side of the crack")
           .unless(has_no_other, "is for field \"opening\"")
           .required("required with `opening`")}};
}

Table<SensitivitySpecification> sensitivity_keys() {
  using Spec = SensitivitySpecification;
  using K = Key<Spec>;
  return {"sensitivity",
          {K("over", &Spec::over, keys_of_case(),
             "numbers of the case, by their keys, with respect to which the columns of the history "
             "are differentiated ([sensitivities](sensitivities.md))")
               .default_words("none")
               .then([](auto& at, auto& sensitivity) {
                 if (!sensitivity.over.empty() && at.so_far.solver.mode != Mode::newton)
                   at.refuse("needs solver.mode = \"newton\", not \"" +
                             std::string(at.so_far.solver.mode.name) + "\"");
                 for (std::size_t k = 0; k < sensitivity.over.size(); ++k)
                   if (std::ranges::count(sensitivity.over, sensitivity.over[k]) > 1)
                     at.from.refuse(at.key, k, "is there twice");
               })}};
}

}  // namespace peristat
