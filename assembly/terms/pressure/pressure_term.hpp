#pragma once

#include <memory>
#include <span>
#include <vector>

#include "assembly/terms/term.hpp"
#include "src/conditions/pressed_boundary.hpp"
#include "src/constraints/constraints.hpp"

namespace peristat {

/// Pressures that follow the deformation, on faces of cells: the forces on the body are
///
///   -p A n / corners   at each corner of an edge or triangle with the area vector A n,
///
/// spread over the points around the corner by the weights that the corner moves with, which are
/// exact for linear displacement fields, such as a rotation. A quadrangle is the mean of its two
/// divisions into triangles; one whose last corners coincide is a triangle. On a closed boundary a
/// constant p has the potential p V, V the volume within, and forces and moments add up to zero. On
/// other boundaries forces have no potential. The energy of the term is zero, its gradient minus
/// the forces, and the tangent the symmetric part of their derivative.
///
/// The pressure of each face comes from the environment.
class PressureTerm : public Term {
 public:
  /// @throws InputError ("loads") where the body is but one point thick
  PressureTerm(const Points& points, PressedBoundary boundary);

  [[nodiscard]] Couplings couplings() const override { return {offset_, partner_}; }
  [[nodiscard]] Balances balances() const override { return {}; }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

  [[nodiscard]] const PressedBoundary& boundary() const { return boundary_; }
  /// Area of the faces in the reference [m2].
  [[nodiscard]] double area() const;

  /// Frobenius norms of the load stiffness on the degrees of freedom that have an equation [N/m]:
  /// of the symmetric part, and of the rest, which the tangent leaves out.
  struct Stiffness {
    double symmetric = 0.0, left_out = 0.0;
  };
  /// @param prescribed true for each degree of freedom without an equation
  [[nodiscard]] Stiffness stiffness(const StateView& at, const Constraints& constraints,
                                    const std::vector<char>& prescribed) const;

  /// An edge or a triangle of a face; 1D: its only corner.
  struct Element {
    std::array<Index, 3> corner{};
    Index face = 0;
    double share = 1.0;  ///< weight: 1/2 for the triangles of a quadrangle's two divisions
  };
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  [[nodiscard]] const Points& points() const { return points_; }
  /// Weights of a corner's points, in the order of the boundary; they add up to 1.
  [[nodiscard]] const std::vector<double>& weights(Index corner) const {
    return weights_[std::size_t(corner)];
  }

 private:
  const Points& points_;
  PressedBoundary boundary_;
  std::vector<std::vector<double>> weights_;
  std::vector<Element> elements_;
  std::vector<Offset> offset_;
  Partners partner_;
};

}  // namespace peristat
