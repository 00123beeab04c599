#include "cases/runner/input/fatigue_keys.hpp"

#include "cases/runner/input/key_kinds.hpp"

namespace peristat {
namespace {

Table<LifeLaw> life_law_keys(const std::string& name) {
  using Spec = LifeLaw;
  using K = Key<Spec>;
  return {"fatigue." + name,
          {K("coefficient", &Spec::coefficient, between(1e-300, 1e300),
             "A: a bond loses A (ε - limit)^m of its life in a cycle, ε the range of its stretch")
               .required(),
           K("exponent", &Spec::exponent, between(0.1, 100.0), "m").required(),
           K("limit", &Spec::limit, between(0.0, 1.0),
             "range of the stretch up to which a bond does not age")}};
}

}  // namespace

Table<FatigueOptions> fatigue_keys() {
  using Spec = FatigueOptions;
  using K = Key<Spec>;
  const auto none = [](auto&, auto&) {};
  return {
      "fatigue",
      {K("load_ratio", &Spec::load_ratio, between(-1.0, 0.999),
         "R: supports and loads at the least load of a cycle over those at the largest, which "
         "is that at the end of `[loading]`"),
       K("cycles", &Spec::cycles, between(0.0, 1e18),
         "number of cycles after which the run ends. 0: it ends when the body fails, or when no "
         "bond ages any more")
           .extends(),
       K("blocks", &Spec::blocks, count_from(0, "blocks"),
         "number of blocks of cycles after which the run ends; each block ends with the next "
         "bond that breaks. 0: no limit")
           .extends(),
       K("life_tolerance", &Spec::life_tolerance, between(0.0, 0.5),
         "bonds with no more life left than this at the end of a block break in it, too. 0: "
         "only bonds with equal lives break together"),
       K("crack_damage", &Spec::crack_damage, between(0.01, 1.0),
         "damage from which a point belongs to a crack. Bonds with an end within a horizon of "
         "such a point age by `growth`. Bonds that a `[[crack]]` has cut count"),
       K("nucleation", &Spec::nucleation, life_law_keys("nucleation"),
         "table: law of the bonds that no crack is near")
           .otherwise(none, "these bonds do not age")
           .written_if([](auto& of, auto&) { return of.nucleation.acts(); }),
       K("growth", &Spec::growth, life_law_keys("growth"),
         "table: law of the bonds near a crack, whose life then begins anew")
           .otherwise(none, "all bonds age by `nucleation`")
           .written_if([](auto& of, auto&) { return of.growth.acts(); })}};
}

void check_fatigue_table(const Entry& at, const Case& result) {
  const bool is_asked_for = result.solver.mode == Mode::fatigue;
  if (!is_asked_for && at.from.has("fatigue"))
    at.from.refuse("fatigue", "is for solver.mode = \"fatigue\"");
  if (is_asked_for && !at.from.has("fatigue"))
    throw InputError("solver.mode", "\"fatigue\"",
                     "needs a table [fatigue] with the laws by which bonds age");
}

}  // namespace peristat
