#include "cases/runner/setup/lattice_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

constexpr double per_radian = 180.0 / std::numbers::pi;

std::vector<Coordinates> vertices_of(const Crack& crack) {
  if (const auto* const segment = std::get_if<CrackSegment>(&crack)) {
    return {segment->from, segment->to};
  }
  const auto* const polygon = std::get_if<CrackPolygon>(&crack);
  return polygon == nullptr ? std::vector<Coordinates>{} : polygon->vertices;
}

/// A vector at a right angle to a crack; twice the area of a polygon.
Coordinates normal_of(const std::vector<Coordinates>& vertices) {
  if (vertices.size() == 2) {
    return {vertices[0][1] - vertices[1][1], vertices[1][0] - vertices[0][0], 0.0};
  }
  Coordinates normal{};
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Coordinates part = cross(vertices[k], vertices[(k + 1) % vertices.size()]);
    for (std::size_t c = 0; c < 3; ++c) normal[c] += part[c];
  }
  return normal;
}

/// Normals of the lines or planes of points along two axes, or along an axis and a diagonal, in the
/// frame of the lattice.
std::vector<Coordinates> normals_of_rows(const Lattice& lattice) {
  std::vector<Coordinates> normals;
  for (int a = 0; a < lattice.dimension; ++a) {
    Coordinates axis{};
    axis[std::size_t(a)] = 1.0;
    normals.push_back(axis);
    for (int b = 0; b < a; ++b) {
      for (const double sign : {1.0, -1.0}) {
        Coordinates normal{};
        normal[std::size_t(a)] = 1.0 / lattice.spacing.along(a);
        normal[std::size_t(b)] = sign / lattice.spacing.along(b);
        normals.push_back(normal);
      }
    }
  }
  return normals;
}

/// Angle between a crack and the nearest row [degrees]; none for outlines and shapes.
std::optional<double> angle_to_row(const std::vector<Coordinates>& vertices,
                                   const Lattice& lattice) {
  const Coordinates normal = normal_of(vertices);
  const double c = std::cos(lattice.angle / per_radian), s = std::sin(lattice.angle / per_radian);
  const Coordinates own{c * normal[0] + s * normal[1], c * normal[1] - s * normal[0], normal[2]};
  if (!(dot<3>(own, own) > 0.0)) return std::nullopt;
  double least = 90.0;
  for (const Coordinates& row : normals_of_rows(lattice)) {
    const Coordinates across = cross(own, row);
    const double angle = std::atan2(std::sqrt(dot<3>(across, across)), std::abs(dot<3>(own, row)));
    least = std::min(least, per_radian * angle);
  }
  return least;
}

bool lies_in_symmetry(const Case& from, const std::vector<Coordinates>& vertices) {
  return std::ranges::any_of(from.constraints.symmetries, [&](const auto& plane) {
    const auto* const lattice = std::get_if<Lattice>(&from.body);
    const double round_off = 1e-6 * lattice->spacing.along(plane.axis);
    return std::ranges::all_of(vertices, [&](const Coordinates& at) {
      return std::abs(at[std::size_t(plane.axis)] - plane.at) <= round_off;
    });
  });
}

}  // namespace

bool has_rows_to_lock_to(const Case& from) {
  const auto* const lattice = std::get_if<Lattice>(&from.body);
  if (lattice == nullptr || lattice->dimension == 1) return false;
  const auto fails = [](const MaterialSpecification& material) {
    return material.damage.law != DamageLaw::none;
  };
  return lattice->arrangement == Arrangement::lattice && lattice->perturbation == 0.0 &&
         lattice->cell_perturbation == 0.0 &&
         (fails(from.material) || std::ranges::any_of(from.regions, [&](const auto& region) {
            return fails(region.material);
          }));
}

std::vector<std::string> cracks_along_rows(const Case& from) {
  std::vector<std::string> keys;
  if (!has_rows_to_lock_to(from)) return keys;
  for (std::size_t k = 0; k < from.cracks.size(); ++k) {
    const std::vector<Coordinates> vertices = vertices_of(from.cracks[k]);
    const std::optional<double> angle = angle_to_row(vertices, std::get<Lattice>(from.body));
    if (!angle || *angle > along_row + 1e-9 || lies_in_symmetry(from, vertices)) continue;
    keys.push_back("crack[" + std::to_string(k) + "]");
  }
  return keys;
}

}  // namespace peristat
