#include "solvers/body/unheld_body.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "assembly/terms/damage.hpp"
#include "src/connectivity/fragments.hpp"
#include "src/connectivity/free_motion.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

namespace {

std::vector<double> at_rest(const Body& body) {
  return std::vector<double>(body.conditions->constraints().dofs(), 0.0);
}

/// Describes the parts of the body that may move freely; empty if there are none.
std::string describe_free_motions(const Body& body, const Bonds& bonds) {
  const std::vector<FreeMotion> parts =
      free_motions(body.points, bonds, body.conditions->holding(at_rest(body)), *body.index_map);
  std::string text;
  constexpr std::size_t most_listed = 5;
  for (std::size_t k = 0; k < std::min(parts.size(), most_listed); ++k) {
    const FreeMotion& part = parts[k];
    const std::string place = place_text(part.place, body.points.dimension);
    if (part.points == body.index_map->whole()) {
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

/// Positions of the loose points of all ranks, each with its number; the lowest number first.
std::vector<std::pair<double, Coordinates>> places_of_loose(const Body& body,
                                                            const std::vector<Index>& loose) {
  std::vector<double> flat;
  for (const Index point : loose) {
    const Coordinates at = body.points.position(point);
    flat.push_back(double(body.index_map->number_of(point)));
    flat.insert(flat.end(), at.begin(), at.end());
  }
  flat = concatenated(body.index_map->ranks(), flat);
  std::vector<std::pair<double, Coordinates>> places;
  for (std::size_t k = 0; k < flat.size(); k += 4) {
    places.emplace_back(flat[k], Coordinates{flat[k + 1], flat[k + 2], flat[k + 3]});
  }
  std::sort(places.begin(), places.end());
  return places;
}

/// Describes points that have too few bonds from the start; empty if there are none.
std::string describe_loose_points(const Body& body, const Bonds& bonds) {
  const std::vector<double> rest = at_rest(body);
  const Fragments fragments = find_fragments(body.points, bonds, {}, body.conditions->prescribed(),
                                             rest, body.conditions->holding(rest), *body.index_map);
  const auto places = places_of_loose(body, fragments.loose);
  if (places.empty()) return {};
  return fmt::format("{} {} on too few bonds to be held by them, {}at {} m", places.size(),
                     places.size() == 1 ? "point hangs" : "points hang",
                     places.size() == 1 ? "" : "one of them ",
                     place_text(places.front().second, body.points.dimension));
}

/// Describes a body whose points all lie in one plane across an axis, so that no bond resists their
/// motion along it; empty for other bodies.
std::string describe_flatness(const Body& body) {
  constexpr double flat = 1e-9;  // round-off, relative to the largest extent
  const int dimension = body.points.dimension;
  std::array<double, 3> extent{};
  for (int c = 0; c < dimension; ++c) {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (Index i = 0; i < body.points.count(); ++i) {
      low = std::min(low, body.points.position(i)[c]);
      high = std::max(high, body.points.position(i)[c]);
    }
    low = body.index_map->ranks().min(low);
    high = body.index_map->ranks().max(high);
    extent[std::size_t(c)] = high - low;
  }
  const double largest = std::max({extent[0], extent[1], extent[2]});
  for (int c = 0; c < dimension; ++c) {
    if (extent[std::size_t(c)] > flat * largest) continue;
    const char axis = "xyz"[c];
    return fmt::format(
        "all points have the same {0}, so no bond resists their motion along {0}: give the body "
        "two layers or more across it, prescribe that displacement everywhere, or model it in {1} "
        "dimension{2}",
        axis, dimension - 1, dimension == 2 ? "" : "s");
  }
  return {};
}

}  // namespace

void refuse_unheld_bodies(const Body& body) {
  const auto is_held_by = [&](const Bonds& bonds) {
    return describe_free_motions(body, bonds).empty() && describe_loose_points(body, bonds).empty();
  };
  if (is_held_by(body.model.bonds())) return;
  const std::shared_ptr<const Bonds> bonds = whole_network(body.model);
  const std::string motions = describe_free_motions(body, *bonds);
  if (!motions.empty()) {
    const std::string remedy =
        body.conditions->obstacles().none()
            ? "Prescribe displacements that prevent this"
            : "Obstacles only push, so they do not hold it. Prescribe displacements that prevent "
              "this, give planes of symmetry, or hold it by soft springs (a foundation)";
    throw InputError("supports", "",
                     "the supports do not hold the body: " + motions + ". " + remedy);
  }
  const std::string loose = describe_loose_points(body, *bonds);
  const std::string flatness = describe_flatness(body);
  if (!loose.empty() && !flatness.empty()) throw InputError("points", "", flatness);
  if (!loose.empty()) {
    throw InputError(body.specification.cracks.empty() ? "points" : "cracks", "",
                     loose +
                         ". Remove such points, move the crack or shape that isolates them, or "
                         "give them more bonds (a larger horizon)");
  }
}

}  // namespace peristat
