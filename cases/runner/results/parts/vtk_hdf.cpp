#include "cases/runner/results/parts/vtk_hdf.hpp"

#include <algorithm>
#include <cstdint>

#include "solvers/observe/point_fields.hpp"

namespace peristat {
namespace {

constexpr const char* results_file = "results.h5";
constexpr const char* vtk_root = "/VTKHDF";

/// Steps in the order of their rows: the last one first.
std::size_t place_of_step(std::size_t step, std::size_t steps) {
  return step + 1 < steps ? step + 1 : 0;
}

std::string array_name(const std::string& name) {
  std::string array = name;
  std::replace(array.begin(), array.end(), '/', '|');
  return array;
}

Hdf5File::Shape shape_in_file(const PointField& field, std::uint64_t points, int dimension) {
  Hdf5File::Shape shape{points};
  for (const std::uint64_t extent : field.extents(dimension)) shape.push_back(extent);
  return shape;
}

/// Shape of a field of all steps, vectors with three components and tensors with nine.
Hdf5File::Shape shown_shape(const Hdf5File::Shape& shape, std::uint64_t rows) {
  if (shape.size() == 1) return {rows};
  return {rows, std::uint64_t(shape.size() == 3 ? 9 : 3)};
}

void write_counts(Hdf5File& file, const CellSizes& cells) {
  const std::string group = std::string(vtk_root) + "/";
  const auto write = [&](const char* name, std::uint64_t count) {
    file.write(group + name, std::vector<std::int64_t>{std::int64_t(count)}, {1}, {"1", name});
  };
  write("NumberOfCells", cells.cells);
  write("NumberOfPoints", cells.corners);
  write("NumberOfConnectivityIds", cells.corners);
}

/// The group Steps: all steps have the same cells.
void write_steps(Hdf5File& file, const std::vector<WrittenStep>& steps) {
  const std::string group = std::string(vtk_root) + "/Steps";
  file.make_group(group);
  file.set_attribute(group, "NSteps", std::int64_t(steps.size()));
  std::vector<double> numbers;
  for (const WrittenStep& step : steps) numbers.push_back(step.step);
  file.write(group + "/Values", numbers, {steps.size()}, {"1", "numbers of the steps"});
  const std::vector<std::int64_t> zeros(steps.size(), 0), ones(steps.size(), 1);
  for (const char* name :
       {"/PartOffsets", "/PointOffsets", "/CellOffsets", "/ConnectivityIdOffsets"}) {
    file.write(group + name, zeros, {steps.size()}, {"1", "all steps have the same cells"});
  }
  file.write(group + "/NumberOfParts", ones, {steps.size()}, {"1", "the body is one part"});
  file.make_group(group + "/CellDataOffsets");
}

/// Writes the first row of an array in each step.
void write_offsets(Hdf5File& file, const std::string& array,
                   const std::vector<std::int64_t>& offsets) {
  file.write(std::string(vtk_root) + "/Steps/CellDataOffsets/" + array, offsets, {offsets.size()},
             {"1", "first row of each step"});
}

/// Name of a kind of cells in XDMF.
std::string topology_of(std::uint8_t kind) {
  if (kind == vertex_cell) return "Polyvertex";
  switch (MeshElements::Kind(kind)) {
    case MeshElements::Kind::line:
      return "Polyline";
    case MeshElements::Kind::triangle:
      return "Triangle";
    case MeshElements::Kind::quadrilateral:
      return "Quadrilateral";
    case MeshElements::Kind::tetrahedron:
      return "Tetrahedron";
    case MeshElements::Kind::hexahedron:
      return "Hexahedron";
    case MeshElements::Kind::wedge:
      return "Wedge";
    case MeshElements::Kind::pyramid:
      return "Pyramid";
  }
  return "Mixed";
}

}  // namespace

void write_vtk_hdf(Hdf5File& file, const std::vector<WrittenStep>& steps, StepShape shape,
                   const CellSizes& cells, const std::vector<XdmfSeries::Field>& constant) {
  file.make_group(vtk_root);
  file.set_attribute(vtk_root, "Version", std::vector<std::int64_t>{2, 0});
  file.set_fixed_attribute(vtk_root, "Type", "UnstructuredGrid");
  write_counts(file, cells);
  const std::string group = std::string(vtk_root) + "/";
  file.link(group + "Points", results_file, "/points/cells/corners");
  file.link(group + "Connectivity", results_file, "/points/cells/connectivity");
  file.link(group + "Offsets", results_file, "/points/cells/offsets");
  file.link(group + "Types", results_file, "/points/cells/types");
  write_steps(file, steps);

  const std::string data = group + "CellData/";
  file.make_group(group + "CellData");
  const auto points = std::uint64_t(shape.points);
  const std::vector<std::int64_t> zeros(steps.size(), 0);
  for (const XdmfSeries::Field& field : constant) {
    const std::string array = array_name(field.name);
    const std::vector<Hdf5File::ViewedRows> rows{{{results_file, field.dataset}, {points}}};
    const DatasetLabel label{"see results.h5", field.name + " of all steps"};
    if (field.is_flag) {
      file.write_view<std::uint8_t>(data + array, {points}, rows, label);
    } else {
      file.write_view<double>(data + array, {points}, rows, label);
    }
    write_offsets(file, array, zeros);
  }
  std::vector<std::int64_t> offsets;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    offsets.push_back(std::int64_t(place_of_step(k, steps.size()) * points));
  }
  for (const std::string& name : steps.back().fields) {
    const PointField& field = *point_field(name);
    if (field.rank == FieldRank::symmetric) continue;  // shown by its tensor
    const Hdf5File::Shape of_step = shape_in_file(field, points, shape.dimension);
    std::vector<Hdf5File::ViewedRows> rows;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const std::string dataset = "/steps/" + steps[k].name() + "/" + name;
      rows.push_back({{results_file, dataset}, of_step, std::uint64_t(offsets[k])});
    }
    file.write_view<double>(data + name, shown_shape(of_step, points * steps.size()), rows,
                            {field.unit, field.meaning + ", the last step first"});
    write_offsets(file, name, offsets);
  }
}

XdmfSeries::Cells xdmf_cells(const CellSizes& cells) {
  const bool is_mixed = cells.kind == 0;
  return {is_mixed ? "Mixed" : topology_of(cells.kind),
          is_mixed ? "/points/cells/topology" : "/points/cells/connectivity", cells.corners,
          is_mixed ? cells.topology : cells.corners};
}

}  // namespace peristat
