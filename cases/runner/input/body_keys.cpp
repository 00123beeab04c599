#include "cases/runner/input/body_keys.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "cases/runner/input/key_kinds.hpp"
#include "cases/runner/input/shape_keys.hpp"
#include "cases/runner/input/unit_system.hpp"
#include "cases/runner/input/value_schema.hpp"
#include "solvers/formulations/formulations.hpp"
#include "src/core/expression.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/point_file.hpp"
#include "src/neighbourhood/optimised_weights.hpp"

namespace peristat {
namespace {

constexpr auto lattice = [](auto& from) -> auto& { return std::get<Lattice>(from.body); };
constexpr auto points = [](auto& from) -> auto& { return std::get<PointSource>(from.body); };

template <class Member>
Key<Case> thickness(Member cross_section) {
  return Key<Case>("thickness", cross_section, positive("m"),
                   "thickness of the plate, dimension 2 only")
      .unless(in_dimension<1>, "is for dimension 2; in dimension 1 give area")
      .unless(in_dimension<3>, "is for dimension 2 only")
      .default_words("1")
      .on_ranks();
}

template <class Member>
Key<Case> area(Member cross_section) {
  return Key<Case>("area", cross_section, positive("m2"),
                   "cross-section of the bar, dimension 1 only")
      .unless(in_dimension<2>, "is for dimension 1; in dimension 2 give thickness")
      .unless(in_dimension<3>, "is for dimension 1 only")
      .default_words("1")
      .on_ranks();
}

template <class Spec>
Key<Spec> where(const std::string& meaning, const std::string& fallback) {
  return Key<Spec>("where", &Spec::where, condition(), meaning)
      .written_if([](auto& spec, auto&) { return !spec.where.empty(); })
      .default_words(fallback);
}

Table<ShapeStep> shape_step_keys() {
  using K = Key<ShapeStep>;
  using Action = ShapeStep::Action;
  return {
      "lattice.shape",
      {K("add", &ShapeStep::shape, shape_beside({"name", "cuts_bonds"}), "kind of the shape to add")
           .written_if([](auto& step, auto&) { return step.action == Action::add; })
           .one_of(),
       K("subtract", &ShapeStep::shape, shape_beside({"name", "cuts_bonds"}),
         "kind of the shape to subtract")
           .then([](auto&, auto& step) { step.action = Action::subtract; })
           .written_if([](auto& step, auto&) { return step.action == Action::subtract; })
           .one_of(),
       K("name", &ShapeStep::name, text(),
         "name of the shape, by which loads refer to its boundary")
           .written_if([](auto& step, auto&) { return !step.name.empty(); }),
       K("cuts_bonds", &ShapeStep::cuts_bonds, boolean(),
         "`subtract`: whether bonds that cross the shape are cut. Otherwise bonds longer than "
         "its width bridge it")
           .written_if([](auto& step, auto&) { return step.cuts_bonds; })
           .then([](auto& at, auto& step) {
             if (step.cuts_bonds && step.action == Action::add)
               at.refuse("is for a shape that is subtracted");
           })}};
}

Table<Layer> layer_keys() {
  using K = Key<Layer>;
  return {"lattice.layer",
          {K("name", &Layer::name, set_name(), "name of the layer and of its set").required(),
           K("side", &Layer::side, side(), "side of the body").required(),
           K("thickness", &Layer::thickness, integer(1, 1000, "spacings"), "number of planes"),
           where<Layer>("expression; the layer keeps only the points where it is not zero",
                        "all points of the layer")}};
}

Table<Refinement> refinement_keys() {
  using K = Key<Refinement>;
  return {"lattice.refine",
          {K("shape", &Refinement::shape, shape_beside({"spacing", "growth"}),
             "kind of the region, which has smooth sides and may reach beyond the body")
               .required(),
           K("spacing", &Refinement::spacing, positive("m"), "distance of points in the region")
               .moreover("below `lattice.spacing`, at least 1/64 of it")
               .required(),
           K("growth", &Refinement::growth, between(0.01, 0.5, ""),
             "by how much the spacing grows per distance from the region, up to "
             "`lattice.spacing`")}};
}

}  // namespace

Table<Case> lattice_keys() {
  using K = Key<Case>;
  return {
      "lattice",
      {K("spacing", in(lattice, &Lattice::spacing), spacing(),
         "distance between neighbouring points, or one distance along each of the lattice's axes")
           .required()
           .on_ranks(),
       K("points", in(lattice, &Lattice::arrangement),
         choice<Arrangement>(
             {{"lattice", Arrangement::lattice}, {"blue_noise", Arrangement::blue_noise}}),
         "`\"lattice\"`: points on the lattice; `\"blue_noise\"`: points at random, at about the "
         "spacing from their neighbours, with the volumes of their Voronoi cells")
           .unless(in_dimension<1>, "is for dimensions 2 and 3")
           .moreover("`blue_noise` with models `bond`, `state` and `lps` as an energy")
           .early()
           .on_ranks(),
       K("lloyd_steps", in(lattice, &Lattice::lloyd_steps), integer(0, 100, ""),
         "number of times that points of blue noise move to the centroids of their Voronoi cells")
           .unless([](auto& from,
                      auto&) { return lattice(from).arrangement != Arrangement::blue_noise; },
                   "is for points = \"blue_noise\""),
       K("angle", in(lattice, &Lattice::angle), between(-360.0, 360.0, "degrees"),
         "angle by which the lattice is rotated relative to the body, anticlockwise about the "
         "origin, in 3D about the z axis. Shapes, layers and sets are not rotated")
           .unless(in_dimension<1>, "is for dimensions 2 and 3")
           .on_ranks(),
       K("horizon_ratio", &Case::horizon_ratio, number(Range::positive("-"), "1 to 1000"),
         "horizon / spacing; if spacings differ, horizon / geometric mean of the spacings")
           .then([](auto& at, auto& result) {
             if (result.horizon_ratio < 1.0)
               at.refuse(
                   "the horizon is smaller than the spacing; must be at least 1, usually 3.015");
             const Spacing& spacing = lattice(result).spacing;
             const double horizon = result.horizon_ratio * spacing;
             if (!spacing.is_square() && horizon < spacing.largest())
               at.refuse("gives a horizon of " + number_text(horizon) +
                         " m (it refers to the geometric mean of the spacings), smaller than the "
                         "largest spacing, " +
                         number_text(spacing.largest()) + " m");
           })
           .moreover("in 3D to 100; with model `cpd` to 50 in 2D, to 8 in 3D")
           .on_ranks(),
       thickness(in(lattice, &Lattice::cross_section)), area(in(lattice, &Lattice::cross_section)),
       K("origin", in(lattice, &Lattice::origin),
         choice<LatticeOrigin>(
             {{"cell_centres", LatticeOrigin::cell_centres}, {"nodes", LatticeOrigin::nodes}}),
         "position of the points relative to the lower corner of the first shape. "
         "`\"cell_centres\"`: half a spacing inside; `\"nodes\"`: on the corner itself")
           .on_ranks(),
       K("volumes", in(lattice, &Lattice::volumes),
         choice<CellVolumes>(
             {{"cells", CellVolumes::whole}, {"fractional", CellVolumes::fractional}}),
         "volumes of points. `\"cells\"`: the whole cell, if its lattice point lies in the body; "
         "`\"fractional\"`: the part of each cell that lies in the body")
           .moreover("`fractional` with model `bond`")
           .on_ranks(),
       K("perturbation", in(lattice, &Lattice::perturbation), between(0.0, 0.49, "spacings"),
         "largest random shift of a point along each of the lattice's axes; points of layers are "
         "not moved")
           .on_ranks(),
       K("cell_perturbation", in(lattice, &Lattice::cell_perturbation),
         between(0.0, 0.249, "spacings"),
         "largest random shift of the corners of cells inside the body along each of the lattice's "
         "axes; a point is at the centroid of its cell and has the volume of the cell")
           .unless(in_dimension<3>, "is for dimensions 1 and 2")
           .moreover("model `bond`")
           .on_ranks(),
       K("seed", in(lattice, &Lattice::seed),
         count_from(0, "", std::numeric_limits<std::int64_t>::max()),
         "seed of the random shifts and positions; the same seed gives the same points")
           .on_ranks(),
       K("shape", in(lattice, &Lattice::shapes), shape_step_keys(),
         "tables: shapes that make up the body")
           .then([](auto& at, auto& result) {
             if (lattice(result).shapes.empty())
               at.refuse("this array of tables is missing; a lattice needs at least one shape");
           })
           .required("at least one is required")
           .on_ranks(),
       K("refine", in(lattice, &Lattice::refinements), refinement_keys(),
         "tables: regions in which points of blue noise, and with them their "
         "[horizons](theory.md#horizon-per-point), are finer")
           .unless([](auto& from,
                      auto&) { return lattice(from).arrangement != Arrangement::blue_noise; },
                   "is for points = \"blue_noise\""),
       K("layer", in(lattice, &Lattice::layers), layer_keys(), "tables: points outside the body")
           .on_ranks()},
      [](auto&, auto& result) {
        result.body = Lattice();
        lattice(result).dimension = result.dimension;
        lattice(result).functions = given_functions(result);
      }};
}

namespace {

const Table<PointHorizon>& point_horizon_keys() {
  using K = Key<PointHorizon>;
  static const Table<PointHorizon> keys{"points.horizon",
                                        {K("ratio", &PointHorizon::ratio, between(1.0, 1000.0),
                                           "horizon of each point divided by its size, which is "
                                           "the edge of a square or cube of its volume")
                                             .required()}};
  return keys;
}

Kind<PointHorizon> point_horizon() {
  const Kind<double> length = positive("m");
  const auto read = [length](const Entry& at) {
    PointHorizon horizon;
    if (at.from.is_table(at.key)) {
      point_horizon_keys().read({at.from.table(at.key), "", at.so_far}, horizon);
    } else {
      horizon.length = length.read(at);
    }
    return horizon;
  };
  const auto text = [length](const PointHorizon& horizon, const Case& from) {
    return horizon.ratio > 0.0 ? "{ ratio = " + toml_number(horizon.ratio) + " }"
                               : length.text(horizon.length, from);
  };
  return {read,
          text,
          either_schema({length.schema, point_horizon_keys().schema()}),
          "positive, or `{ ratio = … }`",
          "m",
          ValueForm::number};
}

}  // namespace

Table<Case> points_keys() {
  using K = Key<Case>;
  constexpr auto are_given = [](const Case& from, const Case&) {
    return from.givens->points.has_value();
  };
  constexpr auto has_mesh = [](const Case& from, const Case&) {
    const auto* const source = std::get_if<PointSource>(&from.body);
    return source != nullptr && source->is_mesh();
  };
  constexpr auto is_no_mesh = [has_mesh](const Case& from, const Case& so_far) {
    return !has_mesh(from, so_far);
  };
  return {"points",
          {K("file", in(points, &PointSource::file), file_beside_the_case(),
             "file of points as text with commas or blanks, or a mesh, chosen by the ending of the "
             "name (.msh, .inp, .vtu, .vtk, .exo, .e, .ex2, .med); its path is relative to the "
             "case file's folder")
               .required()
               .unless(are_given,
                       "cannot be combined with points that a program gives; leave one of them out")
               .early()
               .then([](auto&, auto& from) {
                 if (points(from).is_mesh()) return;
                 for (const std::string& name : further_columns(points(from).file, from.dimension))
                   from.columns[name];
               })
               .on_ranks(),
           K("horizon", in(points, &PointSource::horizon), point_horizon(),
             "horizon, the same for every point; or `{ ratio = 3.015 }`, a "
             "[horizon per point](theory.md#horizon-per-point) of 3.015 times its size, for model "
             "`bond` and points of different sizes")
               .moreover("at least the mean spacing; at most as many mean spacings as "
                         "`lattice.horizon_ratio` allows")
               .required()
               .early()
               .describes([](auto& all) { point_horizon_keys().describe(all); })
               .on_ranks(),
           K("length_unit", in(points, &PointSource::length_unit), positive("m"),
             "unit of the coordinates in the file; its volumes are in this unit cubed")
               .otherwise(
                   [](auto& result, auto&) {
                     points(result).length_unit = unit_system(result.units).length.size();
                   },
                   "1, or the `length` of `[units]`")
               .written_if([](auto& from, auto&) { return points(from).length_unit != 1.0; })
               .on_ranks(),
           K("neighbours", in(points, &PointSource::neighbours), file_beside_the_case(),
             "file with the neighbours of the points and the shares of their volumes that count; "
             "its path is relative to the case file's folder. For model `bond`")
               .unless(has_mesh, "is for a file of text")
               .unless(are_given, "is for points from a file")
               .written_if([](auto& from, auto&) { return !points(from).neighbours.empty(); })
               .then([](auto& at, auto& result) {
                 if (!points(result).neighbours.empty() && points(result).horizon.ratio > 0.0)
                   at.refuse("needs one horizon for all points, not a ratio");
               })
               .default_words("all points within the horizon"),
           K("at", in(points, &PointSource::at),
             choice<PointsAt>({{"elements", PointsAt::elements}, {"nodes", PointsAt::nodes}}),
             "for a mesh: where the points are. `\"elements\"`: at the centroid of each element, "
             "with the "
             "volume of the element; `\"nodes\"`: at each node, with its share of the volumes of "
             "the elements around it")
               .default_words("`\"elements\"`")
               .unless(is_no_mesh, "is for a mesh")
               .written_if(has_mesh),
           K("cut_bonds", in(points, &PointSource::cut_bonds), boolean(),
             "for a mesh: whether the boundary of the elements cuts the bonds that leave the body")
               .default_words("true")
               .unless(is_no_mesh, "is for a mesh")
               .written_if(has_mesh),
           thickness(in(points, &PointSource::cross_section)),
           area(in(points, &PointSource::cross_section))},
          [](auto& at, auto& result) {
            result.body = PointSource();
            const std::optional<Points>& given = result.givens->points;
            if (!given) return;
            if (given->dimension != result.dimension)
              at.refuse("the points that the program gives have dimension " +
                        std::to_string(given->dimension) + ", the case has " +
                        std::to_string(result.dimension));
            for (const auto& [name, values] : given->columns) {
              const std::string why_not = why_no_column(name);
              if (!why_not.empty()) at.refuse("the column \"" + name + "\" " + why_not);
              result.columns[name];
            }
          }};
}

Table<SetRule> set_keys() {
  using K = Key<SetRule>;
  return {"set",
          {K("name", &SetRule::name, set_name(), "name of the set").required(),
           where<SetRule>("expression; the set has the points where it is not zero",
                          "this or `shape` is required"),
           K("shape", &SetRule::shape, shape_inside(),
             "shape; the set has the points in it. Its keys are those of `[[lattice.shape]]`: `{ "
             "box = { min = [0, 0], max = [1, 1] } }`")
               .describes(describe_shapes)
               .default_words("this or `where` is required")},
          {},
          [](auto& at, auto& set) {
            if (set.where.empty() && !set.shape) at.refuse("needs where or shape");
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
  const std::string in_space = "is for dimension 2; in 3D give vertices",
                    beside_outline = "can't be given together with outline; give only one of them";
  return {"crack",
          {K("outline", in(outline, &CrackOutline::vertices), pairs(),
             "2D: corners of a closed polygon. Its sides cut bonds. The last corner is joined to "
             "the first")
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
             "3D: corners of a polygon in order. The last corner is joined to the first")
               .unless(in_dimension<2>, "is for dimension 3; in 2D give from and to, or an outline")
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

// ---- The quadrature

Table<Case> quadrature_keys() {
  using K = Key<Case>;
  const auto with = [](Option option) {
    return [option](auto&, const Case& from) { return takes(from, option); };
  };
  constexpr auto collocation = [](auto& from) -> auto& { return from.collocation; };
  return {
      "quadrature",
      {K("form", &Case::form,
         choice<SolidForm>({{"collocation", SolidForm::collocation},
                            {"energy", SolidForm::energy},
                            {"printed", SolidForm::printed}}),
         "model `lps`. `\"collocation\"`: forces at points by a quadrature that is exact for "
         "linear displacements up to the surface; they have no potential. `\"energy\"`: forces of "
         "an [energy](theory.md#the-solid-as-an-energy), with a symmetric tangent and all modes "
         "and loads of the other models (mode `path`: with damage by release). `\"printed\"`: "
         "forces "
         "of [FCBM] (A-8), for comparisons only; they have no potential where neighbourhoods "
         "differ, and need "
         "`solver.operator = \"fft\"` in mode `dynamics` with `scheme = \"verlet\"`")
           .written_if(with(Option::form))
           .on_ranks(),
       K("volume_correction", &Case::volume_correction,
         choice<VolumeCorrection>({{"none", VolumeCorrection::none},
                                   {"linear", VolumeCorrection::linear},
                                   {"exact", VolumeCorrection::exact},
                                   {"exact_centroids", VolumeCorrection::exact_centroids}}),
         "share of a neighbour's volume that counts near the horizon. `\"none\"`: all of it; "
         "`\"linear\"`: linear over half a spacing to either side; `\"exact\"`: the part of its "
         "cell within the horizon; `\"exact_centroids\"`: the same, with the bond's length and "
         "influence taken at that part's centroid. The last two are for whole cells of a lattice, "
         "whose corners `cell_perturbation` may shift")
           .written_if(with(Option::volume_correction))
           .on_ranks(),
       K("horizon_shape", &Case::horizon_shape,
         choice<HorizonShape>({{"ball", HorizonShape::ball},
                               {"box", HorizonShape::box},
                               {"diamond", HorizonShape::diamond}}),
         "shape of the neighbourhood. A point interacts with the points within the horizon, by a "
         "measure of their distance. `\"ball\"`: its length; `\"box\"`: its largest component "
         "along the "
         "lattice's axes; `\"diamond\"`: the sum of these components. Boxes and "
         "diamonds are stiffer along some directions than along others: "
         "[moduli](theory.md#horizon-shapes) are means over all directions")
           .written_if(with(Option::horizon_shape))
           .on_ranks(),
       K("surface_correction", &Case::surface_correction,
         choice<SurfaceCorrection>({{"none", SurfaceCorrection::none},
                                    {"volume", SurfaceCorrection::volume},
                                    {"energy", SurfaceCorrection::energy}}),
         "factor that restores the stiffness of points whose neighbourhood is cut by a surface. "
         "`\"none\"`: no factor; `\"volume\"`: from the volume of the neighbourhood; `\"energy\"`: "
         "from the energy of simple deformations")
           .written_if(with(Option::surface_correction))
           .on_ranks(),
       K("weights", &Case::weights,
         choice<InteractionWeights>(
             {{"mean", InteractionWeights::mean}, {"bulk", InteractionWeights::bulk}}),
         "model `cpd`: weights of interactions near surfaces. `\"mean\"`: from the mean of their "
         "points' effective volumes; `\"bulk\"`: as in the bulk everywhere")
           .written_if(with(Option::weights))
           .on_ranks(),
       K("degree", in(collocation, &CollocationSpecification::degree),
         count_from(least_exact_degree, "", most_exact_degree),
         "model `lps` by collocation: degree of the polynomials for which the quadrature is exact")
           .written_if(with(Option::collocation))
           .on_ranks(),
       K("traction_form", in(collocation, &CollocationSpecification::traction_form),
         choice<TractionForm>({{"full", TractionForm::full}, {"paper", TractionForm::paper}}),
         "model `lps` by collocation: part of the displacements' continuation beyond the boundary "
         "that is used. `\"full\"`: all of it, which is exact for linear fields on every grid; "
         "`\"paper\"`: the part that [LPS] eq. 4.6 keeps")
           .written_if(with(Option::collocation))
           .on_ranks(),
       K("normals", in(collocation, &CollocationSpecification::normals),
         choice<NormalSource>(
             {{"numerical", NormalSource::numerical}, {"exact", NormalSource::exact}}),
         "model `lps` by collocation: normals of surfaces. `\"numerical\"`: from the "
         "neighbourhoods; `\"exact\"`: from the shapes' faces, at points that have one face and "
         "all of their bonds")
           .written_if(with(Option::collocation))
           .on_ranks()}};
}

void check_quadrature(const Entry& at, const Case& result) {
  if (!at.from.has("quadrature")) return;
  const TomlTable quadrature = at.from.table("quadrature");
  const std::array<std::pair<const char*, Option>, 8> options{
      {{"volume_correction", Option::volume_correction},
       {"horizon_shape", Option::horizon_shape},
       {"surface_correction", Option::surface_correction},
       {"weights", Option::weights},
       {"form", Option::form},
       {"degree", Option::collocation},
       {"traction_form", Option::collocation},
       {"normals", Option::collocation}}};
  for (const auto& [key, option] : options) {
    if (!quadrature.has(key) || takes(result, option)) continue;
    // Corrections that there are none of are as good as not given.
    const bool is_none = option != Option::collocation &&
                         (quadrature.string(key) == "none" || quadrature.string(key) == "ball");
    if (!is_none) quadrature.refuse(key, is_for(option));
  }
}

}  // namespace peristat
