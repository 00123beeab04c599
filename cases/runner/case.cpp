#include "cases/runner/case.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "cases/runner/case_file.hpp"
#include "cases/runner/case_keys.hpp"
#include "cases/runner/case_text.hpp"
#include "cases/runner/toml_table.hpp"
#include "src/conditions/expression.hpp"
#include "src/input_error.hpp"

namespace peristat {
namespace {

/// What the checks of one table need to know of the others.
struct Context {
  int dimension = 0;
  double spacing =
      1.0;  ///< of the lattice; stands for any positive number if points come from a file
  bool sets_from_file = false;  ///< names of sets are not all known before that is read
  std::map<std::string, std::string> names;  ///< path of the key that gives a set its name
};

// ---- Pieces that several tables share

Coordinates coordinates(const TomlTable& table, const std::string& key, int dimension) {
  Coordinates place{};
  const auto numbers = table.numbers(key, static_cast<std::size_t>(dimension), Range{});
  std::copy(numbers.begin(), numbers.end(), place.begin());
  return place;
}

double cross_section(const TomlTable& table, int dimension) {
  if (dimension != 1 && table.has("area"))
    table.refuse("area", dimension == 2 ? "is for dimension 1; dimension 2 has a thickness"
                                        : "is for dimension 1 only");
  if (dimension != 2 && table.has("thickness"))
    table.refuse("thickness", dimension == 1 ? "is for dimension 2; dimension 1 has an area"
                                             : "is for dimension 2 only");
  if (dimension == 1) return table.number("area", Range::positive("m2"), 1.0);
  if (dimension == 2) return table.number("thickness", Range::positive("m"), 1.0);
  return 1.0;
}

std::string name(const TomlTable& table) {
  const std::string text = table.string("name");
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  if (text.empty()) table.refuse("name", "is empty");
  for (const char c : text)
    if (!allowed(c)) table.refuse("name", "may only have letters, digits, _ and -");
  return text;
}

/// Name of a set or of a layer, which is a set too.
std::string set_name(const TomlTable& table, Context& context) {
  const std::string text = name(table);
  const auto [entry, is_new] = context.names.try_emplace(text, table.path("name"));
  if (!is_new) {
    table.refuse("name", "this name is taken by " + entry->second +
                             "; sets and layers need different names");
  }
  return text;
}

/// Name of a set that must be there.
std::string known_set(const TomlTable& table, const Context& context,
                      const std::string& key = "set") {
  const std::string text = table.string(key);
  if (context.names.count(text) > 0 || context.sets_from_file) return text;
  std::vector<std::string> names;
  for (const auto& [known, path] : context.names) names.push_back(known);
  table.refuse(key,
               "no set or layer of this name" + did_you_mean(text, names) +
                   (names.empty() ? "; the case has none" : "  (there: " + listed(names) + ")"));
}

/// An expression that selects points; empty without the key.
std::string condition(const TomlTable& table, const Context& context) {
  if (!table.has("where")) return {};
  const std::string text = table.string("where");
  try {
    Expression(text, context.dimension, context.spacing, Expression::LoadFactor::not_allowed);
  } catch (const InputError& error) {
    table.refuse("where", error.allowed());
  }
  return text;
}

enum class Variables { place_and_load, load };

void check_component(const TomlTable& table, const std::string& key, std::size_t component,
                     const std::string& text, const Context& context, Variables variables) {
  const int dimension = variables == Variables::load ? 0 : context.dimension;
  try {
    Expression(text, dimension, context.spacing, Expression::LoadFactor::allowed);
  } catch (const InputError& error) {
    table.refuse(key, component, error.allowed());
  }
}

// ---- Shapes

Shape read_numbers_of_shape(const TomlTable& table, const std::string& kind, int dimension) {
  if (kind == "box")
    return Box{coordinates(table, "min", dimension), coordinates(table, "max", dimension)};
  if (kind == "polygon") return Polygon{table.pairs("vertices")};
  const Coordinates centre = coordinates(table, "centre", dimension);
  const double radius = table.number("radius", Range::positive("m"));
  if (kind == "disk") return Disk{centre, radius};
  if (kind == "sphere") return Sphere{centre, radius};
  Cylinder cylinder;
  cylinder.centre = centre;
  cylinder.radius = radius;
  if (table.has("axis")) cylinder.axis = coordinates(table, "axis", dimension);
  constexpr double infinite = std::numeric_limits<double>::infinity();
  cylinder.length = table.number("length", Range::positive("m", infinite), infinite);
  return cylinder;
}

Shape read_shape(const TomlTable& table, const std::string& kind, int dimension) {
  const Shape shape = read_numbers_of_shape(table, kind, dimension);
  check_shape(shape, dimension, table.path(), table.path());
  return shape;
}

/// Kinds of shapes that a body of this dimension can have.
std::vector<std::string> shape_kinds(int dimension) {
  if (dimension == 1) return {"box"};
  if (dimension == 2) return {"box", "disk", "polygon"};
  return {"box", "cylinder", "sphere", "polygon"};
}

void refuse_other_dimension(const TomlTable& table, const std::string& key, const std::string& kind,
                            int dimension) {
  const auto allowed = shape_kinds(dimension);
  if (shape_keys().count(kind) == 0 || std::count(allowed.begin(), allowed.end(), kind) > 0) return;
  table.refuse(key, "there is no " + kind + " in dimension " + std::to_string(dimension) +
                        "  (allowed: " + listed(allowed) + ")");
}

ShapeStep read_shape_step(const TomlTable& table, int dimension) {
  const std::string action = table.exactly_one({"add", "subtract"});
  refuse_other_dimension(table, action, table.string(action), dimension);
  const std::string kind = table.one_of(action, shape_kinds(dimension));
  std::vector<std::string> keys{action};
  for (const auto& key : shape_keys().at(kind)) keys.push_back(key);
  table.allow_only(keys, "is no key of a " + kind);

  return {action == "add" ? ShapeStep::Action::add : ShapeStep::Action::subtract,
          read_shape(table, kind, dimension)};
}

// ---- The tables of a case, in the order of the file

Layer read_layer(const TomlTable& table, Context& context) {
  Layer layer;
  layer.name = set_name(table, context);
  std::vector<std::string> sides;
  for (int axis = 0; axis < context.dimension; ++axis)
    for (const char sign : {'-', '+'}) sides.push_back({"xyz"[axis], sign});
  const std::string side = table.one_of("side", sides);
  layer.side = {side[0] - 'x', side[1] == '+' ? 1 : -1};
  layer.thickness = static_cast<int>(table.integer("thickness", 1, 1000, 3));
  layer.where = condition(table, context);
  return layer;
}

Lattice read_lattice(const TomlTable& table, Context& context, double& horizon_ratio) {
  Lattice lattice;
  lattice.dimension = context.dimension;
  lattice.spacing = context.spacing = table.number("spacing", Range::positive("m"));
  horizon_ratio = table.number("horizon_ratio", Range::positive("-"), horizon_ratio);
  if (horizon_ratio < 1.0)
    table.refuse("horizon_ratio",
                 "horizon smaller than the spacing; must be at least 1, usually 3.015");
  lattice.cross_section = cross_section(table, context.dimension);
  lattice.origin = table.choice("origin", lattice_origins, lattice.origin);
  lattice.perturbation =
      table.number("perturbation", Range::between(0.0, 0.49), lattice.perturbation);
  lattice.seed = static_cast<std::uint64_t>(
      table.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));

  for (const auto& shape : table.tables("shape"))
    lattice.shapes.push_back(read_shape_step(shape, context.dimension));
  if (lattice.shapes.empty())
    table.refuse("shape", "this array of tables is missing; a lattice needs at least one shape");
  for (const auto& layer : table.tables("layer"))
    lattice.layers.push_back(read_layer(layer, context));
  return lattice;
}

PointSource read_point_source(const TomlTable& table, Context& context,
                              const std::filesystem::path& case_file) {
  PointSource source;
  const std::filesystem::path file = table.string("file");
  if (file.empty()) table.refuse("file", "is empty");
  source.file = std::filesystem::absolute(case_file.parent_path() / file).lexically_normal();
  std::error_code error;
  if (!std::filesystem::is_regular_file(source.file, error))
    table.refuse("file", "no such file; looked for " + source.file.string());
  source.horizon = table.number("horizon", Range::positive("m"));
  source.cross_section = cross_section(table, context.dimension);
  context.sets_from_file = true;
  return source;
}

SetRule read_set(const TomlTable& table, Context& context) {
  SetRule set;
  set.name = set_name(table, context);
  set.where = condition(table, context);
  if (table.has("shape")) {
    const TomlTable shape = table.table("shape");
    const std::string kind = shape.exactly_one(case_keys().at("set.shape"));
    refuse_other_dimension(shape, kind, kind, context.dimension);
    set.shape = read_shape(shape.table(kind), kind, context.dimension);
  }
  if (set.where.empty() && !set.shape) table.refuse("", "needs a where or a shape");
  return set;
}

/// A stiffness may be negative (auxetic bodies have such), but not remotely large.
Range stiffness(const std::string& unit) {
  return {-1e200, 1e200, "must be a finite number of " + unit};
}

void read_cpd_constants(const TomlTable& table, int dimension, MaterialSpecification& material) {
  for (const char* key : {"plane", "micromodulus"})
    if (table.has(key)) table.refuse(key, "is for model \"bond\"");
  if (dimension == 1)
    table.refuse("model", "cpd needs dimension 2 or 3; in 1D it is the bond model");
  const bool from_moduli = table.exactly_one({"youngs_modulus", "c1"}) == "youngs_modulus";
  if (from_moduli) {
    material.youngs_modulus = table.number("youngs_modulus", Range::positive("Pa"));
    material.poisson_ratio = table.number("poisson_ratio", Range::between(-1.0, 1.0));
    if (dimension == 2 && table.has("c2"))
      table.refuse("c2",
                   "follows from youngs_modulus and poisson_ratio in 2D; give c1 for a free c2");
    if (table.has("c3"))
      table.refuse("c3", "follows from youngs_modulus and poisson_ratio; give c1 for a free c3");
  } else {
    material.c1 = table.number("c1", Range::positive("N/m6", 1e200));
    for (const char* key : {"poisson_ratio", "calibration"})
      if (table.has(key)) table.refuse(key, "goes with youngs_modulus, not with c1");
  }
  material.c2 = table.number("c2", stiffness("N/m10"), material.c2);
  material.c3 = table.number("c3", stiffness("N/m14"), material.c3);
  if (dimension == 2 && material.c3 != 0.0)
    table.refuse("c3", "must be 0 in 2D: three neighbours of a point in a plane span no volume");
  material.calibration = table.choice("calibration", calibrations, material.calibration);
}

MaterialSpecification read_material(const TomlTable& table, int dimension) {
  MaterialSpecification material;
  material.model = table.choice("model", material_models, material.model);
  if (table.has("density")) material.density = table.number("density", Range::positive("kg/m3"));
  if (material.model == MaterialModel::cpd) {
    read_cpd_constants(table, dimension, material);
    return material;
  }
  for (const char* key : {"poisson_ratio", "c1", "c2", "c3", "calibration"})
    if (table.has(key)) table.refuse(key, "is for model \"cpd\"");
  if (dimension != 2 && table.has("plane")) table.refuse("plane", "is for dimension 2 only");
  material.plane = table.choice("plane", plane_states, material.plane);
  if (table.exactly_one({"youngs_modulus", "micromodulus"}) == "youngs_modulus")
    material.youngs_modulus = table.number("youngs_modulus", Range::positive("Pa"));
  else
    material.micromodulus = table.number("micromodulus", Range::positive("N/m6", 1e150));
  return material;
}

DamageSpecification read_damage(const TomlTable& table, const Context& context) {
  DamageSpecification damage;
  damage.law = table.choice("law", damage_laws, damage.law);
  for (const std::string& set : table.strings("no_fail")) {
    if (context.names.count(set) == 0 && !context.sets_from_file)
      table.refuse("no_fail", "there is no set or layer \"" + set + "\"");
    damage.no_fail.push_back(set);
  }
  if (damage.law == DamageLaw::none) return damage;
  damage.critical = table.number("critical", Range::between(1e-9, 1e3));
  if (damage.law == DamageLaw::critical_stretch) {
    for (const char* key : {"onset", "rate"})
      if (table.has(key)) table.refuse(key, "is for the tanh laws");
    return damage;
  }
  damage.onset = table.number("onset", Range::between(1e-9, 1e3));
  if (!(damage.onset < damage.critical * (1.0 - 1e-9)))
    table.refuse("onset", "must be smaller than critical");
  damage.rate = table.number("rate", Range::between(0.1, 50.0), damage.rate);
  return damage;
}

Crack read_crack(const TomlTable& table, int dimension) {
  Crack crack;
  if (dimension == 2) {
    if (table.has("vertices")) table.refuse("vertices", "is for dimension 3; 2D has from and to");
    crack = CrackSegment{coordinates(table, "from", 2), coordinates(table, "to", 2)};
  } else if (dimension == 3) {
    for (const char* key : {"from", "to"})
      if (table.has(key)) table.refuse(key, "is for dimension 2; 3D has vertices");
    crack = CrackPolygon{table.triples("vertices")};
  } else {
    table.refuse("", "there are no cracks in dimension 1; subtract a box instead");
  }
  check_crack(crack, dimension, table.path());
  return crack;
}

SupportSpecification read_support(const TomlTable& table, const Context& context) {
  SupportSpecification support;
  support.set = known_set(table, context);
  const auto components =
      table.components("displacement", static_cast<std::size_t>(context.dimension));
  bool all_free = true;
  for (std::size_t c = 0; c < components.size(); ++c) {
    if (components[c] == "free") continue;
    all_free = false;
    check_component(table, "displacement", c, components[c], context, Variables::place_and_load);
    support.displacement[c] = components[c];
  }
  if (all_free) table.refuse("displacement", "every component is free, so this supports nothing");
  return support;
}

LoadSpecification read_load(const TomlTable& table, const Context& context) {
  LoadSpecification load;
  load.set = known_set(table, context);
  const std::string key = table.exactly_one({"body_force", "total_force"});
  const bool is_density = key == "body_force";
  load.kind =
      is_density ? LoadSpecification::Kind::body_force : LoadSpecification::Kind::total_force;
  const auto components = table.components(key, static_cast<std::size_t>(context.dimension));
  for (std::size_t c = 0; c < components.size(); ++c) {
    if (components[c] == "free")
      table.refuse(key, c, "only displacements of supports can be free; write 0 for no force");
    check_component(table, key, c, components[c], context,
                    is_density ? Variables::place_and_load : Variables::load);
    load.value[c] = components[c];
  }
  return load;
}

LoadingSpecification read_loading(const TomlTable& table) {
  LoadingSpecification loading;
  loading.steps = static_cast<int>(table.integer("steps", 1, 1'000'000, loading.steps));
  loading.adaptive = table.boolean("adaptive", loading.adaptive);
  const double step = 1.0 / loading.steps;
  loading.smallest_step =
      table.number("smallest_step", Range::between(1e-12, 1.0), loading.smallest_step);
  loading.largest_step = table.number("largest_step", Range::between(1e-12, 1.0), step);
  if (loading.smallest_step > step)
    table.refuse("smallest_step", "must not be larger than the first step, 1 / steps");
  if (loading.largest_step < step)
    table.refuse("largest_step", "must not be smaller than the first step, 1 / steps");
  loading.max_broken_bonds = static_cast<int>(
      table.integer("max_broken_bonds", 0, 1'000'000'000, loading.max_broken_bonds));
  return loading;
}

SolverSpecification read_solver(const TomlTable& table) {
  SolverSpecification solver;
  solver.mode = table.choice("mode", modes, solver.mode);
  solver.linear = table.choice("linear", linear_methods, solver.linear);
  solver.preconditioner =
      table.choice("preconditioner", preconditioner_kinds, solver.preconditioner);
  if (solver.linear == LinearMethod::cholesky &&
      solver.preconditioner != PreconditionerKind::automatic)
    table.refuse("preconditioner",
                 "is for iterative solvers, not for solver.linear = \"cholesky\"");
  // Who names a preconditioner wants it used.
  if (solver.linear == LinearMethod::automatic &&
      solver.preconditioner != PreconditionerKind::automatic)
    solver.linear = LinearMethod::conjugate_gradients;
  solver.tangent = table.choice("tangent", tangent_storages, solver.tangent);
  if (solver.tangent == TangentStorage::matrix_free &&
      !can_be_matrix_free({solver.linear, solver.preconditioner}))
    table.refuse("tangent",
                 "does not go with this solver.linear or solver.preconditioner, which "
                 "need the stored tangent");
  solver.predictor = table.choice("predictor", predictors, solver.predictor);
  solver.projection = table.choice("projection", projections, solver.projection);
  solver.relative_tolerance =
      table.number("relative_tolerance", Range::between(1e-14, 1e-2), solver.relative_tolerance);
  solver.max_iterations =
      static_cast<int>(table.integer("max_iterations", 1, 1000, solver.max_iterations));
  solver.linear_tolerance =
      table.number("linear_tolerance", Range::between(1e-14, 1e-1), solver.linear_tolerance);
  solver.fragments = table.choice("fragments", fragment_remedies, solver.fragments);
  if (table.has("elastic_horizon_ratio"))
    solver.elastic_horizon_ratio = table.number("elastic_horizon_ratio", Range::between(1.0, 1e3));
  return solver;
}

RelaxationSpecification read_relaxation(const TomlTable& table, int default_steps,
                                        double relative_tolerance) {
  RelaxationSpecification relaxation;
  RelaxationOptions& options = relaxation.options;
  const auto count = [&](const char* key, std::int64_t low, int fallback) {
    return static_cast<int>(table.integer(key, low, 1'000'000'000, fallback));
  };
  relaxation.moving = table.one_of("load", {"fixed", "moving"}, "fixed") == "moving";
  relaxation.steps = count("steps", 1, default_steps);
  if (relaxation.moving) {
    for (const char* key : {"ramp", "quiet_iterations"})
      if (table.has(key)) table.refuse(key, "is for load = \"fixed\"");
    relaxation.iterations = count("iterations", 1, relaxation.iterations);
    if (relaxation.iterations < relaxation.steps)
      table.refuse("iterations", "must not be fewer than relaxation.steps");
    if (relaxation.iterations % relaxation.steps != 0)
      table.refuse("iterations",
                   "must be a multiple of relaxation.steps, " + std::to_string(relaxation.steps));
  } else if (table.has("iterations")) {
    table.refuse("iterations", "is for load = \"moving\"");
  }
  options.holds = !relaxation.moving;
  options.ramp =
      relaxation.moving ? relaxation.iterations / relaxation.steps : count("ramp", 1, options.ramp);
  options.breaking = table.choice("breaking", breakings,
                                  relaxation.moving ? Breaking::transient : options.breaking);
  // A moving load is the published procedure.
  options.damping =
      table.choice("damping", dampings, relaxation.moving ? Damping::adaptive : options.damping);
  const double mass_factor = options.damping == Damping::adaptive ? 1.0 : options.mass_factor;
  options.mass_factor = table.number("mass_factor", Range::between(1.0, 1e6), mass_factor);
  options.max_iterations = count("max_iterations", 1, options.max_iterations);
  options.quiet_iterations = count("quiet_iterations", 0, options.quiet_iterations);
  options.displacement_tolerance = table.number("displacement_tolerance", Range::between(0.0, 1.0),
                                                options.displacement_tolerance);
  options.relative_tolerance = relative_tolerance;
  return relaxation;
}

/// results/FOLDER_STEM, so that shipped cases of one name in several folders don't collide.
std::filesystem::path default_directory(const std::filesystem::path& case_file) {
  const auto absolute = std::filesystem::absolute(case_file).lexically_normal();
  const std::string folder = absolute.parent_path().filename().string();
  const std::string stem = absolute.stem().string();
  return std::filesystem::path("results") / (folder.empty() ? stem : folder + "_" + stem);
}

OutputSpecification read_output(const TomlTable& table, const std::filesystem::path& case_file) {
  OutputSpecification output;
  output.directory = table.string("directory", default_directory(case_file).string());
  if (output.directory.empty()) table.refuse("directory", "is empty");
  output.every = static_cast<int>(table.integer("every", 1, 1'000'000'000, output.every));
  output.count_cracks = table.boolean("count_cracks", output.count_cracks);
  return output;
}

ProbeSpecification read_probe(const TomlTable& table, const Context& context,
                              std::set<std::string>& names) {
  ProbeSpecification probe;
  probe.name = name(table);
  if (!names.insert(probe.name).second) table.refuse("name", "another probe has this name");
  probe.set = known_set(table, context);
  probe.field = table.one_of("field",
                             {"displacement", "force", "damage", "stretch", "energy_density",
                              "poisson_ratio", "opening", "crack_length"},
                             probe.field);
  const bool is_ratio = probe.field == "poisson_ratio", is_length = probe.field == "crack_length";
  if (is_ratio && context.dimension == 1)
    table.refuse("field", "there is no Poisson's ratio in dimension 1");
  if (!is_ratio && !is_length && table.has("axis"))
    table.refuse("axis", "is for fields \"poisson_ratio\" and \"crack_length\"");
  if (probe.field == "opening")
    probe.other = known_set(table, context, "other");
  else if (table.has("other"))
    table.refuse("other", "is for field \"opening\"");
  const std::vector<std::string> axes{"x", "y", "z"};
  const std::vector<std::string> present(axes.begin(), axes.begin() + context.dimension);
  probe.axis = table.one_of("axis", present, "x")[0] - 'x';
  return probe;
}

// ---- Places

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

// ---- The document

void read_document(const TomlValue& document, const std::filesystem::path& file, Case& result) {
  const TomlTable root(document, "", result.file);
  const TomlValue no_entries;
  const auto optional_table = [&](const std::string& key) {
    return root.has(key) ? root.table(key) : TomlTable(no_entries, key, result.file);
  };

  result.title = root.string("title", file.stem().string());
  result.dimension = static_cast<int>(root.integer("dimension", 1, 3));
  Context context;
  context.dimension = result.dimension;
  if (root.exactly_one({"lattice", "points"}) == "lattice")
    result.body = read_lattice(root.table("lattice"), context, result.horizon_ratio);
  else
    result.body = read_point_source(root.table("points"), context, file);
  for (const auto& set : root.tables("set")) result.sets.push_back(read_set(set, context));

  const TomlTable quadrature = optional_table("quadrature");
  result.volume_correction =
      quadrature.choice("volume_correction", volume_corrections, result.volume_correction);
  result.surface_correction =
      quadrature.choice("surface_correction", surface_corrections, result.surface_correction);

  result.weights = quadrature.choice("weights", interaction_weights, result.weights);

  for (const auto& crack : root.tables("crack"))
    result.cracks.push_back(read_crack(crack, result.dimension));

  const TomlTable material = root.table("material");
  result.material = read_material(material, result.dimension);
  if (material.has("damage"))
    result.material.damage = read_damage(material.table("damage"), context);
  const bool is_cpd = result.material.model == MaterialModel::cpd;
  const std::vector<std::string> not_of_model =
      is_cpd ? std::vector<std::string>{"volume_correction", "surface_correction"}
             : std::vector<std::string>{"weights"};
  for (const auto& key : not_of_model) {
    if (!quadrature.has(key) || quadrature.string(key) == "none") continue;
    quadrature.refuse(key, is_cpd ? "is for model \"bond\"; the effective volumes of cpd need none"
                                  : "is for model \"cpd\"");
  }
  for (const auto& support : root.tables("support"))
    result.supports.push_back(read_support(support, context));
  for (const auto& load : root.tables("load")) result.loads.push_back(read_load(load, context));
  result.loading = read_loading(optional_table("loading"));
  result.solver = read_solver(optional_table("solver"));
  if (result.solver.tangent == TangentStorage::matrix_free &&
      result.material.model != MaterialModel::bond)
    optional_table("solver").refuse("tangent", "is for material.model = \"bond\"");
  if (result.solver.elastic_horizon_ratio > 0.0 && result.material.damage.law == DamageLaw::none)
    optional_table("solver").refuse(
        "elastic_horizon_ratio",
        "is for bodies with damage: the stand-in takes the place of the body until damage begins, "
        "and without damage it would do so to the end");
  // Damage grows in steps that are smaller than elastic ones.
  constexpr int steps_of_damage = 50;
  const bool hands_over =
      result.solver.mode == Mode::adaptive && result.material.damage.law != DamageLaw::none;
  result.relaxation = read_relaxation(
      optional_table("relaxation"),
      hands_over ? std::max(result.loading.steps, steps_of_damage) : result.loading.steps,
      result.solver.relative_tolerance);
  result.output = read_output(optional_table("output"), file);
  std::set<std::string> probe_names;
  for (const auto& probe : root.tables("probe"))
    result.probes.push_back(read_probe(probe, context, probe_names));
}

}  // namespace

Case read_case(const std::filesystem::path& file,
               const std::vector<std::pair<std::string, std::string>>& overrides) {
  Case result;
  result.file = file.string();
  result.as_read = read_case_text(file);

  TomlValue document = parse_toml(result.as_read, result.file);
  for (const auto& [key, value] : overrides) apply_override(document, key, value);
  collect_locations(document, "", result.locations);
  try {
    read_document(document, file, result);
  } catch (const InputError& error) {
    throw located(result, error);
  }
  result.as_resolved = resolved_text(result);
  return result;
}

std::string located(const Case& from, const std::string& key, const std::string& message) {
  return location_of(from, key).text(from.file) + ": " + message;
}

InputError located(const Case& from, const InputError& error) {
  if (!error.place().empty()) return error;
  return InputError(error.key(), error.value(), error.allowed(),
                    location_of(from, error.key()).text(from.file));
}

}  // namespace peristat
