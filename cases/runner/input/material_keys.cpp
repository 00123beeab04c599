#include "cases/runner/input/material_keys.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "cases/runner/input/body_keys.hpp"
#include "cases/runner/input/key_kinds.hpp"
#include "cases/runner/input/value_schema.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/specification/check_damage.hpp"

namespace peristat {

void check_regions(const Entry& at, Case& result) {
  if (!at.from.has("material")) {
    if (result.regions.empty())
      static_cast<void>(at.from.table("material"));  // throws: it is missing
    const MaterialSpecification& first = result.regions.front().material;
    result.material.model = first.model;
    result.material.potential = first.potential;
    result.material.plane = first.plane;
    result.material.influence = first.influence;
    result.material.kinematics = first.kinematics;
  }
  check_quadrature(at, result);
}

namespace {

/// Refuses data of damage without a law, which would have no effect. no_fail may belong to laws of
/// other materials.
void require_law(const Entry& at, DamageSpecification&) {
  if (at.from.has("law")) return;
  for (const char* key :
       {"fracture_energy", "fracture_toughness", "strength", "critical", "onset", "peak",
        "hardening", "rate", "stretches", "forces", "drive", "struts", "compression",
        "strength_surface", "compressive_strength", "biaxial_strength", "strength_factor"}) {
    if (!at.from.has(key)) continue;
    at.from.refuse(key,
                   "needs a law in the same table, such as law = \"linear\"; write law = \"none\" "
                   "for no damage");
  }
}

Kind<std::vector<double>> numbers_of_curve() {
  const Range range{0.0, 1e3, "must be from 0 to 1000", false};
  return {[=](const Entry& at) { return at.from.numbers(at.key, range); },
          [](const std::vector<double>& numbers, const Case&) {
            return array_text(numbers, toml_number);
          },
          list_schema(number_schema(range, "1"), 2),
          "list of numbers",
          "1",
          ValueForm::number};
}

Table<DamageSpecification> damage_keys(const std::string& material) {
  using Spec = DamageSpecification;
  using K = Key<Spec>;
  const auto is_whole = [](auto& damage, auto&) { return damage.law == DamageLaw::none; };
  // Reading a missing key throws the error that it is missing.
  const auto require_key = [](auto lacks) {
    return [=](const Entry& at, const Spec& damage) {
      if (lacks(damage)) static_cast<void>(at.from.number(at.key, Range()));
    };
  };
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
                            {"bilinear", DamageLaw::bilinear},
                            {"cornelissen", DamageLaw::cornelissen},
                            {"table", DamageLaw::table},
                            {"energy_density", DamageLaw::energy_density}}),
         "`\"none\"`: no damage, and the other keys of the table have no effect; "
         "`\"critical_stretch\"`: a bond is undamaged up to `critical` and then broken; "
         "`\"tanh\"`: softening from `onset` to `critical` as published in [ADAPT], with jumps of "
         "(1 − tanh `rate`)/2 at both ends; `\"tanh_continuous\"`: the same law, rescaled to have "
         "no jumps; `\"linear\"`: the force falls linearly from `onset` to zero at `critical`; "
         "`\"exponential\"`: it falls exponentially, without a jump at `critical`; `\"blended\"`: "
         "it rises on a lower slope from `onset` to `peak`, and then falls linearly; "
         "`\"bilinear\"`: the force over the opening of the bond falls to a third at 2/9 of "
         "`critical`, and then to zero, as concrete does [Petersson 1981]; `\"cornelissen\"`: it "
         "follows the curve of concrete of [Cornelissen et al. 1986]; `\"table\"`: "
         "the force is the curve of `stretches` and `forces`; `\"energy_density\"`: a point fails "
         "at once and irreversibly where its energy density exceeds `fracture_energy` / (2 δ); "
         "this law is for `kinematics = \"linear\"`, and with `solver.operator = \"fft\"` for all "
         "models")
           .early(),
       K("fracture_energy", &Spec::fracture_energy, positive("J/m2"),
         "$G_c$ of a plane crack, the mean over its directions on this lattice; `critical` follows "
         "from it. `cpd` with `drive = \"stretch\"` accepts it at horizon ratios up to 12 in 2D, "
         "3.2 in 3D")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .early(),
       K("fracture_toughness", &Spec::fracture_toughness, positive("Pa*sqrt(m)"),
         "$K_{Ic}$, can be given instead of `fracture_energy`: $G_c = K_{Ic}^2/E'$, with $E' = E$ "
         "in plane stress (and with `cpd` in 2D) and $E/(1 - \\nu^2)$ in plane strain and 3D, with "
         "the moduli of the model")
           .unless(is_whole, "")
           .unless(in_dimension<1>, "is for dimension 2 and 3; give fracture_energy")
           .by_rules(damage_rules)
           .early(),
       K("strength", &Spec::strength, positive("Pa"),
         "$f_t$ of the body: the largest stress that the lattice bears under uniaxial tension, the "
         "mean over directions ([theory](theory.md#strength)); `onset` follows from it, for "
         "`blended` the `peak`, for `critical_stretch` the value of `critical`. `cpd` accepts it "
         "at horizon ratios up to 12 in 2D, in 3D only at smaller ones than 3.2, where the "
         "computation takes less than minutes")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .early(),
       K("strength_surface", &Spec::strength_surface,
         choice<StrengthCriterion>({{"none", StrengthCriterion::none},
                                    {"rankine", StrengthCriterion::rankine},
                                    {"drucker_prager", StrengthCriterion::drucker_prager},
                                    {"mohr_coulomb", StrengthCriterion::mohr_coulomb}}),
         "stresses at which a body without flaws fails, through `strength` under uniaxial tension "
         "([theory](theory.md#strength-under-any-stress)). `\"none\"`: one stretch for all "
         "stresses; `\"rankine\"`: the largest principal stress; `\"drucker_prager\"` and "
         "`\"mohr_coulomb\"`: also through `compressive_strength`. Bonds then fail by what their "
         "loss would set free")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .early(),
       K("compressive_strength", &Spec::compressive_strength, positive("Pa"),
         "$f_c$, uniaxial, for `drucker_prager` and `mohr_coulomb`")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .moreover("above `strength`"),
       K("biaxial_strength", &Spec::biaxial_strength, positive("Pa"),
         "$f_b$ under equal tension in two directions, in the place of `compressive_strength`, for "
         "`drucker_prager`")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .moreover("above half of `strength`"),
       K("strength_factor", &Spec::strength_factor, range_of_numbers(),
         "least and largest factor by which the surface may change the `onset` of a bond; the "
         "largest is at most the one at which a bond of the same work is brittle")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .moreover("0.01 to 1, and 1 to 100"),
       K("critical", &Spec::critical, stretch(), "stretch $s_c$ at which a bond breaks")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .then(require_key([](auto& damage) { return damage.critical == 0.0; }))
           .written_if([](auto& damage, auto&) { return damage.critical != 0.0; })
           .default_words("this, `fracture_energy` or `fracture_toughness` is required with a law"),
       K("onset", &Spec::onset, stretch(),
         "laws that soften: stretch $s_m$ beyond which a bond loses stiffness")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .then(require_key(
               [](auto& damage) { return damage.onset == 0.0 && !damage.is_by_data(); }))
           .written_if([](auto& damage, auto&) { return damage.onset != 0.0; })
           .moreover("below `critical`; `bilinear` below a third of it, `cornelissen` below 0.1437 "
                     "of it")
           .default_words("required without `strength`; with `fracture_energy` half the stretch of "
                          "a brittle bond of that energy, for `blended` a quarter"),
       K("peak", &Spec::peak, stretch(), "`blended`: stretch $s_p$ at which the force is largest")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .then(require_key([](auto& damage) {
             return damage.peak == 0.0 && (damage.onset != 0.0 || !damage.has_fracture_energy());
           }))
           .written_if([](auto& damage, auto&) { return damage.peak != 0.0; })
           .moreover("from `onset` to below `critical`")
           .default_words(
               "required without `strength`; if `strength`, `onset` and `peak` are all missing, "
               "the largest force is half that of a brittle bond of that `fracture_energy`"),
       K("hardening", &Spec::hardening, between(0.0, 0.99, "1"),
         "`blended`: slope of the force between `onset` and `peak`, relative to that of the "
         "undamaged bond")
           .unless(is_whole, "")
           .by_rules(damage_rules),
       K("rate", &Spec::rate, between(0.1, 50.0, "1"),
         "tanh laws: $\\beta$; a larger value concentrates the softening midway between the two "
         "stretches. `exponential`: a larger value makes the force fall more steeply at first")
           .unless(is_whole, "")
           .by_rules(damage_rules),
       K("stretches", &Spec::stretches, numbers_of_curve(),
         "`table`: stretches, ascending. The first one ends the elastic part. At the last one the "
         "bond breaks")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .written_if([](auto& damage, auto&) { return !damage.stretches.empty(); })
           .moreover("1e-9 to 1000")
           .default_words("required with law `table`"),
       K("forces", &Spec::forces, numbers_of_curve(),
         "`table`: force of a bond at each of the `stretches`, divided by its constant $c$, and "
         "linear in between. So the first force equals the first stretch. Force over stretch must "
         "not grow. The last force may be 0")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .written_if([](auto& damage, auto&) { return !damage.forces.empty(); })
           .default_words("required with law `table`"),
       K("drive", &Spec::drive,
         choice<DamageDrive>(
             {{"stretch", DamageDrive::stretch}, {"release", DamageDrive::release}}),
         "`cpd`, `state`, and `lps` as an energy: what drives the damage of a bond. "
         "`\"stretch\"`: its stretch; `\"release\"`: [what its loss would set "
         "free](theory.md#damage-by-release) with all that depends on it, as an equivalent stretch "
         "that the law takes. `state` has `\"release\"` alone")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .default_words("`\"release\"` with `state`, and with `fracture_energy` or "
                          "`fracture_toughness`; otherwise `\"stretch\"`")
           .moreover("the same for all materials of a body"),
       K("struts", &Spec::struts,
         choice<StrutRemedy>({{"keep", StrutRemedy::keep}, {"cut", StrutRemedy::cut}}),
         "model `bond`: what becomes of [struts](theory.md#struts), bonds that still join the two "
         "faces of an open crack. `\"keep\"`: their stretch alone decides; `\"cut\"`: they fail "
         "with the bonds around them")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .moreover("the same for all materials of a body"),
       K("compression", &Spec::compression,
         choice<Compression>({{"lost", Compression::lost}, {"kept", Compression::kept}}),
         "model `bond`: whether damaged bonds bear [compression](contact.md#bonds-that-close). "
         "`\"lost\"`: as little as tension; `\"kept\"`: as undamaged ones")
           .unless(is_whole, "")
           .by_rules(damage_rules)
           .moreover("the same for all materials of a body"),
       K("no_fail", &Spec::no_fail, known_sets(),
         "sets of points whose bonds stay elastic at any stretch, including bonds to points "
         "outside the sets")
           .written_if([](auto& damage, auto&) { return damage.law != DamageLaw::none; })
           .early()},
      require_law};
}

/// A stiffness may be negative (auxetic bodies have such), but not remotely large.
Kind<double> stiffness(const std::string& unit) {
  return number({-1e200, 1e200, "must be a finite number of " + unit}, "any number", unit);
}

std::vector<std::string> bond_potentials() {
  std::vector<std::string> names;
  WholeBondPotentials::for_each([&](const auto& whole) { names.emplace_back(whole.name); });
  return names;
}

Table<FibreSpecification> fibre_keys(const std::string& material) {
  using Spec = FibreSpecification;
  using K = Key<Spec>;
  return {
      material + ".fibre",
      {K("angle", &Spec::angle, between(-360.0, 360.0, "degrees"),
         "2D: angle of the fibres against the x axis, towards y")
           .unless(in_dimension<3>, "is for dimension 2; in 3D give direction")
           .required("required in 2D"),
       K("direction", &Spec::direction, coordinates("1"),
         "3D: direction of the fibres, a vector of any length")
           .unless(in_dimension<2>, "is for dimension 3; in 2D give angle")
           .moreover("not all zero")
           .required("required in 3D"),
       K("transverse_modulus", &Spec::transverse_modulus, positive("Pa"),
         "Young's modulus $E_2$ across the fibres; `youngs_modulus` is $E_1$, along them")
           .required(),
       K("shear_modulus", &Spec::shear_modulus, positive("Pa"),
         "$G$ in planes that contain the fibres. Poisson's ratio follows from it")
           .moreover("such that no bond has a negative constant")
           .default_words("$\\sqrt{E_1E_2}/(2 + 2\\nu)$ with the $\\nu$ of isotropic bonds, 1/3 or "
                          "1/4"),
       K("transverse_critical", &Spec::transverse_critical, between(1e-9, 1e3, "1"),
         "`critical` of bonds across the fibres. `critical` of `[material.damage]` then holds "
         "along the fibres. In between, `critical` varies with the square of the cosine, and "
         "`onset` in proportion to it")
           .default_words("as along the fibres")}};
}

Table<ScatterSpecification> scatter_keys(const std::string& material) {
  using Spec = ScatterSpecification;
  using K = Key<Spec>;
  constexpr auto field = [](auto& scatter) -> auto& { return scatter.field; };
  const auto is_given = [](auto& scatter, auto&) { return !scatter.factor.empty(); };
  const char* const is_random = "is for a random factor; leave it out if factor is given";
  return {material + ".scatter",
          {K("of", &Spec::of,
             choice<Spec::Quantity>({{"stiffness", Spec::Quantity::stiffness},
                                     {"strength", Spec::Quantity::strength}}),
             "what the factor multiplies. `\"stiffness\"`: the constants of bonds, triangles and "
             "tetrahedra; `\"strength\"`: the stretches of the law of damage")
               .required(),
           K("factor", &Spec::factor, field_of_place("1"),
             "the factor at each point, instead of a random one. The factor of a bond is the mean "
             "of its ends")
               .written_if(is_given)
               .moreover("from 1e-6 to 1e6 at each point")
               .default_words("random")
               .early(),
           K("distribution", &Spec::distribution,
             choice<Spec::Distribution>({{"weibull", Spec::Distribution::weibull}}),
             "distribution of the factor, whose mean is 1")
               .unless(is_given, is_random),
           K("weibull_modulus", in(field, &WeibullField::modulus), between(1.0, 1e3, "1"),
             "shape $m$; a larger value gives less scatter")
               .unless(is_given, is_random)
               .required("required without `factor`"),
           K("correlation_length", in(field, &WeibullField::correlation_length),
             number({0.0, 1e30, "must be 0 or a positive number [m]"}, "0 or positive", "m"),
             "length $\\ell$ over which the field changes; 0: the points have independent values")
               .unless(is_given, is_random),
           K("seed", in(field, &WeibullField::seed),
             count_from(0, "", std::numeric_limits<std::int64_t>::max()),
             "seed of the field; the same seed and position give the same value, whatever else the "
             "case contains")
               .unless(is_given, is_random)}};
}

void make_linear_if_lps(const Entry& at, MaterialSpecification& material) {
  if (material.model != MaterialModel::lps) return;
  if (at.from.has("kinematics") && material.kinematics == Kinematics::finite) {
    at.refuse("must be \"linear\" with model \"lps\", whatever the deformation");
  }
  material.kinematics = Kinematics::linear;
}

Kind<std::int64_t> choice_of_models() {
  std::vector<Choice<std::int64_t>> choices;
  for (const auto& [model, name] : model_names()) {
    choices.push_back({name, static_cast<std::int64_t>(model)});
  }
  return choice_of_numbers(std::move(choices));
}

}  // namespace

Table<MaterialSpecification> material_keys(const std::string& name) {
  using Spec = MaterialSpecification;
  using K = Key<Spec>;
  // Is there a key only for models that take its option?
  const auto without = [](Option option) {
    return [option](auto& material, auto&) { return !takes(material.model, option); };
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
  const std::string with_moduli = "needs youngs_modulus and cannot be combined with c1";
  return {
      name,
      {K("model", &Spec::model, choice_of_models(),
         "`\"bond\"`: bond-based peridynamics, whose Poisson ratio is 1/4 (3D and plane strain) or "
         "1/3 (plane stress); `\"cpd\"`: continuum-kinematics-inspired peridynamics with one-, "
         "two- and three-neighbour interactions, dimension 2 and 3; `\"state\"`: the [ordinary "
         "state-based solid](theory.md#the-solid-at-finite-strain) of any Poisson ratio, at any "
         "deformation, dimension 2 and 3; `\"lps\"`: the [linear "
         "peridynamic solid](theory.md#linear-peridynamic-solid) of any Poisson ratio, by "
         "collocation or as an energy, for small displacements, dimension 2 and 3; "
         "`\"green_bond\"`: [bonds that stretch by their squared "
         "lengths](theory.md#materials-of-convolutions-at-finite-deformation), at any deformation, "
         "like `bond` at small strains; `\"correspondence\"`: a correspondence material of St. "
         "Venant and Kirchhoff of any Poisson ratio, at any deformation, dimension 2 and 3. The "
         "last two need `solver.operator = \"fft\"`")
           .then([name](auto& at, auto& material) {
             const bool tells_body = name == "material" || (!at.so_far.material.has_constants() &&
                                                            at.so_far.regions.empty());
             const Formulation& can = formulation_of(material);
             if (tells_body) material.influence = can.default_influence;
             if (at.so_far.dimension < can.least_dimension) at.refuse("needs dimension 2 or 3");
           })
           .early()
           .on_ranks(),
       K("potential", &Spec::potential, one_of(bond_potentials()),
         "potential of undamaged bonds, a function of their stretch; a damage law uses it below "
         "its onset")
           .on_ranks(),
       K("plane", &Spec::plane,
         choice<PlaneState>({{"stress", PlaneState::stress}, {"strain", PlaneState::strain}}),
         "plane stress or plane strain, dimension 2 only (`cpd` in 2D is purely two-dimensional "
         "and has neither)")
           .unless(without(Option::plane), is_for(Option::plane))
           .unless(in_dimension<1>, "is for dimension 2 only")
           .unless(in_dimension<3>, "is for dimension 2 only")
           .on_ranks(),
       K("kinematics", &Spec::kinematics,
         choice<Kinematics>({{"finite", Kinematics::finite}, {"linear", Kinematics::linear}}),
         "stretch of a `bond`. `\"finite\"`: from its length, for any deformation; `\"linear\"`: "
         "from the displacements along it, for small displacements, so that forces are linear. "
         "`\"linear\"` is only for `potential = \"harmonic\"`, damage by `energy_density`, and no "
         "eigenstrains. `lps` is always linear")
           .then(make_linear_if_lps)
           .written_if(
               [](auto& material, auto&) { return takes(material.model, Option::kinematics); })
           .on_ranks(),
       K("influence", &Spec::influence, one_of(influence_names()),
         "influence function $\\omega(x)$ with $x = r/\\delta$. `\"constant\"`: 1; "
         "`\"piecewise_constant\"`: 1, and 0 beyond the horizon; `\"linear\"`: $1 - x$; "
         "`\"cubic\"`: $1 - 3x^2 + 2x^3$; `\"quintic\"`: $1 - 10x^3 + 15x^4 - 6x^5$; "
         "`\"septic\"`: $1 - 35x^4 + 84x^5 - 70x^6 + 20x^7$; `\"gaussian\"`: $e^{-x^2}$; "
         "`\"inverse\"`: $1/x$. The first six are those of [GPMB]. The force density of a bond is "
         "$c\\,\\omega s$; "
         "constants, moduli and fracture energy account for it. `cpd`: a triangle or tetrahedron "
         "has the product of its sides' functions, and the constants are those of the lattice. "
         "`state`, and `lps` as an energy: the kernel K(r); `lps` by collocation: only `inverse`")
           .default_words("`\"constant\"`; `\"inverse\"` with `state` and `lps`")
           .on_ranks(),
       K("youngs_modulus", &Spec::youngs_modulus, positive("Pa"), "Young's modulus, for all models")
           .one_of()
           .on_ranks(),
       K("micromodulus", &Spec::micromodulus, positive("N/m6", 1e150),
         "`bond`: bond constant c of the pairwise force c·stretch")
           .unless(without(Option::micromodulus), is_for(Option::micromodulus))
           .one_of()
           .on_ranks(),
       K("poisson_ratio", &Spec::poisson_ratio, between(-1.0, 1.0),
         "Poisson's ratio, for `cpd`, `lps` and `correspondence` with `youngs_modulus`")
           .unless(without(Option::poisson_ratio), is_for(Option::poisson_ratio))
           .unless(has_constants, with_moduli)
           .moreover(
               "`lps`, `correspondence`: to 0.5; `cpd`: in 3D to 0.5; these limits are "
               "excluded; `cpd` with damage: at least 0, by `drive = \"stretch\"` at least 1/3 "
               "(2D) or 1/4 (3D)")
           .required("required with `youngs_modulus`")
           .on_ranks(),
       K("stabilisation", &Spec::stabilisation, positive("-"),
         "`correspondence`: stiffness of the "
         "[springs](theory.md#materials-of-convolutions-at-finite-deformation) against zero-energy "
         "modes, which do not change the deformation gradients; relative to bonds of the same bulk "
         "modulus")
           .unless(without(Option::stabilisation), is_for(Option::stabilisation)),
       K("c1", &Spec::c1, positive("N/m6", 1e200), "`cpd`: one-neighbour constant")
           .unless(without(Option::constants), is_for(Option::constants))
           .one_of()
           .on_ranks(),
       K("c2", &Spec::c2, stiffness("N/m10"),
         "`cpd`: two-neighbour constant; in 3D it may also be given with `youngs_modulus`, in 2D "
         "it follows from it")
           .unless(without(Option::constants), is_for(Option::constants))
           .unless(
               [](auto& material, const Case& so_far) {
                 return material.youngs_modulus && so_far.dimension == 2;
               },
               "follows from youngs_modulus and poisson_ratio in 2D; to choose c2, give c1 instead "
               "of the moduli")
           .moreover("a negative one is refused with damage by `stretch`, and where it makes the "
                     "body [unstable at rest](theory.md#stability-at-rest)")
           .on_ranks(),
       K("c3", &Spec::c3, stiffness("N/m14"),
         "`cpd`: three-neighbour constant, 3D; it follows from `youngs_modulus` if that is given")
           .unless(without(Option::constants), is_for(Option::constants))
           .unless(has_moduli,
                   "follows from youngs_modulus and poisson_ratio; to choose c3, give c1 instead "
                   "of the moduli")
           .then([](auto& at, auto& material) {
             if (at.so_far.dimension == 2 && material.c3 != 0.0)
               at.refuse("must be 0 in 2D: three neighbours of a point in a plane span no volume");
           })
           .moreover("for a negative one see `c2`")
           .on_ranks(),
       K("calibration", &Spec::calibration,
         choice<Calibration>(
             {{"lattice", Calibration::lattice}, {"continuum", Calibration::continuum}}),
         "with `youngs_modulus`: how the constants follow from the moduli. `\"lattice\"`: by the "
         "sums of this lattice with their corrections (`bond`: in the mean over all directions); "
         "`\"continuum\"`: by integrals")
           .unless(has_constants, with_moduli)
           .unless(has_micromodulus,
                   "needs youngs_modulus and cannot be combined with micromodulus")
           .unless(without(Option::calibration), is_for(Option::calibration))
           .default_words("`\"lattice\"` with `cpd`, `\"continuum\"` with `bond`")
           .on_ranks(),
       K("thermal_expansion", &Spec::thermal_expansion, between(-1.0, 1.0, "1/K"),
         "coefficient α of linear expansion, for `[temperature]`")
           .on_ranks(),
       K("density", &Spec::density, positive("kg/m3"),
         "mass density, for gravity and mode `dynamics`. Dynamic relaxation has a pseudo density "
         "of its own")
           .on_ranks(),
       K("damage", &Spec::damage, damage_keys(name), "table `[material.damage]`")
           .default_words("no damage")
           .on_ranks(),
       K("fibre", fibre_of, fibre_keys(name),
         "table `[material.fibre]`: moduli and stretches that depend on the direction of the bond")
           .written_if([](auto& material, auto&) { return material.fibre.has_value(); })
           .unless(without(Option::fibre), is_for(Option::fibre))
           .unless(in_dimension<1>, "needs dimension 2 or 3")
           .otherwise([](auto&, auto&) {}, "none")
           .on_ranks(),
       K("scatter", &Spec::scatter, scatter_keys(name),
         "tables `[[material.scatter]]`: factors that vary from point to point, random or given")
           .on_ranks()}};
}

namespace {

/// Keys of the material of a region or interface: its model, potential, plane, influence function
/// and kinematics are those of the body.
Table<MaterialSpecification> material_of_body_keys(const std::string& name) {
  Table<MaterialSpecification> keys = material_keys(name);
  const auto of_body = [](const Case& so_far) -> const MaterialSpecification& {
    const bool is_first = !so_far.material.has_constants() && !so_far.regions.empty();
    return is_first ? so_far.regions.front().material : so_far.material;
  };
  keys.do_before([of_body](const Entry& at, MaterialSpecification& material) {
    const MaterialSpecification& body = of_body(at.so_far);
    material.model = body.model;
    material.potential = body.potential;
    material.plane = body.plane;
    material.influence = body.influence;
    material.kinematics = body.kinematics;
  });
  return keys;
}

}  // namespace

Table<RegionSpecification> region_keys() {
  using Spec = RegionSpecification;
  using K = Key<Spec>;
  return {"region",
          {K("set", &Spec::set, known_set(), "set of the points that have this material")
               .moreover("no region shares points with another")
               .required()
               .early(),
           K("material", &Spec::material, material_of_body_keys("region.material"),
             "table `[region.material]`, with the keys of [`[material]`](#material)")
               .required()}};
}

namespace {

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
    return std::array{given[0], given[1]};
  };
  return {read, [](const auto& names, const Case&) { return array_text(names, toml_string); },
          list_schema(text_schema(), 2, 2),
          "two sets of regions; `\"material\"` for the points in none"};
}

}  // namespace

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
      {K("between", &Spec::between, two_materials(), "the two materials that meet at the interface")
           .written_if([](auto& interface, auto&) { return !interface.is_of_all(); })
           .default_words("all pairs that no other `[[interface]]` names"),
       K("rule", &Spec::rule,
         choice<InterfaceRule>({{"harmonic", InterfaceRule::harmonic},
                                {"arithmetic", InterfaceRule::arithmetic},
                                {"weaker", InterfaceRule::weaker}}),
         "rule for the constants of a bond or other interaction between points of the two "
         "materials. `\"harmonic\"`: the harmonic mean of the values of its points; "
         "`\"arithmetic\"`: their arithmetic mean; `\"weaker\"`: the smallest value. The stretches "
         "of damage laws of the same kind follow by the same rule")
           .unless([](auto& interface, auto&) { return interface.material.has_value(); },
                   "can't be given together with material; give one of them"),
       K("material", own, material_of_body_keys("interface.material"),
         "table `[interface.material]`, with the keys of [`[material]`](#material) except "
         "`density` and `scatter`: constants and damage of the interface")
           .written_if([](auto& interface, auto&) { return interface.material.has_value(); })
           .early()
           .otherwise([](auto&, auto&) {}, "none: the `rule` holds")}};
}

}  // namespace peristat
