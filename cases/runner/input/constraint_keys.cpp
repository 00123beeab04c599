#include "cases/runner/input/constraint_keys.hpp"

#include <algorithm>

#include "cases/runner/input/key_kinds.hpp"

namespace peristat {
namespace {

const Range any_number;

}  // namespace

Table<RigidSetSpecification> rigid_set_keys() {
  using Spec = RigidSetSpecification;
  using K = Key<Spec>;
  return {"rigid",
          {K("set", &Spec::set, known_set(), "set whose points move as one rigid body").required(),
           K("centre", &Spec::centre, coordinates(),
             "reference position of the centre of rotation, about which moments are reported, too")
               .default_words("centre of the set's volume"),
           K("displacement", &Spec::displacement, free_components(Components::axes, "m"),
             "displacement of the centre, per component"),
           K("rotation", &Spec::rotation, free_components(Components::rotations, "rad"),
             "rotation vector: in 2D one component, about z")},
          [](auto& at, auto&) {
            if (at.so_far.dimension == 1)
              at.refuse("is for dimension 2 and 3; in 1D prescribe a displacement");
          }};
}

Table<RollerSpecification> roller_keys() {
  using Spec = RollerSpecification;
  using K = Key<Spec>;
  return {
      "roller",
      {K("set", &Spec::set, known_set(),
         "set of points, each of which can slide at right angles to the normal")
           .written_if([](auto& roller, auto&) { return !roller.at; })
           .one_of(),
       K("at", &Spec::at, coordinates(),
         "position at which a roller touches the body. It holds the mean displacement of the "
         "points around, with weights that give the displacement at this position")
           .early()
           .one_of(),
       K("to", &Spec::to, coordinates(),
         "3D: other end of the line along which the roller touches the body")
           .unless(in_dimension<2>, "is for dimension 3: in 2D a roller touches at a point")
           .unless([](auto& roller, auto&) { return !roller.at; }, "needs the key at")
           .default_words("a point"),
       K("name", &Spec::label, name(), "with `at`: name under which its reaction is reported")
           .unless([](auto& roller, auto&) { return !roller.at; }, "needs the key at")
           .required("required with `at`"),
       K("normal", &Spec::normal, coordinates(""), "direction that is held, a vector of any length")
           .moreover("not all zero")
           .required(),
       K("displacement", &Spec::displacement, expression_or_free(),
         "displacement along the normal; `\"free\"`: unknown, but the same for all points of the "
         "set (a platen without friction that does not rotate)")},
      [](auto& at, auto&) {
        if (at.so_far.dimension == 1)
          at.refuse("is for dimension 2 and 3; in 1D prescribe a displacement");
      }};
}

Table<LinearConstraintSpecification> linear_constraint_keys() {
  using Spec = LinearConstraintSpecification;
  using K = Key<Spec>;
  const Table<ControlTerm> term{"constraint.term",
                                {Key<ControlTerm>("set", &ControlTerm::set, known_set(),
                                                  "set whose mean displacement is taken")
                                     .required(),
                                 Key<ControlTerm>("weights", &ControlTerm::weights, coordinates(""),
                                                  "weights of the mean displacement's components")
                                     .required()}};
  return {"constraint",
          {K("name", &Spec::name, name(), "name under which its force is reported").required(),
           K("displacement", &Spec::displacement, expression_of_load(),
             "sum of the weighted mean displacements of all terms"),
           K("term", &Spec::terms, term, "tables: the terms").required()},
          {},
          [](auto& at, auto& spec) {
            if (spec.terms.empty()) at.refuse("needs at least one [[constraint.term]]");
          }};
}

Table<FoundationSpecification> foundation_keys() {
  using Spec = FoundationSpecification;
  using K = Key<Spec>;
  const auto has_modulus = [](auto& of, auto&) { return of.modulus != Coordinates{}; };
  const auto has_stiffness = [](auto& of, auto&) { return of.stiffness != Coordinates{}; };
  return {
      "foundation",
      {K("name", &Spec::name, name(), "name under which its force is reported").required(),
       K("set", &Spec::set, known_set(),
         "set on the foundation; with `modulus` one plane of points on the boundary")
           .written_if([](auto& of, auto&) { return !of.set.empty(); })
           .default_words("required, except for `modulus` with a `side`"),
       K("side", &Spec::side, optional_side(),
         "`modulus`: the body's outermost plane of points on a side, or the side that is meant if "
         "the set lies on several")
           .written_if([](auto& of, auto&) { return of.side.has_value(); })
           .default_words("none"),
       K("modulus", &Spec::modulus, stiffnesses("N/m3"),
         "traction per displacement along each axis, on a flat part of the boundary; on a "
         "lattice only")
           .written_if(has_modulus)
           .one_of(),
       K("stiffness", &Spec::stiffness, stiffnesses("N/m"),
         "stiffness of all springs of the set together along each axis, distributed in proportion "
         "to the volume")
           .written_if(has_stiffness)
           .one_of(),
       K("displacement", &Spec::displacement, displacement_components(),
         "displacement of the ground, per component")},
      {},
      [](auto& at, auto& of) {
        const bool is_on_boundary = of.modulus != Coordinates{};
        if (!is_on_boundary) static_cast<void>(at.from.string("set"));
        if (!is_on_boundary && of.side) at.from.refuse("side", "is for a modulus");
        if (of.set.empty() && !of.side) at.refuse("a modulus needs a side or a set");
      }};
}

Table<ObstacleSpecification> obstacle_keys() {
  using Spec = ObstacleSpecification;
  using K = Key<Spec>;
  using Surface = RigidSurface;
  const auto is_plane = [](auto& of, auto&) { return of.surface.kind == Surface::Kind::plane; };
  const auto is_curved = [](auto& of, auto&) { return of.surface.kind != Surface::Kind::plane; };
  const auto has_no_axis = [](auto& of, auto& from) {
    return of.surface.kind != Surface::Kind::cylinder || from.dimension < 3;
  };
  return {
      "obstacle",
      {K("name", &Spec::name, name(), "name under which its force is reported").required(),
       K("set", &Spec::set, known_set(), "set of the points that it can touch")
           .written_if([](auto& of, auto&) { return !of.set.empty(); })
           .default_words("all points"),
       K("shape", in(&Spec::surface, &Surface::kind),
         choice<Surface::Kind>({{"plane", Surface::Kind::plane},
                                {"cylinder", Surface::Kind::cylinder},
                                {"sphere", Surface::Kind::sphere}}),
         "shape of its surface: in 1D a plane, in 2D a plane or a cylinder (a disk)")
           .early()
           .required(),
       K("point", in(&Spec::surface, &Surface::point), coordinates(),
         "a place on the plane or on the cylinder's axis, or the centre of the sphere; moments are "
         "reported about it")
           .required(),
       K("normal", in(&Spec::surface, &Surface::direction), coordinates(""),
         "`plane`: direction from it towards the body, a vector of any length")
           .moreover("not all zero")
           .unless(is_curved, "is for shape \"plane\"")
           .required("required for a plane"),
       K("axis", in(&Spec::surface, &Surface::direction), coordinates(""),
         "`cylinder` in 3D: direction of its axis, a vector of any length")
           .moreover("not all zero")
           .unless(has_no_axis, "is for shape \"cylinder\" in 3D")
           .required("required for a cylinder in 3D"),
       K("radius", in(&Spec::surface, &Surface::radius), positive("m"),
         "`cylinder`, `sphere`: radius, at least two spacings")
           .unless(is_plane, "is for shapes \"cylinder\" and \"sphere\"")
           .required("required for these"),
       K("inside", in(&Spec::surface, &Surface::is_hollow), boolean(),
         "`cylinder`, `sphere`: the body is inside of it")
           .unless(is_plane, "is for shapes \"cylinder\" and \"sphere\""),
       K("displacement", &Spec::displacement, obstacle_displacement(),
         "displacement of the obstacle, per component; `\"free\"` for the one along which a force "
         "drives it")
           .early(),
       K("force", &Spec::force, expression_of_load("N"),
         "[force](contact.md#forces) that drives the obstacle along the component of its "
         "displacement that is `\"free\"`, and that it exerts on the body")
           .written_if([](auto& of, auto&) { return !of.force.empty(); })
           .unless(
               [](auto& of, auto&) {
                 return std::ranges::find(of.displacement, "free") == of.displacement.end();
               },
               "needs a component of displacement that is \"free\", along which it acts")
           .default_words("none; required if a component is `\"free\"`"),
       K("stiffness", &Spec::stiffness, positive(""),
         "stiffness of the contact relative to that of the point's cell, Young's modulus times its "
         "section over half a spacing"),
       K("depth", &Spec::depth, between(0.001, 0.999),
         "depth that no point may reach, relative to half a spacing"),
       K("softness", &Spec::softness, between(1e-12, 0.999),
         "depth over which the stiffness sets in, relative to half a spacing")
           .moreover("below `depth`"),
       K("friction", &Spec::friction, between(0.0, 1000.0),
         "coefficient of Coulomb's [friction](contact.md#friction)")
           .early(),
       K("tangential_stiffness", &Spec::tangential_stiffness, between(0.001, 1000.0),
         "stiffness of contacts that stick, relative to `stiffness`")
           .unless([](auto& of, auto&) { return of.friction == 0.0; }, "needs friction")}};
}

Table<SymmetryPlane> symmetry_keys() {
  using K = Key<SymmetryPlane>;
  return {"symmetry",
          {K("axis", &SymmetryPlane::axis, axis(), "axis normal to the plane").required(),
           K("at", &SymmetryPlane::at, number(any_number, "a number", "m"),
             "coordinate of the plane on the axis, half a spacing before the first points")}};
}

Table<PeriodSpecification> period_keys() {
  using Spec = PeriodSpecification;
  using K = Key<Spec>;
  return {"period",
          {K("axis", &Spec::axis, axis(), "axis along which the body repeats").required(),
           K("from", &Spec::from, number(any_number, "a number", "m"), "one side of the cell")
               .required(),
           K("to", &Spec::to, number(any_number, "a number", "m"), "the other side")
               .moreover("above `from`")
               .required(),
           K("gradient", &Spec::gradient, free_components(Components::of_load, "1"),
             "mean displacement gradient ∂u/∂(axis), per component; `\"free\"`: the cell has no "
             "mean stress there")}};
}

}  // namespace peristat
