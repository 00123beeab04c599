#include "cases/runner/input/contact_keys.hpp"

#include "cases/runner/input/key_kinds.hpp"

namespace peristat {

Table<ContactSpecification> contact_keys() {
  using Spec = ContactSpecification;
  using K = Key<Spec>;
  return {
      "contact",
      {K("set", &Spec::set, known_set(), "set whose points touch")
           .written_if([](auto& of, auto&) { return !of.set.empty(); })
           .default_words("all points"),
       K("with", &Spec::with, known_set(),
         "another set, which the points of `set` touch, and not one another")
           .written_if([](auto& of, auto&) { return !of.with.empty(); })
           .default_words("the points of `set` touch one another"),
       K("shape", &Spec::shape,
         choice<ContactShape>({{"points", ContactShape::points}, {"faces", ContactShape::faces}}),
         "what touches. `\"points\"`: points, for cracks that slip by less than a spacing and "
         "for fragments; `\"faces\"`: points and the [faces](contact.md#faces) that join "
         "surface points, for surfaces that slide"),
       K("distance", &Spec::distance, positive("m"), "distance at which two points touch")
           .written_if([](auto& of, auto&) { return of.distance > 0.0; })
           .default_words("the mean of the two points' sizes, on a lattice the spacing"),
       K("reach", &Spec::reach, positive("m"),
         "distance in the undeformed body up to which points see one another [beyond planes of "
         "symmetry and periods](contact.md#beyond-planes-and-periods) and [on other ranks]"
         "(contact.md#ranks); nothing else needs it. A state in which others would touch is "
         "refused")
           .written_if([](auto& of, auto&) { return of.reach > 0.0; })
           .default_words("the horizon"),
       K("stiffness", &Spec::stiffness, between(1e-3, 1e3),
         "stiffness over that of the bar of material between two points"),
       K("depth", &Spec::depth, between(0.01, 0.5),
         "largest depth of the contact over its distance; the force grows without limit "
         "towards it"),
       K("softness", &Spec::softness, between(1e-9, 0.25),
         "strain of the gap over which the stiffness sets in; at most a tenth of the strains "
         "of interest"),
       K("friction", &Spec::friction, between(0.0, 1000.0),
         "coefficient of Coulomb's [friction](contact.md#friction)")
           .early(),
       K("tangential_stiffness", &Spec::tangential_stiffness, between(0.001, 1000.0),
         "stiffness of contacts that stick, relative to `stiffness`")
           .unless([](auto& of, auto&) { return of.friction == 0.0; }, "needs friction")}};
}

}  // namespace peristat
