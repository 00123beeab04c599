#include "cases/runner/results/parts/point_cells.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "cases/runner/results/parts/vtk_hdf.hpp"
#include "cases/runner/results/tables/load_displacement.hpp"

namespace peristat {
namespace {

using Corners = std::vector<Coordinates>;

Corners corners_of(PointCells cells, std::size_t point) {
  if (!cells.box.empty()) cells.corners = boxes_about(cells.corners, cells.box);
  std::size_t first = 0;
  for (std::size_t k = 0; k < point; ++k) first += std::size_t(cells.count[k]);
  Corners corners;
  for (std::size_t k = first; k < first + std::size_t(cells.count[point]); ++k) {
    corners.push_back({cells.corners[3 * k], cells.corners[3 * k + 1], cells.corners[3 * k + 2]});
  }
  return corners;
}

double area(const Corners& corners) {
  double twice = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Coordinates &a = corners[k], &b = corners[(k + 1) % corners.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

Points lattice(int dimension, const Spacing& spacing) {
  Points points;
  points.dimension = dimension;
  points.spacing = spacing;
  points.lattice = LatticeCells{};
  points.volume = {1.0, 1.0};
  points.reference.assign(2 * std::size_t(dimension), 0.0);
  points.reference[std::size_t(dimension)] = spacing.along(0);
  return points;
}

TEST(PointCells, OfALatticeAreItsBoxes) {
  const PointCells line = cells_of(lattice(1, 0.5));
  EXPECT_EQ(line.kind, (std::vector<std::uint8_t>{3, 3}));
  EXPECT_EQ(corners_of(line, 1), (Corners{{0.25, 0.0, 0.0}, {0.75, 0.0, 0.0}}));

  const PointCells squares = cells_of(lattice(2, {{0.5, 0.25, 0.0}, 2}));
  EXPECT_EQ(squares.kind, (std::vector<std::uint8_t>{9, 9}));
  EXPECT_EQ(
      corners_of(squares, 0),
      (Corners{
          {-0.25, -0.125, 0.0}, {0.25, -0.125, 0.0}, {0.25, 0.125, 0.0}, {-0.25, 0.125, 0.0}}));

  const PointCells cubes = cells_of(lattice(3, {{2.0, 4.0, 6.0}, 3}));
  EXPECT_EQ(cubes.kind, (std::vector<std::uint8_t>{12, 12}));
  const Corners corners = corners_of(cubes, 1);
  ASSERT_EQ(corners.size(), 8u);
  EXPECT_EQ(corners[0], (Coordinates{1.0, -2.0, -3.0}));
  EXPECT_EQ(corners[6], (Coordinates{3.0, 2.0, 3.0}));  // opposite in VTK's order
}

TEST(PointCells, OfATurnedLatticeAreTurned) {
  Points points = lattice(2, {{0.5, 0.25, 0.0}, 2});
  points.angle = 90.0;
  const Corners corners = corners_of(cells_of(points), 0);
  const Corners expected{
      {0.125, -0.25, 0.0}, {0.125, 0.25, 0.0}, {-0.125, 0.25, 0.0}, {-0.125, -0.25, 0.0}};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(corners[k][c], expected[k][c], 1e-16);
  }
  EXPECT_NEAR(area(corners), 0.125, 1e-16);
}

TEST(PointCells, OfPolygonsAndElementsAreThese) {
  Points points = lattice(2, 1.0);
  points.polygons.append({{-0.5, -0.5}, {0.5, -0.5}, {0.0, 0.5}});
  points.polygons.append({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {0.0, 0.75}, {-0.5, 0.5}});
  const PointCells polygons = cells_of(points);
  EXPECT_EQ(polygons.kind, (std::vector<std::uint8_t>{7, 7}));
  EXPECT_EQ(polygons.count, (std::vector<std::int32_t>{3, 5}));
  EXPECT_EQ(corners_of(polygons, 1)[3], (Coordinates{1.0, 0.75, 0.0}));
  EXPECT_DOUBLE_EQ(area(corners_of(polygons, 1)), 1.125);

  points.elements.nodes = {0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 2.0, 0.0};
  points.elements.kind = {MeshElements::Kind::quadrilateral, MeshElements::Kind::triangle};
  points.elements.offset = {0, 4, 7};
  points.elements.corners = {0, 1, 2, 3, 1, 4, 2};
  const PointCells elements = cells_of(points);
  EXPECT_EQ(elements.kind, (std::vector<std::uint8_t>{9, 5}));
  EXPECT_EQ(corners_of(elements, 1), (Corners{{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {1.0, 1.0, 0.0}}));
}

TEST(PointCells, OfACloudAreItsPoints) {
  Points points = lattice(2, 1.0);
  points.lattice.reset();
  const PointCells cells = cells_of(points);
  EXPECT_EQ(cells.kind, (std::vector<std::uint8_t>{1, 1}));
  EXPECT_EQ(cells.corners, (std::vector<double>{0.0, 0.0, 0.0, 1.0, 0.0, 0.0}));
}

TEST(PointCells, OfSeveralKindsHaveAMixedTopology) {
  PointCells cells;
  cells.kind = {9, 5, 7, 1};
  cells.count = {4, 3, 5, 1};
  for (int k = 0; k < 39; ++k) cells.corners.push_back(k);
  const CellSizes sizes = sizes_of(cells, no_gathering());
  EXPECT_EQ(sizes.cells, 4u);
  EXPECT_EQ(sizes.corners, 13u);
  EXPECT_EQ(sizes.kind, 0);
  auto file = Hdf5File::in_memory("mixed", 1 << 16);
  file.make_group("/points");
  write_cells(&file, cells, sizes, no_gathering());
  EXPECT_EQ(
      file.integers("/points/cells/topology"),
      (std::vector<std::int64_t>{5, 0, 1, 2, 3, 4, 4, 5, 6, 3, 5, 7, 8, 9, 10, 11, 1, 1, 12}));
  EXPECT_EQ(xdmf_cells(sizes).numbers, file.count_of_rows("/points/cells/topology"));
  EXPECT_EQ(xdmf_cells(sizes).topology, "Mixed");
  EXPECT_EQ(file.integers("/points/cells/offsets"), (std::vector<std::int64_t>{0, 4, 7, 12, 13}));
  EXPECT_EQ(file.numbers("/points/cells/corners"), cells.corners);

  cells.kind = {9, 9};
  cells.count = {4, 4};
  cells.corners.resize(24);
  EXPECT_EQ(xdmf_cells(sizes_of(cells, no_gathering())).topology, "Quadrilateral");
}

TEST(LoadDisplacement, HasTheForceBesideTheDisplacementOfWhatIsDriven) {
  using enum Column::Kind;
  const std::vector<Column> history{{integer, "step", "1", ""},
                                    {number, "load_factor", "1", ""},
                                    {number, "reaction_y:top", "N", ""},
                                    {number, "displacement_y:top", "m", ""},
                                    {number, "displacement_x:x+", "m", ""},
                                    {number, "force_x:x+", "N", ""},
                                    {number, "displacement_x:pressed", "m", ""},
                                    {number, "displacement_x", "m", ""},
                                    {number, "control", "m", ""}};
  const auto names = [](const LoadDisplacement& table) {
    std::vector<std::string> all;
    for (const Column& column : table.columns()) all.push_back(column.name);
    return all;
  };
  const LoadDisplacement table(history, true);
  EXPECT_EQ(names(table), (std::vector<std::string>{
                              "step", "load_factor", "control", "displacement_y:top", "force_y:top",
                              "displacement_x:x+", "force_x:x+", "displacement_x:pressed"}));
  EXPECT_EQ(table.columns()[4].unit, "N");
  const Row row{std::int64_t{3}, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0};
  EXPECT_EQ(table.row(row), (Row{std::int64_t{3}, 0.5, 64.0, 2.0, 1.0, 4.0, 8.0, 16.0}));
  EXPECT_EQ(names(LoadDisplacement(history, false)).at(2), "displacement_y:top");
}

}  // namespace
}  // namespace peristat
