#include "cases/runner/input/load_keys.hpp"

#include <string>
#include <type_traits>

#include "cases/runner/input/key_kinds.hpp"
#include "solvers/formulations/formulations.hpp"

namespace peristat {

Table<SupportSpecification> support_keys() {
  using Spec = SupportSpecification;
  using K = Key<Spec>;
  return {"support",
          {K("set", &Spec::set, known_set(), "set that is held or moved").required(),
           K("displacement", &Spec::displacement, prescribed_components(),
             "prescribed displacement per component")
               .required()}};
}

namespace {

/// A key that gives the value of a load of a kind.
Key<LoadSpecification> load_value(LoadSpecification::Kind kind, const std::string& unit,
                                  const std::string& meaning) {
  using Spec = LoadSpecification;
  return Key<Spec>(load_key(kind), &Spec::value,
                   force_components(kind == Spec::Kind::total_force, unit), meaning)
      .then([=](auto&, auto& load) { load.kind = kind; })
      .written_if([=](auto& load, auto&) { return load.kind == kind; })
      .one_of()
      .on_ranks();
}

/// Checks where a load acts, which depends on its kind.
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
  const bool is_on_surface = takes(at.so_far, Option::surface_loads);
  if (is_on_surface && at.from.has("depth") && load.depth != Depth::surface)
    at.from.refuse("depth",
                   "must be \"surface\" with model lps, whose tractions act on the surface itself");
  if (is_on_boundary && load.set.empty() && !load.side && !is_on_surface)
    at.refuse(std::string("a ") + load_key(load.kind) + " needs a side or a set to act on");
}

}  // namespace

Table<LoadSpecification> load_keys() {
  using Spec = LoadSpecification;
  using K = Key<Spec>;
  using Kind = Spec::Kind;
  const auto is_traction = [](auto& load, auto&) { return load.kind == Kind::traction; };
  constexpr auto pressure = [](auto& load) -> auto& { return load.value[0]; };
  return {
      "load",
      {K("set", &Spec::set, known_set(), "set that is loaded")
           .early()
           .written_if([](auto& load, auto&) { return !load.set.empty(); })
           .default_words("required, except for `gravity`, which then acts on the whole body, and "
                          "for `traction` and `pressure` with a `side`")
           .on_ranks(),
       load_value(Kind::body_force, "N/m3", "force density per component"),
       load_value(Kind::total_force, "N",
                  "force on the whole set per component, distributed in proportion to the volumes "
                  "of the points"),
       load_value(Kind::gravity, "m/s2",
                  "acceleration per component. It is multiplied by `material.density`. Layers have "
                  "no weight unless `set` names them"),
       load_value(Kind::traction, "Pa",
                  "force per area per component on a flat part of the boundary, or on facets of a "
                  "mesh. Its direction is fixed. For a lattice or a mesh"),
       K("pressure", pressure, scalar_field("Pa"),
         "pressure on the exposed faces of the cells of the set's points, or of a side. It follows "
         "the faces as they deform. Positive values push. For a lattice or a mesh")
           .then([](auto&, auto& load) { load.kind = Kind::pressure; })
           .written_if([](auto& load, auto&) { return load.kind == Kind::pressure; })
           .one_of()
           .on_ranks(),
       K("stress", &Spec::stress, stress_components(),
         "model `lps`: stress outside the surface, [xx, yy, xy] or [xx, yy, zz, xy, yz, xz]. It "
         "loads the surface with the traction stress · outward normal")
           .then([](auto&, auto& load) { load.kind = Kind::stress; })
           .written_if([](auto& load, auto&) { return load.kind == Kind::stress; })
           .one_of()
           .on_ranks(),
       K("boundary", &Spec::boundary, text(),
         "model `lps`: `name` of the `[[lattice.shape]]` whose boundary is loaded")
           .written_if([](auto& load, auto&) { return !load.boundary.empty(); })
           .on_ranks(),
       K("side", &Spec::side, optional_side(),
         "`traction`, `pressure`: the body's outermost plane of points on a side, named as in "
         "`[[lattice.layer]]`")
           .written_if([](auto& load, auto&) { return load.side.has_value(); })
           .default_words("`traction`, `pressure`: this or a `set` is required; the set of a "
                          "traction lies in one plane of points")
           .on_ranks(),
       K("depth", &Spec::depth,
         choice<Depth>(
             {{"row", Depth::row}, {"horizon", Depth::horizon}, {"surface", Depth::surface}}),
         "`traction`: where it acts. `\"row\"`: on the outermost row of points; `\"horizon\"`: "
         "spread evenly over a horizon below the boundary; `\"surface\"`: on the surface itself, "
         "only and always with model `lps`")
           .written_if([=](auto& load, const Case& from) {
             return is_traction(load, from) && !takes(from, Option::surface_loads);
           })
           .on_ranks()},
      {},
      check_place_of_load};
}

Table<EigenstrainSpecification> eigenstrain_keys() {
  using Spec = EigenstrainSpecification;
  using K = Key<Spec>;
  return {"eigenstrain",
          {K("set", &Spec::set, known_set(), "set with the strain")
               .written_if([](auto& strained, auto&) { return !strained.set.empty(); })
               .default_words("all points"),
           K("strain", &Spec::strain, scalar_field("1"),
             "strain that a part would have if it were not held, the same in all directions: its "
             "length relative to that in the reference, minus 1")
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
             "change of the temperature from the reference. With `material.thermal_expansion` all "
             "points get the eigenstrain α ΔT")
               .written_if([](auto& of, auto&) { return of.temperature_change.has_value(); })
               .default_words("no change; required in the table")}};
}

void check_temperature(const Entry& at, const Case& result) {
  if (at.from.has("temperature") && !result.eigenstrains.temperature_change)
    static_cast<void>(at.from.table("temperature").string("change"));
}

Table<ControlTerm> control_keys() {
  using K = Key<ControlTerm>;
  return {
      "control",
      {K("set", &ControlTerm::set, known_set(), "set whose mean displacement is taken").required(),
       K("weights", &ControlTerm::weights, coordinates(""),
         "weights of the mean displacement's components. The controlled displacement is the sum of "
         "the weighted displacements of all these tables")
           .moreover("not all zero")
           .required()}};
}

}  // namespace peristat
