#pragma once

#include <vector>

#include "assembly/terms/simplices/local_workspace.hpp"
#include "assembly/terms/simplices/simplex_term.hpp"
#include "assembly/terms/workspace.hpp"

namespace peristat {

/// Buffers of the passes over triangles and tetrahedra of one dimension.
template <int D>
struct SimplexWorkspace {
  SimplexWorkspace(const SimplexTerm& of, const TermSetting& setting)
      : term(of),
        pattern(setting.pattern),
        places(setting.pattern.places_of(of.couplings())),
        threads(setting.workspace) {
    for (const RowRange& range : threads.ranges) {
      const Offset beyond = pattern.offset[range.touched_end] - pattern.offset[range.last];
      blocks.emplace_back(std::size_t(beyond) * D * D);
      local.push_back(std::make_unique<LocalWorkspace<D>>(setting.points, of.bonds()));
    }
  }

  const SimplexTerm& term;
  const BlockPattern& pattern;
  std::vector<Offset> places;  ///< positions of bonds' blocks in the pattern; empty: its order
  Workspace& threads;
  std::vector<std::unique_ptr<LocalWorkspace<D>>> local;  ///< per part
  std::vector<std::vector<double>>
      blocks;  ///< per part, off-diagonal blocks of rows last..touched_end
  std::vector<std::vector<double>>
      releases_beyond;  ///< per part, of the bonds of these rows; empty without need

  /// Position of a bond's block in the pattern.
  [[nodiscard]] Offset place(Offset bond) const {
    return places.empty() ? bond : places[std::size_t(bond)];
  }
};

}  // namespace peristat
