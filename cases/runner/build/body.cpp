#include "cases/runner/build/body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "cases/runner/build/bond_potential.hpp"
#include "cases/runner/build/cpd_model.hpp"
#include "cases/runner/process/available_memory.hpp"
#include "src/connectivity/fragments.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/stopwatch.hpp"
#include "src/geometry/point_file.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/horizon.hpp"

namespace peristat {
namespace {

/// Input errors of `make` speak of keys inside a table.
template <class Make>
auto errors_in_table(const std::string& table, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(table + (error.key().empty() ? "" : ".") + error.key(), error.value(),
                     error.allowed());
  }
}

const Lattice* lattice_of(const Case& from) { return std::get_if<Lattice>(&from.body); }

/// Refuses a horizon whose neighbourhood in the bulk takes minutes to sum, however small the body.
void require_summable(const Case& from, const std::string& key, double value, double ratio) {
  const bool counts_pairs = from.material.model == MaterialModel::cpd;
  const double largest = counts_pairs          ? largest_ratio_with_pairs(from.dimension)
                         : from.dimension == 3 ? 100.0
                                               : 1000.0;
  if (ratio <= inclusive_radius(largest)) return;
  throw InputError(key, number_text(value),
                   "the horizon is " + number_text(ratio) + " spacings; at most " +
                       number_text(largest) + (counts_pairs ? " with model \"cpd\"" : "") + " in " +
                       std::to_string(from.dimension) + "D");
}

BondSetting setting_of(const Case& from, const Points& points) {
  BondSetting setting;
  setting.dimension = from.dimension;
  setting.plane = from.material.plane;
  setting.volume_correction = from.volume_correction;
  if (const Lattice* lattice = lattice_of(from)) {
    setting.horizon = from.horizon_ratio * lattice->spacing;
    require_summable(from, "lattice.horizon_ratio", from.horizon_ratio, from.horizon_ratio);
    setting.cross_section = lattice->cross_section;
  } else {
    const auto& source = std::get<PointSource>(from.body);
    setting.horizon = source.horizon;
    setting.cross_section = source.cross_section;
    if (setting.horizon < points.spacing) {
      throw InputError("points.horizon", number_text(setting.horizon),
                       "horizon smaller than the mean spacing of the points, " +
                           number_text(points.spacing) + " m");
    }
    require_summable(from, "points.horizon", source.horizon, source.horizon / points.spacing);
  }
  return setting;
}

/// Refuses places whose digits don't tell neighbours from points beyond the horizon.
void require_resolved(const Case& from, const Points& points, double horizon) {
  double farthest = 0.0;
  for (const double at : points.reference) farthest = std::max(farthest, std::abs(at));
  if (farthest * std::numeric_limits<double>::epsilon() <= horizon_tolerance * horizon) return;
  throw InputError(lattice_of(from) ? "lattice.shape" : "points.file", "",
                   "a point stands at " + number_text(farthest) +
                       " m, so far from the origin that round-off of its place is more than " +
                       number_text(horizon_tolerance) + " of the horizon, " + number_text(horizon) +
                       " m; move the body to the origin");
}

/// No more than there are pairs of points.
double expected_bonds(double points, int dimension, double horizon_ratio) {
  return points * std::min(bonds_per_point(dimension, horizon_ratio), 0.5 * points);
}

/// Refuses a lattice that can't fit before any of its points is made.
void require_memory_for_lattice(const Case& from, const Lattice& lattice) {
  const double points = estimate_points(lattice);
  BodySize size;
  size.dimension = from.dimension;
  size.points = points;
  size.longest = std::pow(points, 1.0 / from.dimension);
  size.horizon_ratio = from.horizon_ratio;
  size.bonds = expected_bonds(points, from.dimension, from.horizon_ratio);
  size.free_dofs = points * from.dimension;
  const Box box = lattice.shapes.empty() ? Box{} : bounds(lattice.shapes.front().shape);
  for (int c = 0; c < from.dimension; ++c) {
    const double along = (box.max[c] - box.min[c]) / lattice.spacing;
    if (std::isfinite(along)) size.longest = std::max(size.longest, along);
  }
  // This estimate counts the bounding box: only what cannot fit even if half of it is cut away is
  // refused here; the points themselves tell the rest.
  require_memory(0.5 * estimate_memory(size).least_bytes(),
                 fmt::format("the case with up to {:.3g} points", points));
}

/// Stores interactions that can be stored if they fit into half of what everything else leaves.
void store_interactions(Body& body, int threads) {
  InteractionStorage& storage = body.interaction_storage;
  for (const auto& term : body.model.terms()) storage.needed += term->bytes_to_store();
  storage.room = std::max(0.5 * (available_memory() - estimate_memory(body).least_bytes()), 0.0);
  if (!storage.fits()) return;
  for (const auto& term : body.model.terms()) term->store(body.points, threads);
}

}  // namespace

Points make_points_of(const Case& from) {
  return located_errors(from, [&] {
    Points points;
    if (const Lattice* lattice = lattice_of(from)) {
      check_lattice(*lattice);  // first: what can't be used has no size
      require_memory_for_lattice(from, *lattice);
      points = make_points(*lattice);
    } else {
      const auto& source = std::get<PointSource>(from.body);
      points = read_points(source.file, from.dimension, source.cross_section);
    }
    for (std::size_t k = 0; k < from.sets.size(); ++k) {
      const SetRule& rule = from.sets[k];
      const std::string table = "set[" + std::to_string(k) + "]";
      if (points.sets.contains(rule.name)) {
        throw InputError(
            table + ".name", '"' + rule.name + '"',
            "there is a set of this name already (sets, layers and the sets of a point "
            "file share their names)");
      }
      std::vector<Index> members = errors_in_table(table, [&] { return select(points, rule); });
      if (members.empty()) {
        throw InputError(table, '"' + rule.name + '"', "the set selects no point");
      }
      points.sets[rule.name] = std::move(members);
    }
    for (std::size_t k = 0; k < from.probes.size(); ++k) {
      const ProbeSpecification& probe = from.probes[k];
      const std::string table = "probe[" + std::to_string(k) + "]";
      const auto require = [&](const std::string& key, const std::string& set) {
        if (set.empty() || points.sets.contains(set)) return;
        throw InputError(table + key, '"' + set + '"', "no set of this name");
      };
      require(".set", probe.set);
      require(".other", probe.other);
    }
    return points;
  });
}

BodySize size_of(const Points& points) {
  BodySize size;
  size.dimension = points.dimension;
  size.points = double(points.count());
  size.free_dofs = double(points.reference.size());
  for (int c = 0; c < points.dimension; ++c) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (Index i = 0; i < points.count(); ++i) {
      const double at = points.reference[std::size_t(i) * points.dimension + c];
      least = std::min(least, at);
      most = std::max(most, at);
    }
    size.longest = std::max(size.longest, (most - least) / points.spacing + 1.0);
  }
  return size;
}

std::unique_ptr<const Body> make_body(const Case& from, int threads) {
  auto owned = std::make_unique<Body>();
  Body& body = *owned;
  body.points = make_points_of(from);
  located_errors(from, [&] {
    body.setting = setting_of(from, body.points);
    require_resolved(from, body.points, body.setting.horizon);
    BodySize expected = size_of(body.points);
    expected.horizon_ratio = body.horizon_ratio();
    expected.bonds = expected_bonds(expected.points, from.dimension, body.horizon_ratio());
    require_memory(estimate_memory(expected).least_bytes(),
                   "the case with " + std::to_string(body.points.count()) + " points");
    {
      const Stopwatch watch(body.seconds_neighbourhood);
      Bonds bonds = make_bonds(body.points, from.surface_correction, body.setting, threads);
      CutBonds cut;
      if (from.material.model == MaterialModel::cpd) {
        body.model =
            make_cpd_model(from, body.points, body.setting, std::move(bonds), cut, threads);
      } else {
        // Corrections near surfaces are those of the whole body: a crack is no surface.
        cut = cut_bonds(bonds, body.points, from.cracks);
        std::vector<char> never_fails = never_failing_bonds(from, body.points, bonds);
        body.model = Model(std::move(bonds),
                           bond_potential(from.material, micromodulus_of(from, body.setting)),
                           std::move(never_fails));
      }
      body.cut_weight = std::move(cut.weight);
      body.cut_bonds = std::move(cut.ends);
    }
    body.conditions = std::make_unique<Conditions>(body.points, from.supports, from.loads);
    const Stopwatch watch(body.seconds_neighbourhood);
    store_interactions(body, threads);
  });
  return owned;
}

std::optional<Model> make_elastic_stand_in(const Case& from, const Body& body, int threads) {
  if (from.solver.elastic_horizon_ratio == 0.0 || from.solver.mode != Mode::adaptive) return {};
  return located_errors(from, [&]() -> std::optional<Model> {
    const std::string key = "solver.elastic_horizon_ratio";
    if (from.material.model != MaterialModel::bond || !from.material.youngs_modulus)
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "needs the bond model with a youngs_modulus: a micromodulus belongs to one "
                       "horizon");
    require_summable(from, key, from.solver.elastic_horizon_ratio,
                     from.solver.elastic_horizon_ratio);
    BondSetting setting = body.setting;
    setting.horizon = from.solver.elastic_horizon_ratio * body.points.spacing;
    Bonds bonds = make_bonds(body.points, from.surface_correction, setting, threads);
    static_cast<void>(cut_bonds(bonds, body.points, from.cracks));
    if (!free_motions(body.points, bonds, body.conditions->prescribed()).empty())
      throw InputError(key, number_text(from.solver.elastic_horizon_ratio),
                       "leaves points that may move freely");
    return Model(std::move(bonds), Harmonic{micromodulus(*from.material.youngs_modulus, setting)});
  });
}

MemoryEstimate estimate_memory(const Body& body) {
  const auto& prescribed = body.conditions->prescribed();
  BodySize size = size_of(body.points);
  size.horizon_ratio = body.horizon_ratio();
  size.bonds = double(body.model.bonds().count());
  size.bytes_per_bond = double(sizeof(Index) + body.model.bonds().kind.bytes_per_bond());
  size.has_history = body.model.has_history();
  size.has_symmetric_blocks = body.model.has_symmetric_blocks();
  size.free_dofs = double(std::count(prescribed.begin(), prescribed.end(), 0));
  MemoryEstimate estimate = estimate_memory(size);
  for (const auto& term : body.model.terms()) estimate.body_bytes += term->stored_bytes();
  return estimate;
}

std::vector<std::string> describe_interactions(const Body& body) {
  std::vector<std::string> lines;
  for (const auto& term : body.model.terms()) {
    if (term.get() == body.model.bond_term().get()) continue;  // told apart
    for (const InteractionCount& kind : term->counts()) {
      const auto [least, most] = std::minmax_element(kind.per_point.begin(), kind.per_point.end());
      lines.push_back(
          fmt::format("{} {}; per point {} to {}", kind.count, kind.name, *least, *most));
    }
  }
  const InteractionStorage& storage = body.interaction_storage;
  if (storage.needed > 0.0) {
    lines.push_back(fmt::format("{}: storing them takes {} of {} that are free for it",
                                storage.fits() ? "stored" : "found anew in every pass",
                                bytes_text(storage.needed), bytes_text(storage.room)));
  }
  return lines;
}

std::string describe_free_motions(const Body& body) {
  const std::vector<FreeMotion> parts =
      free_motions(body.points, body.model.bonds(), body.conditions->prescribed());
  std::string text;
  constexpr std::size_t most_listed = 5;
  for (std::size_t k = 0; k < std::min(parts.size(), most_listed); ++k) {
    const FreeMotion& part = parts[k];
    const std::string place = place_text(body.points.position(part.example), body.points.dimension);
    if (part.points == body.points.count()) {
      text += "the whole body may ";
    } else if (part.points == 1) {
      text += "the isolated point at " + place + " m may ";
    } else {
      text +=
          "a part of " + std::to_string(part.points) + " points, with one at " + place + " m, may ";
    }
    for (std::size_t m = 0; m < part.motions.size(); ++m) {
      text += (m == 0 ? "" : m + 1 == part.motions.size() ? " and " : ", ") + part.motions[m];
    }
    text += "; ";
  }
  if (parts.size() > most_listed) {
    text += "so may " + std::to_string(parts.size() - most_listed) + " more parts; ";
  }
  if (!text.empty()) text.resize(text.size() - 2);
  return text;
}

std::string describe_loose_points(const Body& body) {
  const std::vector<double> at_rest(body.points.reference.size(), 0.0);
  const Fragments fragments =
      find_fragments(body.points, body.model.bonds(), {}, body.conditions->prescribed(), at_rest);
  if (fragments.loose.empty()) return {};
  const std::size_t count = fragments.loose.size();
  return fmt::format(
      "{} {} on too few bonds to be held by them, {}at {} m", count,
      count == 1 ? "point hangs" : "points hang", count == 1 ? "" : "one of them ",
      place_text(body.points.position(fragments.loose.front()), body.points.dimension));
}

void refuse_unheld_bodies(const Case& from, const Body& body) {
  const std::string motions = describe_free_motions(body);
  if (!motions.empty()) {
    throw located(from, InputError("support", "",
                                   "the supports do not hold the body: " + motions +
                                       ". Prescribe displacements that prevent this"));
  }
  const std::string loose = describe_loose_points(body);
  if (!loose.empty()) {
    throw located(from, InputError(from.cracks.empty() ? "lattice" : "crack", "",
                                   loose + ". Take such points away, move what cuts them off, or "
                                           "give them more bonds (a larger horizon)"));
  }
}

}  // namespace peristat
