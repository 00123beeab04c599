#include "solvers/study/surface_sites.hpp"

#include <memory>
#include <stdexcept>

#include <Eigen/QR>

#include "assembly/terms/collocation/collocation_term.hpp"

namespace peristat {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// a_f of least squares, of all the one of least norm.
std::vector<double> shares_of(const std::vector<Foot>& feet, const Coordinates& normal) {
  if (feet.size() == 1) return {1.0};
  Matrix normals(3, Eigen::Index(feet.size()));
  for (std::size_t f = 0; f < feet.size(); ++f) {
    for (int c = 0; c < 3; ++c) normals(c, Eigen::Index(f)) = feet[f].normal[c];
  }
  const Vector of_point = Eigen::Map<const Vector>(normal.data(), 3);
  const Vector shares = normals.completeOrthogonalDecomposition().solve(of_point);
  return {shares.begin(), shares.end()};
}

}  // namespace

std::vector<SurfaceSite> surface_sites(const Points& points, const Model& model,
                                       const BodyBoundary* boundary,
                                       const std::vector<std::string>& names, double horizon,
                                       int threads) {
  const auto* term = dynamic_cast<const CollocationTerm*>(model.bond_term().get());
  if (!term) throw std::logic_error("surface sites are of bodies of model lps");
  std::vector<SurfaceSite> sites;
  if (!boundary) return sites;
  CollocationOperator operator_at_rest(points, term->whole(), threads);
  const std::span<const double> normals = operator_at_rest.normals();
  const auto d = std::size_t(points.dimension);
  for (Index i = 0; i < points.count(); ++i) {
    Coordinates normal{};
    bool has_normal = false;
    for (std::size_t c = 0; c < d; ++c) {
      normal[c] = normals[std::size_t(i) * d + c];
      has_normal = has_normal || normal[c] != 0.0;
    }
    if (!has_normal) continue;
    const Coordinates place = points.position(i);
    std::vector<Foot> feet = boundary->near(place, horizon);
    // In front of a face a point is beyond a concave corner or a gap.
    std::erase_if(feet, [&](const Foot& foot) { return foot.depth(place) < 0.0; });
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

}  // namespace peristat
