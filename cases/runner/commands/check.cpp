#include "cases/runner/commands/check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "assembly/operators/constrained_tangent.hpp"
#include "assembly/terms/points/point_term.hpp"
#include "assembly/terms/pressure/pressure_term.hpp"
#include "cases/runner/setup/body.hpp"
#include "cases/runner/setup/preflight.hpp"
#include "cases/runner/setup/preflight_rules.hpp"
#include "cases/runner/setup/solver_options.hpp"
#include "solvers/body/describe_body.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/materials/bond_potential.hpp"
#include "solvers/linear/available_memory.hpp"
#include "solvers/linear/make_linear_solver.hpp"
#include "solvers/study/crack_tips.hpp"
#include "solvers/study/crack_trapping.hpp"
#include "solvers/study/found_loads.hpp"
#include "solvers/study/linear_systems.hpp"
#include "solvers/study/study.hpp"
#include "src/neighbourhood/neighbour_counts.hpp"
#include "src/potentials/make_saw_tooth.hpp"

namespace peristat {
namespace {

struct NeighbourCounts {
  Index least = 0, most = 0, isolated = 0;
  double mean = 0.0;
};

/// Counts neighbours of the body's own points, without images.
NeighbourCounts count_neighbours(const Bonds& bonds, Index own) {
  std::vector<std::int32_t> neighbours = neighbour_counts(bonds);
  neighbours.resize(std::size_t(own));
  NeighbourCounts counts;
  const auto [least, most] = std::minmax_element(neighbours.begin(), neighbours.end());
  counts.least = *least;
  counts.most = *most;
  counts.isolated = static_cast<Index>(std::count(neighbours.begin(), neighbours.end(), 0));
  counts.mean = std::accumulate(neighbours.begin(), neighbours.end(), 0.0) / own;
  return counts;
}

/// "0.001 m", "0.001 x 0.002 m", "0.001 m (turned by 30 degrees)"
std::string spacing_text(const Points& points) {
  std::string text;
  for (int c = 0; c < (points.spacing.is_square() ? 1 : points.dimension); ++c)
    text += fmt::format("{}{:g}", c == 0 ? "" : " x ", points.spacing.along(c));
  text += " m";
  if (points.angle != 0.0) text += fmt::format(" (turned by {:g} degrees)", points.angle);
  return text;
}

std::string seconds_text(double seconds) {
  if (seconds < 1.0) return "below a second";
  if (seconds < 120.0) return fmt::format("about {:.0f} s", seconds);
  if (seconds < 7200.0) return fmt::format("about {:.0f} min", seconds / 60.0);
  return fmt::format("about {:.1f} h", seconds / 3600.0);
}

/// "constants", or "constants of fibres": with several materials, lines name theirs.
std::string heading(const std::string& what, const std::string& of) {
  return of.empty() ? fmt::format("{:<11}", what) : fmt::format("{} of {}:", what, of);
}

/// ": fracture energy 10 J/m2, …"; empty if computing it would take minutes.
/// @param setting of the bonds
std::string fracture_energy_text(const DamageSpecification& damage, const FractureScale& scale,
                                 const BondSetting& setting) {
  if (scale.crossing == 0.0) return "";
  const double energy = scale.energy(damage);
  const std::string mean = fmt::format(": fracture energy {:.6g} J/m2", energy);
  if (!scale.tear && (!setting.lattice || setting.dimension == 1)) return mean;
  DirectionalSpread spread;
  if (scale.tear) {
    spread = scale.tear->spread(law_of(damage));
  } else {
    spread = BulkBonds(setting).crossing();
    spread.least *= energy / spread.mean;
    spread.most *= energy / spread.mean;
  }
  return fmt::format("{} in the mean over the directions of a crack ({:.4g} to {:.4g})", mean,
                     spread.least, spread.most);
}

/// ", strength 3e+06 Pa in the mean …"; empty if computing it would take minutes.
std::string strength_text(const DamageSpecification& damage, const FractureScale& scale,
                          int dimension) {
  if (!scale.pull) return "";
  const DirectionalSpread of = scale.pull->peak(Loading::tension, law_of(damage));
  if (of.mean == 0.0) return "";
  if (!std::isfinite(of.mean)) return ", no strength: a pull fails no bond";
  const std::string mean = fmt::format(", strength {:.6g} Pa", of.mean);
  return dimension == 1
             ? mean
             : fmt::format("{} in the mean over the directions of a pull ({:.4g} to {:.4g})", mean,
                           of.least, of.most);
}

/// Prints strengths on a surface, and those that the law does not reach.
void print_surface(std::FILE* out, const DamageSpecification& damage, const std::string& name) {
  constexpr double same = 0.01;
  const auto text = [&](const char* of, double first, double second) {
    const auto [asked, reached, begins] = damage.peak_factors->strength({first, second});
    if (!(asked > 0.0) || !std::isfinite(asked)) return fmt::format("{} none", of);
    if (!std::isfinite(reached)) return fmt::format("{} no value: it drives no bond", of);
    std::string told = fmt::format("{} {:.4g} Pa", of, reached);
    if (reached < (1.0 - same) * asked) {
      told += fmt::format(" where {:.4g} Pa are asked (too little work for more)", asked);
    } else if (reached > (1.0 + same) * asked) {
      told += fmt::format(" where {:.4g} Pa are asked (strength_factor ends)", asked);
    }
    return told;
  };
  fmt::print(out, "{} {}; {}; bonds begin to soften under compression at {}\n",
             heading("strengths", name), text("equal biaxial", 1.0, 1.0), text("shear", 1.0, -1.0),
             text("", 0.0, -1.0).substr(1));
}

/// Prints stresses at which bonds begin to soften, and strengths under other stresses.
void print_strengths(std::FILE* out, const DamageSpecification& damage, const std::string& name,
                     const FractureScale& scale, int dimension) {
  if (!scale.pull || dimension == 1) return;
  const AnyLaw law = law_of(damage);
  const auto text = [](double stress) {
    return std::isfinite(stress) ? fmt::format("{:.4g} Pa", stress) : "no value";
  };
  const auto onset = [&](Loading loading) { return scale.pull->onset(loading, law).mean; };
  if (onset(Loading::tension) == 0.0) return;
  if (damage.peak_factors) return print_surface(out, damage, name);
  fmt::print(out,
             "{} bonds begin to soften at {} of tension, {} of compression; equal biaxial strength "
             "{}, shear strength {}\n",
             heading("strengths", name), text(onset(Loading::tension)),
             text(onset(Loading::compression)), text(scale.pull->peak(Loading::biaxial, law).mean),
             text(scale.pull->peak(Loading::shear, law).mean));
}

/// Prints fracture energy and strength of a law of damage.
void print_fracture(std::FILE* out, const Formulation& formulation,
                    const PointMaterials::Material& of, const std::string& name,
                    const BondSetting& setting, double spacing) {
  const DamageSpecification& damage = of.of->damage;
  if (damage.law == DamageLaw::none || of.of->fibre) return;
  if (damage.law == DamageLaw::energy_density) {
    fmt::print(out, "{} points fail at an energy density of {:.6g} J/m3\n",
               heading("fracture", name), bearable_energy_density(damage, setting.horizon));
    return;
  }
  if (formulation.crack_energy_of_dilation &&
      drive_of(formulation, damage) == DamageDrive::stretch) {
    const double energy = formulation.crack_energy_of_dilation(*of.of, of.key, setting, spacing);
    fmt::print(
        out, "{} critical stretch {:.6g}: fracture energy {:.6g} J/m2 under a uniform dilation\n",
        heading("fracture", name), damage.critical, energy * damage.critical * damage.critical);
    return;
  }
  const FractureScale scale = fracture_scale_of(*of.of, of.key, setting, spacing);
  const std::string begin = damage.softens() ? fmt::format("onset {:.6g}, ", damage.onset) : "";
  fmt::print(out, "{} {}critical stretch {:.6g}{}{}\n", heading("fracture", name), begin,
             damage.critical,
             fracture_energy_text(damage, scale, setting_of_bonds(formulation, setting)),
             strength_text(damage, scale, setting.dimension));
  print_strengths(out, damage, name, scale, setting.dimension);
}

/// Prints a toughness with the fracture energy that follows from it.
void print_toughness(std::FILE* out, const MaterialSpecification& given, const std::string& key,
                     const std::string& name, const BondSetting& setting, double spacing) {
  if (!given.damage.fracture_toughness) return;
  fmt::print(out, "{} {:.6g} Pa sqrt(m): fracture energy {:.6g} J/m2 by a modulus of {:.6g} Pa\n",
             heading("toughness", name), *given.damage.fracture_toughness,
             *with_fracture_energy(given, key, setting, spacing).damage.fracture_energy,
             modulus_of_tip(given, key, setting, spacing));
}

/// Prints the error of the quadrature of bonds, whatever their constants.
void print_quadrature(std::FILE* out, const Case& from, const Body& body, int threads) {
  Bonds bonds = body.model.bonds();
  if (!from.is_uniform()) {  // the weights include the constants
    bonds = make_bonds(body.points, from.surface_correction, body.setting, threads);
    static_cast<void>(cut_bonds(bonds, body.points, body.specification.cracks));
  }
  fmt::print(
      out,
      "quadrature  energy of a confined strain deviates from the classical one by at most {:.3g}\n",
      confined_energy_error(body.points, bonds, body.setting));
}

void print_constants(std::FILE* out, const Case& from, const Body& body, int threads) {
  const BodySpecification& of = body.specification;  // its stretches are computed
  const PointMaterials materials(of, body.points);
  const auto all = all_materials(of, materials);
  const Formulation& formulation = formulation_of(of);
  const double spacing = body.points.spacing;
  for (const auto& material : all) {
    const std::string name = from.regions.empty() ? "" : material.name;
    for (const auto& [topic, text] :
         formulation.describe(*material.of, material.key, body.setting, spacing)) {
      fmt::print(out, "{} {}\n", heading(topic, name), text);
    }
  }
  // A convolved body stores short bonds only.
  if (formulation.has_quadrature_of_bonds && !of.is_convolved()) {
    print_quadrature(out, from, body, threads);
  }
  for (const std::string& remark : body.remarks) fmt::print(out, "{}\n", remark);
  const PointMaterials as_given(from, body.points);
  const auto given = all_materials(from, as_given);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::string name = from.regions.empty() ? "" : all[k].name;
    print_toughness(out, *given[k].of, all[k].key, name, body.setting, spacing);
    print_fracture(out, formulation, all[k], name, body.setting, spacing);
  }
  const BondFailure* const bonds = body.model.failing_bonds();
  const ToothedStrength teeth = bonds ? toothed_strength(bonds->potential()) : ToothedStrength();
  if (teeth.teeth > 0) fmt::print(out, "saw-tooth   {}\n", description(teeth));
  const double size = body.setting.horizon / body.horizon_ratio();
  if (const auto trapping = crack_trapping(of, body.points.dimension, size)) {
    fmt::print(out, "crack       {}\n", description(*trapping));
  }
}

/// Prints the number of points of each material.
void print_regions(std::FILE* out, const Case& from, const Body& body) {
  if (from.regions.empty()) return;
  const auto count = [&](std::int32_t region) {
    return std::count(body.region.begin(), body.region.end(), region);
  };
  for (std::size_t k = 0; k < from.regions.size(); ++k) {
    fmt::print(out, "region      {}: {} points\n", from.regions[k].set, count(std::int32_t(k)));
  }
  if (count(-1) > 0) fmt::print(out, "region      none, [material]: {} points\n", count(-1));
}

/// Prints the numbers of prescribed, dependent and free degrees of freedom: those of the body's own
/// points, and the unknowns that constraints add.
void print_supports(std::FILE* out, const Body& body) {
  const std::vector<char>& prescribed = body.conditions->prescribed();
  const std::vector<char>& follows = body.conditions->constraints().dependent();
  const std::size_t own = std::size_t(body.points.own()) * std::size_t(body.points.dimension);
  std::size_t following = 0, free = 0, of_constraints = 0;
  for (std::size_t dof = 0; dof < prescribed.size(); ++dof) {
    if (dof >= own) {
      of_constraints += !prescribed[dof];
    } else {
      following += follows[dof];
      free += !prescribed[dof];
    }
  }
  std::string text = fmt::format("{} prescribed", own - following - free);
  text += following > 0 ? fmt::format(", {} that follow constraints,", following) : "";
  text += fmt::format(" and {} free degrees of freedom", free);
  if (of_constraints > 0)
    text += fmt::format("; free ones added by constraints: {}", of_constraints);
  fmt::print(out, "supports    {}\n", text);
}

/// Prints the pressures, and the part of their stiffness that the symmetric tangent leaves out.
void print_pressures(std::FILE* out, const Body& body) {
  for (const auto& term : body.model.terms()) {
    const auto* const pressures = dynamic_cast<const PressureTerm*>(term.get());
    if (!pressures) continue;
    const Conditions& conditions = *body.conditions;
    const double end = conditions.programme().end();
    const std::vector<double> at_rest(conditions.constraints().dofs(), 0.0);
    const History history;
    const auto [symmetric, left_out] = pressures->stiffness(
        {at_rest, history, Damage::grows,
         conditions.environment(conditions.control() ? LoadPoint(end, 1.0) : LoadPoint(end))},
        conditions.constraints(), conditions.prescribed());
    const bool is_symmetric = left_out <= 1e-12 * symmetric;
    fmt::print(
        out, "pressure    {} faces, {:.6g} m2; {}\n", pressures->boundary().face.size(),
        pressures->area(),
        is_symmetric
            ? "closed or held: its stiffness is symmetric"
            : fmt::format("open or uneven: its stiffness at the end of the load is {:.3g} N/m; the "
                          "tangent omits its unsymmetric part, {:.3g} N/m (forces are exact)",
                          std::hypot(symmetric, left_out), left_out));
  }
}

const PointTerm* convolved(const Body& body) {
  const auto* const term = body.model.find<PointTerm>();
  return term != nullptr && term->has_lattice() ? term : nullptr;
}

/// Measured time of the forces of an explicit step [s]; terms other than bonds take longer.
double seconds_of_forces(const Body& body) {
  constexpr double seconds_per_bond = 6e-9, seconds_per_place = 2e-7;
  if (const PointTerm* const term = convolved(body)) {
    return double(term->lattice()->box.count()) * seconds_per_place;
  }
  return double(body.model.bonds().count()) * seconds_per_bond;
}

/// Prints the stable step of a motion in time, and the time that its steps take.
void print_motion(std::FILE* out, const Case& from, const Body& body, const StudyOptions& options,
                  double seconds_of_solving) {
  const double stable = Study(body, options).find_initial_stiffness().stable_step();
  const DynamicsSpecification& dynamics = from.dynamics;
  const double step = dynamics.time_step > 0.0 ? dynamics.time_step : dynamics.step_share * stable;
  const double steps = std::ceil(dynamics.end_time / step * (1.0 - 1e-9));
  fmt::print(out, "motion      stable {}time step {:.6g} s; {:.0f} steps of {:.6g} s\n",
             from.dynamics.is_implicit() ? "explicit " : "", stable, steps, step);
  const double seconds_of_step =
      from.dynamics.is_implicit() ? seconds_of_solving : seconds_of_forces(body);
  fmt::print(out, "time        {}{}, without results\n", seconds_text(steps * seconds_of_step),
             from.dynamics.is_implicit() ? "" : " on one thread");
}

/// Prints the cycles of mode fatigue and the laws by which bonds age.
void print_fatigue(std::FILE* out, const Case& from) {
  const FatigueOptions& of = from.fatigue;
  const std::string until =
      of.cycles > 0.0 ? fmt::format("{:g} cycles", of.cycles) : std::string("failure");
  fmt::print(out,
             "fatigue     load ratio {:g}: ranges of stretches are {:g} of the largest ones; "
             "until {}\n",
             of.load_ratio, 1.0 - of.load_ratio, until);
  const auto print_law = [&](const LifeLaw& law, const char* where) {
    if (!law.acts()) return;
    constexpr double range = 1e-3;
    fmt::print(out,
               "fatigue     bonds {} lose {:g} (range - {:g})^{:g} of their life in a cycle: "
               "{:.4g} cycles at a range of {:g}\n",
               where, law.coefficient, law.limit, law.exponent, 1.0 / law.rate(range), range);
  };
  print_law(of.nucleation, of.growth.acts() ? "without a crack near" : "everywhere");
  print_law(of.growth, "near a crack");
}

Offset count_of_bonds(const Body& body) {
  return convolved(body) ? body.model.failure().count_of_bonds()
                         : weighted_bonds(body.model.bonds());
}

NeighbourCounts neighbours_of(const Body& body) {
  const PointTerm* const term = convolved(body);
  if (!term) return count_neighbours(body.model.bonds(), body.points.own());
  const std::vector<std::int32_t> of_point = term->counts().front().per_point;
  const auto [least, most] = std::ranges::minmax(of_point);
  return {least, most, Index(std::ranges::count(of_point, 0)),
          2.0 * double(count_of_bonds(body)) / double(of_point.size())};
}

void print_points(std::FILE* out, const Body& body) {
  const Points& points = body.points;
  fmt::print(out, "points      {} in {}D, spacing {}", points.own(), points.dimension,
             spacing_text(points));
  if (points.horizons.empty()) {
    fmt::print(out, ", horizon {:g} m ({:.4g} spacings)\n", body.setting.horizon,
               body.horizon_ratio());
    return;
  }
  fmt::print(out,
             ", horizons {:g} to {:g} m ({:.4g} sizes of their points)\nhorizons    constants "
             "below are for the largest horizon: the micromodulus is proportional to the power -{} "
             "of the horizon, stretches by fracture_energy alone to its power -1/2\n",
             *std::ranges::min_element(points.horizons), body.setting.horizon, body.horizon_ratio(),
             points.dimension + 1);
}

}  // namespace

Exit check(const Case& from, int threads, std::FILE* out) {
  const std::unique_ptr<const Body> made = make_body(from, threads);
  const Body& body = *made;
  const Points& points = body.points;
  const NeighbourCounts neighbours = neighbours_of(body);
  fmt::print(out, "case        {}\n", from.title.empty() ? from.file : from.title);
  print_points(out, body);
  const Preflight preflight =
      located_errors(from, [&] { return preflight_of(from, body, SoleRank()); });
  for (const auto& [label, text] : preflight_lines(preflight)) {
    fmt::print(out, "{:<11} {}\n", label, text);
  }
  fmt::print(out, "bonds       {}; neighbours per point {} to {}, {:.1f} on average\n",
             count_of_bonds(body), neighbours.least, neighbours.most, neighbours.mean);
  for (const std::string& line : describe_interactions(body)) {
    fmt::print(out, "interaction {}\n", line);
  }
  print_regions(out, from, body);
  print_constants(out, from, body, threads);
  for (const auto& [set, members] : points.sets) {
    fmt::print(out, "set         {}: {} points\n", set, members.size());
  }
  if (!points.columns.empty()) {
    std::vector<std::string> names;
    for (const auto& [name, values] : points.columns) names.push_back(name);
    fmt::print(out, "columns     {}\n", fmt::join(names, ", "));
  }
  print_supports(out, body);
  for (const std::string& line : describe_constraints(body)) {
    fmt::print(out, "constraint  {}\n", line);
  }
  print_pressures(out, body);
  if (neighbours.isolated > 0) {
    fmt::print(out, "isolated    {} points have no neighbour\n", neighbours.isolated);
  }

  const FreeDofs free(body.conditions->prescribed(), points.dimension);
  const Constraints& constraints = body.conditions->constraints();
  std::string reason;
  const StudyOptions options = study_options(from, threads);
  const LinearSystems systems = located_errors(from, [&] {
    return choose_linear_systems(options, body, [&](const std::string& told) { reason = told; });
  });
  const ChosenSolver& chosen = systems.chosen;
  require_memory(systems.bytes, fmt::format("the case with {} points", points.count()));
  const BlockPattern whole = systems.pattern_of() == Assembler::PatternOf::blocks
                                 ? body.model.pattern()
                                 : body.model.visited_pattern();
  const BlockPattern pattern = constraints.none() ? whole : constrained_pattern(whole, constraints);
  if (chosen.solver->analyze(pattern, free) == LinearOutcome::solved) {
    fmt::print(out, "solver      {} ({})\n", chosen.solver->describe(),
               reason.empty() ? chosen.reason : reason);
  }
  fmt::print(out, "memory      about {} of {} available\n", bytes_text(systems.bytes),
             bytes_text(available_memory()));
  if (from.solver.mode == Mode::dynamics) {
    located_errors(from, [&] { print_motion(out, from, body, options, chosen.seconds / threads); });
  } else if (from.solver.mode == Mode::fatigue) {
    print_fatigue(out, from);
    fmt::print(out,
               "time        {} per block of cycles; the number of blocks is not known before the "
               "run\n",
               seconds_text(chosen.seconds / threads));
  } else if (from.solver.mode == Mode::path) {
    fmt::print(out, "time        {} per event; the number of events is not known before the run\n",
               seconds_text(chosen.seconds / threads));
  } else {
    const int steps = from.loading.steps_to_entry() * int(body.conditions->programme().end());
    fmt::print(out, "time        {} for {} load steps, if none has to be cut{}\n",
               seconds_text(chosen.seconds * steps / threads), steps,
               preflight.may_fail ? "; steps in which damage grows take many times as long, and "
                                    "their number is not known before the run"
                                  : "");
  }
  located_errors(from, [&] {
    check_study(body, options);
    if (finds_loads(options, *body.conditions)) static_cast<void>(Study(body, options).analyze());
    static_cast<void>(make_crack_tips(body, from.crack_tips, options));
  });
  for (const std::string& warning : warnings_of(preflight))
    fmt::print(out, "warning: {}\n", warning);
  return Exit::done;
}

}  // namespace peristat
