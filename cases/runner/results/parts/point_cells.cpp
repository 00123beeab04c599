#include "cases/runner/results/parts/point_cells.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace peristat {
namespace {

/// Corners of a line, square or cube of edge 2 about the origin, in VTK's order.
std::vector<Coordinates> box_corners(int dimension) {
  if (dimension == 1) return {{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  std::vector<Coordinates> corners{
      {-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}, {-1.0, 1.0, 0.0}};
  if (dimension == 2) return corners;
  for (std::size_t k = 0; k < 4; ++k) {
    corners[k][2] = -1.0;
    corners.push_back({corners[k][0], corners[k][1], 1.0});
  }
  return corners;
}

/// Corners of a lattice's cell about its point [m].
std::vector<double> lattice_box(const Points& points) {
  std::vector<Coordinates> corners = box_corners(points.dimension);
  constexpr double degree = 3.14159265358979323846 / 180.0;
  const double cosine = std::cos(points.angle * degree), sine = std::sin(points.angle * degree);
  for (Coordinates& corner : corners) {
    for (int c = 0; c < points.dimension; ++c) {
      corner[std::size_t(c)] *= 0.5 * points.spacing.along(c);
    }
    if (points.angle == 0.0) continue;
    corner = {cosine * corner[0] - sine * corner[1], sine * corner[0] + cosine * corner[1],
              corner[2]};
  }
  std::vector<double> box;
  for (const Coordinates& corner : corners) box.insert(box.end(), corner.begin(), corner.end());
  return box;
}

class CellBuilder {
 public:
  explicit CellBuilder(std::size_t points) {
    made_.kind.reserve(points);
    made_.count.reserve(points);
  }

  void begin(std::uint8_t kind) {
    made_.kind.push_back(kind);
    made_.count.push_back(0);
  }
  void add(const Coordinates& corner) {
    made_.corners.insert(made_.corners.end(), corner.begin(), corner.end());
    ++made_.count.back();
  }
  void add(const Coordinates& centre, const Coordinates& offset) {
    add({centre[0] + offset[0], centre[1] + offset[1], centre[2] + offset[2]});
  }
  [[nodiscard]] PointCells release() { return std::move(made_); }

 private:
  PointCells made_;
};

void add_element(CellBuilder& made, const MeshElements& elements, std::size_t point,
                 int dimension) {
  made.begin(std::uint8_t(elements.kind[point]));
  for (std::size_t k = elements.offset[point]; k < elements.offset[point + 1]; ++k) {
    Coordinates at{};
    const auto first = std::size_t(elements.corners[k]) * std::size_t(dimension);
    for (std::size_t c = 0; c < std::size_t(dimension); ++c) at[c] = elements.nodes[first + c];
    made.add(at);
  }
}

/// Calls put with the rows of the whole body, from row 0 on.
template <class Value>
void each_row(const RowGathering& gathering, const std::vector<Value>& mine, std::size_t width,
              const Hdf5File::PutRows<Value>& put) {
  if (!gathering.is_whole()) return gathering.gather<Value>(mine, width, put);
  const std::uint64_t rows = width == 0 ? 0 : mine.size() / width;
  constexpr std::uint64_t most = 1 << 16;
  for (std::uint64_t first = 0; put && first < rows; first += most) {
    const auto begin = mine.begin() + std::ptrdiff_t(first * width);
    const std::uint64_t count = std::min(most, rows - first);
    put(first, {begin, begin + std::ptrdiff_t(count * width)});
  }
}

/// Writes a compressed dataset whose parts follow from rows per point.
/// @param make turns rows into a part of the dataset
template <class Value, class Source, class Make>
void write_from_rows(Hdf5File* file, const std::string& path, const Hdf5File::Shape& shape,
                     const DatasetLabel& label, const RowGathering& gathering,
                     const std::vector<Source>& mine, std::size_t width, const Make& make) {
  if (!file) return each_row<Source>(gathering, mine, width, {});
  std::uint64_t per_row = 1;
  for (std::size_t k = 1; k < shape.size(); ++k) per_row *= shape[k];
  file->write_rows<Value>(
      path, shape, label,
      [&](const Hdf5File::PutRows<Value>& put) {
        std::uint64_t next = 0;
        each_row<Source>(gathering, mine, width,
                         [&](std::uint64_t, const std::vector<Source>& rows) {
                           const std::vector<Value> part = make(rows);
                           if (part.empty()) return;
                           put(next, part);
                           next += part.size() / per_row;
                         });
      },
      Hdf5File::Storage::compressed);
}

/// Corners of each point in a row of `most` corners, filled up with NaN.
std::vector<double> in_equal_rows(const PointCells& cells, std::uint64_t most) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> rows;
  rows.reserve(cells.count.size() * most * 3);
  auto next = cells.corners.begin();
  for (const std::int32_t count : cells.count) {
    rows.insert(rows.end(), next, next + 3 * count);
    rows.resize(rows.size() + 3 * (most - std::uint64_t(count)), none);
    next += 3 * count;
  }
  return rows;
}

/// Number of a cell's kind in XDMF; of polygons, lines and points their number of corners follows.
std::int32_t xdmf_kind(std::int32_t kind) {
  switch (kind) {
    case vertex_cell:
      return 1;
    case std::int32_t(MeshElements::Kind::line):
      return 2;
    case polygon_cell:
      return 3;
    case std::int32_t(MeshElements::Kind::triangle):
      return 4;
    case std::int32_t(MeshElements::Kind::quadrilateral):
      return 5;
    case std::int32_t(MeshElements::Kind::tetrahedron):
      return 6;
    case std::int32_t(MeshElements::Kind::pyramid):
      return 7;
    case std::int32_t(MeshElements::Kind::wedge):
      return 8;
    default:
      return 9;  // hexahedron
  }
}

bool tells_count(std::int32_t xdmf) { return xdmf <= 3; }

}  // namespace

namespace {

PointCells points_as_cells(const Points& points) {
  const Index own = points.owned.value_or(points.own());
  CellBuilder made{std::size_t(own)};
  for (Index point = 0; point < own; ++point) {
    made.begin(vertex_cell);
    made.add(points.position(point));
  }
  return made.release();
}

PointCells boxes_of_lattice(const Points& points) {
  constexpr MeshElements::Kind kinds[] = {MeshElements::Kind::line, MeshElements::Kind::line,
                                          MeshElements::Kind::quadrilateral,
                                          MeshElements::Kind::hexahedron};
  PointCells cells = points_as_cells(points);
  cells.box = lattice_box(points);
  std::ranges::fill(cells.kind, std::uint8_t(kinds[points.dimension]));
  std::ranges::fill(cells.count, std::int32_t(cells.box.size() / 3));
  return cells;
}

}  // namespace

std::vector<double> boxes_about(const std::vector<double>& points, const std::vector<double>& box) {
  std::vector<double> corners;
  corners.reserve(points.size() / 3 * box.size());
  for (std::size_t point = 0; point < points.size(); point += 3) {
    for (std::size_t k = 0; k < box.size(); ++k) corners.push_back(points[point + k % 3] + box[k]);
  }
  return corners;
}

PointCells cells_of(const Points& points) {
  if (points.elements.empty() && points.polygons.empty()) {
    return points.lattice ? boxes_of_lattice(points) : points_as_cells(points);
  }
  const Index own = points.owned.value_or(points.own());
  CellBuilder made{std::size_t(own)};
  for (Index point = 0; point < own; ++point) {
    const Coordinates at = points.position(point);
    if (!points.elements.empty()) {
      add_element(made, points.elements, std::size_t(point), points.dimension);
    } else {
      made.begin(points.dimension == 1 ? std::uint8_t(MeshElements::Kind::line) : polygon_cell);
      for (const auto& [x, y] : points.polygons.of(std::size_t(point))) made.add(at, {x, y, 0.0});
    }
  }
  return made.release();
}

CellSizes sizes_of(const PointCells& cells, const RowGathering& gathering) {
  const Communicator& ranks = gathering.ranks();
  CellSizes sizes;
  sizes.cells = std::uint64_t(ranks.count_all(std::int64_t(cells.kind.size())).all);
  const std::int64_t corners =
      std::accumulate(cells.count.begin(), cells.count.end(), std::int64_t(0));
  sizes.corners = std::uint64_t(ranks.count_all(corners).all);
  double most = 0.0, lowest = 255.0, highest = 0.0;
  for (const std::int32_t count : cells.count) most = std::max(most, double(count));
  for (const std::uint8_t kind : cells.kind) {
    lowest = std::min(lowest, double(kind));
    highest = std::max(highest, double(kind));
  }
  sizes.most = std::uint64_t(ranks.max(most));
  lowest = ranks.min(lowest);
  highest = ranks.max(highest);
  if (lowest == highest && highest != polygon_cell) sizes.kind = std::uint8_t(highest);
  if (sizes.kind != 0) return sizes;
  const std::int64_t counted = std::ranges::count_if(
      cells.kind, [](std::uint8_t kind) { return tells_count(xdmf_kind(kind)); });
  sizes.topology = sizes.corners + sizes.cells + std::uint64_t(ranks.count_all(counted).all);
  return sizes;
}

CellsOfBody::CellsOfBody(const Points& points, const RowGathering& gathering)
    : cells(cells_of(points)), sizes(sizes_of(cells, gathering)) {
  if (sizes.corners <= std::uint64_t(std::numeric_limits<std::int32_t>::max())) return;
  cells = points_as_cells(points);
  sizes = sizes_of(cells, gathering);
}

std::uint64_t CellSizes::bytes() const {
  return corners * (3 * sizeof(double) + sizeof(std::int32_t)) + cells +
         (cells + 1 + topology) * sizeof(std::int32_t);
}

void write_cells(Hdf5File* file, const PointCells& cells, const CellSizes& sizes,
                 const RowGathering& gathering) {
  const std::string group = "/points/cells";
  if (file) file->make_group(group);
  const bool are_boxes = !cells.box.empty();
  const bool are_equal = are_boxes || sizes.corners == sizes.cells * sizes.most;
  const std::vector<double> padded =
      are_equal ? std::vector<double>() : in_equal_rows(cells, sizes.most);
  write_from_rows<double>(
      file, group + "/corners", {sizes.corners, 3},
      {"m", "reference positions of the corners of each point's cell, one point after another"},
      gathering, are_equal ? cells.corners : padded, are_boxes ? 3 : 3 * sizes.most,
      [&](const std::vector<double>& rows) {
        if (are_boxes) return boxes_about(rows, cells.box);
        std::vector<double> corners;
        corners.reserve(rows.size());
        std::ranges::copy_if(rows, std::back_inserter(corners),
                             [](double value) { return !std::isnan(value); });
        return corners;
      });
  write_from_rows<std::uint8_t>(
      file, group + "/types", {sizes.cells}, {"1", "kind of each point's cell, its number in VTK"},
      gathering, cells.kind, 1, [](const std::vector<std::uint8_t>& rows) { return rows; });
  std::int32_t corner = -1;  // nothing yet
  write_from_rows<std::int32_t>(file, group + "/offsets", {sizes.cells + 1},
                                {"1", "first corner of each point's cell, and the end"}, gathering,
                                cells.count, 1, [&](const std::vector<std::int32_t>& rows) {
                                  std::vector<std::int32_t> offsets;
                                  if (corner < 0) offsets.push_back(corner = 0);
                                  for (const std::int32_t count : rows) {
                                    offsets.push_back(corner += count);
                                  }
                                  return offsets;
                                });
  corner = 0;
  write_from_rows<std::int32_t>(file, group + "/connectivity", {sizes.corners},
                                {"1", "numbers of the corners of each point's cell: 0, 1, 2, …"},
                                gathering, cells.count, 1,
                                [&](const std::vector<std::int32_t>& rows) {
                                  std::vector<std::int32_t> corners;
                                  for (const std::int32_t count : rows) {
                                    for (int k = 0; k < count; ++k) corners.push_back(corner++);
                                  }
                                  return corners;
                                });
  if (sizes.kind != 0) return;
  std::vector<std::int32_t> kinds;
  for (std::size_t k = 0; k < cells.kind.size(); ++k) {
    kinds.insert(kinds.end(), {xdmf_kind(cells.kind[k]), cells.count[k]});
  }
  corner = 0;
  write_from_rows<std::int32_t>(
      file, group + "/topology", {sizes.topology},
      {"1",
       "each point's cell for results.xdmf: its kind in XDMF, for polygons, lines and points "
       "the number of its corners, and their numbers"},
      gathering, kinds, 2, [&](const std::vector<std::int32_t>& rows) {
        std::vector<std::int32_t> cells_of_rows;
        for (std::size_t k = 0; k < rows.size(); k += 2) {
          cells_of_rows.push_back(rows[k]);
          if (tells_count(rows[k])) cells_of_rows.push_back(rows[k + 1]);
          for (int n = 0; n < rows[k + 1]; ++n) cells_of_rows.push_back(corner++);
        }
        return cells_of_rows;
      });
}

}  // namespace peristat
