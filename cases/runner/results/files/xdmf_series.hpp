#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// Text of results.xdmf: per step with fields two grids that read their arrays from results.h5,
/// `body` with a cell per point, and once bonds have broken `broken_bonds` with a line per bond.
/// The time is the step number (load factors may repeat), the load factor a number of the body;
/// vectors have three components, which the glyphs and the warping of ParaView need, and tensors
/// nine.
class XdmfSeries {
 public:
  struct Field {
    std::string name;
    std::string dataset;  ///< path in results.h5; count, or count x 3 (vector) or 9 (tensor)
    bool is_vector = false;
    bool is_flag = false;  ///< of one byte, 0 or 1; else of doubles
    bool is_tensor = false;
  };
  /// Cells of the points with corners of their own.
  struct Cells {
    std::string topology;                    ///< "Quadrilateral", "Mixed", …
    std::string dataset;                     ///< path of the corners' numbers in results.h5
    std::uint64_t corners = 0, numbers = 0;  ///< number of corners, and of numbers in the dataset
  };
  /// Lines between points.
  struct Lines {
    std::string group{};  ///< in results.h5, with `bonds` (count x 2) and `step`
    std::uint64_t count = 0;
  };

  /// @param constant fields that all steps have, e.g. volumes
  XdmfSeries(Index points, Cells cells, std::vector<Field> constant)
      : points_(std::to_string(points)), cells_(std::move(cells)), constant_(std::move(constant)) {}

  void add(int step, double load_factor, const std::string& mode, const std::vector<Field>& fields,
           const Lines& broken_bonds);

  /// The whole file.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] std::string attribute(const Field& field, const std::string& centre) const;
  [[nodiscard]] std::string body() const;
  [[nodiscard]] std::string lines(const Lines& broken_bonds,
                                  const std::vector<Field>& fields) const;

  std::string points_;
  Cells cells_;
  std::vector<Field> constant_;
  std::string grids_;
};

}  // namespace peristat
