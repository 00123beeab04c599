#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/drivers/path_state.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// What the values of an array are of: of a part of a body it has those of its own.
enum class Rows {
  whole,           ///< of nothing that a body has parts of
  points,          ///< one per point
  dofs,            ///< one per degree of freedom
  recorded_dofs,   ///< likewise of points that stand for themselves and are owned
  free_dofs,       ///< one per degree of freedom that is solved for
  bonds,           ///< one per bond
  histories,       ///< one per bond or, where points fail, per point
  list_of_points,  ///< numbers of points, ascending
};

/// Where the values of a path's state are written to, or read from, by their names.
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

  /// Told before what Rows::free_dofs depend on: the state's pins.
  virtual void number_free_dofs(const FragmentPins&) {}
};

/// Writes a path's state to an archive, or reads it from one, whole: a member that is added to it
/// and not here does not compile. Names: "accepted/displacement", "ledger/stored", ….
void transfer(StateArchive& archive, PathState& state);

}  // namespace peristat
