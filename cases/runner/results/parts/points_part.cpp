#include "cases/runner/results/parts/points_part.hpp"

#include <algorithm>
#include <bit>

namespace peristat {
namespace {

/// The point sets as a matrix: 1 where the point of the row is in the set of the column.
std::vector<std::uint8_t> membership(const Points& points) {
  std::vector<std::uint8_t> matrix(std::size_t(points.count()) * points.sets.size());
  std::size_t column = 0;
  for (const auto& [name, members] : points.sets) {
    for (const Index point : members) matrix[point * points.sets.size() + column] = 1;
    ++column;
  }
  return matrix;
}

/// Name of a set's dataset.
std::string name_of_flags(const std::string& set) {
  std::string name = set;
  std::replace(name.begin(), name.end(), '/', '|');
  return name;
}

/// 1 where a point is among the members.
std::vector<std::uint8_t> flags(const Points& points, const std::vector<Index>& members) {
  std::vector<std::uint8_t> flags(points.volume.size());
  for (const Index point : members) flags[point] = 1;
  return flags;
}

/// True if all numbers are the same to the last bit.
bool are_same(const std::vector<double>& some, const std::vector<double>& others) {
  return std::equal(some.begin(), some.end(), others.begin(), others.end(), [](double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  });
}

constexpr const char* columns_group = "/points/columns";

std::string column_of(const std::string& name) { return columns_group + ("/" + name); }

/// True if a group holds columns of these names, or there are none.
bool holds_columns(const Hdf5File& file, const std::string& group, const Points& points) {
  const std::string place = group + "/columns";
  if (!file.has(place)) return points.columns.empty();
  std::vector<std::string> names;
  for (const auto& [name, values] : points.columns) names.push_back(name);
  return file.names(place) == names;
}

std::vector<std::int32_t> neighbour_points(const Points& points) {
  std::vector<std::int32_t> ends;
  for (const NeighbourShares& pair : points.neighbours) ends.insert(ends.end(), {pair.i, pair.j});
  return ends;
}

std::vector<double> neighbour_shares(const Points& points) {
  std::vector<double> shares;
  for (const NeighbourShares& pair : points.neighbours)
    shares.insert(shares.end(), {pair.of_j, pair.of_i});
  return shares;
}

/// True if a group holds the given neighbours of the points, or neither has any.
bool holds_neighbours(const Hdf5File& file, const std::string& group, const Points& points) {
  const std::string place = group + "/given_neighbours";
  if (file.has(place) == points.neighbours.empty()) return false;
  if (points.neighbours.empty()) return true;
  const std::vector<std::int64_t> ends = file.integers(place + "/points");
  const std::vector<std::int32_t> now = neighbour_points(points);
  return std::equal(ends.begin(), ends.end(), now.begin(), now.end()) &&
         are_same(file.numbers(place + "/shares"), neighbour_shares(points));
}

/// Writes how each kind of images follows its sources.
void write_image_kinds(Hdf5File& file, const Points& points) {
  const std::vector<ImageKind>& kinds = points.images.kinds;
  if (kinds.empty()) return;
  std::vector<double> mirror, shift;
  for (const ImageKind& kind : kinds) {
    mirror.insert(mirror.end(), kind.mirror.begin(), kind.mirror.begin() + points.dimension);
    shift.insert(shift.end(), kind.shift.begin(), kind.shift.begin() + points.dimension);
  }
  const Hdf5File::Shape shape{kinds.size(), std::uint64_t(points.dimension)};
  file.make_group("/points/images");
  file.write("/points/images/mirror", mirror, shape,
             {"1", "of each kind of images: the image of X is at mirror X + shift"});
  file.write("/points/images/shift", shift, shape,
             {"m", "of each kind of images: the image of X is at mirror X + shift"});
}

}  // namespace

std::string flags_of(const std::string& set) { return "/points/sets/" + name_of_flags(set); }

namespace {

/// Writes all arrays with a row per point.
void write_rows_of(const Points& points, const std::vector<PointCounts>& counts,
                   const RowGathering& gathering, Hdf5File* file) {
  const RowSink sink(file, gathering, gathering.rows(points.volume.size()));
  const auto dimension = static_cast<std::uint64_t>(points.dimension);
  sink.write("/points/reference", points.reference, {dimension},
             {"m", "reference position of each point"});
  sink.write("/points/volume", points.volume, {}, {"m3", "volume of each point"});
  // A rank without points has no horizons, but its part in the gathering.
  if (gathering.part().ranks().max(points.horizons.empty() ? 0.0 : 1.0) > 0.0) {
    sink.write("/points/horizon", points.horizons, {}, {"m", "horizon of each point"});
  }
  sink.write(
      "/points/set_ids", membership(points), {points.sets.size()},
      {"1", "1 where the point (row) is in the set (column); attribute sets names the columns"});
  for (const auto& [name, members] : points.sets) {
    sink.write(flags_of(name), flags(points, members), {},
               {"1", "1 where the point is in set " + name});
  }
  for (const auto& [name, values] : points.columns) {
    sink.write(column_of(name), values, {},
               {"none", "column " + name + " of the file of points, in its own unit"});
  }
  for (const PointCounts& of_points : counts) {
    std::visit(
        [&](const auto& values) {
          sink.write("/points/" + of_points.name, values, {}, {"1", of_points.description});
        },
        of_points.values);
  }
  std::vector<double> geometry;
  std::vector<std::int32_t> numbers;
  for (Index point = 0; point < points.count(); ++point) {
    const Coordinates at = points.position(point);
    geometry.insert(geometry.end(), at.begin(), at.end());
    numbers.push_back(std::int32_t(gathering.part().number_of(point)));
  }
  sink.write("/points/geometry", geometry, {3},
             {"m", "reference position with zeros beyond the dimension, for results.xdmf"});
  sink.write("/points/number", numbers, {}, {"1", "number of each point, for results.xdmf"});
}

}  // namespace

void write_points(Hdf5File& file, const Points& points, const std::vector<PointCounts>& counts,
                  const CellsOfBody& cells, const RowGathering& gathering) {
  file.make_group("/points");
  file.set_attribute("/points", "dimension", std::int64_t{points.dimension});
  file.set_attribute("/points", "spacing", double(points.spacing));
  for (int c = 0; c < points.dimension && !points.spacing.is_square(); ++c) {
    file.set_attribute("/points", std::string("spacing_") + "xyz"[c], points.spacing.along(c));
  }
  if (points.angle != 0.0) file.set_attribute("/points", "angle", points.angle);
  file.make_group("/points/sets");
  if (!points.columns.empty()) file.make_group(columns_group);
  write_rows_of(points, counts, gathering, &file);
  write_cells(&file, cells.cells, cells.sizes, gathering);
  std::vector<std::string> names;
  for (const auto& [name, members] : points.sets) names.push_back(name);
  if (!names.empty()) file.set_attribute("/points/set_ids", "sets", names);

  if (!points.neighbours.empty()) {
    const auto pairs = std::uint64_t(points.neighbours.size());
    file.make_group("/points/given_neighbours");
    file.write("/points/given_neighbours/points", neighbour_points(points), {pairs, 2},
               {"1", "pairs of points i < j that interact, as given"});
    file.write("/points/given_neighbours/shares", neighbour_shares(points), {pairs, 2},
               {"1", "share of the volume of j that i counts, and of i that j counts"});
  }
  write_image_kinds(file, points);
}

void send_points(const Points& points, const std::vector<PointCounts>& counts,
                 const CellsOfBody& cells, const RowGathering& gathering) {
  write_rows_of(points, counts, gathering, nullptr);
  write_cells(nullptr, cells.cells, cells.sizes, gathering);
}

std::uint64_t bytes_of(const Points& points, const std::vector<PointCounts>& counts,
                       const CellSizes& cells, std::uint64_t rows) {
  const std::uint64_t bytes_per_point = (counts.size() + points.columns.size()) * sizeof(double) +
                                        (std::uint64_t(points.dimension) + 5) * sizeof(double) +
                                        sizeof(std::int32_t) + 2 * points.sets.size();
  const std::uint64_t bytes_per_pair = 2 * (sizeof(std::int32_t) + sizeof(double));
  return rows * bytes_per_point + cells.bytes() + points.neighbours.size() * bytes_per_pair +
         points.images.kinds.size() * 6 * sizeof(double);
}

bool holds_points(const Hdf5File* file, const std::string& group, const Points& points,
                  const RowGathering& gathering) {
  std::vector<std::string> names;
  for (const auto& [set, members] : points.sets) names.push_back(name_of_flags(set));
  std::sort(names.begin(), names.end());
  const RowSource source(file, gathering);
  const std::uint64_t rows = gathering.rows(points.volume.size());
  const bool is_outline_held = source.all_agree([&] {
    return file->names(group + "/sets") == names && holds_neighbours(*file, group, points) &&
           holds_columns(*file, group, points) && file->count_of_rows(group + "/volume") == rows;
  });
  if (!is_outline_held) return false;
  const auto d = std::size_t(points.dimension);
  bool are_held = are_same(source.read<double>(group + "/reference", d), points.reference);
  are_held = are_same(source.read<double>(group + "/volume", 1), points.volume) && are_held;
  for (const auto& [name, values] : points.columns) {
    are_held = are_same(source.read<double>(group + "/columns/" + name, 1), values) && are_held;
  }
  for (const auto& [set, members] : points.sets) {
    const std::string path = group + "/sets/" + name_of_flags(set);
    are_held = source.read<std::uint8_t>(path, 1) == flags(points, members) && are_held;
  }
  return are_held;
}

}  // namespace peristat
