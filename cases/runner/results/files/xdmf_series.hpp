#pragma once

#include <string>
#include <utility>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Text of results.xdmf: one grid of points per step with fields, that reads its arrays from
/// results.h5. Its time is the step number (load factors may repeat), the load factor a number of
/// the grid; vectors have three components, which the glyphs and the warping of ParaView need, and
/// tensors nine.
class XdmfSeries {
 public:
  struct Field {
    std::string name;
    std::string dataset;  ///< path in results.h5; count, or count x 3 (vector) or 9 (tensor)
    bool is_vector = false;
    bool is_flag = false;  ///< of one byte, 0 or 1; else of doubles
    bool is_tensor = false;
  };

  /// @param constant fields that all steps have, e.g. volumes
  XdmfSeries(Index points, std::vector<Field> constant)
      : points_(std::to_string(points)), constant_(std::move(constant)) {}

  void add(int step, double load_factor, const std::string& mode, const std::vector<Field>& fields);

  /// The whole file.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] std::string attribute(const Field& field) const;

  std::string points_;
  std::vector<Field> constant_;
  std::string grids_;
};

}  // namespace peristat
