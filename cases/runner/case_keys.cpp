#include "cases/runner/case_keys.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <tuple>
#include <variant>

#include "cases/runner/key_kinds.hpp"

namespace peristat {
namespace {

// ---- Names of values

const Choices<LatticeOrigin> lattice_origins{{"cell_centres", LatticeOrigin::cell_centres},
                                             {"nodes", LatticeOrigin::nodes}};
const Choices<VolumeCorrection> volume_corrections{{"none", VolumeCorrection::none},
                                                   {"linear", VolumeCorrection::linear}};
const Choices<SurfaceCorrection> surface_corrections{{"none", SurfaceCorrection::none},
                                                     {"volume", SurfaceCorrection::volume},
                                                     {"energy", SurfaceCorrection::energy}};
const Choices<InteractionWeights> interaction_weights{{"mean", InteractionWeights::mean},
                                                      {"bulk", InteractionWeights::bulk}};
const Choices<MaterialModel> material_models{{"bond", MaterialModel::bond},
                                             {"cpd", MaterialModel::cpd}};
const Choices<Calibration> calibrations{{"lattice", Calibration::lattice},
                                        {"continuum", Calibration::continuum}};
const Choices<PlaneState> plane_states{{"stress", PlaneState::stress},
                                       {"strain", PlaneState::strain}};
const Choices<DamageLaw> damage_laws{{"none", DamageLaw::none},
                                     {"critical_stretch", DamageLaw::critical_stretch},
                                     {"tanh", DamageLaw::tanh},
                                     {"tanh_continuous", DamageLaw::tanh_continuous}};
const Choices<Mode> modes{
    {"newton", Mode::newton}, {"relaxation", Mode::relaxation}, {"adaptive", Mode::adaptive}};
const Choices<LinearMethod> linear_methods{{"auto", LinearMethod::automatic},
                                           {"cholesky", LinearMethod::cholesky},
                                           {"pcg", LinearMethod::conjugate_gradients},
                                           {"minres", LinearMethod::minres},
                                           {"gmres", LinearMethod::gmres}};
const Choices<PreconditionerKind> preconditioner_kinds{
    {"auto", PreconditionerKind::automatic},
    {"jacobi", PreconditionerKind::jacobi},
    {"block_jacobi", PreconditionerKind::block_jacobi},
    {"rigid_pieces", PreconditionerKind::rigid_pieces},
    {"surrogate", PreconditionerKind::surrogate},
    {"riluk", PreconditionerKind::riluk},
    {"chebyshev", PreconditionerKind::chebyshev},
    {"multigrid", PreconditionerKind::multigrid}};
const Choices<TangentStorage> tangent_storages{{"auto", TangentStorage::automatic},
                                               {"stored", TangentStorage::stored},
                                               {"matrix_free", TangentStorage::matrix_free}};
const Choices<Predictor> predictors{{"consistent", Predictor::consistent},
                                    {"none", Predictor::none}};
const Choices<Projection> projections{
    {"auto", Projection::automatic}, {"never", Projection::never}, {"always", Projection::always}};
const Choices<FragmentRemedy> fragment_remedies{{"hold", FragmentRemedy::hold},
                                                {"remove", FragmentRemedy::remove},
                                                {"stop", FragmentRemedy::stop}};
const Choices<bool> load_motions{{"fixed", false}, {"moving", true}};
const Choices<Breaking> breakings{{"at_equilibrium", Breaking::at_equilibrium},
                                  {"transient", Breaking::transient}};
const Choices<Damping> dampings{{"adaptive", Damping::adaptive}, {"kinetic", Damping::kinetic}};

// ---- Conditions and members that several tables share

template <int dimension>
constexpr auto is_dimension =
    [](const auto&, const Case& from) { return from.dimension == dimension; };

bool is_cpd(const Case& from) { return from.material.model == MaterialModel::cpd; }

constexpr auto itself = [](auto& spec) -> auto& { return spec; };
constexpr auto lattice = [](auto& from) -> auto& { return std::get<Lattice>(from.body); };
constexpr auto points = [](auto& from) -> auto& { return std::get<PointSource>(from.body); };

template <class Member>
Key<Case> thickness(Member cross_section) {
  return Key<Case>("thickness", cross_section, positive("m"), "of the plate, dimension 2 only")
      .unless(is_dimension<1>, "is for dimension 2; dimension 1 has an area")
      .unless(is_dimension<3>, "is for dimension 2 only");
}

template <class Member>
Key<Case> area(Member cross_section) {
  return Key<Case>("area", cross_section, positive("m2"),
                   "cross section of the bar, dimension 1 only")
      .unless(is_dimension<2>, "is for dimension 1; dimension 2 has a thickness")
      .unless(is_dimension<3>, "is for dimension 1 only");
}

template <class Spec>
Key<Spec> where_key(const std::string& meaning, const std::string& fallback) {
  return Key<Spec>("where", &Spec::where, condition(), meaning)
      .written_if([](const Spec& spec, const Case&) { return !spec.where.empty(); })
      .default_words(fallback);
}

// ---- Shapes

const Table<Box>& keys_of(const Box&) {
  static const Table<Box> table{
      "set.shape.box",
      {Key<Box>("min", &Box::min, coordinates(), "box: lower corner")
           .moreover("below `max`")
           .required(),
       Key<Box>("max", &Box::max, coordinates(), "box: upper corner").required()}};
  return table;
}

template <class Round>
Key<Round> centre() {
  return Key<Round>("centre", &Round::centre, coordinates(), "disk, cylinder, sphere").required();
}

template <class Round>
Key<Round> radius() {
  return Key<Round>("radius", &Round::radius, positive("m"), "disk, cylinder, sphere").required();
}

const Table<Disk>& keys_of(const Disk&) {
  static const Table<Disk> table{"set.shape.disk", {centre<Disk>(), radius<Disk>()}};
  return table;
}

const Table<Cylinder>& keys_of(const Cylinder&) {
  static const Table<Cylinder> table{
      "set.shape.cylinder",
      {centre<Cylinder>(),
       Key<Cylinder>("axis", &Cylinder::axis, coordinates(), "cylinder: direction")
           .moreover("not zero")
           .default_words("`[0, 0, 1]`")
           .listed_after("radius"),
       radius<Cylinder>(),
       Key<Cylinder>("length", &Cylinder::length,
                     positive("m", std::numeric_limits<double>::infinity()),
                     "cylinder: along its axis, half of it to each side of the centre")
           .moreover("finite if it is added")
           .default_words("infinite")}};
  return table;
}

const Table<Sphere>& keys_of(const Sphere&) {
  static const Table<Sphere> table{"set.shape.sphere", {centre<Sphere>(), radius<Sphere>()}};
  return table;
}

const Table<Polygon>& keys_of(const Polygon&) {
  static const Table<Polygon> table{
      "set.shape.polygon",
      {Key<Polygon>("vertices", &Polygon::vertices, pairs(),
                    "polygon: corners in order, the last is joined to the first")
           .moreover("that enclose an area")
           .required()}};
  return table;
}

/// Does something with one shape of every kind.
template <class Action>
void for_each_shape(const Action& action) {
  std::apply([&](const auto&... shape) { (action(shape), ...); },
             std::tuple<Box, Disk, Cylinder, Sphere, Polygon>());
}

/// "box" of the table "set.shape.box".
template <class Kind>
std::string kind_of(const Kind& shape) {
  const std::string& table = keys_of(shape).name;
  return table.substr(table.rfind('.') + 1);
}

std::vector<std::string> shape_kinds() {
  std::vector<std::string> kinds;
  for_each_shape([&](const auto& shape) { kinds.push_back(kind_of(shape)); });
  return kinds;
}

/// Kinds of shapes that a body of this dimension can have.
std::vector<std::string> shape_kinds(int dimension) {
  if (dimension == 1) return {"box"};
  if (dimension == 2) return {"box", "disk", "polygon"};
  return {"box", "cylinder", "sphere", "polygon"};
}

void refuse_other_dimension(const TomlTable& from, const std::string& key, const std::string& kind,
                            int dimension) {
  const auto all = shape_kinds(), allowed = shape_kinds(dimension);
  if (std::count(all.begin(), all.end(), kind) == 0 ||
      std::count(allowed.begin(), allowed.end(), kind) > 0)
    return;
  from.refuse(key, "there is no " + kind + " in dimension " + std::to_string(dimension) +
                       "  (allowed: " + listed(allowed) + ")");
}

Shape read_shape(const TomlTable& from, const std::string& kind, const Case& so_far) {
  Shape result;
  for_each_shape([&](auto shape) {
    if (kind_of(shape) != kind) return;
    keys_of(shape).read(from, shape, so_far);
    result = shape;
  });
  check_shape(result, so_far.dimension, from.path(), from.path());
  return result;
}

std::string shape_lines(const Shape& shape, const Case& from) {
  return std::visit([&](const auto& kind) { return keys_of(kind).lines(kind, from); }, shape);
}

/// A shape's kind, its keys beside it in the table.
Kind<Shape> shape_beside() {
  const auto read = [](const TomlTable& from, const std::string& key, const Case& so_far) {
    refuse_other_dimension(from, key, from.string(key), so_far.dimension);
    const std::string kind = from.one_of(key, shape_kinds(so_far.dimension));
    std::vector<std::string> keys = case_keys().at("set.shape." + kind);
    keys.insert(keys.begin(), key);
    from.allow_only(keys, "is no key of a " + kind);
    return read_shape(from, kind, so_far);
  };
  const auto text = [](const Shape& shape, const Case& from) {
    const std::string lines = shape_lines(shape, from);
    return toml_string(std::visit([](const auto& kind) { return kind_of(kind); }, shape)) + "\n" +
           lines.substr(0, lines.size() - 1);
  };
  return {read, text,
          "`\"box\"` (1D, 2D, 3D), `\"disk\"` (2D), `\"polygon\"` (2D; in 3D, where it has no end "
          "in z, only to subtract), `\"cylinder\"`, `\"sphere\"` (3D)",
          ""};
}

/// A shape in a table of its own: { box = { min = …, max = … } }
Kind<Shape> shape_inside() {
  const auto read = [](const TomlTable& from, const std::string& key, const Case& so_far) {
    const TomlTable shape = from.table(key);
    const std::string kind = shape.exactly_one(shape_kinds());
    refuse_other_dimension(shape, kind, kind, so_far.dimension);
    return read_shape(shape.table(kind), kind, so_far);
  };
  const auto text = [](const Shape& shape, const Case& from) {
    std::string inside = shape_lines(shape, from);
    inside.pop_back();
    for (std::size_t end; (end = inside.find('\n')) != std::string::npos;)
      inside.replace(end, 1, ", ");
    return "{ " + std::visit([](const auto& kind) { return kind_of(kind); }, shape) + " = { " +
           inside + " } }";
  };
  return {read, text, "one of `" + listed(shape_kinds()) + "`", ""};
}

const Table<ShapeStep>& shape_step_keys() {
  using Step = ShapeStep;
  using Action = ShapeStep::Action;
  static const Table<Step> table = [] {
    const auto is = [](Action action) {
      return [=](const Step& step, const Case&) { return step.action == action; };
    };
    Table<Step> keys{
        "lattice.shape",
        {Key<Step>("add", &Step::shape, shape_beside(), "kind of the shape to add")
             .written_if(is(Action::add))
             .one_of(),
         Key<Step>("subtract", &Step::shape, shape_beside(), "kind of the shape to take away")
             .then(
                 [](const TomlTable&, Step& step, const Case&) { step.action = Action::subtract; })
             .written_if(is(Action::subtract))
             .one_of()}};
    return keys;
  }();
  return table;
}

// ---- The body

const Table<Layer>& layer_keys() {
  const auto read_side = [](const TomlTable& from, const std::string& key, const Case& so_far) {
    std::vector<std::string> sides;
    for (int axis = 0; axis < so_far.dimension; ++axis)
      for (const char sign : {'-', '+'}) sides.push_back({"xyz"[axis], sign});
    const std::string side = from.one_of(key, sides);
    return Side{side[0] - 'x', side[1] == '+' ? 1 : -1};
  };
  const auto side_text = [](const Side& side, const Case&) {
    return toml_string(std::string(1, "xyz"[side.axis]) + (side.sign > 0 ? "+" : "-"));
  };
  const Kind<Side> side{read_side, side_text, "`\"x-\"`, `\"x+\"`, and so on for y and z", ""};
  static const Table<Layer> table{
      "lattice.layer",
      {Key<Layer>("name", &Layer::name, set_name(), "of the layer and of its set").required(),
       Key<Layer>("side", &Layer::side, side, "of the body").required(),
       Key<Layer>("thickness", &Layer::thickness, integer(1, 1000, "spacings"), "number of planes"),
       where_key<Layer>("expression that keeps a part of the layer", "all of it")}};
  return table;
}

const Table<Case>& lattice_keys() {
  static const Table<Case> table{
      "lattice",
      {Key<Case>("spacing", in(lattice, &Lattice::spacing), positive("m"),
                 "distance of neighbouring points")
           .required(),
       Key<Case>("horizon_ratio", &Case::horizon_ratio, positive("-"), "horizon / spacing")
           .then([](const TomlTable& from, Case& result, const Case&) {
             if (result.horizon_ratio < 1.0)
               from.refuse("horizon_ratio",
                           "horizon smaller than the spacing; must be at least 1, usually 3.015");
           })
           .moreover("1 to 1000, in 3D to 100; with model `cpd` to 50 in 2D, to 8 in 3D"),
       thickness(in(lattice, &Lattice::cross_section)), area(in(lattice, &Lattice::cross_section)),
       Key<Case>("origin", in(lattice, &Lattice::origin), choice(lattice_origins),
                 "where points stand relative to the lower corner of the first shape: cells' "
                 "centres, half a spacing inside, or the corner itself"),
       Key<Case>("perturbation", in(lattice, &Lattice::perturbation), between(0.0, 0.49),
                 "largest random shift of a point per component, in spacings; points of layers "
                 "stay"),
       Key<Case>("seed", in(lattice, &Lattice::seed),
                 integer(0, std::numeric_limits<std::int64_t>::max()),
                 "of the random shifts; the same seed gives the same points"),
       Key<Case>("shape", in(lattice, &Lattice::shapes), shape_step_keys(), "tables: the body")
           .then([](const TomlTable& from, Case& result, const Case&) {
             if (lattice(result).shapes.empty())
               from.refuse("shape",
                           "this array of tables is missing; a lattice needs at least one shape");
           })
           .default_words("at least one is required"),
       Key<Case>("layer", in(lattice, &Lattice::layers), layer_keys(),
                 "tables: points outside the body")},
      [](const TomlTable&, Case& result, const Case&) {
        result.body = Lattice();
        lattice(result).dimension = result.dimension;
      }};
  return table;
}

Kind<std::filesystem::path> existing_file() {
  const auto read = [](const TomlTable& from, const std::string& key, const Case& so_far) {
    const std::filesystem::path given = from.string(key);
    if (given.empty()) from.refuse(key, "is empty");
    const auto folder = std::filesystem::path(so_far.file).parent_path();
    const auto file = std::filesystem::absolute(folder / given).lexically_normal();
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
      from.refuse(key, "no such file; looked for " + file.string());
    return file;
  };
  return {read,
          [](const std::filesystem::path& file, const Case&) { return toml_string(file.string()); },
          "an existing file", ""};
}

const Table<Case>& points_keys() {
  static const Table<Case> table{
      "points",
      {Key<Case>("file", in(points, &PointSource::file), existing_file(),
                 "comma- or blank-separated text, relative to the case file's folder")
           .required(),
       Key<Case>("horizon", in(points, &PointSource::horizon), positive("m"),
                 "the same for every point")
           .moreover("at least the mean spacing; at most as many mean spacings as "
                     "`lattice.horizon_ratio` allows")
           .required(),
       thickness(in(points, &PointSource::cross_section)).default_words("1"),
       area(in(points, &PointSource::cross_section)).default_words("1")},
      [](const TomlTable&, Case& result, const Case&) { result.body = PointSource(); }};
  return table;
}

const Table<SetRule>& set_keys() {
  static const Table<SetRule> table{
      "set",
      {Key<SetRule>("name", &SetRule::name, set_name(), "of the set").required(),
       where_key<SetRule>("expression, true where it is not zero", "this or `shape` is required"),
       Key<SetRule>("shape", &SetRule::shape, shape_inside(),
                    "a shape with its keys, as in `[[lattice.shape]]`: "
                    "`{ box = { min = [0, 0], max = [1, 1] } }`")
           .describes([](std::vector<TableDescription>& all) {
             all.push_back({"set.shape", false, {}, shape_kinds()});
             for_each_shape([&](const auto& shape) { keys_of(shape).describe(all); });
           })
           .default_words("this or `where` is required")},
      {},
      [](const TomlTable& from, SetRule& set, const Case&) {
        if (set.where.empty() && !set.shape) from.refuse("", "needs a where or a shape");
      }};
  return table;
}

const Table<Crack>& crack_keys() {
  constexpr auto segment = [](auto& crack) -> auto& { return std::get<CrackSegment>(crack); };
  constexpr auto polygon = [](auto& crack) -> auto& { return std::get<CrackPolygon>(crack); };
  static const Table<Crack> table{
      "crack",
      {Key<Crack>("from", in(segment, &CrackSegment::from), coordinates(), "2D: one end")
           .unless(is_dimension<3>, "is for dimension 2; 3D has vertices")
           .required("required in 2D"),
       Key<Crack>("to", in(segment, &CrackSegment::to), coordinates(), "2D: the other end")
           .unless(is_dimension<3>, "is for dimension 2; 3D has vertices")
           .moreover("not `from`")
           .required("required in 2D"),
       Key<Crack>("vertices", in(polygon, &CrackPolygon::vertices), triples(),
                  "3D: corners in order, the last is joined to the first")
           .unless(is_dimension<2>, "is for dimension 3; 2D has from and to")
           .moreover("in one plane (to 10⁻⁹ of the extent) that enclose an area; edges must not "
                     "cross or touch")
           .required("required in 3D")},
      [](const TomlTable& from, Crack& crack, const Case& so_far) {
        if (so_far.dimension == 1)
          from.refuse("", "there are no cracks in dimension 1; subtract a box instead");
        if (so_far.dimension == 3) crack = CrackPolygon();
      },
      [](const TomlTable& from, Crack& crack, const Case& so_far) {
        check_crack(crack, so_far.dimension, from.path());
      }};
  return table;
}

// ---- The material

const Table<Case>& quadrature_keys() {
  const auto of_cpd = [](const Case& from, const Case&) { return is_cpd(from); };
  const auto of_bond = [](const Case& from, const Case&) { return !is_cpd(from); };
  static const Table<Case> table{
      "quadrature",
      {Key<Case>("volume_correction", &Case::volume_correction, choice(volume_corrections),
                 "share of a neighbour's volume that counts near the edge of the horizon: all, or "
                 "linear over half a spacing to either side")
           .written_if(of_bond),
       Key<Case>("surface_correction", &Case::surface_correction, choice(surface_corrections),
                 "factor that restores the stiffness of points whose neighbourhood is cut by a "
                 "surface: none, by the volume of the neighbourhood, or by the energy of simple "
                 "deformations")
           .written_if(of_bond),
       Key<Case>("weights", &Case::weights, choice(interaction_weights),
                 "model `cpd`: weights of interactions near surfaces, by the mean of their points' "
                 "effective volumes, or as in the bulk everywhere")
           .written_if(of_cpd)}};
  return table;
}

/// The quadrature is read before the material.
void check_quadrature_of_model(const TomlTable& root, Case& result, const Case&) {
  if (!root.has("quadrature")) return;
  const TomlTable quadrature = root.table("quadrature");
  const std::vector<std::string> not_of_model =
      is_cpd(result) ? std::vector<std::string>{"volume_correction", "surface_correction"}
                     : std::vector<std::string>{"weights"};
  for (const auto& key : not_of_model) {
    if (!quadrature.has(key) || quadrature.string(key) == "none") continue;
    quadrature.refuse(key, is_cpd(result)
                               ? "is for model \"bond\"; the effective volumes of cpd need none"
                               : "is for model \"cpd\"");
  }
}

const Table<DamageSpecification>& damage_keys() {
  using Damage = DamageSpecification;
  const auto has_none = [](const Damage& damage, const Case&) {
    return damage.law == DamageLaw::none;
  };
  const auto is_sudden = [](const Damage& damage, const Case&) {
    return damage.law == DamageLaw::critical_stretch;
  };
  static const Table<Damage> table{
      "material.damage",
      {Key<Damage>("law", &Damage::law, choice(damage_laws),
                   "no damage; whole up to `critical` and then broken; softening from `onset` to "
                   "`critical` as published in [ADAPT], which jumps by (1 − tanh `rate`)/2 at both "
                   "ends; the same law rescaled so that it does not jump")
           .early(),
       Key<Damage>("critical", &Damage::critical, between(1e-9, 1e3, "1"),
                   "stretch $s_c$ from which on a bond is broken")
           .unless(has_none, "")
           .required("required with a law")
           .listed_after("onset"),
       Key<Damage>("onset", &Damage::onset, between(1e-9, 1e3, "1"),
                   "tanh laws: stretch $s_m$ beyond which a bond loses stiffness")
           .unless(has_none, "")
           .unless(is_sudden, "is for the tanh laws")
           .then([](const TomlTable& from, Damage& damage, const Case&) {
             if (!(damage.onset < damage.critical * (1.0 - 1e-9)))
               from.refuse("onset", "must be smaller than critical");
           })
           .moreover("below `critical`")
           .required("required with a tanh law"),
       Key<Damage>("rate", &Damage::rate, between(0.1, 50.0, "1"),
                   "tanh laws: $\\beta$, how much of the softening falls on the middle between the "
                   "two stretches")
           .unless(has_none, "")
           .unless(is_sudden, "is for the tanh laws"),
       Key<Damage>("no_fail", &Damage::no_fail, known_sets(),
                   "sets whose points' bonds stay elastic at any stretch, also those to points "
                   "outside the sets")
           .written_if(
               [](const Damage& damage, const Case&) { return damage.law != DamageLaw::none; })
           .early()}};
  return table;
}

/// A stiffness may be negative (auxetic bodies have such), but not remotely large.
Kind<double> stiffness(const std::string& unit) {
  return number({-1e200, 1e200, "must be a finite number of " + unit}, "any number", unit);
}

const Table<MaterialSpecification>& material_keys() {
  using Material = MaterialSpecification;
  const auto of_cpd = [](const Material& material, const Case&) {
    return material.model == MaterialModel::cpd;
  };
  const auto of_bond = [](const Material& material, const Case&) {
    return material.model == MaterialModel::bond;
  };
  const auto has_moduli = [](const Material& material, const Case&) {
    return material.youngs_modulus.has_value();
  };
  const auto has_plane_moduli = [](const Material& material, const Case& so_far) {
    return material.youngs_modulus.has_value() && so_far.dimension == 2;
  };
  const auto has_constants = [](const Material& material, const Case&) {
    return material.c1.has_value();
  };
  const std::string for_bond = "is for model \"bond\"", for_cpd = "is for model \"cpd\"",
                    with_moduli = "goes with youngs_modulus, not with c1";
  static const Table<Material> table{
      "material",
      {Key<Material>("model", &Material::model, choice(material_models),
                     "bond-based peridynamics, whose Poisson ratio is 1/4 (3D and plane strain) or "
                     "1/3 (plane stress); or continuum-kinematics-inspired peridynamics with one-, "
                     "two- and three-neighbour interactions, dimension 2 and 3")
           .then([](const TomlTable& from, Material& material, const Case& so_far) {
             if (material.model == MaterialModel::cpd && so_far.dimension == 1)
               from.refuse("model", "cpd needs dimension 2 or 3; in 1D it is the bond model");
           })
           .early(),
       Key<Material>("plane", &Material::plane, choice(plane_states),
                     "`bond`: state of a plane body, dimension 2 only (`cpd` in 2D is purely "
                     "two-dimensional, neither)")
           .unless(of_cpd, for_bond)
           .unless(is_dimension<1>, "is for dimension 2 only")
           .unless(is_dimension<3>, "is for dimension 2 only"),
       Key<Material>("youngs_modulus", &Material::youngs_modulus, positive("Pa"), "in both models")
           .one_of(),
       Key<Material>("micromodulus", &Material::micromodulus, positive("N/m6", 1e150),
                     "`bond`: bond constant c of the pairwise force c·stretch")
           .unless(of_cpd, for_bond)
           .one_of(),
       Key<Material>("poisson_ratio", &Material::poisson_ratio, between(-1.0, 1.0),
                     "`cpd`, with `youngs_modulus`")
           .unless(of_bond, for_cpd)
           .unless(has_constants, with_moduli)
           .moreover("in 3D to 0.5, both excluded; with damage from 1/3 (2D) or 1/4 (3D) on")
           .required("required with `youngs_modulus`"),
       Key<Material>("c1", &Material::c1, positive("N/m6", 1e200), "`cpd`: one-neighbour constant")
           .unless(of_bond, for_cpd)
           .one_of(),
       Key<Material>("c2", &Material::c2, stiffness("N/m10"),
                     "`cpd`: two-neighbour constant; in 3D also beside `youngs_modulus`, in 2D it "
                     "then follows")
           .unless(of_bond, for_cpd)
           .unless(has_plane_moduli,
                   "follows from youngs_modulus and poisson_ratio in 2D; give c1 for a free c2")
           .moreover("a negative one is refused with damage, and where it makes the body "
                     "[unstable at rest](theory.md#stability-at-rest)"),
       Key<Material>("c3", &Material::c3, stiffness("N/m14"),
                     "`cpd`: three-neighbour constant, 3D; follows from `youngs_modulus`")
           .unless(of_bond, for_cpd)
           .unless(has_moduli,
                   "follows from youngs_modulus and poisson_ratio; give c1 for a free c3")
           .then([](const TomlTable& from, Material& material, const Case& so_far) {
             if (so_far.dimension == 2 && material.c3 != 0.0)
               from.refuse(
                   "c3", "must be 0 in 2D: three neighbours of a point in a plane span no volume");
           })
           .moreover("a negative one as of `c2`"),
       Key<Material>("calibration", &Material::calibration, choice(calibrations),
                     "`cpd`, with `youngs_modulus`: what the constants reproduce the moduli on, "
                     "this lattice's sums or integrals")
           .unless(of_bond, for_cpd)
           .unless(has_constants, with_moduli),
       Key<Material>("density", &Material::density, positive("kg/m3"),
                     "for dynamics only: dynamic relaxation has a density of its own"),
       Key<Material>("damage", &Material::damage, damage_keys(), "table `[material.damage]`")
           .default_words("no damage")}};
  return table;
}

// ---- Supports and loads

const Table<SupportSpecification>& support_keys() {
  using Support = SupportSpecification;
  static const Table<Support> table{
      "support",
      {Key<Support>("set", &Support::set, known_set(), "that is held or moved").required(),
       Key<Support>("displacement", &Support::displacement, prescribed_components(),
                    "per component")
           .required()}};
  return table;
}

const Table<LoadSpecification>& load_keys() {
  using Load = LoadSpecification;
  const auto is = [](Load::Kind kind) {
    return [=](const Load& load, const Case&) { return load.kind == kind; };
  };
  static const Table<Load> table{
      "load",
      {Key<Load>("set", &Load::set, known_set(), "that is loaded").required().early(),
       Key<Load>("body_force", &Load::value, force_components(false), "force density per component")
           .written_if(is(Load::Kind::body_force))
           .one_of(),
       Key<Load>("total_force", &Load::value, force_components(true),
                 "force on the whole set per component, spread in proportion to the volume")
           .then([](const TomlTable&, Load& load, const Case&) {
             load.kind = Load::Kind::total_force;
           })
           .written_if(is(Load::Kind::total_force))
           .one_of()}};
  return table;
}

// ---- The search for equilibrium

const Table<LoadingSpecification>& loading_keys() {
  using Loading = LoadingSpecification;
  static const Table<Loading> table{
      "loading",
      {Key<Loading>("steps", &Loading::steps, integer(1, 1'000'000),
                    "number of equal steps; 1/steps is the first one"),
       Key<Loading>(
           "adaptive", &Loading::adaptive, boolean(),
           "cut a step that does not converge, and grow again; otherwise such a step ends the run"),
       Key<Loading>("smallest_step", &Loading::smallest_step, between(1e-12, 1.0),
                    "of the load factor; needing a smaller one ends the run")
           .moreover("at most 1/steps"),
       Key<Loading>("largest_step", &Loading::largest_step, between(1e-12, 1.0),
                    "of the load factor, to which steps may grow")
           .otherwise(
               [](Loading& loading, const Case&) { loading.largest_step = 1.0 / loading.steps; },
               "1/steps")
           .then([](const TomlTable& from, Loading& loading, const Case&) {
             const double step = 1.0 / loading.steps;
             if (loading.smallest_step > step)
               from.refuse("smallest_step", "must not be larger than the first step, 1 / steps");
             if (loading.largest_step < step)
               from.refuse("largest_step", "must not be smaller than the first step, 1 / steps");
           })
           .moreover("at least 1/steps"),
       Key<Loading>("max_broken_bonds", &Loading::max_broken_bonds, count_from(0, "bonds"),
                    "mode `newton`: bonds that may break in one step; a step with more is cut. 0 "
                    "is no limit")}};
  return table;
}

const Table<SolverSpecification>& solver_keys() {
  using Solver = SolverSpecification;
  using Action = Key<Solver>::Action;
  const Action check_preconditioner = [](const TomlTable& from, Solver& solver, const Case&) {
    if (solver.preconditioner == PreconditionerKind::automatic) return;
    if (solver.linear == LinearMethod::cholesky)
      from.refuse("preconditioner",
                  "is for iterative solvers, not for solver.linear = \"cholesky\"");
    // Who names a preconditioner wants it used.
    if (solver.linear == LinearMethod::automatic) solver.linear = LinearMethod::conjugate_gradients;
  };
  const Action check_tangent = [](const TomlTable& from, Solver& solver, const Case& so_far) {
    if (solver.tangent != TangentStorage::matrix_free) return;
    if (!can_be_matrix_free({solver.linear, solver.preconditioner}))
      from.refuse("tangent",
                  "does not go with this solver.linear or solver.preconditioner, which "
                  "need the stored tangent");
    if (is_cpd(so_far)) from.refuse("tangent", "is for material.model = \"bond\"");
  };
  const Action check_stand_in = [](const TomlTable& from, Solver& solver, const Case& so_far) {
    if (solver.elastic_horizon_ratio > 0.0 && so_far.material.damage.law == DamageLaw::none)
      from.refuse("elastic_horizon_ratio",
                  "is for bodies with damage: the stand-in takes the place of the body until "
                  "damage begins, and without damage it would do so to the end");
  };
  static const Table<Solver> table{
      "solver",
      {Key<Solver>("mode", &Solver::mode, choice(modes),
                   "implicit throughout; by dynamic relaxation throughout; implicit while no "
                   "damage grows and by relaxation while it does"),
       Key<Solver>("linear", &Solver::linear, choice(linear_methods),
                   "solver of the linear systems ([linear-solvers.md](linear-solvers.md)); "
                   "`\"auto\"` chooses, says why, and falls back where it fails"),
       Key<Solver>("preconditioner", &Solver::preconditioner, choice(preconditioner_kinds),
                   "of the last three, not for `\"cholesky\"`; with `linear = \"auto\"` it means "
                   "`\"pcg\"`; `\"auto\"` is `\"rigid_pieces\"`")
           .then(check_preconditioner),
       Key<Solver>("tangent", &Solver::tangent, choice(tangent_storages),
                   "the tangent's blocks are stored, or computed anew in each product, which takes "
                   "a third of the memory in 3D; for `material.model = \"bond\"` without "
                   "`\"cholesky\"`, `\"riluk\"`, `\"chebyshev\"` and `\"multigrid\"`. `\"auto\"` "
                   "stores for direct solvers")
           .then(check_tangent),
       Key<Solver>("predictor", &Solver::predictor, choice(predictors),
                   "the first iteration of a step linearises about the old state and spreads the "
                   "jump of the supports, or, as in [CPD], about the state after the jump")
           .listed_after("max_iterations"),
       Key<Solver>("projection", &Solver::projection, choice(projections),
                   "of interactions to their positive semidefinite part: when the exact tangent "
                   "has negative pivots or leads nowhere, never, always")
           .listed_after("max_iterations"),
       Key<Solver>("relative_tolerance", &Solver::relative_tolerance, between(1e-14, 1e-2),
                   "of the residual"),
       Key<Solver>("linear_tolerance", &Solver::linear_tolerance, between(1e-14, 1e-1),
                   "largest relative residual that the linear system of a Newton iteration is left "
                   "with. Smaller ones follow by themselves as the search converges; 1e-12 from "
                   "the first iteration on shows the order of convergence undisturbed"),
       Key<Solver>("max_iterations", &Solver::max_iterations, integer(1, 1000),
                   "of Newton in one step"),
       Key<Solver>("fragments", &Solver::fragments, choice(fragment_remedies),
                   "what becomes of pieces that come off: just enough of their degrees of freedom "
                   "are pinned that they cannot move freely; they leave the equations and stay "
                   "where they are (unless a support still moves them: then as `\"hold\"`); the "
                   "run ends with outcome `fragmented`. Points that hang on too few bonds are "
                   "pinned in any case"),
       Key<Solver>("elastic_horizon_ratio", &Solver::elastic_horizon_ratio, between(1.0, 1e3),
                   "mode `adaptive`: horizon / spacing of an elastic body that stands in for the "
                   "real one until damage begins: with a smaller horizon than "
                   "`lattice.horizon_ratio` it is cheaper to solve. Needs model `bond` with "
                   "`youngs_modulus`, which gives both bodies the same modulus, and a damage law: "
                   "without damage the stand-in would never give way")
           .then(check_stand_in)
           .written_if(
               [](const Solver& solver, const Case&) { return solver.elastic_horizon_ratio > 0.0; })
           .moreover("in 3D to 100")
           .default_words("no stand-in")}};
  return table;
}

/// Damage grows in steps that are smaller than elastic ones.
int default_relaxation_steps(const Case& from) {
  constexpr int steps_of_damage = 50;
  const bool hands_over =
      from.solver.mode == Mode::adaptive && from.material.damage.law != DamageLaw::none;
  return hands_over ? std::max(from.loading.steps, steps_of_damage) : from.loading.steps;
}

const Table<RelaxationSpecification>& relaxation_keys() {
  using Relaxation = RelaxationSpecification;
  using Options = RelaxationOptions;
  const auto options = &Relaxation::options;
  const auto moves = [](const Relaxation& relaxation, const Case&) { return relaxation.moving; };
  const auto rests = [](const Relaxation& relaxation, const Case&) { return !relaxation.moving; };
  const std::string for_fixed = "is for load = \"fixed\"", for_moving = "is for load = \"moving\"";
  static const Table<Relaxation> table{
      "relaxation",
      {Key<Relaxation>("steps", &Relaxation::steps, count_from(1),
                       "number of equal steps of the *whole* load; 1/steps is the first one, "
                       "whatever the implicit steps have left. In mode `adaptive` it should be "
                       "several times `loading.steps`: an implicit step is cut to the onset of "
                       "damage only if what is left of it is larger than a relaxed step")
           .otherwise([](Relaxation& relaxation,
                         const Case& from) { relaxation.steps = default_relaxation_steps(from); },
                      "`loading.steps`; in mode `adaptive` with damage no fewer than 50"),
       Key<Relaxation>("load", &Relaxation::moving, choice(load_motions),
                       "relaxes at the fixed load after the ramp, or ends each step with it: such "
                       "states are not in equilibrium (`settled` in "
                       "[`history.csv`](results.md#historycsv)), and mode `adaptive` then never "
                       "hands back")
           .early(),
       Key<Relaxation>("iterations", &Relaxation::iterations, count_from(1),
                       "load `moving`: iterations over the whole load, shared out equally to the "
                       "steps")
           .unless(rests, for_moving)
           .then([](const TomlTable& from, Relaxation& relaxation, const Case&) {
             if (relaxation.iterations < relaxation.steps)
               from.refuse("iterations", "must not be fewer than relaxation.steps");
             if (relaxation.iterations % relaxation.steps != 0)
               from.refuse("iterations", "must be a multiple of relaxation.steps, " +
                                             std::to_string(relaxation.steps));
           })
           .moreover("a multiple of `steps`"),
       Key<Relaxation>("ramp", in(options, &Options::ramp), count_from(1),
                       "load `fixed`: iterations over which supports and loads move to their new "
                       "values")
           .unless(moves, for_fixed),
       Key<Relaxation>("quiet_iterations", in(options, &Options::quiet_iterations), count_from(0),
                       "load `fixed`: iterations without a further bond breaking before a state "
                       "may be accepted")
           .unless(moves, for_fixed)
           .listed_after("max_iterations"),
       Key<Relaxation>("breaking", in(options, &Options::breaking), choice(breakings),
                       "when damage is for good: in accepted states alone, so that overshoot "
                       "breaks nothing; or in every iteration, as published")
           .otherwise(
               [](Relaxation& relaxation, const Case&) {
                 if (relaxation.moving) relaxation.options.breaking = Breaking::transient;
               },
               "`\"at_equilibrium\"`; `\"transient\"` if the load is `moving`"),
       Key<Relaxation>("damping", in(options, &Options::damping), choice(dampings),
                       "none, and all motion stops whenever the kinetic energy has passed a peak "
                       "(`\"kinetic\"`); or, as published, a coefficient from the Rayleigh "
                       "quotient of the present motion, which amplifies round-off so that the path "
                       "of a crack may hang on the number of threads (`\"adaptive\"`)")
           .otherwise(
               [](Relaxation& relaxation, const Case&) {
                 if (relaxation.moving) relaxation.options.damping = Damping::adaptive;
               },
               "`\"kinetic\"`; `\"adaptive\"` if the load is `moving`"),
       Key<Relaxation>("mass_factor", in(options, &Options::mass_factor), between(1.0, 1e6),
                       "pseudo density over the least stable one: larger is slower and safer. At 1 "
                       "kinetic damping is crippled: its highest mode sits at the limit of "
                       "stability")
           .otherwise(
               [](Relaxation& relaxation, const Case&) {
                 if (relaxation.options.damping == Damping::adaptive)
                   relaxation.options.mass_factor = 1.0;
               },
               "2; 1 with adaptive damping"),
       Key<Relaxation>("max_iterations", in(options, &Options::max_iterations), count_from(1),
                       "load `fixed`: after the ramp; a step with more fails and is cut"),
       Key<Relaxation>("displacement_tolerance", in(options, &Options::displacement_tolerance),
                       between(0.0, 1.0),
                       "load `fixed`: also accepts a state whose displacements changed by less "
                       "than this in an iteration, ‖Δu‖/‖u‖, as published (10⁻⁹). It has "
                       "*settled* (so in `history.csv`), and need not be in equilibrium. 0: "
                       "never")},
      {},
      [](const TomlTable&, Relaxation& relaxation, const Case& so_far) {
        relaxation.options.holds = !relaxation.moving;
        if (relaxation.moving) relaxation.options.ramp = relaxation.iterations / relaxation.steps;
        relaxation.options.relative_tolerance = so_far.solver.relative_tolerance;
      }};
  return table;
}

// ---- Results

/// results/FOLDER_STEM, so that shipped cases of one name in several folders don't collide.
std::filesystem::path default_directory(const std::filesystem::path& case_file) {
  const auto absolute = std::filesystem::absolute(case_file).lexically_normal();
  const std::string folder = absolute.parent_path().filename().string();
  const std::string stem = absolute.stem().string();
  return std::filesystem::path("results") / (folder.empty() ? stem : folder + "_" + stem);
}

const Table<OutputSpecification>& output_keys() {
  using Output = OutputSpecification;
  static const Table<Output> table{
      "output",
      {Key<Output>("directory", &Output::directory, text(),
                   "results folder, relative to the current folder; `--output` on the command line "
                   "is the same")
           .otherwise([](Output& output,
                         const Case& from) { output.directory = default_directory(from.file); },
                      "`results/FOLDER_NAME` of the case file: `results/bar_tension` for "
                      "`cases/bar/tension.toml`")
           .then([](const TomlTable& from, Output& output, const Case&) {
             if (output.directory.empty()) from.refuse("directory", "is empty");
           }),
       Key<Output>("every", &Output::every, count_from(1, "steps"),
                   "fields are written at every n-th accepted step and at the last one"),
       Key<Output>("count_cracks", &Output::count_cracks, boolean(),
                   "whether bonds that a `[[crack]]` has cut count as lost in `damage` and "
                   "`max_damage`, so that the crack shows in the pictures from the start")}};
  return table;
}

const Table<ProbeSpecification>& probe_keys() {
  using Probe = ProbeSpecification;
  static const Table<Probe> table{
      "probe",
      {Key<Probe>("name", &Probe::name, name(), "of the column")
           .then([](const TomlTable& from, Probe& probe, const Case& so_far) {
             for (const Probe& other : so_far.probes)
               if (other.name == probe.name) from.refuse("name", "another probe has this name");
           })
           .moreover("no other probe has it")
           .required()
           .early(),
       Key<Probe>("set", &Probe::set, known_set(), "over whose points").required().early(),
       Key<Probe>("field", &Probe::field,
                  one_of({"displacement", "force", "damage", "stretch", "energy_density",
                          "poisson_ratio", "opening", "crack_length"}),
                  "displacement, opening and length in m, force in N, energy density in J/m³")
           .then([](const TomlTable& from, Probe& probe, const Case& so_far) {
             if (probe.field == "poisson_ratio" && so_far.dimension == 1)
               from.refuse("field", "there is no Poisson's ratio in dimension 1");
           })
           .early(),
       Key<Probe>("axis", &Probe::axis, axis(),
                  "`poisson_ratio`: direction of the pull; `crack_length`: direction in which the "
                  "crack runs")
           .unless(
               [](const Probe& probe, const Case&) {
                 return probe.field != "poisson_ratio" && probe.field != "crack_length";
               },
               "is for fields \"poisson_ratio\" and \"crack_length\""),
       Key<Probe>("other", &Probe::other, known_set(),
                  "`opening`: the set on the other side of the crack")
           .unless([](const Probe& probe, const Case&) { return probe.field != "opening"; },
                   "is for field \"opening\"")
           .required("required with it")
           .listed_after("set")}};
  return table;
}

}  // namespace

// ---- The document

const Table<Case>& document_keys() {
  const auto has_lattice = [](const Case& from, const Case&) {
    return std::holds_alternative<Lattice>(from.body);
  };
  const auto has_points = [](const Case& from, const Case&) {
    return std::holds_alternative<PointSource>(from.body);
  };
  static const Table<Case> table{
      "",
      {Key<Case>("title", &Case::title, text(), "one line for people")
           .otherwise(
               [](Case& result, const Case&) {
                 result.title = std::filesystem::path(result.file).stem().string();
               },
               "name of the file without its ending")
           .early(),
       Key<Case>("dimension", &Case::dimension, integer(1, 3), "of the space the body lives in")
           .required()
           .early(),
       Key<Case>("lattice", itself, lattice_keys(), "table: points on a lattice")
           .written_if(has_lattice)
           .one_of(),
       Key<Case>("points", itself, points_keys(), "table: points from a file")
           .written_if(has_points)
           .one_of(),
       Key<Case>("set", &Case::sets, set_keys(), "tables: named sets of points"),
       Key<Case>("crack", &Case::cracks, crack_keys(),
                 "tables: cracks that are there from the start"),
       Key<Case>("quadrature", itself, quadrature_keys(), "table: corrections of the weights"),
       Key<Case>("material", &Case::material, material_keys(), "table: model and constants")
           .then(check_quadrature_of_model)
           .required(),
       Key<Case>("support", &Case::supports, support_keys(), "tables: prescribed displacements"),
       Key<Case>("load", &Case::loads, load_keys(), "tables: forces"),
       Key<Case>("loading", &Case::loading, loading_keys(), "table: steps of the load factor"),
       Key<Case>("solver", &Case::solver, solver_keys(), "table: search for equilibrium"),
       Key<Case>("relaxation", &Case::relaxation, relaxation_keys(),
                 "table: steps by dynamic relaxation"),
       Key<Case>("output", &Case::output, output_keys(), "table: results folder"),
       Key<Case>("probe", &Case::probes, probe_keys(), "tables: values that enter the history")}};
  return table;
}

const std::vector<TableDescription>& table_descriptions() {
  static const auto tables = [] {
    std::vector<TableDescription> all;
    document_keys().describe(all);
    // The keys of all kinds of shapes stand beside its kind, too.
    const auto named = [&](const std::string& name) {
      return std::find_if(all.begin(), all.end(), [&](const auto& t) { return t.name == name; });
    };
    TableDescription& shape = *named("lattice.shape");
    for (const auto& kind : shape_kinds()) {
      const TableDescription own = *named("set.shape." + kind);
      for (const auto& key : own.listed) {
        if (std::count(shape.listed.begin(), shape.listed.end(), key) > 0) continue;
        shape.listed.push_back(key);
        shape.keys.push_back(*std::find_if(own.keys.begin(), own.keys.end(),
                                           [&](const auto& k) { return k.name == key; }));
      }
    }
    return all;
  }();
  return tables;
}

const std::map<std::string, std::vector<std::string>>& case_keys() {
  static const auto keys = [] {
    std::map<std::string, std::vector<std::string>> by_table;
    for (const auto& table : table_descriptions()) by_table[table.name] = table.listed;
    return by_table;
  }();
  return keys;
}

}  // namespace peristat
