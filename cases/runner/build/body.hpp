#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assembly/assembler.hpp"
#include "cases/runner/input/case.hpp"
#include "solvers/linear/free_dofs.hpp"
#include "solvers/linear/memory_estimate.hpp"
#include "src/conditions/conditions.hpp"
#include "src/connectivity/free_motion.hpp"

namespace peristat {

/// What storing all triangles and tetrahedra takes, and what may be taken [bytes]. They are stored
/// if it fits, and found anew in every pass otherwise.
struct InteractionStorage {
  double needed = 0.0, room = 0.0;
  [[nodiscard]] bool fits() const { return needed <= room; }
};

/// Everything that a case makes before anything is solved; constant from then on.
struct Body {
  Body() = default;
  Body(const Body&) = delete;  // its members refer to its points: it stays where it is made
  Body& operator=(const Body&) = delete;

  Points points;
  BondSetting setting;
  Model model;
  std::unique_ptr<Conditions> conditions;  // refers to points
  InteractionStorage interaction_storage;
  std::vector<double> cut_weight;   ///< per point, of the bonds that pre-cracks have cut [m6]
  std::vector<BondEnds> cut_bonds;  ///< by pre-cracks
  double seconds_neighbourhood = 0.0;

  [[nodiscard]] double horizon_ratio() const { return setting.horizon / points.spacing; }
};

/// Points and sets of a case.
/// @throws InputError (with place) if a set selects nothing, and as the makers of points do
/// @throws MemoryError if the points would not fit
[[nodiscard]] Points make_points_of(const Case& from);

/// The whole body.
/// @throws InputError (with place), MemoryError if the estimate exceeds the memory available
[[nodiscard]] std::unique_ptr<const Body> make_body(const Case& from, int threads);

/// The same points and conditions with elastic bonds of another horizon (solver.
/// elastic_horizon_ratio), or nothing if the case asks for none.
[[nodiscard]] std::optional<Model> make_elastic_stand_in(const Case& from, const Body& body,
                                                         int threads);

/// Body size for the memory estimate.
[[nodiscard]] BodySize size_of(const Points& points);

/// The estimate from the counts that the body has.
[[nodiscard]] MemoryEstimate estimate_memory(const Body& body);

/// Lines that tell the triangles and tetrahedra, and whether they are stored; empty for bonds
/// alone.
[[nodiscard]] std::vector<std::string> describe_interactions(const Body& body);

/// Sentence that tells which parts of the body may move freely; empty if none.
[[nodiscard]] std::string describe_free_motions(const Body& body);

/// Sentence that tells points that swing on too few bonds from the start; empty if none.
[[nodiscard]] std::string describe_loose_points(const Body& body);

/// @throws InputError if a part of the body may move freely, or points swing
void refuse_unheld_bodies(const Case& from, const Body& body);

}  // namespace peristat
