#include "src/conditions/surface_tractions.hpp"

#include <algorithm>
#include <array>

#include "src/conditions/points_of_set.hpp"
#include "src/conditions/with_key.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Indices of the entries of a stress: xx yy xy, or xx yy zz xy yz xz.
constexpr std::array<std::array<int, 2>, 3> plane_entries{{{0, 0}, {1, 1}, {0, 1}}};
constexpr std::array<std::array<int, 2>, 6> solid_entries{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

std::span<const std::array<int, 2>> stress_entries(int dimension) {
  if (dimension == 2) return plane_entries;
  return solid_entries;
}

/// Two faces are opposite if the cosine between their normals is at most this.
constexpr double faces_away = -0.7;

std::string key_of(LoadSpecification::Kind kind) {
  using Kind = LoadSpecification::Kind;
  if (kind == Kind::pressure) return ".pressure";
  return kind == Kind::stress ? ".stress" : ".traction";
}

/// Texts of a load's expressions.
std::vector<std::string> texts_of(const LoadSpecification& load, int dimension) {
  using Kind = LoadSpecification::Kind;
  if (load.kind == Kind::pressure) return {load.value[0]};
  if (load.kind == Kind::traction) {
    return {load.value.begin(), load.value.begin() + dimension};
  }
  return load.stress;
}

}  // namespace

void SurfaceTractions::add(const Points& points, const LoadSpecification& load,
                           const std::vector<std::string>& parameters, const std::string& table,
                           const std::vector<char>& prescribed, const Communicator& ranks) {
  Load made{load.kind, table + key_of(load.kind), {}, {}};
  std::vector<Index> members;
  if (!load.set.empty()) members = points_of_set(points, load.set, table + ".set");
  const auto acts_at = [&](const SurfaceSite& site) {
    if (load.side && site.side != load.side) return false;
    if (!load.boundary.empty() && site.name != load.boundary) return false;
    return load.set.empty() || std::binary_search(members.begin(), members.end(), site.point);
  };
  for (std::size_t k = 0; k < sites_.size(); ++k) {
    if (acts_at(sites_[k])) made.sites.push_back(k);
  }
  const double sites = double(made.sites.size());
  if (ranks.sum(sites) == 0.0) {
    const std::string key = table + (load.side                ? ".side"
                                     : !load.boundary.empty() ? ".boundary"
                                     : !load.set.empty()      ? ".set"
                                                              : "");
    const std::string value = load.side                ? name(*load.side)
                              : !load.boundary.empty() ? load.boundary
                                                       : load.set;
    throw InputError(key, value.empty() ? "" : '"' + value + '"',
                     "there is no free boundary here for a traction to act on; give a side of the "
                     "body without a layer, or the name of a shape of lattice.shape");
  }
  const std::vector<std::string> texts = texts_of(load, points.dimension);
  if (load.kind == LoadSpecification::Kind::stress &&
      texts.size() != stress_entries(points.dimension).size()) {
    throw InputError(made.key, "",
                     points.dimension == 2 ? "needs the components xx, yy, xy"
                                           : "needs the components xx, yy, zz, xy, yz, xz");
  }
  for (const std::string& text : texts) {
    with_key(made.key, [&] { made.value.push_back(expression_of(text, points, parameters)); });
  }
  if (load.kind != LoadSpecification::Kind::stress) refuse_one_sided(points, made, prescribed);
  loads_.push_back(std::move(made));
}

void SurfaceTractions::refuse_one_sided(const Points& points, const Load& load,
                                        const std::vector<char>& prescribed) const {
  // Equal pressures on both faces are the tractions of one stress; equal tractions are not.
  const bool is_balanced = load.kind == LoadSpecification::Kind::pressure;
  const auto d = std::size_t(points.dimension);
  std::vector<char> is_loaded(sites_.size(), 0);
  for (const std::size_t k : load.sites) is_loaded[k] = 1;
  for (const std::size_t k : load.sites) {
    const SurfaceSite& site = sites_[k];
    const auto first = prescribed.begin() + std::ptrdiff_t(std::size_t(site.point) * d);
    if (std::all_of(first, first + std::ptrdiff_t(d), [](char held) { return held != 0; }))
      continue;
    // The sites of a point are consecutive.
    std::size_t begin = k;
    while (begin > 0 && sites_[begin - 1].point == site.point) --begin;
    for (std::size_t other = begin; other < sites_.size(); ++other) {
      if (sites_[other].point != site.point) break;
      if (dot<3>(sites_[other].normal, site.normal) > faces_away) continue;
      if (is_balanced && is_loaded[other]) continue;
      throw InputError(load.key, "",
                       "acts on one of two faces that are less than two horizons apart, at " +
                           place_text(points.position(site.point), points.dimension) +
                           " m, where a part of the load would be lost; use a finer lattice or, if "
                           "the stress is known, a load with the key stress");
    }
  }
}

bool SurfaceTractions::changes_with_parameters() const {
  return std::any_of(loads_.begin(), loads_.end(), [](const Load& load) {
    return std::any_of(load.value.begin(), load.value.end(),
                       [](const Expression& value) { return value.has_parameters(); });
  });
}

Coordinates SurfaceTractions::traction(const Load& load, const SurfaceSite& site, int dimension,
                                       std::span<const double> values) const {
  Coordinates result{};
  switch (load.kind) {
    case LoadSpecification::Kind::pressure: {
      for (int c = 0; c < dimension; ++c) result[c] = -site.share * values[0] * site.normal[c];
      break;
    }
    case LoadSpecification::Kind::stress: {
      const Coordinates& normal = site.part_of_normal;
      const auto entries = stress_entries(dimension);
      for (std::size_t k = 0; k < entries.size(); ++k) {
        const auto [r, c] = entries[k];
        result[r] += values[k] * normal[c];
        if (r != c) result[c] += values[k] * normal[r];
      }
      break;
    }
    default:
      for (int c = 0; c < dimension; ++c) {
        result[c] = site.share * values[std::size_t(c)];
      }
  }
  return result;
}

std::vector<double> SurfaceTractions::at(const Points& points,
                                         std::span<const double> loads) const {
  const auto d = std::size_t(points.dimension);
  std::vector<double> tractions(points.reference.size(), 0.0);
  for (const Load& load : loads_) {
    std::vector<Coordinates> places;
    for (const std::size_t k : load.sites) places.push_back(sites_[k].place);
    std::vector<std::vector<double>> values;
    for (const Expression& value : load.value) {
      values.push_back(with_key(load.key, [&] { return value.at(places, loads); }));
    }
    std::vector<double> here(values.size());
    for (std::size_t number = 0; number < load.sites.size(); ++number) {
      const SurfaceSite& site = sites_[load.sites[number]];
      for (std::size_t k = 0; k < here.size(); ++k) here[k] = values[k][number];
      const Coordinates of_load = traction(load, site, points.dimension, here);
      for (std::size_t c = 0; c < d; ++c) {
        tractions[std::size_t(site.point) * d + c] += of_load[c];
      }
    }
  }
  return tractions;
}

}  // namespace peristat
