#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/drivers/path_state.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Where the values of a path's state are written to, or read from, by their names.
class StateArchive {
 public:
  virtual ~StateArchive() = default;

  virtual void transfer(const std::string& name, bool& value) = 0;
  virtual void transfer(const std::string& name, int& value) = 0;
  virtual void transfer(const std::string& name, std::int64_t& value) = 0;
  virtual void transfer(const std::string& name, double& value) = 0;
  virtual void transfer(const std::string& name, std::vector<char>& values) = 0;
  virtual void transfer(const std::string& name, std::vector<Index>& values) = 0;
  virtual void transfer(const std::string& name, std::vector<double>& values) = 0;
};

/// Writes a path's state to an archive, or reads it from one, whole: a member that is added to it
/// and not here does not compile. Names: "accepted/displacement", "ledger/stored", ….
void transfer(StateArchive& archive, PathState& state);

}  // namespace peristat
