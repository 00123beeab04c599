#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/drivers/path_state.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Meaning of an array's entries. A part of a partitioned body has its own entries.
enum class Rows {
  whole,           ///< not distributed over the parts of a body
  points,          ///< one per point
  dofs,            ///< one per degree of freedom
  recorded_dofs,   ///< likewise, of owned points without images
  free_dofs,       ///< one per degree of freedom that is solved for
  bonds,           ///< one per bond
  histories,       ///< one per bond or, where points fail, per point
  list_of_points,  ///< numbers of points, ascending
};

/// Archive that the values of a path's state are written to, or read from, by their names.
class StateArchive {
 public:
  virtual ~StateArchive() = default;

  virtual void transfer(const std::string& name, bool& value) = 0;
  virtual void transfer(const std::string& name, int& value) = 0;
  virtual void transfer(const std::string& name, std::int64_t& value) = 0;
  virtual void transfer(const std::string& name, double& value) = 0;
  virtual void transfer(const std::string& name, std::vector<char>& values, Rows rows) = 0;
  virtual void transfer(const std::string& name, std::vector<Index>& values, Rows rows) = 0;
  virtual void transfer(const std::string& name, std::vector<double>& values, Rows rows) = 0;

  /// Called before arrays of Rows::free_dofs, which depend on the state's pins.
  virtual void number_free_dofs(const FragmentPins&) {}
};

/// Writes a path's state to an archive, or reads it from one, completely: a member that is added to
/// it and not here does not compile. Names: "accepted/displacement", "ledger/stored", ….
void transfer(StateArchive& archive, PathState& state);

}  // namespace peristat
