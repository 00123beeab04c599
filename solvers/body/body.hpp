#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "assembly/terms/model.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/formulations/specification/body_specification.hpp"
#include "solvers/linear/memory_estimate.hpp"
#include "solvers/ranks/make_index_map.hpp"
#include "src/conditions/conditions.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Memory that storing all triangles and tetrahedra needs, and memory that it may take [bytes].
/// They are stored if they fit, and computed anew in every pass otherwise.
struct InteractionStorage {
  double needed = 0.0, room = 0.0;
  [[nodiscard]] bool fits() const { return needed <= room; }
};

/// Points, model and conditions: everything that is made before anything is solved, and constant
/// from then on.
struct Body {
  Body() = default;
  Body(const Body&) = delete;  // its members refer to its points, so it can't be moved
  Body& operator=(const Body&) = delete;

  BodySpecification specification;
  Points points;
  BondSetting setting;
  Model model;
  std::unique_ptr<Conditions> conditions;  // refers to points
  InteractionStorage interaction_storage;
  std::vector<std::int32_t> region;  ///< per point, from 0; -1: in no region; empty without regions
  PointFactors factors;              ///< of random fields
  std::vector<double> cut_weight;    ///< per point, sum over the bonds that pre-cracks have cut
                                     ///< [m6]
  std::vector<BondEnds> cut_bonds;   ///< by pre-cracks
  std::vector<std::string> remarks;  ///< of its formulation, for `check`
  double seconds_neighbourhood = 0.0;
  std::unique_ptr<const IndexMap> index_map;

  /// Horizon over spacing; with horizons of points the mean of their ratios to the points' sizes.
  [[nodiscard]] double horizon_ratio() const;
};

/// Makes a body of points, which get horizons of their own by horizon_per_size. It may still move
/// freely: that is refused where it is solved.
/// @param points with the sets that supports and loads name
/// @param threads 0: as many as OpenMP takes by itself
/// @throws InputError with the member that is wrong ("horizon", "material.youngs_modulus",
///         "supports[0].set", "points.volume", …)
/// @throws MemoryError if the estimate exceeds the memory available
[[nodiscard]] std::unique_ptr<const Body> make_body(Points points, const BodySpecification& of,
                                                    int threads = 0);

/// Gives points the horizons of a specification with horizon_per_size, and the specification the
/// largest of all ranks. Collective.
void take_horizons(Points& points, BodySpecification& of, const Communicator& ranks);

/// Returns the setting of a body's bonds, as far as it does not depend on the points of this rank.
[[nodiscard]] BondSetting bond_setting(const BodySpecification& of, const Points& points);

/// Returns the kinds of images that points of a body have beyond its planes of symmetry and
/// periods. Collective.
/// @param points of the body, or of this rank without ghosts
/// @throws InputError as image_kinds does
[[nodiscard]] std::vector<ImageKind> kinds_of_images(const BodySpecification& of,
                                                     const Points& points,
                                                     const Communicator& ranks);

/// Makes this rank's part of a partitioned body. Collective.
/// @param part with ghosts as far as reach_of_bonds, of kinds_of_images too, and with all sets that
///        are named
/// @throws InputError, MemoryError as the other make_body does, perhaps on one rank alone; also for
///         features that are for one rank only
[[nodiscard]] std::unique_ptr<const Body> make_body(Part part, const BodySpecification& of,
                                                    const Communicator& ranks, int threads);

/// Makes elastic bonds between the points of a body of model "bond" with another horizon.
/// @throws InputError as make_body does
[[nodiscard]] Model make_elastic_bonds(const Body& body, Bonds bonds, const BondSetting& setting);

/// Adds the pressures, foundations and obstacles of the body's conditions, its contacts and its
/// inertia to a model of its points. The body's own model has them already.
void add_terms_of_conditions(Model& model, const Body& body);

/// Number of threads to run on.
/// @param asked_for 0: as many as OpenMP takes by itself
/// @throws InputError ("threads") for a number below 0
/// @throws ThreadError if the system does not run so many
[[nodiscard]] int usable_threads(int asked_for);

}  // namespace peristat
