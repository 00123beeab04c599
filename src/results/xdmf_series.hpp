#pragma once

#include <string>
#include <vector>

#include "src/types.hpp"

namespace peristat {

/// Text of results.xdmf: one grid of points per step with fields, that reads its arrays from
/// results.h5. Its time is the step number (load factors may repeat); vectors have three
/// components, which the glyphs and the warping of ParaView need.
class XdmfSeries {
 public:
  struct Field {
    std::string name;
    std::string dataset;  ///< path in results.h5; count, or count x 3 for a vector
    bool is_vector = false;
  };

  explicit XdmfSeries(Index points) : points_(std::to_string(points)) {}

  void add(int step, double load_factor, const std::string& mode, const std::vector<Field>& fields);

  /// The whole file.
  [[nodiscard]] std::string text() const;

 private:
  std::string points_;
  std::string grids_;
};

}  // namespace peristat
