#include "cases/runner/input/case.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "cases/runner/input/case_file.hpp"
#include "cases/runner/input/given_values.hpp"
#include "cases/runner/input/key_table.hpp"
#include "cases/runner/input/si_document.hpp"
#include "cases/runner/input/toml_table.hpp"
#include "cases/runner/input/unit_system.hpp"
#include "solvers/formulations/check_specification.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/observe/point_fields.hpp"
#include "src/conditions/loading_programme.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

void collect_locations(const TomlValue& value, const std::string& path,
                       std::map<std::string, CaseLocation>& locations) {
  if (!path.empty()) locations[path] = value.location;
  for (const auto& [key, entry] : value.entries)
    collect_locations(entry, path.empty() ? key : path + "." + key, locations);
  for (std::size_t k = 0; k < value.items.size(); ++k)
    collect_locations(value.items[k], path + "[" + std::to_string(k) + "]", locations);
}

/// Place of a key, or of the longest part of it that the case file has.
CaseLocation location_of(const Case& from, const std::string& key) {
  for (std::string part = key; !part.empty();) {
    const auto known = from.locations.find(part);
    if (known != from.locations.end()) return known->second;
    const auto cut = part.find_last_of(".[");
    part.resize(cut == std::string::npos ? 0 : cut);
  }
  return {};
}

/// Sets horizon and cross-section, of a lattice or of points from a file.
void resolve_size(Case& result) {
  if (const auto* lattice = std::get_if<Lattice>(&result.body)) {
    result.horizon = result.horizon_ratio * lattice->spacing;
    result.horizon_per_size = lattice->refinements.empty() ? 0.0 : result.horizon_ratio;
    result.cross_section = lattice->cross_section;
  } else {
    const auto& source = std::get<PointSource>(result.body);
    result.horizon = source.horizon.length;
    result.horizon_per_size = source.horizon.ratio;
    result.cross_section = source.cross_section;
  }
}

/// Keys of the case file by the names that lower layers use for their inputs.
const std::map<std::string, std::string>& keys_of_members() {
  static const std::map<std::string, std::string> keys{
      {"spacing", "lattice.spacing"},
      {"arrangement", "lattice.points"},
      {"lloyd_steps", "lattice.lloyd_steps"},
      {"refinements", "lattice.refine"},
      {"perturbation", "lattice.perturbation"},
      {"cell_perturbation", "lattice.cell_perturbation"},
      {"angle", "lattice.angle"},
      {"volume_correction", "quadrature.volume_correction"},
      {"surface_correction", "quadrature.surface_correction"},
      {"horizon_shape", "quadrature.horizon_shape"},
      {"force_operator", "solver.operator"},
      {"degree", "quadrature.degree"},
      {"collocation", "quadrature"},
      {"weights", "quadrature.weights"},
      {"form", "quadrature.form"},
      {"shapes", "lattice.shape"},
      {"layers", "lattice.layer"},
      {"cracks", "crack"},
      {"file", "points.file"},
      {"supports", "support"},
      {"loads", "load"},
      {"regions", "region"},
      {"interfaces", "interface"},
      {"foundations", "foundation"},
      {"contacts", "contact"},
      {"obstacles", "obstacle"},
      {"crack_tips", "crack_tip"},
      {"rigid_sets", "rigid"},
      {"rollers", "roller"},
      {"linear", "constraint"},
      {"symmetries", "symmetry"},
      {"periods", "period"},
      {"eigenstrains", "eigenstrain"},
      {"directory", "output.directory"},
      {"controls", "control"},
      {"end_time", "dynamics.end_time"},
      {"programme", "loading.table"}};
  return keys;
}

/// "load[0].body_force[1]" for "loads[0].value[1]"; a key of the case file stays as it is.
std::string key_of(const Case& from, std::string member) {
  const auto* lattice = std::get_if<Lattice>(&from.body);
  if (member == "cross_section")
    return std::string(lattice != nullptr ? "lattice." : "points.") +
           (from.dimension == 1 ? "area" : "thickness");
  if (member == "points.horizons" || member == "horizon_per_size") return key_of_own_horizons(from);
  if (member == "horizon") return lattice != nullptr ? "lattice.horizon_ratio" : "points.horizon";
  if (member.starts_with("points") && lattice != nullptr) return "lattice.shape";
  if (member == "loading.mode") return "solver.mode";
  if (member == "points.reference") return "points.file";
  if (member == "neighbours") return "points.neighbours";
  if (member == "linear.preconditioner") return "solver.preconditioner";
  if (member == "linear.method") return "solver.linear";
  if (member == "tangent") return "solver.tangent";
  const std::size_t end = std::min(member.find_first_of("[."), member.size());
  const auto known = keys_of_members().find(member.substr(0, end));
  if (known == keys_of_members().end()) return member;
  const auto replace = [&](const std::string& part, const auto& key_of_element) {
    const std::size_t at = member.find(part);
    if (at == std::string::npos) return;
    const std::size_t number = std::stoul(member.substr(end + 1));
    member.replace(at + 2, part.size() - 2, key_of_element(number));
  };
  replace("].value", [&](std::size_t k) { return std::string(load_key(from.loads.at(k).kind)); });
  replace("].action", [&](std::size_t k) {
    return lattice->shapes.at(k).action == ShapeStep::Action::add ? "add" : "subtract";
  });
  return known->second + member.substr(end);
}

}  // namespace

std::string key_of_own_horizons(const Case& from) {
  if (const auto* lattice = std::get_if<Lattice>(&from.body))
    return lattice->refinements.empty() ? "" : "lattice.refine";
  return std::get<PointSource>(from.body).horizon.ratio > 0.0 ? "points.horizon" : "";
}

bool PointSource::is_mesh() const {
  std::string end = file.extension().string();
  std::ranges::transform(end, end.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr std::array known{".msh", ".inp", ".vtu", ".vtk", ".exo", ".e", ".ex2", ".med"};
  return std::ranges::any_of(known, [&](const char* one) { return end == one; });
}

namespace {

/// Units of the case's own table; SI units without one.
UnitSystem units_of(const TomlValue& document, const Case& result) {
  UnitNames names;
  const auto table = document.entries.find("units");
  if (table != document.entries.end())
    unit_keys().read({TomlTable(table->second, "units", result.file), "", result}, names);
  return unit_system(names);
}

}  // namespace

int LoadingSpecification::steps_to_entry() const {
  const bool is_of_step = std::any_of(tables.begin(), tables.end(), [](const LoadTable& table) {
    return !table.expression.empty();
  });
  return is_of_step ? 1 : steps;
}

std::vector<std::string> LoadingSpecification::parameters() const {
  return LoadingProgramme::names(std::max<std::size_t>(tables.size(), 1));
}

std::vector<std::string> Case::parameters() const {
  if (!dynamics.is_asked_for) return loading.parameters();
  std::vector<std::string> all = LoadingProgramme::names(loading.tables.size());
  all.insert(all.begin(), "t");
  return all;
}

Case read_case(const std::filesystem::path& file, const Settings& overrides) {
  return read_case(file, read_case_text(file), overrides);
}

std::shared_ptr<const GivenFunctions> given_functions(const Case& from) {
  return {from.givens, &from.givens->functions};
}

Case read_case(const std::filesystem::path& file, const std::string& text,
               const Settings& overrides, std::shared_ptr<const Givens> givens) {
  check_functions(givens->functions);
  Case result;
  result.givens = std::move(givens);
  result.file = file.string();
  result.as_read = text;
  result.settings = overrides;

  TomlValue document = parse_toml(result.as_read, result.file);
  for (const auto& [key, value] : overrides) apply_override(document, key, value);
  collect_locations(document, "", result.locations);
  result.typed = convert_to_si(document, units_of(document, result), result.file);
  try {
    document_keys().read({TomlTable(document, "", result.file), "", result}, result);
    refuse_idle_tables(result);
    resolve_size(result);
    check_materials(result, result.dimension);
    resolve_drives(result);
  } catch (const InputError& error) {
    throw located(result, error);
  }
  for (const LoadTable& table : result.loading.tables) {
    if (result.dynamics.is_asked_for) {
      result.loads_over_time.push_back(table.over_time);
    } else {
      result.programme.push_back(table.entries);
    }
  }
  if (result.dynamics.is_asked_for) result.end_time = result.dynamics.end_time;
  result.has_inertia = result.dynamics.is_implicit();
  result.as_resolved = document_keys().lines(result, result);
  return result;
}

std::string located(const Case& from, const std::string& key, const std::string& message) {
  return location_of(from, key).text(from.file) + ": " + message;
}

InputError located(const Case& from, const InputError& error) {
  if (!error.place().empty()) return error;
  const std::string key = key_of(from, error.key());
  // A lattice's horizon is given in spacings.
  const std::string value =
      key == "lattice.horizon_ratio" ? number_text(from.horizon_ratio) : error.value();
  return InputError(key, value, error.allowed(), location_of(from, key).text(from.file));
}

bool tells_stress(const Case& from) {
  return from.output.stress ||
         std::ranges::any_of(from.probes, [](const ProbeSpecification& probe) {
           const PointField* const field = point_field(probe.field);
           return field != nullptr && field->needs == FieldNeeds::stress;
         });
}

}  // namespace peristat
