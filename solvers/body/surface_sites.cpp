#include "solvers/body/surface_sites.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "assembly/terms/collocation/collocation_term.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/dense/least_squares.hpp"

namespace peristat {
namespace {

/// Depth below a face, in spacings, of points that stand on it.
constexpr double on_face = 1e-6;

/// Shares a_f by least squares; the solution of least norm.
std::vector<double> shares_of(const std::vector<Foot>& feet, const Coordinates& normal) {
  if (feet.size() == 1) return {1.0};
  std::vector<double> normals;
  for (const Foot& foot : feet) {
    normals.insert(normals.end(), foot.normal.begin(), foot.normal.end());
  }
  return least_squares(normals, 3, normal);
}

}  // namespace

std::vector<SurfaceSite> surface_sites(const Points& points, const Model& model,
                                       const BodyBoundary* boundary,
                                       const std::vector<std::string>& names, double horizon,
                                       int threads) {
  const auto* term = model.find<CollocationTerm>();
  if (!term) throw std::logic_error("surface sites are of bodies of model lps");
  std::vector<SurfaceSite> sites;
  if (!boundary) return sites;
  CollocationOperator operator_at_rest(points, term->whole(), threads);
  const std::span<const double> normals = operator_at_rest.normals();
  const auto d = std::size_t(points.dimension);
  for (Index i = 0; i < points.owned.value_or(points.count()); ++i) {
    Coordinates normal{};
    bool has_normal = false;
    for (std::size_t c = 0; c < d; ++c) {
      normal[c] = normals[std::size_t(i) * d + c];
      has_normal = has_normal || normal[c] != 0.0;
    }
    if (!has_normal) continue;
    const Coordinates place = points.position(i);
    const std::vector<Foot> feet = boundary->above(place, horizon);
    const std::vector<double> shares =
        feet.empty() ? std::vector<double>() : shares_of(feet, normal);
    Coordinates rest = normal;
    for (std::size_t f = 0; f < feet.size(); ++f) {
      SurfaceSite site;
      site.point = i;
      for (const Side side :
           {Side{0, -1}, Side{0, 1}, Side{1, -1}, Side{1, 1}, Side{2, -1}, Side{2, 1}}) {
        if (side.axis < points.dimension && boundary->is_on(feet[f], side)) site.side = side;
      }
      if (feet[f].part.shape < names.size()) site.name = names[feet[f].part.shape];
      site.place = feet[f].at;
      site.normal = feet[f].normal;
      site.share = shares[f];
      for (std::size_t c = 0; c < d; ++c) {
        site.part_of_normal[c] = shares[f] * feet[f].normal[c];
        rest[c] -= site.part_of_normal[c];
      }
      sites.push_back(std::move(site));
    }
    if (feet.empty()) continue;
    Coordinates& nearest = sites[sites.size() - feet.size()].part_of_normal;
    for (std::size_t c = 0; c < d; ++c) nearest[c] += rest[c];
  }
  return sites;
}

void refuse_points_on_faces(const Points& points, const std::vector<SurfaceSite>& sites,
                            const std::vector<char>& prescribed) {
  const auto d = std::size_t(points.dimension);
  const double least = on_face * points.spacing.largest();
  for (const SurfaceSite& site : sites) {
    const auto first = prescribed.begin() + std::ptrdiff_t(std::size_t(site.point) * d);
    if (std::all_of(first, first + std::ptrdiff_t(d), [](char held) { return held != 0; }))
      continue;
    const Coordinates place = points.position(site.point);
    double squared = 0.0;
    for (std::size_t c = 0; c < d; ++c) squared += std::pow(place[c] - site.place[c], 2);
    if (squared > least * least) continue;
    throw InputError("material.model", "lps",
                     "needs points inside the body, about half a spacing below its free faces: the "
                     "one at " +
                         place_text(place, points.dimension) +
                         " m lies on a face; give lattice origin = \"cell_centres\", or move the "
                         "shape by half a spacing");
  }
}

}  // namespace peristat
