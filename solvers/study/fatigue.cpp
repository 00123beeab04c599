#include "solvers/study/fatigue.hpp"

#include <string>

#include "solvers/formulations/specification/for_each_material.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/conditions/preload.hpp"
#include "src/core/input_error.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// The bonds' own law decides about the final failure only, and bonds must be elastic within a
/// cycle.
void require_brittle_bonds(const BodySpecification& of) {
  if (of.material.model != MaterialModel::bond || of.is_convolved()) {
    throw InputError("loading.mode", "fatigue",
                     "is for material.model = \"bond\", whose bonds break one by one");
  }
  bool may_fail = false;
  for_each_material(of, [&](const MaterialSpecification& material, const std::string& key) {
    const DamageSpecification& damage = material.damage;
    may_fail |= damage.law != DamageLaw::none;
    if (material.kinematics != Kinematics::finite) {
      throw InputError(key + ".kinematics", "linear", "is not allowed in mode fatigue");
    }
    if (damage.softens() || damage.law == DamageLaw::energy_density) {
      throw InputError(key + ".damage.law", "",
                       "must be \"critical_stretch\" in mode fatigue: bonds that soften are not "
                       "elastic within a cycle");
    }
    if (damage.compression == Compression::kept) {
      throw InputError(key + ".damage.compression", "kept",
                       "is not allowed in mode fatigue: a body with bonds that close is not "
                       "linear within a cycle");
    }
    if (damage.has_surface()) {
      throw InputError(key + ".damage.strength_surface", "", "is not allowed in mode fatigue");
    }
    if (material.fibre) {
      throw InputError(key + ".fibre", "",
                       "is not allowed in mode fatigue, which has one law for all directions");
    }
  });
  if (!may_fail) {
    throw InputError("loading.mode", "fatigue",
                     "needs material.damage.law = \"critical_stretch\": bonds at the end of their "
                     "life break, and the law decides when the body fails");
  }
}

/// The laws of life are those of one material.
void require_one_material(const BodySpecification& of) {
  for (std::size_t k = 0; k < of.regions.size(); ++k) {
    if (of.regions[k].material.damage.law == DamageLaw::none) continue;
    throw InputError(indexed("regions", k) + ".material.damage", "",
                     "is not allowed in mode fatigue, whose laws are those of one material; a "
                     "region without damage neither ages nor breaks");
  }
  if (of.interfaces.empty()) return;
  throw InputError("interfaces", "", "are not allowed in mode fatigue, which has one material");
}

/// Within a cycle, stretches must be proportional to the load.
void require_proportional_cycles(const Body& body) {
  const BodySpecification& of = body.specification;
  const Conditions& conditions = *body.conditions;
  const auto refuse = [](const std::string& key, const std::string& why) {
    throw InputError(key, "", why);
  };
  if (conditions.control()) {
    refuse("controls", "is not allowed in mode fatigue, whose loads are given");
  }
  if (!of.contacts.empty())
    refuse("contacts", "is not allowed in mode fatigue: contacts close and open within a cycle");
  if (!conditions.obstacles().none()) {
    refuse("obstacles", "is not allowed in mode fatigue: contacts close and open within a cycle");
  }
  if (of.eigenstrains.are_there()) {
    refuse("eigenstrains",
           "and a temperature are not allowed in mode fatigue: their stretches are no part of the "
           "cycle");
  }
  const ConstraintSpecification& constraints = of.constraints;
  if (!constraints.symmetries.empty()) {
    refuse("symmetries", "is not allowed in mode fatigue; give the whole body");
  }
  if (!constraints.periods.empty()) {
    refuse("periods", "is not allowed in mode fatigue; give a body with ends");
  }
  if (conditions.programme().parameters() > 1) {
    refuse("programme[1]",
           "is not allowed in mode fatigue, where one load parameter varies in proportion");
  }
  const Preload preload = find_preload(conditions, body.index_map->ranks());
  if (preload.acts()) {
    refuse("loading.mode",
           "fatigue needs supports and loads that vanish at load 0, because a cycle goes from "
           "load_ratio times their largest values to these: " +
               preload.description() + " act at load 0");
  }
}

}  // namespace

void check_fatigue(const Body& body, const StudyOptions& options) {
  const FatigueOptions& fatigue = options.loading.fatigue;
  if (!fatigue.nucleation.acts() && !fatigue.growth.acts()) {
    throw InputError("fatigue", "",
                     "needs a law by which bonds age: nucleation, growth or both, each with "
                     "coefficient and exponent");
  }
  if (!fatigue.nucleation.acts() && body.cut_bonds.empty()) {
    throw InputError(
        "fatigue.growth", "",
        "is the law of bonds near a crack, but the body has none; give a [[crack]], or "
        "a law of nucleation by which one begins");
  }
  require_brittle_bonds(body.specification);
  require_one_material(body.specification);
  require_proportional_cycles(body);
}

}  // namespace peristat
