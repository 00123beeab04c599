#include "cases/runner/commands/points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cases/runner/input/quantity.hpp"
#include "cases/runner/process/output_file.hpp"
#include "cases/runner/setup/read_mesh.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/element_shape.hpp"
#include "src/geometry/local_spacing.hpp"
#include "src/geometry/mesh_body.hpp"
#include "src/geometry/mesh_points.hpp"

namespace peristat {
namespace {

constexpr const char* heading_of_points = "# points of a mesh in m, written by peristat points";
constexpr double usual_horizon_ratio = 3.015;

int dimension_of_mesh(const Mesh& mesh) {
  const bool has_solids = std::ranges::any_of(mesh.blocks, [](const Mesh::Block& block) {
    const ElementShape* const shape = shape_of_type(block.type);
    return shape != nullptr && shape->dimension == 3 && !block.nodes.empty();
  });
  return has_solids ? 3 : 2;
}

void print_mesh(const MeshBody& mesh, const Points& points, PointsAt at) {
  fmt::print("elements    {}\n", element_counts(mesh));
  for (const std::string& remark : mesh.remarks) fmt::print("remark      {}\n", remark);
  const auto& volume = points.volume;
  const auto [least, largest] = std::ranges::minmax(volume);
  const double all = std::accumulate(volume.begin(), volume.end(), 0.0);
  fmt::print("points      {} in {}D, at {}\n", points.count(), points.dimension,
             at == PointsAt::elements ? "the centroids of elements" : "nodes");
  fmt::print("volume      {:.10g} m3; of a point {:.4g} to {:.4g} m3, {:.4g} in the mean\n", all,
             least, largest, all / double(volume.size()));
  fmt::print("boundary    {} {}\n", mesh.boundary.size(), mesh.dimension == 2 ? "sides" : "faces");
  for (const auto& [name, members] : points.sets) {
    const std::size_t facets = facets_of(mesh, name).size();
    fmt::print("set         {}: {} points{}\n", name, members.size(),
               facets == 0 ? "" : fmt::format("; {} of the boundary's", facets));
  }
}

void print_spacings(const Points& points) {
  const std::vector<double> distances = nearest_distances(points);
  const auto [nearest, farthest] = std::ranges::minmax(distances);
  const double horizon = usual_horizon_ratio * points.spacing;
  const auto spacings = local_spacings(points, horizon);
  const auto [finest, coarsest] = std::ranges::minmax(spacings);
  fmt::print("distance    from the nearest other point {:.4g} to {:.4g} m\n", nearest, farthest);
  fmt::print(
      "spacing     {:.4g} m in the mean; around a point {:.4g} to {:.4g} m, a ratio of {:.3g}\n",
      double(points.spacing), finest, coarsest, coarsest / finest);
  fmt::print("horizon     {:.4g} m is {} mean spacings\n", horizon, usual_horizon_ratio);
  if (coarsest <= graded_ratio * finest) return;
  fmt::print(
      "warning: the mesh is graded: this horizon is {:.3g} spacings where the mesh is coarsest and "
      "{:.3g} where it is finest. One horizon for all points must be {:.4g} m, {} of the coarsest "
      "spacings; points.horizon = {{ ratio = {} }} gives each point a horizon of its own\n",
      horizon / coarsest, horizon / finest, usual_horizon_ratio * coarsest, usual_horizon_ratio,
      usual_horizon_ratio);
}

std::string text_of(const Points& points) {
  std::vector<std::vector<const std::string*>> sets(points.volume.size());
  for (const auto& [name, members] : points.sets)
    for (const Index point : members) sets[std::size_t(point)].push_back(&name);
  std::string text = points.dimension == 2 ? "x, y, volume, set\n" : "x, y, z, volume, set\n";
  for (Index i = 0; i < points.count(); ++i) {
    const Coordinates at = points.position(i);
    for (int c = 0; c < points.dimension; ++c) text += fmt::format("{}, ", at[std::size_t(c)]);
    text += fmt::format("{}, ", points.volume[std::size_t(i)]);
    for (const std::string* const name : sets[std::size_t(i)])
      text += (name == sets[std::size_t(i)].front() ? "" : "|") + *name;
    text += "\n";
  }
  return text;
}

void write_points_file(const Points& points, const PointsQuestion& question) {
  std::error_code error;
  if (std::filesystem::equivalent(question.output, question.mesh, error))
    throw InputError("--output", question.output.string(), "is the mesh itself");
  std::FILE* file = nullptr;
  try {
    file = open_own_file(question.output, heading_of_points);
  } catch (const ForeignFile& foreign) {
    throw InputError("--output", question.output.string(), foreign.what());
  }
  const std::string text = text_of(points);
  const bool is_written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if (std::fclose(file) != 0 || !is_written)
    throw OutputError(question.output.string() + " can't be written", errno);
  fmt::print("written     {}\n", question.output.string());
}

double length_of(const std::string& unit) {
  std::string why_not;
  const std::optional<Unit> found = parse_unit(unit, why_not);
  if (!found || found->dimension != unit_of_key("m").dimension)
    throw InputError("--length-unit", unit, "must be a unit of length, such as mm");
  return found->size();
}

}  // namespace

Exit print_points(const PointsQuestion& question) {
  PointSource source;
  source.file = question.mesh;
  if (!source.is_mesh())
    throw InputError(
        "", question.mesh.string(),
        "is not a mesh; names of meshes end in .msh, .inp, .vtu, .vtk, .exo, .e, .ex2 or .med");
  if (!std::isfinite(question.thickness) || !(question.thickness > 0.0))
    throw InputError("--thickness", fmt::format("{}", question.thickness), "must be positive");
  std::error_code error;
  if (!std::filesystem::is_regular_file(question.mesh, error))
    throw InputError("", question.mesh.string(), "no such file");
  const Mesh mesh = read_mesh(question.mesh, length_of(question.length_unit));
  const int dimension = question.dimension == 0 ? dimension_of_mesh(mesh) : question.dimension;
  if (dimension == 3 && question.thickness != 1.0)
    throw InputError("--thickness", fmt::format("{}", question.thickness), "is for dimension 2");
  const std::string name = question.mesh.string();
  const auto body = make_mesh_body(mesh, dimension, name);
  const Points points = make_points(body, question.at, question.thickness, name);
  print_mesh(*body, points, question.at);
  print_spacings(points);
  if (!question.output.empty()) write_points_file(points, question);
  return Exit::done;
}

}  // namespace peristat
