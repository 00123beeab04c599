#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "src/conditions/specification.hpp"
#include "src/core/communicator.hpp"
#include "src/core/expression.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// A face of the boundary over which the ball around a point reaches.
struct SurfaceSite {
  Index point = 0;
  std::optional<Side> side{};  ///< of the body's box, if it is one
  std::string name{};          ///< of the face's shape; empty: it has none
  Coordinates place{};         ///< on the face, nearest to the point [m]
  Coordinates normal{};        ///< of the face there, outward
  /// Part a_f of the point's traction T = sum_f a_f t_f that is the face's, with n = sum_f a_f e_f
  /// of the point's normal: 1 where the face is the only one.
  double share = 1.0;
  /// The same part a_f e_f of the point's normal; what the faces don't span is the nearest one's.
  Coordinates part_of_normal{};
};

/// Tractions on the surface at points, of models that take them as they are ([LPS] sec. 4.2). At a
/// point with one face a traction keeps its vector, and a stress gives sigma n with the normal of
/// the point, which is what makes a linear field exact on every grid.
class SurfaceTractions {
 public:
  SurfaceTractions() = default;
  explicit SurfaceTractions(std::vector<SurfaceSite> sites) : sites_(std::move(sites)) {}

  /// Takes up a traction, a pressure or a stress.
  /// @param table of the load, for errors
  /// @param prescribed per degree of freedom: forces on held points move nothing
  /// @param ranks that have parts of the body, in a call that all make; null: it is whole
  /// @throws InputError ("TABLE.side", "TABLE.boundary", …) for a part of the boundary that no
  /// point
  ///         is at, for expressions that can't be read, and for a traction on one of two faces that
  ///         are less than two horizons apart: a point between them knows but one traction
  void add(const Points& points, const LoadSpecification& load,
           const std::vector<std::string>& parameters, const std::string& table,
           const std::vector<char>& prescribed, const Communicator* ranks = nullptr);

  [[nodiscard]] bool none() const { return loads_.empty(); }
  [[nodiscard]] bool changes_with_parameters() const;

  /// Tractions at points under load parameters, points x dimension [Pa].
  /// @throws InputError if one is not finite
  [[nodiscard]] std::vector<double> at(const Points& points, std::span<const double> loads) const;

 private:
  struct Load {
    LoadSpecification::Kind kind;
    std::string key;  // of its value, for errors
    std::vector<std::size_t> sites;
    std::vector<Expression> value;  // components; pressure; or stress xx yy (zz) xy (yz xz)
  };
  void refuse_one_sided(const Points& points, const Load& load,
                        const std::vector<char>& prescribed) const;
  [[nodiscard]] Coordinates traction(const Load& load, const SurfaceSite& site, int dimension,
                                     std::span<const double> loads) const;

  std::vector<SurfaceSite> sites_;
  std::vector<Load> loads_;
};

}  // namespace peristat
