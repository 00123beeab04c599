#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/found_step.hpp"
#include "solvers/drivers/implicit_stepping.hpp"
#include "solvers/drivers/increment.hpp"

namespace peristat {

/// Steps along the path of equilibria itself, through limit points of the load and of the
/// displacement, with integrities as they are. The stage is an unknown: supports and loads follow
/// the programme's one line, also beyond its ends. The path ends where the stage first comes to the
/// programme's end.
///
/// The arc length s has
///
///   ds^2 = (|du|^2 / |u'|^2 + dl^2) / 2
///
/// with the stage l and u' = du/dl at rest, so that at first ds = dl. A step goes ds along the
/// tangent of the path; the equilibrium is searched in the plane normal to it there (Riks, Int. J.
/// Solids Struct. 15, 1979; Ramm, 1981). One that ends far from the tangent, or where the path has
/// turned by much, is cut: it might have come to another path.
///
/// Each state's pivots are counted. Where their signs change within a step, the critical point is
/// located by bisection: a limit point if the stage turns there, a bifurcation otherwise. From a
/// bifurcation of a stable path the next step goes along the eigenvector of the vanishing pivot, to
/// the path that branches off; which of its two sides is taken is given by the numbering of points
/// alone.
class ArcLengthStepping : public Driver {
 public:
  explicit ArcLengthStepping(Path& path);

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// A step on its way.
  struct Step {
    double attempted = 0.0;  ///< of the arc length
    Attempt attempt;
    FoundStep found;
    std::string fault;
    std::vector<double> direction;
    double stage_direction = 0.0;
    std::int64_t negative_pivots = 0;
  };

  [[nodiscard]] std::optional<Advance> end() const;
  /// A step of what acts at load 0, by steps of it.
  [[nodiscard]] Advance put_on_preload();
  [[nodiscard]] Advance begin();
  /// Equilibrium at a length along the path, and the path's direction there.
  [[nodiscard]] Step search(double length);
  /// In the plane normal to the path's direction.
  [[nodiscard]] Attempt search_across(double length);
  /// At the end of the load, on the way to an equilibrium near it or beyond.
  [[nodiscard]] Attempt search_end(const Attempt& near);
  /// Why what was found is not the next state of the path; sets the outcome.
  void judge(Step& step) const;
  void find_direction(Step& step);
  /// Between the accepted state and one whose pivots have other signs.
  [[nodiscard]] Advance locate(Step beyond);
  /// @param modes that vanish together
  [[nodiscard]] Advance branch_off(std::int64_t modes);
  [[nodiscard]] Advance accept(Step step, const std::string& reason);
  [[nodiscard]] Advance fail(Step step);

  /// Scalar product of two directions whose square is that of the arc length.
  [[nodiscard]] double product(std::span<const double> du, double dl, std::span<const double> dv,
                               double dm) const;

  ImplicitStepping implicit_;
  Increment increment_;
};

}  // namespace peristat
