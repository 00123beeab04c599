#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "solvers/body/body.hpp"
#include "solvers/observe/probe.hpp"
#include "solvers/observe/recorded_points.hpp"

namespace peristat {

/// A component in which a case moves or loads a set, a side or the points of a constraint.
struct Driven {
  std::string name;  ///< as in the columns of reactions; of a side "y+"
  int component = 0;
  /// First load that acts; null: the displacement is prescribed, and its force is the reaction.
  const LoadSpecification* load = nullptr;
  std::vector<const LoadSpecification*> forces{};  ///< all loads here that are forces on points
  std::string
      set{};  ///< whose mean displacement is recorded; empty: of the load's side, or `value`
  std::string value{};  ///< expression of a displacement without a set [m]
  double factor = 1.0;  ///< of `value`
  Coordinates place{};  ///< at which `value` is evaluated [m]
};

/// Returns what a case drives, each name and component once: supports, rigid sets, rollers,
/// linear constraints and obstacles whose displacement is not the number 0, then loads on sets and
/// sides in the components that are not the number 0. Pressures count with a side. The case must
/// outlive them.
[[nodiscard]] std::vector<Driven> driven_by(const Case& from);

/// Columns of the history for these: displacement_y:SET [m], the mean over the set, and for loads
/// also force_y:SET [N], the sum of all loads of fixed direction at the points that they act on.
[[nodiscard]] std::vector<ProbeColumns> columns_of(const std::vector<Driven>& driven);

/// Values of these columns in accepted states.
class DrivenSets {
 public:
  /// The case and the body must outlive this object. Collective.
  DrivenSets(const Case& from, const Body& body);

  /// Adds them to `values`. Collective.
  /// @param displacement, external_force per degree of freedom [m], [N]
  void add_values(std::span<const double> displacement, std::span<const double> external_force,
                  const LoadValues& loads,
                  std::map<std::string, std::vector<double>>& values) const;

 private:
  struct Measured {
    Driven driven;
    std::vector<Index> points;  ///< recorded here, of which the mean is taken
    double count = 0.0;         ///< of them, on all ranks
    std::vector<Index> loaded;  ///< points that its forces act on, of this rank
  };

  const Points& points_;
  const Communicator& ranks_;
  std::vector<Measured> measured_;
};

}  // namespace peristat
