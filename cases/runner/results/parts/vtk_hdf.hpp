#pragma once

#include <string>
#include <vector>

#include "cases/runner/results/files/hdf5_file.hpp"
#include "cases/runner/results/files/xdmf_series.hpp"
#include "cases/runner/results/parts/point_cells.hpp"
#include "cases/runner/results/parts/step_part.hpp"

namespace peristat {

/// Writes the contents of results.vtkhdf: an UnstructuredGrid of VTKHDF 2.0 whose datasets are
/// links to results.h5 and views of it. Readers of version 1.0 know no steps and show the last one,
/// whose rows come first.
/// @param file   empty, to be placed beside results.h5
/// @param steps  at least one; all have the fields of the last
/// @param constant fields that all steps have
void write_vtk_hdf(Hdf5File& file, const std::vector<WrittenStep>& steps, StepShape shape,
                   const CellSizes& cells, const std::vector<XdmfSeries::Field>& constant);

/// Description of the cells for results.xdmf.
[[nodiscard]] XdmfSeries::Cells xdmf_cells(const CellSizes& cells);

}  // namespace peristat
