#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cases/runner/results/files/hdf5_file.hpp"
#include "cases/runner/results/files/xdmf_series.hpp"

namespace peristat {

/// Broken bonds as lines between points, for results.xdmf: /cracks/NNNNNN with `bonds` (count x 2)
/// and `step`, views of the first rows of /broken_bonds, which take no space. Bonds to images are
/// left out: their ends are no points. A body with images has a table of the others,
/// /cracks/within.
class CrackLines {
 public:
  /// @param file results.h5 with the table /broken_bonds; must outlive this object
  CrackLines(Hdf5File& file, bool has_images);

  /// Adds a row of /broken_bonds.
  void add(const Row& broken_bond);
  /// Writes what has been added.
  void append_pending();
  /// Makes the views of a step that all bonds added so far were broken in or before.
  [[nodiscard]] XdmfSeries::Lines lines_of(const std::string& step);

 private:
  Hdf5File& file_;
  bool has_images_;
  std::uint64_t count_ = 0;
  std::vector<Row> pending_;
};

}  // namespace peristat
