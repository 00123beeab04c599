#include "cases/runner/input/case_keys.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <type_traits>
#include <variant>

#include "cases/runner/input/constraint_keys.hpp"
#include "cases/runner/input/key_kinds.hpp"
#include "cases/runner/input/probe_fields.hpp"
#include "cases/runner/input/shape_keys.hpp"
#include "solvers/drivers/drivers.hpp"
#include "src/conditions/loading_programme.hpp"
#include "src/core/expression.hpp"
#include "src/core/number_text.hpp"
#include "src/neighbourhood/influence.hpp"
#include "src/neighbourhood/optimised_weights.hpp"

namespace peristat {
namespace {

// ---- What several tables share

template <class Body>
constexpr auto body_is =
    [](auto&, const Case& from) { return std::holds_alternative<Body>(from.body); };

bool is_cpd(const Case& from) { return from.material.model == MaterialModel::cpd; }
bool is_lps(const Case& from) { return from.material.model == MaterialModel::lps; }

/// Whether any of the materials has a law of damage.
bool may_fail(const Case& from) {
  const auto fails = [](const MaterialSpecification& material) {
    return material.damage.law != DamageLaw::none;
  };
  return fails(from.material) ||
         std::ranges::any_of(from.regions, fails, &RegionSpecification::material) ||
         std::ranges::any_of(from.interfaces, [&](const InterfaceSpecification& interface) {
           return interface.material && fails(*interface.material);
         });
}

constexpr auto itself = [](auto& spec) -> auto& { return spec; };
constexpr auto lattice = [](auto& from) -> auto& { return std::get<Lattice>(from.body); };
constexpr auto points = [](auto& from) -> auto& { return std::get<PointSource>(from.body); };

template <class Member>
Key<Case> thickness(Member cross_section) {
  return Key<Case>("thickness", cross_section, positive("m"), "of the plate, dimension 2 only")
      .unless(in_dimension<1>, "is for dimension 2; dimension 1 has an area")
      .unless(in_dimension<3>, "is for dimension 2 only")
      .default_words("1");
}

template <class Member>
Key<Case> area(Member cross_section) {
  return Key<Case>("area", cross_section, positive("m2"), "of the bar, dimension 1 only")
      .unless(in_dimension<2>, "is for dimension 1; dimension 2 has a thickness")
      .unless(in_dimension<3>, "is for dimension 1 only")
      .default_words("1");
}

template <class Spec>
Key<Spec> where(const std::string& meaning, const std::string& fallback) {
  return Key<Spec>("where", &Spec::where, condition(), meaning)
      .written_if([](auto& spec, auto&) { return !spec.where.empty(); })
      .default_words(fallback);
}

// ---- The body

Table<ShapeStep> shape_step_keys() {
  using K = Key<ShapeStep>;
  using Action = ShapeStep::Action;
  return {"lattice.shape",
          {K("add", &ShapeStep::shape, shape_beside(), "kind of the shape to add")
               .written_if([](auto& step, auto&) { return step.action == Action::add; })
               .one_of(),
           K("subtract", &ShapeStep::shape, shape_beside(), "kind of the shape to take away")
               .then([](auto&, auto& step) { step.action = Action::subtract; })
               .written_if([](auto& step, auto&) { return step.action == Action::subtract; })
               .one_of(),
           K("name", &ShapeStep::name, text(), "of the shape, by which loads find its boundary")
               .written_if([](auto& step, auto&) { return !step.name.empty(); }),
           K("cuts_bonds", &ShapeStep::cuts_bonds, boolean(),
             "`subtract`: whether bonds that cross the shape are cut; otherwise those that are "
             "longer than it is wide bridge it")
               .written_if([](auto& step, auto&) { return step.cuts_bonds; })
               .then([](auto& at, auto& step) {
                 if (step.cuts_bonds && step.action == Action::add)
                   at.refuse("is for a shape that is subtracted");
               })}};
}

Table<Layer> layer_keys() {
  using K = Key<Layer>;
  return {"lattice.layer",
          {K("name", &Layer::name, set_name(), "of the layer and of its set").required(),
           K("side", &Layer::side, side(), "of the body").required(),
           K("thickness", &Layer::thickness, integer(1, 1000, "spacings"), "number of planes"),
           where<Layer>("keeps a part of the layer", "all of it")}};
}

Table<Case> lattice_keys() {
  using K = Key<Case>;
  return {
      "lattice",
      {K("spacing", in(lattice, &Lattice::spacing), spacing(),
         "distance of neighbouring points, or one along each of the lattice's axes")
           .required(),
       K("points", in(lattice, &Lattice::arrangement),
         choice<Arrangement>(
             {{"lattice", Arrangement::lattice}, {"blue_noise", Arrangement::blue_noise}}),
         "where they stand: on the lattice, or at random with about the spacing as the distance "
         "from their neighbours, with the volumes of their Voronoi cells")
           .unless(in_dimension<1>, "is for dimensions 2 and 3")
           .moreover("`blue_noise` with model `bond`")
           .early(),
       K("lloyd_steps", in(lattice, &Lattice::lloyd_steps), integer(0, 100, ""),
         "how often points of blue noise move to the centroids of their Voronoi cells")
           .unless([](auto& from,
                      auto&) { return lattice(from).arrangement != Arrangement::blue_noise; },
                   "is for points = \"blue_noise\""),
       K("angle", in(lattice, &Lattice::angle), between(-360.0, 360.0, "degrees"),
         "that the lattice is turned by under the body, anticlockwise about the origin, in 3D "
         "about the z axis; shapes, layers and sets stay")
           .unless(in_dimension<1>, "is for dimensions 2 and 3"),
       K("horizon_ratio", &Case::horizon_ratio, number(Range::positive("-"), "1 to 1000"),
         "horizon / spacing; of spacings that differ, their geometric mean")
           .then([](auto& at, auto& result) {
             if (result.horizon_ratio < 1.0)
               at.refuse("horizon smaller than the spacing; must be at least 1, usually 3.015");
             const Spacing& spacing = lattice(result).spacing;
             const double horizon = result.horizon_ratio * spacing;
             if (!spacing.is_square() && horizon < spacing.largest())
               at.refuse("gives a horizon of " + number_text(horizon) +
                         " m (it refers to the geometric mean of the spacings), smaller than the "
                         "largest spacing, " +
                         number_text(spacing.largest()) + " m");
           })
           .moreover("in 3D to 100; with model `cpd` to 50 in 2D, to 8 in 3D"),
       thickness(in(lattice, &Lattice::cross_section)), area(in(lattice, &Lattice::cross_section)),
       K("origin", in(lattice, &Lattice::origin),
         choice<LatticeOrigin>(
             {{"cell_centres", LatticeOrigin::cell_centres}, {"nodes", LatticeOrigin::nodes}}),
         "where points stand relative to the lower corner of the first shape: cells' centres, half "
         "a spacing inside, or the corner itself"),
       K("volumes", in(lattice, &Lattice::volumes),
         choice<CellVolumes>(
             {{"cells", CellVolumes::whole}, {"fractional", CellVolumes::fractional}}),
         "of points: that of a cell if its place lies in the body, or of the part of each cell "
         "that "
         "does")
           .moreover("`fractional` with model `bond`"),
       K("perturbation", in(lattice, &Lattice::perturbation), between(0.0, 0.49, "spacings"),
         "largest random shift of a point along each of the lattice's axes; points of layers stay"),
       K("cell_perturbation", in(lattice, &Lattice::cell_perturbation),
         between(0.0, 0.249, "spacings"),
         "largest random shift of the corners of cells inside the body along each of the lattice's "
         "axes; points stand at the cells' centroids and have their volumes")
           .unless(in_dimension<3>, "is for dimensions 1 and 2")
           .moreover("model `bond`"),
       K("seed", in(lattice, &Lattice::seed),
         count_from(0, "", std::numeric_limits<std::int64_t>::max()),
         "of the random shifts and places; the same seed gives the same points"),
       K("shape", in(lattice, &Lattice::shapes), shape_step_keys(), "tables: the body")
           .then([](auto& at, auto& result) {
             if (lattice(result).shapes.empty())
               at.refuse("this array of tables is missing; a lattice needs at least one shape");
           })
           .default_words("at least one is required"),
       K("layer", in(lattice, &Lattice::layers), layer_keys(), "tables: points outside the body")},
      [](auto&, auto& result) {
        result.body = Lattice();
        lattice(result).dimension = result.dimension;
      }};
}

Kind<std::filesystem::path> file_beside_the_case() {
  const auto read = [](const Entry& at) {
    const std::filesystem::path given = at.from.string(at.key);
    if (given.empty()) at.refuse("is empty");
    const auto folder = std::filesystem::path(at.so_far.file).parent_path();
    const auto file = std::filesystem::absolute(folder / given).lexically_normal();
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
      at.refuse("no such file; looked for " + file.string());
    return file;
  };
  return {read, [](auto& file, auto&) { return toml_string(file.string()); }, "an existing file"};
}

Table<Case> points_keys() {
  using K = Key<Case>;
  return {
      "points",
      {K("file", in(points, &PointSource::file), file_beside_the_case(),
         "comma- or blank-separated text, relative to the case file's folder")
           .required(),
       K("horizon", in(points, &PointSource::horizon), positive("m"), "the same for every point")
           .moreover("at least the mean spacing; at most as many mean spacings as "
                     "`lattice.horizon_ratio` allows")
           .required(),
       K("neighbours", in(points, &PointSource::neighbours), file_beside_the_case(),
         "neighbours of the points and the shares of their volumes that count, beside the case "
         "file like `file`; model `bond`")
           .written_if([](auto& from, auto&) { return !points(from).neighbours.empty(); })
           .default_words("all points within the horizon"),
       thickness(in(points, &PointSource::cross_section)),
       area(in(points, &PointSource::cross_section))},
      [](auto&, auto& result) { result.body = PointSource(); }};
}

Table<SetRule> set_keys() {
  using K = Key<SetRule>;
  return {"set",
          {K("name", &SetRule::name, set_name(), "of the set").required(),
           where<SetRule>("selects points where it is not zero", "this or `shape` is required"),
           K("shape", &SetRule::shape, shape_inside(),
             "selects the points in it; its keys are those of `[[lattice.shape]]`: `{ box = { min "
             "= [0, 0], max = [1, 1] } }`")
               .describes(describe_shapes)
               .default_words("this or `where` is required")},
          {},
          [](auto& at, auto& set) {
            if (set.where.empty() && !set.shape) at.refuse("needs a where or a shape");
          }};
}

Table<Crack> crack_keys() {
  using K = Key<Crack>;
  constexpr auto segment = [](auto& crack) -> auto& { return std::get<CrackSegment>(crack); };
  constexpr auto polygon = [](auto& crack) -> auto& { return std::get<CrackPolygon>(crack); };
  constexpr auto outline = [](auto& crack) -> auto& {
    if constexpr (std::is_const_v<std::remove_reference_t<decltype(crack)>>) {
      static const CrackOutline none;
      const auto* const own = std::get_if<CrackOutline>(&crack);
      return own != nullptr ? *own : none;
    } else {
      return crack.template emplace<CrackOutline>();
    }
  };
  const auto is_outline = [](auto& crack, auto&) {
    return std::holds_alternative<CrackOutline>(crack);
  };
  const std::string in_space = "is for dimension 2; 3D has vertices",
                    beside_outline = "stands beside outline; a crack is one or the other";
  return {"crack",
          {K("outline", in(outline, &CrackOutline::vertices), pairs(),
             "2D: corners of a closed polygon whose sides cut, the last is joined to the first")
               .unless(in_dimension<3>, in_space)
               .written_if(is_outline)
               .default_words("this, or `from` and `to`, in 2D")
               .early(),
           K("from", in(segment, &CrackSegment::from), coordinates(), "2D: one end")
               .unless(in_dimension<3>, in_space)
               .unless(is_outline, beside_outline)
               .required("required in 2D without `outline`"),
           K("to", in(segment, &CrackSegment::to), coordinates(), "2D: the other end")
               .unless(in_dimension<3>, in_space)
               .unless(is_outline, beside_outline)
               .moreover("not `from`")
               .required("required in 2D without `outline`"),
           K("vertices", in(polygon, &CrackPolygon::vertices), triples(),
             "3D: corners in order, the last is joined to the first")
               .unless(in_dimension<2>, "is for dimension 3; 2D has from and to, or an outline")
               .moreover("in one plane (to 10⁻⁹ of the extent) and around an area; edges must not "
                         "cross or touch")
               .required("required in 3D")},
          [](auto& at, auto& crack) {
            if (at.so_far.dimension == 1)
              at.refuse("there are no cracks in dimension 1; subtract a box instead");
            if (at.so_far.dimension == 3) crack = CrackPolygon();
          },
          [](auto& at, auto& crack) { check_crack(crack, at.so_far.dimension, at.from.path()); }};
}

// ---- The material

Table<Case> quadrature_keys() {
  using K = Key<Case>;
  const auto of_kernel = [](auto&, const Case& from) {
    return !is_cpd(from) && !from.is_collocated();
  };
  const auto of_bond = [](auto&, const Case& from) {
    return from.material.model == MaterialModel::bond;
  };
  const auto of_lps = [](auto&, const Case& from) { return is_lps(from); };
  const auto of_collocation = [](auto&, const Case& from) { return from.is_collocated(); };
  constexpr auto collocation = [](auto& from) -> auto& { return from.collocation; };
  return {
      "quadrature",
      {K("form", &Case::form,
         choice<SolidForm>({{"collocation", SolidForm::collocation},
                            {"energy", SolidForm::energy},
                            {"printed", SolidForm::printed}}),
         "model `lps`: forces at points by a quadrature that is exact for linear displacements "
         "up to the surface, which have no potential; or those of an "
         "[energy](theory.md#the-solid-as-an-energy), symmetric, as the other models' are, with "
         "all modes and loads that these have but mode `path`; or those of [FCBM] (A-8), for "
         "comparisons alone: without a potential where neighbourhoods differ, by "
         "`solver.operator = \"fft\"` in mode `dynamics` with `scheme = \"verlet\"`")
           .written_if(of_lps),
       K("volume_correction", &Case::volume_correction,
         choice<VolumeCorrection>({{"none", VolumeCorrection::none},
                                   {"linear", VolumeCorrection::linear},
                                   {"exact", VolumeCorrection::exact},
                                   {"exact_centroids", VolumeCorrection::exact_centroids}}),
         "share of a neighbour's volume that counts near the edge of the horizon: all; linear "
         "over half a spacing to either side; what its cell has within the horizon; the same, "
         "with length and influence of the bond those of that part's centroid. The last two "
         "are for whole cells of a lattice, of which `cell_perturbation` may shift the corners")
           .written_if(of_kernel),
       K("horizon_shape", &Case::horizon_shape,
         choice<HorizonShape>({{"ball", HorizonShape::ball},
                               {"box", HorizonShape::box},
                               {"diamond", HorizonShape::diamond}}),
         "which neighbours a point sees: those whose distance, whose largest component or whose "
         "sum of components along the lattice's axes is at most the horizon. Boxes and diamonds "
         "are stiffer along some directions than along others: "
         "[moduli](theory.md#horizon-shapes) are means over all of them")
           .written_if(of_bond),
       K("surface_correction", &Case::surface_correction,
         choice<SurfaceCorrection>({{"none", SurfaceCorrection::none},
                                    {"volume", SurfaceCorrection::volume},
                                    {"energy", SurfaceCorrection::energy}}),
         "factor that restores the stiffness of points whose neighbourhood is cut by a "
         "surface: none, by the volume of the neighbourhood, or by the energy of simple "
         "deformations")
           .written_if(of_bond),
       K("weights", &Case::weights,
         choice<InteractionWeights>(
             {{"mean", InteractionWeights::mean}, {"bulk", InteractionWeights::bulk}}),
         "model `cpd`: weights of interactions near surfaces, by the mean of their points' "
         "effective volumes, or as in the bulk everywhere")
           .written_if([](auto&, const Case& from) { return is_cpd(from); }),
       K("degree", in(collocation, &CollocationSpecification::degree),
         count_from(least_exact_degree, "", most_exact_degree),
         "model `lps` by collocation: of the polynomials that the quadrature is exact for")
           .written_if(of_collocation),
       K("traction_form", in(collocation, &CollocationSpecification::traction_form),
         choice<TractionForm>({{"full", TractionForm::full}, {"paper", TractionForm::paper}}),
         "model `lps` by collocation: what of the displacements' continuation over the boundary "
         "counts: all of it, which is exact for linear fields on every grid, or what [LPS] eq. "
         "4.6 keeps")
           .written_if(of_collocation),
       K("normals", in(collocation, &CollocationSpecification::normals),
         choice<NormalSource>(
             {{"numerical", NormalSource::numerical}, {"exact", NormalSource::exact}}),
         "model `lps` by collocation: normals of surfaces from the neighbourhoods, or from the "
         "shapes' faces, at points that have one face and all of their bonds")
           .written_if(of_collocation)}};
}

/// The quadrature is read before the material, whose model tells which of its keys apply.
void check_quadrature(const Entry& at, const Case& result) {
  if (!at.from.has("quadrature")) return;
  const TomlTable quadrature = at.from.table("quadrature");
  const std::vector<std::string> of_bond{"volume_correction", "surface_correction",
                                         "horizon_shape"},
      of_cpd{"weights"}, of_lps{"form"}, of_collocation{"degree", "traction_form", "normals"};
  const auto refuse = [&](const std::vector<std::string>& keys, const std::string& what) {
    for (const std::string& key : keys) {
      const bool is_none = key != "degree" && quadrature.has(key) &&
                           (quadrature.string(key) == "none" || quadrature.string(key) == "ball");
      if (quadrature.has(key) && !is_none) quadrature.refuse(key, what);
    }
  };
  if (is_cpd(result))
    refuse(of_bond, "is for model \"bond\"; the effective volumes of cpd need none");
  if (result.is_collocated())
    refuse(of_bond, "is for model \"bond\"; lps has a quadrature of its own");
  if (result.has_states())
    refuse({"surface_correction", "horizon_shape"},
           "is for model \"bond\"; the states of lps are those of the "
           "neighbours there are");
  if (is_polynomial(result.material.model))
    refuse({"surface_correction", "horizon_shape"}, "is for model \"bond\"");
  if (!is_cpd(result)) refuse(of_cpd, "is for model \"cpd\"");
  if (!is_lps(result)) refuse(of_lps, "is for model \"lps\"");
  if (!result.is_collocated()) refuse(of_collocation, "is for model \"lps\" by collocation");
}

/// What follows from the materials. Without [material] the first region tells model and plane.
void check_regions(const Entry& at, Case& result) {
  if (!at.from.has("material")) {
    if (result.regions.empty()) static_cast<void>(at.from.table("material"));  // it is missing
    const MaterialSpecification& first = result.regions.front().material;
    result.material.model = first.model;
    result.material.potential = first.potential;
    result.material.plane = first.plane;
    result.material.influence = first.influence;
    result.material.kinematics = first.kinematics;
  }
  check_quadrature(at, result);
}

/// Without a law its data would do nothing; no_fail may be of other materials' laws.
void require_law(const Entry& at, DamageSpecification&) {
  if (at.from.has("law")) return;
  for (const char* key :
       {"fracture_energy", "strength", "critical", "onset", "peak", "hardening", "rate"}) {
    if (!at.from.has(key)) continue;
    at.from.refuse(key,
                   "needs a law beside it, like law = \"linear\"; without one there is no "
                   "damage (law = \"none\" says so)");
  }
}

Table<DamageSpecification> damage_keys(const std::string& material) {
  using Spec = DamageSpecification;
  using K = Key<Spec>;
  const auto is_whole = [](auto& damage, auto&) { return damage.law == DamageLaw::none; };
  const auto is_of_points = [](auto& damage, auto&) {
    return damage.law == DamageLaw::energy_density;
  };
  const std::string for_stretches = "is for the laws of stretches";
  const auto is_sudden = [](auto& damage, auto&) { return !damage.softens(); };
  const auto has_no_rate = [](auto& damage, auto&) { return !damage.has_rate(); };
  const auto is_not_blended = [](auto& damage, auto&) { return damage.law != DamageLaw::blended; };
  const auto is_sized = [](auto& damage, auto&) {
    return damage.fracture_energy || (damage.strength && !damage.softens());
  };
  const auto begins_by_strength = [](auto& damage, auto&) {
    return damage.strength && damage.law != DamageLaw::blended;
  };
  // Asking for what is not there tells that it is missing.
  const auto require_key = [](auto lacks) {
    return [=](const Entry& at, const Spec& damage) {
      if (lacks(damage)) static_cast<void>(at.from.number(at.key, Range()));
    };
  };
  const std::string for_softening = "is for the laws that soften",
                    for_blended = "is for the law \"blended\"";
  return {
      material + ".damage",
      {K("law", &Spec::law,
         choice<DamageLaw>({{"none", DamageLaw::none},
                            {"critical_stretch", DamageLaw::critical_stretch},
                            {"tanh", DamageLaw::tanh},
                            {"tanh_continuous", DamageLaw::tanh_continuous},
                            {"linear", DamageLaw::linear},
                            {"exponential", DamageLaw::exponential},
                            {"blended", DamageLaw::blended},
                            {"energy_density", DamageLaw::energy_density}}),
         "no damage, whatever else stands in the table; whole up to `critical` and then broken; "
         "softening from `onset` to "
         "`critical` as published in [ADAPT], which jumps by (1 − tanh `rate`)/2 at both ends; "
         "the same law rescaled so that it does not jump; force falling linearly from `onset` "
         "to zero at `critical`; exponentially, without a jump at `critical`; rising on a "
         "lower slope from `onset` to `peak`, and then falling linearly; of points, with "
         "`kinematics = \"linear\"`, and of all models by `solver.operator = \"fft\"`: all at once "
         "and "
         "for good where the energy density exceeds "
         "`fracture_energy` / (2 δ)")
           .early(),
       K("fracture_energy", &Spec::fracture_energy, positive("J/m2"),
         "$G_c$ of a plane crack, the mean over its directions on this lattice; `critical` "
         "follows. Of `cpd` at horizon ratios up to 12 in 2D, 3.2 in 3D")
           .unless(is_whole, "")
           .early(),
       K("strength", &Spec::strength, positive("Pa"),
         "$f_t$ of the body: the largest stress that the lattice bears under a pull in one "
         "direction, the mean over directions ([theory](theory.md#strength)); `onset` follows, "
         "`peak` of `blended`, `critical` of `critical_stretch`. Of `cpd` at the horizon ratios of "
         "`fracture_energy`, in 3D at shorter ones, where it does not take minutes")
           .unless(is_whole, "")
           .unless(is_of_points, for_stretches)
           .early(),
       K("critical", &Spec::critical, stretch(), "stretch $s_c$ from which on a bond is broken")
           .unless(is_whole, "")
           .unless(is_of_points, for_stretches)
           .unless(is_sized, "follows from fracture_energy or strength; give one of them")
           .then(require_key([](auto& damage) { return damage.critical == 0.0; }))
           .default_words("this or `fracture_energy` is required with a law"),
       K("onset", &Spec::onset, stretch(),
         "laws that soften: stretch $s_m$ beyond which a bond loses stiffness")
           .unless(is_whole, "")
           .unless(is_sudden, for_softening)
           .unless(begins_by_strength, "follows from strength; give one of them")
           .then(require_key(
               [](auto& damage) { return damage.onset == 0.0 && !damage.is_by_data(); }))
           .written_if([](auto& damage, auto&) { return damage.onset != 0.0; })
           .moreover("below `critical`")
           .default_words("required without `strength`; with `fracture_energy` half the "
                          "stretch of a brittle bond of that energy, a quarter of `blended`"),
       K("peak", &Spec::peak, stretch(), "`blended`: stretch $s_p$ at which the force is largest")
           .unless(is_whole, "")
           .unless(is_not_blended, for_blended)
           .unless([](auto& damage, auto&) { return damage.strength.has_value(); },
                   "follows from strength; give one of them")
           .then(require_key([](auto& damage) {
             return damage.peak == 0.0 && (damage.onset != 0.0 || !damage.fracture_energy);
           }))
           .written_if([](auto& damage, auto&) { return damage.peak != 0.0; })
           .moreover("from `onset` to below `critical`")
           .default_words("required without `strength`; without any of the three the largest "
                          "force is half that of a brittle bond of that `fracture_energy`"),
       K("hardening", &Spec::hardening, between(0.0, 0.99, "1"),
         "`blended`: slope of the force between `onset` and `peak` over that of the whole "
         "bond")
           .unless(is_whole, "")
           .unless(is_not_blended, for_blended),
       K("rate", &Spec::rate, between(0.1, 50.0, "1"),
         "tanh laws: $\\beta$, how much of the softening falls on the middle between the two "
         "stretches; `exponential`: how much steeper the force falls at first")
           .unless(is_whole, "")
           .unless(has_no_rate, "is for the tanh laws and \"exponential\""),
       K("no_fail", &Spec::no_fail, known_sets(),
         "sets whose points' bonds stay elastic at any stretch, also those to points outside "
         "the sets")
           .written_if([](auto& damage, auto&) { return damage.law != DamageLaw::none; })
           .early()},
      require_law};
}

/// A stiffness may be negative (auxetic bodies have such), but not remotely large.
Kind<double> stiffness(const std::string& unit) {
  return number({-1e200, 1e200, "must be a finite number of " + unit}, "any number", unit);
}

Choices<std::string> bond_potentials() {
  Choices<std::string> names;
  WholeBondPotentials::for_each(
      [&](const auto& whole) { names.emplace_back(whole.name, whole.name); });
  return names;
}

Table<FibreSpecification> fibre_keys(const std::string& material) {
  using Spec = FibreSpecification;
  using K = Key<Spec>;
  return {
      material + ".fibre",
      {K("angle", &Spec::angle, between(-360.0, 360.0, "degrees"),
         "2D: of the fibres against the x axis, towards y")
           .unless(in_dimension<3>, "is for dimension 2; 3D has a direction")
           .required("required in 2D"),
       K("direction", &Spec::direction, coordinates("1"), "3D: of the fibres, of any length")
           .unless(in_dimension<2>, "is for dimension 3; 2D has an angle")
           .moreover("not all zero")
           .required("required in 3D"),
       K("transverse_modulus", &Spec::transverse_modulus, positive("Pa"),
         "Young's modulus $E_2$ across the fibres; `youngs_modulus` is $E_1$, along them")
           .required(),
       K("shear_modulus", &Spec::shear_modulus, positive("Pa"),
         "$G$ of planes that the fibres lie in; Poisson's ratio follows")
           .moreover("such that no bond has a negative constant")
           .default_words("$\\sqrt{E_1E_2}/(2 + 2\\nu)$ with the $\\nu$ of isotropic bonds, 1/3 or "
                          "1/4"),
       K("transverse_critical", &Spec::transverse_critical, between(1e-9, 1e3, "1"),
         "`critical` of bonds across the fibres; that of `[material.damage]` is then of those "
         "along them, and between it goes with the square of the cosine, `onset` with it")
           .default_words("as along the fibres")}};
}

Table<ScatterSpecification> scatter_keys(const std::string& material) {
  using Spec = ScatterSpecification;
  using K = Key<Spec>;
  constexpr auto field = [](auto& scatter) -> auto& { return scatter.field; };
  return {material + ".scatter",
          {K("of", &Spec::of,
             choice<Spec::Quantity>({{"stiffness", Spec::Quantity::stiffness},
                                     {"strength", Spec::Quantity::strength}}),
             "what the factor multiplies: the constants of bonds, triangles and tetrahedra, or the "
             "stretches of the law of damage")
               .required(),
           K("distribution", &Spec::distribution,
             choice<Spec::Distribution>({{"weibull", Spec::Distribution::weibull}}),
             "of the factor, whose mean is 1"),
           K("weibull_modulus", in(field, &WeibullField::modulus), between(1.0, 1e3, "1"),
             "shape $m$: the larger, the less scatter")
               .required(),
           K("correlation_length", in(field, &WeibullField::correlation_length),
             number({0.0, 1e30, "must be 0 or a positive number [m]"}, "0 or positive", "m"),
             "$\\ell$ over which the field changes; 0: every point has a value of its own"),
           K("seed", in(field, &WeibullField::seed),
             count_from(0, "", std::numeric_limits<std::int64_t>::max()),
             "of the field; the same seed and place give the same value, whatever else the case "
             "has")}};
}

void make_linear_if_lps(const Entry& at, MaterialSpecification& material) {
  if (material.model != MaterialModel::lps) return;
  if (at.from.has("kinematics") && material.kinematics == Kinematics::finite) {
    at.refuse("of \"lps\" is \"linear\", whatever the deformation");
  }
  material.kinematics = Kinematics::linear;
}

/// @param name of the table: of the body, a region or an interface
Table<MaterialSpecification> material_keys(const std::string& name) {
  using Spec = MaterialSpecification;
  using K = Key<Spec>;
  const auto of_cpd = [](auto& material, auto&) { return material.model == MaterialModel::cpd; };
  const auto of_bond = [](auto& material, auto&) { return has_bonds(material.model); };
  const auto of_lps = [](auto& material, auto&) { return has_lame_constants(material.model); };
  const auto of_correspondence = [](auto& material, auto&) {
    return material.model == MaterialModel::correspondence;
  };
  const auto has_moduli = [](auto& material, auto&) { return material.youngs_modulus.has_value(); };
  const auto has_constants = [](auto& material, auto&) { return material.c1.has_value(); };
  const auto has_micromodulus = [](auto& material, auto&) {
    return material.micromodulus.has_value();
  };
  constexpr auto fibre_of = [](auto& material) -> auto& {
    if constexpr (std::is_const_v<std::remove_reference_t<decltype(material)>>) {
      static const FibreSpecification none;
      return material.fibre ? *material.fibre : none;
    } else {
      if (!material.fibre) material.fibre.emplace();
      return *material.fibre;
    }
  };
  const std::string for_bond = "is for model \"bond\"", for_cpd = "is for model \"cpd\"",
                    with_moduli = "goes with youngs_modulus, not with c1";
  return {
      name,
      {K("model", &Spec::model,
         choice<MaterialModel>({{"bond", MaterialModel::bond},
                                {"cpd", MaterialModel::cpd},
                                {"lps", MaterialModel::lps},
                                {"green_bond", MaterialModel::green_bond},
                                {"correspondence", MaterialModel::correspondence}}),
         "bond-based peridynamics, whose Poisson ratio is 1/4 (3D and plane strain) or 1/3 (plane "
         "stress); continuum-kinematics-inspired peridynamics with one-, two- and "
         "three-neighbour interactions, dimension 2 and 3; or the "
         "[linear peridynamic solid](theory.md#linear-peridynamic-solid) of any Poisson ratio, by "
         "collocation or as an energy, for small displacements, dimension 2 and 3; or, at any "
         "deformation and by `solver.operator = \"fft\"` alone, "
         "[bonds that stretch by their squared lengths](theory.md#materials-of-convolutions-at-"
         "finite-deformation), as `bond` at small strains, or a correspondence material of "
         "St. Venant and Kirchhoff of any Poisson ratio, dimension 2 and 3")
           .then([name](auto& at, auto& material) {
             const bool tells_body = name == "material" || (!at.so_far.material.has_constants() &&
                                                            at.so_far.regions.empty());
             if (tells_body && material.model == MaterialModel::lps)
               material.influence = InverseInfluence::name;
             if (at.so_far.dimension > 1) return;
             if (material.model == MaterialModel::cpd)
               at.refuse("cpd needs dimension 2 or 3; in 1D it is the bond model");
             if (material.model == MaterialModel::lps) at.refuse("lps needs dimension 2 or 3");
             if (material.model == MaterialModel::correspondence)
               at.refuse("correspondence needs dimension 2 or 3");
           })
           .early(),
       K("potential", &Spec::potential, choice(bond_potentials()),
         "of whole bonds, a function of their stretch, and below its onset of a damage law"),
       K("plane", &Spec::plane,
         choice<PlaneState>({{"stress", PlaneState::stress}, {"strain", PlaneState::strain}}),
         "state of a plane body, dimension 2 only (`cpd` in 2D is purely two-dimensional, neither)")
           .unless(of_cpd, for_bond)
           .unless(in_dimension<1>, "is for dimension 2 only")
           .unless(in_dimension<3>, "is for dimension 2 only"),
       K("kinematics", &Spec::kinematics,
         choice<Kinematics>({{"finite", Kinematics::finite}, {"linear", Kinematics::linear}}),
         "`bond`: bonds stretch by their lengths, at any deformation; or by the displacements "
         "along them, for small ones, which is linear: without eigenstrains, with "
         "`potential = \"harmonic\"`, and damage by `energy_density` alone. `lps` is always linear")
           .then(make_linear_if_lps)
           .unless(of_cpd, "is for models \"bond\" and \"lps\""),
       K("influence", &Spec::influence, one_of(influence_names()),
         "influence function $\\omega(r/\\delta)$, $c\\,\\omega s$ is the force density of a bond: "
         "[GPMB]'s of order 0, 0.5, 1, 3, 5 and 7, $e^{-(r/\\delta)^2}$, or $\\delta/r$; "
         "constants, "
         "moduli and fracture energy go with it. `cpd`: of triangles and tetrahedra the product of "
         "those of their sides, with constants of the lattice. `lps` as an energy: the kernel "
         "K(r), "
         "by collocation the inverse one alone")
           .default_words("`\"constant\"`, with `lps` `\"inverse\"`"),
       K("youngs_modulus", &Spec::youngs_modulus, positive("Pa"), "in all models").one_of(),
       K("micromodulus", &Spec::micromodulus, positive("N/m6", 1e150),
         "`bond`: bond constant c of the pairwise force c·stretch")
           .unless(of_cpd, for_bond)
           .unless(of_lps, for_bond)
           .one_of(),
       K("poisson_ratio", &Spec::poisson_ratio, between(-1.0, 1.0),
         "`cpd`, `lps`, `correspondence`, with `youngs_modulus`")
           .unless(of_bond,
                   "is not free with bonds alone: they have 1/3 in plane stress, 1/4 in plane "
                   "strain and 3D; models \"cpd\", \"lps\" and \"correspondence\" take others")
           .unless(has_constants, with_moduli)
           .moreover("`lps`, `correspondence`: to 0.5; `cpd`: in 3D to 0.5, all excluded; with "
                     "damage from 1/3 (2D) "
                     "or 1/4 (3D) on")
           .required("required with `youngs_modulus`"),
       K("stabilisation", &Spec::stabilisation, positive("-"),
         "`correspondence`: stiffness of the "
         "[springs](theory.md#materials-of-convolutions-at-finite-deformation) that resist what "
         "deformation gradients do not see, relative to bonds of the same bulk modulus")
           .written_if(of_correspondence)
           .unless([of_correspondence](auto& material,
                                       auto& from) { return !of_correspondence(material, from); },
                   "is for model \"correspondence\""),
       K("c1", &Spec::c1, positive("N/m6", 1e200), "`cpd`: one-neighbour constant")
           .unless(of_bond, for_cpd)
           .unless(of_lps, for_cpd)
           .one_of(),
       K("c2", &Spec::c2, stiffness("N/m10"),
         "`cpd`: two-neighbour constant; in 3D also beside `youngs_modulus`, in 2D it then follows")
           .unless(of_bond, for_cpd)
           .unless(of_lps, for_cpd)
           .unless(
               [](auto& material, const Case& so_far) {
                 return material.youngs_modulus && so_far.dimension == 2;
               },
               "follows from youngs_modulus and poisson_ratio in 2D; give c1 for a free c2")
           .moreover("a negative one is refused with damage, and where it makes the body "
                     "[unstable at rest](theory.md#stability-at-rest)"),
       K("c3", &Spec::c3, stiffness("N/m14"),
         "`cpd`: three-neighbour constant, 3D; follows from `youngs_modulus`")
           .unless(of_bond, for_cpd)
           .unless(of_lps, for_cpd)
           .unless(has_moduli,
                   "follows from youngs_modulus and poisson_ratio; give c1 for a free c3")
           .then([](auto& at, auto& material) {
             if (at.so_far.dimension == 2 && material.c3 != 0.0)
               at.refuse("must be 0 in 2D: three neighbours of a point in a plane span no volume");
           })
           .moreover("a negative one as of `c2`"),
       K("calibration", &Spec::calibration,
         choice<Calibration>(
             {{"lattice", Calibration::lattice}, {"continuum", Calibration::continuum}}),
         "with `youngs_modulus`: what the constants reproduce the moduli on, this lattice's sums "
         "with their corrections (`bond`: in the mean over all directions) or integrals")
           .unless(has_constants, with_moduli)
           .unless(has_micromodulus, "goes with youngs_modulus, not with micromodulus")
           .unless(of_lps, "is for models \"bond\", \"green_bond\" and \"cpd\"")
           .default_words("`\"lattice\"` with `cpd`, `\"continuum\"` with `bond`"),
       K("thermal_expansion", &Spec::thermal_expansion, between(-1.0, 1.0, "per K"),
         "of lengths, α: for `[temperature]`"),
       K("density", &Spec::density, positive("kg/m3"),
         "for gravity and mode `dynamics`: dynamic relaxation has a density of its own"),
       K("damage", &Spec::damage, damage_keys(name), "table `[material.damage]`")
           .default_words("no damage"),
       K("fibre", fibre_of, fibre_keys(name),
         "table `[material.fibre]`: moduli and stretches by "
         "the direction of the bond")
           .written_if([](auto& material, auto&) { return material.fibre.has_value(); })
           .unless(of_cpd, for_bond)
           .unless(of_lps, for_bond)
           .unless(in_dimension<1>, "needs dimension 2 or 3")
           .otherwise([](auto&, auto&) {}, "none"),
       K("scatter", &Spec::scatter, scatter_keys(name),
         "tables `[[material.scatter]]`: random fields")}};
}

/// What regions and interfaces add to the keys of a material: its model, potential, plane,
/// influence function and kinematics are those of the body.
Table<MaterialSpecification> material_of_body_keys(const std::string& name) {
  Table<MaterialSpecification> keys = material_keys(name);
  const auto of_body = [](const Case& so_far) -> const MaterialSpecification& {
    const bool is_first = !so_far.material.has_constants() && !so_far.regions.empty();
    return is_first ? so_far.regions.front().material : so_far.material;
  };
  keys.before = [of_body](const Entry& at, MaterialSpecification& material) {
    const MaterialSpecification& body = of_body(at.so_far);
    material.model = body.model;
    material.potential = body.potential;
    material.plane = body.plane;
    material.influence = body.influence;
    material.kinematics = body.kinematics;
  };
  keys.after = [of_body](const Entry& at, MaterialSpecification& material) {
    const bool is_first = !at.so_far.material.has_constants() && at.so_far.regions.empty();
    const MaterialSpecification& body = of_body(at.so_far);
    if (is_first) return;
    const auto require = [&](bool is_same, const std::string& key) {
      if (!is_same) at.from.refuse(key, "must be the same for all materials of a body");
    };
    require(material.model == body.model, "model");
    require(material.potential == body.potential, "potential");
    require(material.plane == body.plane, "plane");
    require(material.influence == body.influence, "influence");
    require(material.kinematics == body.kinematics, "kinematics");
  };
  return keys;
}

Table<RegionSpecification> region_keys() {
  using Spec = RegionSpecification;
  using K = Key<Spec>;
  return {"region",
          {K("set", &Spec::set, known_set(), "whose points are of this material")
               .then([](auto& at, auto& region) {
                 if (region.set == rest_name)
                   at.refuse(
                       "is what `between` calls the points in no region; give the set another "
                       "name");
               })
               .moreover("no region shares points with another")
               .required()
               .early(),
           K("material", &Spec::material, material_of_body_keys("region.material"),
             "table `[region.material]`, with the keys of [`[material]`](#material)")
               .required()}};
}

Kind<std::array<std::string, 2>> two_materials() {
  const auto read = [](const Entry& at) {
    const std::vector<std::string> given = at.from.strings(at.key);
    if (given.size() != 2) at.refuse("must be two names");
    std::vector<std::string> names;
    for (const RegionSpecification& region : at.so_far.regions) names.push_back(region.set);
    if (at.so_far.material.has_constants()) names.emplace_back(rest_name);
    for (const std::string& name : given) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      at.refuse("there is no region of the set \"" + name + "\"" + did_you_mean(name, names) +
                (names.empty() ? "" : "  (there: " + listed(names) + ")"));
    }
    if (given[0] == given[1]) at.refuse("must be two materials, not one");
    return std::array{given[0], given[1]};
  };
  return {read, [](const auto& names, const Case&) { return array_text(names, toml_string); },
          "two sets of regions; `\"material\"` for the points in none"};
}

Table<InterfaceSpecification> interface_keys() {
  using Spec = InterfaceSpecification;
  using K = Key<Spec>;
  constexpr auto own = [](auto& interface) -> auto& {
    if constexpr (std::is_const_v<std::remove_reference_t<decltype(interface)>>) {
      static const MaterialSpecification none;
      return interface.material ? *interface.material : none;
    } else {
      if (!interface.material) interface.material.emplace();
      return *interface.material;
    }
  };
  return {
      "interface",
      {K("between", &Spec::between, two_materials(), "the two materials that it lies between")
           .written_if([](auto& interface, auto&) { return !interface.is_of_all(); })
           .default_words("all pairs that no other `[[interface]]` names"),
       K("rule", &Spec::rule,
         choice<InterfaceRule>({{"harmonic", InterfaceRule::harmonic},
                                {"arithmetic", InterfaceRule::arithmetic},
                                {"weaker", InterfaceRule::weaker}}),
         "what a bond between them, or an interaction of points of both, makes of the constants "
         "of its points, and of the stretches of like laws of damage: their mean, or the least")
           .unless([](auto& interface, auto&) { return interface.material.has_value(); },
                   "stands beside material; give one of them"),
       K("material", own, material_of_body_keys("interface.material"),
         "table `[interface.material]`, with the keys of [`[material]`](#material) but "
         "`density` and `scatter`: constants and damage of its own")
           .written_if([](auto& interface, auto&) { return interface.material.has_value(); })
           .early()
           .otherwise([](auto&, auto&) {}, "none: by the rule")},
      {},
      [](auto& at, auto& interface) {
        for (const auto& other : at.so_far.interfaces) {
          const auto& [a, b] = interface.between;
          if (other.between == interface.between || other.between == std::array{b, a})
            at.refuse("another interface is of the same pair");
        }
      }};
}

// ---- Supports and loads

Table<SupportSpecification> support_keys() {
  using Spec = SupportSpecification;
  using K = Key<Spec>;
  return {"support",
          {K("set", &Spec::set, known_set(), "that is held or moved").required(),
           K("displacement", &Spec::displacement, prescribed_components(), "per component")
               .required()}};
}

/// A key that gives the value of a load of a kind.
Key<LoadSpecification> load_value(LoadSpecification::Kind kind, const std::string& unit,
                                  const std::string& meaning) {
  using Spec = LoadSpecification;
  return Key<Spec>(load_key(kind), &Spec::value,
                   force_components(kind == Spec::Kind::total_force, unit), meaning)
      .then([=](auto&, auto& load) { load.kind = kind; })
      .written_if([=](auto& load, auto&) { return load.kind == kind; })
      .one_of();
}

/// Where a load acts depends on its kind.
void check_place_of_load(const Entry& at, const LoadSpecification& load) {
  using Kind = LoadSpecification::Kind;
  const bool is_on_boundary =
      load.kind == Kind::traction || load.kind == Kind::pressure || load.kind == Kind::stress;
  if (!is_on_boundary && at.from.has("side"))
    at.from.refuse("side", "is for a traction or a pressure");
  if (load.kind != Kind::traction && at.from.has("depth"))
    at.from.refuse("depth", "is for a traction");
  const bool needs_set = load.kind == Kind::body_force || load.kind == Kind::total_force;
  if (needs_set) static_cast<void>(at.from.string("set"));
  const bool is_on_surface = at.so_far.is_collocated();
  if (is_on_surface && at.from.has("depth") && load.depth != Depth::surface)
    at.from.refuse("depth", "of model lps is \"surface\", on which its tractions act");
  if (is_on_boundary && load.set.empty() && !load.side && !is_on_surface)
    at.refuse(std::string("a ") + load_key(load.kind) + " needs a side or a set that it acts on");
}

Table<LoadSpecification> load_keys() {
  using Spec = LoadSpecification;
  using K = Key<Spec>;
  using Kind = Spec::Kind;
  const auto is_traction = [](auto& load, auto&) { return load.kind == Kind::traction; };
  constexpr auto pressure = [](auto& load) -> auto& { return load.value[0]; };
  return {"load",
          {K("set", &Spec::set, known_set(), "that is loaded")
               .early()
               .written_if([](auto& load, auto&) { return !load.set.empty(); })
               .default_words("required, but for `gravity`, which then acts on the whole body, and "
                              "`traction` and `pressure` with a `side`"),
           load_value(Kind::body_force, "N/m3", "force density per component"),
           load_value(Kind::total_force, "N",
                      "force on the whole set per component, spread in proportion to the volume"),
           load_value(
               Kind::gravity, "m/s2",
               "acceleration per component, times `material.density`; layers weigh nothing unless "
               "`set` names them"),
           load_value(Kind::traction, "Pa",
                      "force per area per component on a flat part of the boundary, which keeps "
                      "its direction; on a lattice only"),
           K("pressure", pressure, scalar_field("Pa"),
             "on the exposed faces of the cells of the set's points, or of a side: it follows them "
             "as they deform, and pushes where it is positive; on a lattice only")
               .then([](auto&, auto& load) { load.kind = Kind::pressure; })
               .written_if([](auto& load, auto&) { return load.kind == Kind::pressure; })
               .one_of(),
           K("stress", &Spec::stress, stress_components(),
             "model `lps`: of the surroundings, [xx, yy, xy] or [xx, yy, zz, xy, yz, xz]; it loads "
             "the surface by its traction, the stress times the outward normal")
               .then([](auto&, auto& load) { load.kind = Kind::stress; })
               .written_if([](auto& load, auto&) { return load.kind == Kind::stress; })
               .one_of(),
           K("boundary", &Spec::boundary, text(),
             "model `lps`: the boundary of a shape of `[[lattice.shape]]`, by its `name`")
               .written_if([](auto& load, auto&) { return !load.boundary.empty(); }),
           K("side", &Spec::side, optional_side(),
             "`traction`, `pressure`: the body's outermost plane of points on a side, as of "
             "`[[lattice.layer]]`")
               .written_if([](auto& load, auto&) { return load.side.has_value(); })
               .default_words("`traction`, `pressure`: this or a `set` is required, for a traction "
                              "one in one plane of points"),
           K("depth", &Spec::depth,
             choice<Depth>(
                 {{"row", Depth::row}, {"horizon", Depth::horizon}, {"surface", Depth::surface}}),
             "`traction`: borne by the outermost row of points, spread evenly over a horizon "
             "below the boundary, or on the surface itself, as model `lps` alone has it, always")
               .written_if([=](auto& load, const Case& from) {
                 return is_traction(load, from) && !from.is_collocated();
               })},
          {},
          check_place_of_load};
}

Table<EigenstrainSpecification> eigenstrain_keys() {
  using Spec = EigenstrainSpecification;
  using K = Key<Spec>;
  return {"eigenstrain",
          {K("set", &Spec::set, known_set(), "that is strained")
               .written_if([](auto& strained, auto&) { return !strained.set.empty(); })
               .default_words("all points"),
           K("strain", &Spec::strain, scalar_field("1"),
             "that a part which nothing held would have, the same in all directions: its length "
             "over the one in the reference, less 1")
               .moreover("above −1")
               .required()}};
}

Table<Eigenstrains> temperature_keys() {
  using K = Key<Eigenstrains>;
  const auto change = [](auto& eigenstrains) -> auto& {
    if constexpr (!std::is_const_v<std::remove_reference_t<decltype(eigenstrains)>>) {
      if (!eigenstrains.temperature_change) eigenstrains.temperature_change.emplace();
      return *eigenstrains.temperature_change;
    } else {
      static const std::string none;
      return eigenstrains.temperature_change ? *eigenstrains.temperature_change : none;
    }
  };
  return {"temperature",
          {K("change", change, scalar_field("K"),
             "of the temperature from that of the reference: with `material.thermal_expansion` an "
             "eigenstrain α ΔT of all points")
               .written_if([](auto& of, auto&) { return of.temperature_change.has_value(); })
               .default_words("no change; required in the table")}};
}

/// A table without its only key is a slip.
void check_temperature(const Entry& at, const Case& result) {
  if (at.from.has("temperature") && !result.eigenstrains.temperature_change)
    static_cast<void>(at.from.table("temperature").string("change"));
}

Table<ControlTerm> control_keys() {
  using K = Key<ControlTerm>;
  return {"control",
          {K("set", &ControlTerm::set, known_set(), "whose mean displacement is taken").required(),
           K("weights", &ControlTerm::weights, coordinates(""),
             "of its components: the weighted displacements of all these tables add up to the "
             "controlled one")
               .moreover("not all zero")
               .required()}};
}

// ---- Motion in time

Table<InitialSpecification> initial_keys() {
  using Spec = InitialSpecification;
  using K = Key<Spec>;
  return {"initial",
          {K("set", &Spec::set, known_set(), "that begins with it")
               .written_if([](auto& initial, auto&) { return !initial.set.empty(); })
               .default_words("all points"),
           K("displacement", &Spec::displacement, components_of_place("m"),
             "at the time 0, per component; where a support prescribes another one, that holds"),
           K("velocity", &Spec::velocity, components_of_place("m/s"),
             "at the time 0, per component, of what no support prescribes")}};
}

Table<AbsorbingSpecification> absorbing_keys() {
  using Spec = AbsorbingSpecification;
  using K = Key<Spec>;
  return {"absorbing",
          {K("set", &Spec::set, known_set(), "that absorbs")
               .written_if([](auto& absorbing, auto&) { return !absorbing.set.empty(); })
               .default_words("all points"),
           K("rate", &Spec::rate, field_of_place("1/s"),
             "at which velocities decay, beside what forces do")
               .required()}};
}

constexpr const char *newmark_name = "newmark", *equilibrium_name = "equilibrium";

/// Supports and loads are read as soon as it is known whether they are expressions of the time, and
/// settings of the solver as soon as it is known whether steps search equilibria.
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
  return {"dynamics",
          {K("end_time", &Spec::end_time, positive("s"), "from 0 to which the motion is followed")
               .required()
               .extends(),
           K("scheme", &Spec::scheme,
             choice<MotionScheme>(
                 {{"verlet", MotionScheme::verlet}, {newmark_name, MotionScheme::newmark}}),
             "explicit steps, or implicit ones, each of which searches an equilibrium with "
             "inertia by Newton's method: for motions that are slow beside the stable step")
               .early(),
           K("start", &Spec::start,
             choice<MotionStart>(
                 {{"rest", MotionStart::rest}, {equilibrium_name, MotionStart::equilibrium}}),
             "undeformed, but for initial displacements; or in the equilibrium of supports and "
             "loads at t = 0, which is searched by Newton's method and may damage nothing")
               .early(),
           K("spectral_radius", &Spec::spectral_radius, between(0.0, 1.0),
             "of implicit steps: what a step leaves of the highest frequencies. 1: average "
             "acceleration, which keeps the energy; below 1: the generalised alpha method, which "
             "damps what steps do not resolve")
               .written_if(is_implicit),
           K("time_step", &Spec::time_step, positive("s"),
             "that is kept. Explicit: the run ends where it is longer than the stable one. "
             "Implicit: one that finds nothing is halved, down to a thousandth. The last step is "
             "shorter where it has to be")
               .written_if(is_given)
               .early()
               .moreover("explicit: at most the stable step")
               .default_words("a share of the stable step"),
           K("step_share", &Spec::step_share, between(1e-6, 0.99),
             "time step over the stable one, which is found anew as the stiffness changes")
               .unless(has_no_share,
                       "stands beside time_step, or is of explicit steps; give time_step alone"),
           K("history_every", &Spec::history_every, count_from(1, "time steps"),
             "from one row of the history to the next")
               .written_if([](auto& dynamics, auto&) { return dynamics.history_every > 0; })
               .default_words("`output.every`")}};
}

/// What goes with a motion in time, and what goes with it alone.
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
         "does not go with solver.mode = \"dynamics\": its integrals leave out the inertia");
  for (const char* key : {"loading", "control", "relaxation", "arc_length"}) {
    refuse(key,
           "does not go with solver.mode = \"dynamics\", whose supports and loads go with the "
           "time t; give their values as expressions of it");
  }
  const TomlTable solver = at.from.table("solver");
  for (const char* key : {"fragments", "elastic_horizon_ratio"}) {
    if (solver.has(key)) solver.refuse(key, "is not heeded in mode dynamics");
  }
  if (result.dynamics.is_implicit()) {
    const TomlTable dynamics = at.from.table("dynamics");
    if (!dynamics.has("time_step")) {
      dynamics.refuse("scheme",
                      "needs a time_step: implicit steps have no stable one to take a share of");
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
                    "is not heeded by explicit time steps, which search no equilibrium; "
                    "dynamics.scheme = \"newmark\" and dynamics.start = \"equilibrium\" do");
    }
  }
}

// ---- The search for equilibrium

/// "table", "table2", …
std::string load_table_key(std::size_t k) {
  std::string key = "table";
  if (k > 0) key += std::to_string(k + 1);
  return key;
}

/// Entries of a table that is an expression: one for each step, and 0 before the first.
std::vector<double> entries_of(const Entry& at, const std::string& expression, int steps) {
  try {
    const Expression of_step(expression, 0, 0.0, {"step"});
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

/// Finds the entries of all tables, and refuses tables that don't go together.
void resolve_tables(const Entry& at, LoadingSpecification& loading) {
  auto& tables = loading.tables;
  if (tables.empty()) return;
  if (tables.front().entries.empty() && tables.front().expression.empty()) {
    tables.front().entries = {0.0, 1.0};
  }
  std::vector<std::vector<double>> entries;
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const Entry table{at.from, load_table_key(k), at.so_far};
    if (!tables[k].expression.empty()) {
      tables[k].entries = entries_of(table, tables[k].expression, loading.steps);
    }
    if (tables[k].entries.empty()) table.refuse("is needed for the tables that follow it");
    entries.push_back(tables[k].entries);
    try {
      static_cast<void>(LoadingProgramme(entries));
    } catch (const InputError& error) {
      table.refuse(error.allowed());
    }
  }
}

Table<LoadingSpecification> loading_keys() {
  using Spec = LoadingSpecification;
  using K = Key<Spec>;
  Table<Spec> keys{"loading", {}};
  keys.keys.push_back(
      K("steps", &Spec::steps, integer(1, 1'000'000),
        "number of equal steps from one entry of the tables to the next, or of an expression; "
        "without a table from 0 to 1")
          .extends());
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
          k == 0 ? "values of `load` that the path goes through, linearly from one to the next: "
                   "up, down, and rests; with `[[control]]` of the controlled displacement in m"
                 : "likewise of a further load parameter, `" + parameter + "`");
    key.written_if([k](auto& loading, auto&) { return loading.tables.size() > k; })
        .default_words(k == 0 ? "`[0, 1]`; required with `[[control]]`" : "no `" + parameter + "`")
        .extends();
    keys.keys.push_back(std::move(key));
  }
  keys.keys.back().then(resolve_tables);
  const auto follows_events = [](auto&, auto& from) { return from.solver.mode == Mode::path; };
  const auto takes_steps = [](auto&, auto& from) { return from.solver.mode != Mode::path; };
  const std::vector<K> others{
      K("adaptive", &Spec::adaptive, boolean(),
        "cut a step that does not converge, and grow again; otherwise such a step ends the "
        "run")
          .extends(),
      K("smallest_step", &Spec::smallest_step, between(1e-12, 1.0),
        "of the stage (the load factor, without a table); needing a smaller one ends the run")
          .extends()
          .moreover("at most the first step"),
      K("largest_step", &Spec::largest_step, between(1e-12, 1.0),
        "of the stage, to which steps may grow")
          .extends()
          .otherwise(
              [](auto& loading, auto&) { loading.largest_step = 1.0 / loading.steps_to_entry(); },
              "the first step")
          .written_if([](auto&, auto& from) {
            return from.solver.mode != Mode::arc_length && from.solver.mode != Mode::path;
          })
          .then([](auto& at, auto& loading) {
            const double step = 1.0 / loading.steps_to_entry();
            if (loading.smallest_step > step)
              at.from.refuse("smallest_step", "must not be larger than the first step, 1 / steps");
            if (loading.largest_step < step)
              at.refuse("must not be smaller than the first step, 1 / steps");
          })
          .moreover("at least the first step"),
      K("max_broken_bonds", &Spec::max_broken_bonds, count_from(0, "bonds"),
        "mode `newton`: bonds that may break in one step; a step with more is cut. 0 is no "
        "limit")
          .written_if(takes_steps)
          .extends(),
      K("stop_below", &Spec::stop_below, between(0.0, 1.0),
        "of the largest reaction of a support so far: the run has come to its end when the largest "
        "one falls below this share of it, as that of a specimen that tears. 0: the load alone "
        "ends it")
          .extends(),
      K("event_tolerance", in(&Spec::events, &EventOptions::tolerance), between(0.0, 0.5),
        "mode `path`: bonds within this share of the most utilised one break with it; 0: those "
        "that tie with it alone")
          .written_if(follows_events),
      K("teeth", &Spec::teeth, integer(1, 1000),
        "mode `path`: most teeth of the saw-tooth that a law of damage is followed by whose force "
        "falls smoothly")
          .written_if(follows_events)};
  keys.keys.insert(keys.keys.end(), others.begin(), others.end());
  return keys;
}

/// Whether the model's tangent is symmetric, as that of an energy is.
bool has_symmetric_tangent(const Case& from) { return !from.is_collocated(); }

void check_linear(const Entry& at, const SolverSpecification& solver) {
  const std::string why = what_is_against(solver.linear, has_symmetric_tangent(at.so_far));
  if (!why.empty()) at.refuse(why);
}

void check_preconditioner(const Entry& at, SolverSpecification& solver) {
  if (solver.preconditioner == PreconditionerKind::automatic) return;
  const bool is_symmetric = has_symmetric_tangent(at.so_far);
  const std::string why = what_is_against(solver.preconditioner, is_symmetric);
  if (!why.empty()) at.refuse(why);
  if (solver.linear == LinearMethod::cholesky || solver.linear == LinearMethod::lu)
    at.refuse("is for iterative solvers, not for solver.linear = \"cholesky\" and \"lu\"");
  // Who names a preconditioner wants it used.
  if (solver.linear == LinearMethod::automatic) {
    solver.linear = is_symmetric ? LinearMethod::conjugate_gradients : LinearMethod::gmres;
  }
}

void check_tangent(const Entry& at, const SolverSpecification& solver) {
  if (solver.tangent != TangentStorage::matrix_free) return;
  if (!can_be_matrix_free({solver.linear, solver.preconditioner}))
    at.refuse(
        "does not go with this solver.linear or solver.preconditioner, which need the stored "
        "tangent");
  if (is_cpd(at.so_far)) at.refuse("is for material.model = \"bond\"");
  if (!at.so_far.foundations.empty())
    at.refuse("does not go with a [[foundation]], which the tangent is stored with");
  for (const LoadSpecification& load : at.so_far.loads) {
    if (load.kind == LoadSpecification::Kind::pressure)
      at.refuse("does not go with a [[load]] pressure, whose stiffness has to be stored");
  }
}

/// A piece that stays where it is would be torn by what it can't take up.
void check_fragments(const Entry& at, const SolverSpecification& solver) {
  if (solver.fragments == FragmentRemedy::remove && at.so_far.eigenstrains.are_there())
    at.refuse(
        "does not go with eigenstrains or a temperature: a piece that left the equations could not "
        "grow or shrink; take \"hold\"");
}

void check_stand_in(const Entry& at, const SolverSpecification& solver) {
  if (solver.elastic_horizon_ratio > 0.0 && !may_fail(at.so_far))
    at.refuse(
        "is for bodies with damage: the stand-in takes the place of the body until damage begins, "
        "and without damage it would do so to the end");
}

Choices<Mode> modes() {
  Choices<Mode> all;
  for (const DriverEntry& driver : all_drivers()) all.emplace_back(driver.mode.name, driver.mode);
  return all;
}

Table<SolverSpecification> solver_keys() {
  using Spec = SolverSpecification;
  using K = Key<Spec>;
  const auto searches = [](auto&, auto& from) {
    return !from.dynamics.is_asked_for || from.dynamics.searches();
  };
  const auto is_static = [](auto&, auto& from) { return !from.dynamics.is_asked_for; };
  return {
      "solver",
      {K("mode", &Spec::mode, choice(modes()),
         "implicit throughout; by dynamic relaxation throughout; implicit while no damage grows "
         "and by relaxation while it does; along the path itself, through limit points and "
         "bifurcations, without damage; from one breaking bond to the next; the motion in time, by "
         "explicit steps")
           .extends(),
       K("linear", &Spec::linear,
         choice<LinearMethod>({{"auto", LinearMethod::automatic},
                               {"cholesky", LinearMethod::cholesky},
                               {"pcg", LinearMethod::conjugate_gradients},
                               {"minres", LinearMethod::minres},
                               {"gmres", LinearMethod::gmres},
                               {"lu", LinearMethod::lu},
                               {"bicgstab", LinearMethod::bicgstab}}),
         "solver of the linear systems ([linear-solvers.md](linear-solvers.md)); `\"auto\"` "
         "chooses, says why, and falls back where it fails. `\"lu\"` and `\"bicgstab\"` are for "
         "models whose tangent is not symmetric, `\"gmres\"` is for all, the others are for those "
         "whose is")
           .written_if(searches)
           .extends()
           .then(check_linear),
       K("preconditioner", &Spec::preconditioner,
         choice<PreconditionerKind>({{"auto", PreconditionerKind::automatic},
                                     {"jacobi", PreconditionerKind::jacobi},
                                     {"block_jacobi", PreconditionerKind::block_jacobi},
                                     {"rigid_pieces", PreconditionerKind::rigid_pieces},
                                     {"surrogate", PreconditionerKind::surrogate},
                                     {"sines", PreconditionerKind::sines},
                                     {"riluk", PreconditionerKind::riluk},
                                     {"chebyshev", PreconditionerKind::chebyshev},
                                     {"multigrid", PreconditionerKind::multigrid},
                                     {"local_operator", PreconditionerKind::local_operator}}),
         "of the iterative ones, not for `\"cholesky\"` and `\"lu\"`; with `linear = \"auto\"` it "
         "means `\"pcg\"`; `\"auto\"` is `\"rigid_pieces\"`. `\"sines\"` is for points on a "
         "lattice along the axes, "
         "without constraints and images. Where the tangent is not symmetric: "
         "`\"local_operator\"`, which `\"auto\"` is and with which `linear = \"auto\"` means "
         "`\"gmres\"`, `\"jacobi\"` and `\"block_jacobi\"`")
           .written_if(searches)
           .extends()
           .then(check_preconditioner),
       K("tangent", &Spec::tangent,
         choice<TangentStorage>({{"auto", TangentStorage::automatic},
                                 {"stored", TangentStorage::stored},
                                 {"matrix_free", TangentStorage::matrix_free}}),
         "the tangent's blocks are stored, or computed anew in each product, which takes a third "
         "of the memory in 3D; for `material.model = \"bond\"` without `\"cholesky\"`, "
         "`\"riluk\"`, `\"chebyshev\"` and `\"multigrid\"`. `\"auto\"` stores for direct solvers")
           .written_if(searches)
           .then(check_tangent),
       K("operator", &Spec::force_operator,
         choice<ForceOperator>({{"auto", ForceOperator::automatic},
                                {"bonds", ForceOperator::bonds},
                                {"fft", ForceOperator::fft}}),
         "forces of `material.kinematics = \"linear\"`, and of `lps` as an energy, are summed bond "
         "by bond, or by fast Fourier "
         "transforms, which store no bonds and take the same time whatever the horizon: for one "
         "material on points of a lattice with equal volumes, without a `surface_correction`. "
         "Both give the same results to round-off. `\"auto\"` takes the one that is sooner: `fft` "
         "for "
         "motions by explicit steps with a horizon of 2.5 spacings and more where it can. Models "
         "`green_bond` and `correspondence`, and "
         "`lps` as printed, have `fft` alone"),
       K("predictor", &Spec::predictor,
         choice<Predictor>({{"consistent", Predictor::consistent}, {"none", Predictor::none}}),
         "the first iteration of a step linearises about the old state and spreads the jump of the "
         "supports, or, as in [CPD], about the state after the jump")
           .written_if(searches),
       K("projection", &Spec::projection,
         choice<Projection>({{"auto", Projection::automatic},
                             {"never", Projection::never},
                             {"always", Projection::always}}),
         "of interactions to their positive semidefinite part: when the exact tangent has negative "
         "pivots or leads nowhere, never, always")
           .written_if(searches),
       K("relative_tolerance", &Spec::relative_tolerance, between(1e-14, 1e-2), "of the residual")
           .written_if(searches),
       K("linear_tolerance", &Spec::linear_tolerance, between(1e-14, 1e-1),
         "largest relative residual that the linear system of a Newton iteration is left with")
           .written_if(searches),
       K("max_iterations", &Spec::max_iterations, integer(1, 1000), "of Newton in one step")
           .written_if(searches)
           .extends(),
       K("fragments", &Spec::fragments,
         choice<FragmentRemedy>({{"hold", FragmentRemedy::hold},
                                 {"remove", FragmentRemedy::remove},
                                 {"stop", FragmentRemedy::stop}}),
         "what becomes of pieces that come off: just enough of their degrees of freedom are pinned "
         "that they cannot move freely; they leave the equations and stay where they are; the run "
         "ends with outcome `fragmented`")
           .written_if(is_static)
           .then(check_fragments)
           .moreover("not `\"remove\"` with eigenstrains or a temperature"),
       K("elastic_horizon_ratio", &Spec::elastic_horizon_ratio, between(1.0, 1e3),
         "mode `adaptive`: horizon / spacing of an elastic body that stands in for the real one "
         "until damage begins; with model `bond`, `youngs_modulus` and a damage law")
           .then(check_stand_in)
           .written_if([](auto& solver, auto&) { return solver.elastic_horizon_ratio > 0.0; })
           .moreover("in 3D to 100")
           .default_words("no stand-in")}};
}

Table<SolverSpecification> arc_length_keys() {
  using Spec = SolverSpecification;
  using K = Key<Spec>;
  constexpr auto arc_length = &Spec::arc_length;
  return {"arc_length",
          {K("steps", in(arc_length, &ArcLengthOptions::steps), count_from(0, "steps"),
             "the path ends after so many, unless the load has come to its end before; 0: the load "
             "has to come there, within 10 000 steps")
               .extends(),
           K("largest_step", in(arc_length, &ArcLengthOptions::largest_step), between(1e-12, 1e6),
             "of the arc length, to which steps grow where the path is straight; the first is "
             "1/`loading.steps`, which at first is a step of the load factor")
               .extends(),
           K("bifurcation", in(arc_length, &ArcLengthOptions::branches_off),
             choice<bool>({{"branch", true}, {"straight", false}}),
             "where another path leaves a stable one: go on along that, or straight on, where "
             "states are unstable")}};
}

/// Refuses settings of the solver that a control and mode arc_length would not heed.
void check_heeded(const Entry& at, const std::string& who) {
  if (!at.from.has("solver")) return;
  const TomlTable solver = at.from.table("solver");
  const std::vector<std::pair<std::string, std::string>> heeded{{"linear", "auto"},
                                                                {"preconditioner", "auto"},
                                                                {"tangent", "auto"},
                                                                {"projection", "auto"},
                                                                {"predictor", "consistent"}};
  for (const auto& [key, value] : heeded) {
    if (solver.has(key) && solver.string(key) != value)
      solver.refuse(key, "must be \"" + value + "\" with " + who +
                             ", which has a solver and a search of its own");
  }
}

/// What goes with a load that is found, not given.
void check_found_loads(const Entry& at, const Case& result) {
  const bool is_controlled = !result.controls.empty();
  const bool is_arc_length = result.solver.mode == Mode::arc_length;
  const auto& tables = result.loading.tables;
  if (is_controlled && result.solver.mode != Mode::newton)
    throw InputError("solver.mode", '"' + std::string(result.solver.mode.name) + '"',
                     "must be \"newton\" with [[control]]");
  if (is_controlled && (!at.from.has("loading") || !at.from.table("loading").has("table")))
    throw InputError("control", "",
                     "needs loading.table, the values of the controlled displacement [m] that the "
                     "path goes through: [0, 1e-4], for example");
  if (is_arc_length && !tables.empty() && tables.front().entries.size() != 2)
    throw InputError(
        "loading.table", "",
        "must have two entries in mode arc_length, which follows one line of the load");
  if (is_arc_length && at.from.has("loading") && at.from.table("loading").has("largest_step"))
    throw InputError("loading.largest_step", "",
                     "is not heeded in mode arc_length, which has arc_length.largest_step");
  const bool is_path = result.solver.mode == Mode::path;
  if (is_path && !may_fail(result))
    throw InputError("solver.mode", "\"path\"",
                     "is for bodies with damage: it goes from one breaking bond to the next");
  if (is_path && result.solver.elastic_horizon_ratio > 0.0)
    throw InputError("solver.elastic_horizon_ratio", "", "is for mode adaptive");
  if (is_path && at.from.has("loading")) {
    for (const char* key : {"largest_step", "max_broken_bonds"}) {
      if (at.from.table("loading").has(key))
        throw InputError(std::string("loading.") + key, "",
                         "is not heeded in mode path, which goes from event to event");
    }
  }
  if (!is_path && at.from.has("loading")) {
    for (const char* key : {"event_tolerance", "teeth"}) {
      if (at.from.table("loading").has(key))
        throw InputError(std::string("loading.") + key, "", "is for solver.mode = \"path\"");
    }
  }
  if (is_controlled) check_heeded(at, "[[control]]");
  if (is_arc_length) check_heeded(at, "mode arc_length");
}

/// Damage grows in steps that are smaller than elastic ones.
int default_relaxation_steps(const Case& from) {
  constexpr int steps_of_damage = 50;
  const bool hands_over = from.solver.mode == Mode::adaptive && may_fail(from);
  const int steps = from.loading.steps_to_entry();
  if (!hands_over) return steps;
  const int entries =
      from.loading.steps / steps;  // as many as steps where these are an expression's
  return std::max(steps, (steps_of_damage + entries - 1) / entries);
}

void check_iterations(const Entry& at, const RelaxationSpecification& relaxation) {
  if (relaxation.iterations < relaxation.steps)
    at.refuse("must not be fewer than relaxation.steps");
  if (relaxation.iterations % relaxation.steps != 0)
    at.refuse("must be a multiple of relaxation.steps, " + std::to_string(relaxation.steps));
}

Table<RelaxationSpecification> relaxation_keys() {
  using Spec = RelaxationSpecification;
  using Options = RelaxationOptions;
  using K = Key<Spec>;
  const auto options = &Spec::options;
  const auto moves = [](auto& relaxation, auto&) { return relaxation.moving; };
  const auto rests = [](auto& relaxation, auto&) { return !relaxation.moving; };
  const auto flows = [](auto& relaxation, auto&) {
    return relaxation.options.method == RelaxationMethod::flow;
  };
  const auto is_dynamic = [flows](auto& relaxation, auto& from) {
    return !flows(relaxation, from);
  };
  const std::string for_dynamic = "is for method = \"dynamic\"";
  return {
      "relaxation",
      {K("steps", &Spec::steps, count_from(1),
         "number of equal steps of the *whole* load, or from one entry of `loading.table` to the "
         "next; 1/steps is the first one, whatever the implicit steps have left")
           .extends()
           .otherwise([](auto& relaxation,
                         auto& from) { relaxation.steps = default_relaxation_steps(from); },
                      "`loading.steps`; in mode `adaptive` with damage no fewer than 50. With a "
                      "table that is "
                      "an expression, which has an entry for each step: 1, and 50 in all"),
       K("method", in(options, &Options::method),
         choice<RelaxationMethod>(
             {{"dynamic", RelaxationMethod::dynamic}, {"flow", RelaxationMethod::flow}}),
         "dynamic relaxation, a motion in a made-up dynamics; or the flow without inertia, whose "
         "directions are solved for")
           .early(),
       K("flow_tolerance", in(options, &Options::flow_tolerance), between(1e-3, 0.5),
         "method `flow`: share of a step's length by which it may leave the flow's path")
           .unless(is_dynamic, "is for method = \"flow\""),
       K("peak_tolerance", &Spec::peak_tolerance, between(0.0, 1.0),
         "mode `adaptive`: a relaxed step in which the force begins to fall is halved until it is "
         "no longer than this share of the whole load; the decision that accepts it tells between "
         "which load factors the peak lies. 0: not searched")
           .unless([](auto&, auto& from) { return from.solver.mode != Mode::adaptive; },
                   "is for mode \"adaptive\"")
           .extends(),
       K("load", &Spec::moving, choice<bool>({{"fixed", false}, {"moving", true}}),
         "rests after the ramp until the body is in equilibrium, or never rests")
           .unless(flows, for_dynamic)
           .early(),
       K("iterations", &Spec::iterations, count_from(1),
         "load `moving`: iterations over the whole load, or from one entry of `loading.table` to "
         "the next, shared out equally to the steps")
           .unless(rests, "is for load = \"moving\"")
           .then(check_iterations)
           .moreover("a multiple of `steps`"),
       K("ramp", in(options, &Options::ramp), count_from(1),
         "load `fixed`: iterations over which supports and loads move to their new values")
           .unless(flows, for_dynamic)
           .unless(moves, "is for load = \"fixed\""),
       K("quiet_iterations", in(options, &Options::quiet_iterations), count_from(0),
         "load `fixed`: iterations without a further bond breaking before a state may be accepted")
           .unless(flows, for_dynamic)
           .unless(moves, "is for load = \"fixed\""),
       K("breaking", in(options, &Options::breaking),
         choice<Breaking>(
             {{"at_equilibrium", Breaking::at_equilibrium}, {"transient", Breaking::transient}}),
         "when damage is for good: in accepted states alone, so that overshoot breaks nothing; or "
         "in every iteration, as published")
           .otherwise(
               [](auto& relaxation, auto&) {
                 if (relaxation.moving) relaxation.options.breaking = Breaking::transient;
               },
               "`\"at_equilibrium\"`; `\"transient\"` if the load is `moving`"),
       K("damping", in(options, &Options::damping),
         choice<Damping>({{"adaptive", Damping::adaptive}, {"kinetic", Damping::kinetic}}),
         "as published, a coefficient from the Rayleigh quotient of the present motion; or none, "
         "and all motion stops whenever the kinetic energy has passed a peak")
           .unless(flows, for_dynamic)
           .otherwise(
               [](auto& relaxation, auto&) {
                 if (relaxation.moving) relaxation.options.damping = Damping::adaptive;
               },
               "`\"kinetic\"`; `\"adaptive\"` if the load is `moving`"),
       K("mass_factor", in(options, &Options::mass_factor), between(1.0, 1e6),
         "pseudo density over the least stable one: larger is slower and safer")
           .unless(flows, for_dynamic)
           .otherwise(
               [](auto& relaxation, auto&) {
                 if (relaxation.options.damping == Damping::adaptive)
                   relaxation.options.mass_factor = 1.0;
               },
               "2; 1 with adaptive damping"),
       K("max_iterations", in(options, &Options::max_iterations), count_from(1),
         "load `fixed`: after the ramp; a step with more fails and is cut")
           .extends(),
       K("displacement_tolerance", in(options, &Options::displacement_tolerance), between(0.0, 1.0),
         "load `fixed`: also accepts a state whose displacements changed by less than this in an "
         "iteration, ‖Δu‖/‖u‖, as published (10⁻⁹). 0: never")
           .unless(flows, for_dynamic)},
      {},
      [](auto& at, auto& relaxation) {
        relaxation.options.holds = !relaxation.moving;
        if (relaxation.moving) relaxation.options.ramp = relaxation.iterations / relaxation.steps;
        relaxation.options.relative_tolerance = at.so_far.solver.relative_tolerance;
      }};
}

// ---- Results

/// results/FOLDER_STEM, so that shipped cases of one name in several folders don't collide.
std::filesystem::path default_directory(const std::filesystem::path& case_file) {
  const auto absolute = std::filesystem::absolute(case_file).lexically_normal();
  const std::string folder = absolute.parent_path().filename().string();
  const std::string stem = absolute.stem().string();
  return std::filesystem::path("results") / (folder.empty() ? stem : folder + "_" + stem);
}

Table<OutputSpecification> output_keys() {
  using Spec = OutputSpecification;
  using K = Key<Spec>;
  return {
      "output",
      {K("directory", &Spec::directory, text(),
         "results folder, relative to the current folder; `--output` on the command line is "
         "the same")
           .otherwise(
               [](auto& output, auto& from) { output.directory = default_directory(from.file); },
               "`results/FOLDER_NAME` of the case file: `results/bar_tension` for "
               "`cases/bar/tension.toml`")
           .then([](auto& at, auto& output) {
             if (output.directory.empty()) at.refuse("is empty");
           }),
       K("every", &Spec::every, count_from(1, "steps"),
         "fields are written at every n-th accepted step, in mode `dynamics` time step, and at "
         "the last one")
           .otherwise(
               [](auto& output, auto& from) {
                 if (from.dynamics.is_asked_for)
                   output.every = std::max(1, 100 / std::max(1, from.dynamics.history_every)) *
                                  std::max(1, from.dynamics.history_every);
               },
               "1; in mode `dynamics` some 100 time steps")
           .then([](auto& at, auto& output) {
             const int rows = at.so_far.dynamics.history_every;
             if (rows > 0 && output.every % rows != 0)
               at.refuse("must be a multiple of dynamics.history_every, " + std::to_string(rows));
           })
           .extends(),
       K("count_cracks", &Spec::count_cracks, boolean(),
         "whether bonds that a `[[crack]]` has cut count as lost in `damage` and `max_damage`, "
         "so that the crack shows in the pictures from the start"),
       K("stress", &Spec::stress, boolean(),
         "whether strain and stress are among the fields: deformation gradient, strain, first "
         "Piola–Kirchhoff and Cauchy stress, von Mises' stress, principal values and "
         "directions ([theory](theory.md#strain-and-stress)); they take several times the room "
         "of the others")}};
}

/// Of fields that are looked at as a whole, over a set.
bool is_whole(const ProbeSpecification& probe, const Case&) {
  return probe_field(probe.field) == nullptr;
}

/// Whether a probe's component is one of its field's, and is there where it has to be.
void check_component(const Entry& at, const ProbeSpecification& probe) {
  const ProbeField* field = probe_field(probe.field);
  if (field == nullptr) return;
  const auto components = field->components(at.so_far.dimension);
  if (probe.component.empty()) {
    const bool must_choose = field->kind != ProbeField::Kind::scalar &&
                             field->kind != ProbeField::Kind::vector && !probe.from;
    if (must_choose)
      at.from.refuse("", "needs a component of " + probe.field + ": one of " + listed(components));
    return;
  }
  if (components.empty()) at.refuse(probe.field + " has no components");
  if (std::ranges::find(components, probe.component) == components.end())
    at.refuse("is none of " + probe.field + ", which has " + listed(components));
}

/// Whether there is an expression for each component.
void check_expected(const Entry& at, const ProbeSpecification& probe) {
  const ProbeField* const field = probe_field(probe.field);
  const std::size_t all = std::max<std::size_t>(1, field->components(at.so_far.dimension).size());
  const std::size_t components = probe.component.empty() ? all : 1;
  if (probe.expected.size() != components)
    at.refuse("needs as many expressions as there are components: " + std::to_string(components));
}

Table<CrackTipSpecification> crack_tip_keys() {
  using Spec = CrackTipSpecification;
  using K = Key<Spec>;
  return {"crack_tip",
          {K("name", &Spec::name, name(), "with which its columns begin")
               .then([](auto& at, auto& tip) {
                 for (const auto& other : at.so_far.crack_tips)
                   if (other.name == tip.name) at.refuse("another crack tip has this name");
               })
               .moreover("no other crack tip has it")
               .required(),
           K("at", &Spec::at, coordinates(), "of the tip; 3D: any place on its straight front")
               .required(),
           K("direction", &Spec::direction, coordinates(""),
             "in which the crack would go on, of any length")
               .moreover("not all zero")
               .required(),
           K("front", &Spec::front, coordinates(""),
             "3D: along the front, of any length; it goes through the whole body")
               .moreover("at a right angle on `direction`")
               .unless(in_dimension<2>, "is for dimension 3")
               .default_words("`[0, 0, 1]`"),
           K("inner", &Spec::inner, positive("m"), "inner radius of the ring of the integrals")
               .moreover("2 horizons at least")
               .written_if([](auto& tip, auto&) { return tip.inner > 0.0; })
               .default_words("2 horizons"),
           K("outer", &Spec::outer, positive("m"), "its outer radius")
               .moreover("a horizon more at least")
               .written_if([](auto& tip, auto&) { return tip.outer > 0.0; })
               .default_words("4 horizons, or twice `inner`"),
           K("cut", &Spec::cut, positive("m"),
             "length of a cut ahead of the tip, by which energy release rates are found, too: one "
             "more system of equations in every step")
               .moreover("a horizon at least")
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
      {K("name", &Spec::name, name(), "of the column")
           .then([](auto& at, auto& probe) {
             for (const auto& other : at.so_far.probes)
               if (other.name == probe.name) at.refuse("another probe has this name");
           })
           .moreover("no other probe has it")
           .required()
           .early(),
       K("set", &Spec::set, known_set(), "over whose points")
           .written_if([](auto& probe, auto&) { return !probe.set.empty(); })
           .one_of(),
       K("at", &Spec::at, coordinates(), "place whose nearest point is looked at")
           .unless(is_whole, "is for a field that every point has")
           .one_of(),
       K("from", &Spec::from, coordinates(),
         "begin of a line: the points within half a spacing of it make a table, `line_NAME.csv`")
           .unless(is_whole, "is for a field that every point has")
           .one_of(),
       K("field", &Spec::field, one_of(probe_field_names()),
         "displacement, opening, length and place in m, area in m², force in N, energy densities "
         "in "
         "J/m³, velocity in m/s, stress in Pa, angles in degrees, work of fracture and crack "
         "resistance in J/m²; "
         "`stress` is Cauchy's, `strain` Green and Lagrange's")
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
             const ProbeField* const field = probe_field(probe.field);
             if (field != nullptr && field->is_of_motion && !at.so_far.dynamics.is_asked_for)
               at.refuse("is for solver.mode = \"dynamics\"");
           })
           .early(),
       K("to", &Spec::to, coordinates(), "end of the line")
           .default_words("required with `from`")
           .then([](auto& at, auto& probe) {
             if (probe.to && !probe.from) at.refuse("goes with from");
             if (probe.from && !probe.to) at.from.refuse("", "a line from a place needs to");
             if (probe.from && *probe.to == *probe.from) at.refuse("is where the line begins");
           }),
       K("component", &Spec::component, one_of(probe_component_names()),
         "of a vector (`x`), a tensor (`xy`; of a stress or a deformation gradient first the "
         "component, then the reference direction) or `principal_stress` (`1`: the largest)")
           .unless(is_whole, "is for a field that every point has")
           .default_words("all of a vector; required for `set` and `at` with others")
           .written_if([](auto& probe, auto&) { return !probe.component.empty(); })
           .then(check_component),
       K("statistic", &Spec::statistic,
         choice<Statistic>({{"mean", Statistic::mean},
                            {"max", Statistic::max},
                            {"min", Statistic::min},
                            {"rms_error", Statistic::rms_error},
                            {"max_error", Statistic::max_error}}),
         "over the points of the set, of each component; the mean counts every point alike. "
         "`rms_error`, `max_error`: one number, the root mean square or the largest of the lengths "
         "of the differences from `expected`")
           .written_if(
               [](auto& probe, auto& from) { return !probe.set.empty() && !is_whole(probe, from); })
           .then([](auto& at, auto& probe) {
             if (at.from.has(at.key) && (probe.set.empty() || is_whole(probe, at.so_far)))
               at.refuse("is for a field over a set");
           }),
       K("expected", &Spec::expected, expected_components(),
         "what the components should be at a point's reference place")
           .written_if([](auto& probe, auto&) { return is_of_error(probe.statistic); })
           .default_words("required with `rms_error` and `max_error`")
           .then([](auto& at, auto& probe) {
             const bool is_given = at.from.has(at.key);
             if (is_given && !is_of_error(probe.statistic))
               at.refuse("goes with statistic \"rms_error\" or \"max_error\"");
             if (!is_given && is_of_error(probe.statistic))
               at.from.refuse("", "this statistic needs expected");
             if (is_given) check_expected(at, probe);
           }),
       K("axis", &Spec::axis, axis(),
         "`poisson_ratio`: direction of the pull; `crack_length`, `crack_begin`, `crack_end`: "
         "direction in which the crack runs; `crack_angle`: that it is counted from")
           .unless(has_no_axis,
                   "is for fields \"poisson_ratio\", \"crack_length\", \"crack_begin\", "
                   "\"crack_end\" and \"crack_angle\""),
       K("other", &Spec::other, known_set(), "`opening`: the set on the other side of the crack")
           .unless(has_no_other, "is for field \"opening\"")
           .required("required with it")}};
}

// ---- The document

Table<Case> all_keys() {
  using K = Key<Case>;
  const auto searches = [](auto& result, auto&) { return !result.dynamics.is_asked_for; };
  return {
      "",
      {K("title", &Case::title, text(), "one line for people")
           .moreover("any text")
           .otherwise(
               [](auto& result, auto&) {
                 result.title = std::filesystem::path(result.file).stem().string();
               },
               "name of the file without its ending")
           .early(),
       K("dimension", &Case::dimension, integer(1, 3), "of the space the body lives in")
           .required()
           .early(),
       K("lattice", itself, lattice_keys(), "table: points on a lattice")
           .written_if(body_is<Lattice>)
           .one_of(),
       K("points", itself, points_keys(), "table: points from a file")
           .written_if(body_is<PointSource>)
           .one_of(),
       K("set", &Case::sets, set_keys(), "tables: named sets of points"),
       K("crack", &Case::cracks, crack_keys(), "tables: cracks that are there from the start"),
       K("quadrature", itself, quadrature_keys(), "table: corrections of the weights"),
       K("material", &Case::material, material_keys("material"),
         "table: model, constants, damage; of the points in no region")
           .otherwise([](auto&, auto&) {}, "required without `[[region]]`")
           .written_if([](auto& result, auto&) { return result.material.has_constants(); }),
       K("region", &Case::regions, region_keys(),
         "tables: sets of points with materials of their own")
           .then(check_regions),
       K("interface", &Case::interfaces, interface_keys(),
         "tables: what holds between points of two materials")
           .then([](auto& at, auto& result) {
             if (!result.interfaces.empty() && result.regions.empty()) at.refuse("needs regions");
           }),
       K("support", &Case::supports, support_keys(), "tables: prescribed displacements"),
       K("rigid", in(&Case::constraints, &ConstraintSpecification::rigid_sets), rigid_set_keys(),
         "tables: sets that move as rigid bodies"),
       K("roller", in(&Case::constraints, &ConstraintSpecification::rollers), roller_keys(),
         "tables: points that slide, at any angle"),
       K("constraint", in(&Case::constraints, &ConstraintSpecification::linear),
         linear_constraint_keys(), "tables: linear constraints between sets"),
       K("symmetry", in(&Case::constraints, &ConstraintSpecification::symmetries), symmetry_keys(),
         "tables: planes of symmetry, with the bonds across them"),
       K("period", in(&Case::constraints, &ConstraintSpecification::periods), period_keys(),
         "tables: sides across which the body repeats"),
       K("load", &Case::loads, load_keys(), "tables: forces"),
       K("foundation", &Case::foundations, foundation_keys(),
         "tables: springs between a part of the body and a ground"),
       K("eigenstrain", in(&Case::eigenstrains, &Eigenstrains::given), eigenstrain_keys(),
         "tables: strains that cost no energy"),
       K("temperature", &Case::eigenstrains, temperature_keys(), "table: change of temperature")
           .then(check_temperature)
           .written_if([](auto& result, auto&) {
             return result.eigenstrains.temperature_change.has_value();
           }),
       K("control", &Case::controls, control_keys(),
         "tables: the displacement that is controlled in the place of `load`"),
       K("initial", &Case::initial, initial_keys(),
         "tables: displacements and velocities at the time 0"),
       K("absorbing", &Case::absorbing, absorbing_keys(), "tables: layers that absorb waves"),
       K("loading", &Case::loading, loading_keys(), "table: the way of the loads, and its steps")
           .written_if(searches)
           .early(),
       K("solver", &Case::solver, solver_keys(), "table: search for equilibrium"),
       K("relaxation", &Case::relaxation, relaxation_keys(), "table: steps by dynamic relaxation")
           .written_if(searches),
       K("arc_length", &Case::solver, arc_length_keys(), "table: steps in mode `arc_length`")
           .written_if(searches)
           .then(check_found_loads),
       K("dynamics", &Case::dynamics, dynamics_keys(), "table: the motion in time")
           .early()
           .unless([](auto& result, auto&) { return !result.dynamics.is_asked_for; }, "")
           .default_words("required in mode `dynamics`"),
       K("output", &Case::output, output_keys(), "table: results folder"),
       K("probe", &Case::probes, probe_keys(), "tables: values that enter the history"),
       K("crack_tip", &Case::crack_tips, crack_tip_keys(),
         "tables: J, stress intensity factors and T-stress in the history")},
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
      if (table.name == "lattice.shape") add_shapes(all, table);
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

const std::vector<std::string>& extending_keys() {
  static const auto keys = [] {
    std::vector<std::string> extending;
    for (const auto& table : table_descriptions())
      for (const auto& key : table.keys)
        if (key.extends) extending.push_back(table.name + "." + key.name);
    return extending;
  }();
  return keys;
}

}  // namespace peristat
