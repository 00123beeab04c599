#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "src/conditions/specification.hpp"
#include "src/core/expression.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// A face of the boundary that the ball around a point crosses.
struct SurfaceSite {
  Index point = 0;
  std::optional<Side> side{};  ///< of the body's box, if the face is one
  std::string name{};          ///< of the face's shape; empty: it has no name
  Coordinates place{};         ///< on the face, nearest to the point [m]
  Coordinates normal{};        ///< of the face there, outward
  /// Fraction a_f of the face in the point's traction T = sum_f a_f t_f, where n = sum_f a_f e_f is
  /// the point's normal: 1 if there is no other face.
  double share = 1.0;
  /// Part a_f e_f of the point's normal; the nearest face also gets the part that the faces don't
  /// span.
  Coordinates part_of_normal{};
};

/// Tractions on the surface at points, for models that apply them directly ([LPS] sec. 4.2). At a
/// point with one face a traction keeps its vector, and a stress gives sigma n with the normal of
/// the point, which makes a linear field exact on every grid.
class SurfaceTractions {
 public:
  SurfaceTractions() = default;
  explicit SurfaceTractions(std::vector<SurfaceSite> sites) : sites_(std::move(sites)) {}

  /// Adds a traction, a pressure or a stress.
  /// @param table of the load, for errors
  /// @param prescribed per degree of freedom; faces at fully prescribed points are not checked
  /// @param ranks that have parts of the body ; collective
  /// @throws InputError ("TABLE.side", "TABLE.boundary", …) for a part of the boundary without
  ///         points, for expressions that can't be read, and for a traction on one of two faces
  ///         that are less than two horizons apart: a point between them has only one traction
  void add(const Points& points, const LoadSpecification& load,
           const std::vector<std::string>& parameters, const std::string& table,
           const std::vector<char>& prescribed, const Communicator& ranks = sole_rank());

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
  /// @param values of the load's expressions at the site
  [[nodiscard]] Coordinates traction(const Load& load, const SurfaceSite& site, int dimension,
                                     std::span<const double> values) const;

  std::vector<SurfaceSite> sites_;
  std::vector<Load> loads_;
};

}  // namespace peristat
