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

/// Steps along the equilibrium path itself, through limit points of the load and of the
/// displacement, with fixed integrities. The stage is an unknown: supports and loads follow the
/// programme's one line, also beyond its ends. The path ends where the stage first reaches the
/// programme's end.
///
/// The arc length s has
///
///   ds^2 = (|du|^2 / |u'|^2 + dl^2) / 2
///
/// with the stage l and u' = du/dl at rest, so that at first ds = dl. A step goes ds along the
/// tangent of the path; the equilibrium is searched in the plane normal to it there (Riks, Int. J.
/// Solids Struct. 15, 1979; Ramm, 1981). A step that ends far from the tangent, or where the path
/// has turned by much, is cut: it might have reached another path.
///
/// The negative pivots of each state are counted. If their number changes within a step, the
/// critical point is located by bisection: a limit point if the stage turns there, a bifurcation
/// otherwise. From a bifurcation of a stable path the next step goes along the eigenvector of the
/// vanishing pivot, to the path that branches off. Which of its two sides is taken depends on the
/// numbering of points alone.
class ArcLengthStepping : public Driver {
 public:
  explicit ArcLengthStepping(Path& path);

 protected:
  [[nodiscard]] Advance next() override;

 private:
  /// A step in progress.
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
  /// Takes a step of the preload, which acts at load 0.
  [[nodiscard]] Advance put_on_preload();
  [[nodiscard]] Advance begin();
  /// Searches the equilibrium at a length along the path, and the path's direction there.
  [[nodiscard]] Step search(double length);
  /// Searches in the plane normal to the path's direction.
  [[nodiscard]] Attempt search_across(double length);
  /// Searches at the end of the load, beginning between the accepted state and an equilibrium near
  /// the end or beyond it.
  [[nodiscard]] Attempt search_end(const Attempt& near);
  /// Judges whether a step is the next state of the path; sets outcome and fault if it is not.
  void judge(Step& step) const;
  void find_direction(Step& step);
  /// Turns round the corner of the path where a contact closes just ahead, for a step that cannot
  /// pass it. The determinant of the bordered tangent keeps its sign along a path: the load turns
  /// if the number of negative pivots changes by an odd number.
  /// @return false if none closes
  [[nodiscard]] bool turn(const Step& step);
  /// Locates the critical point between the accepted state and one with other negative pivots.
  [[nodiscard]] Advance locate(Step beyond);
  /// @param modes number of modes that vanish together
  [[nodiscard]] Advance branch_off(std::int64_t modes);
  [[nodiscard]] Advance accept(Step step, const std::string& reason);
  [[nodiscard]] Advance fail(Step step);

  /// Scalar product of two directions, by which the arc length is measured.
  [[nodiscard]] double product(std::span<const double> du, double dl, std::span<const double> dv,
                               double dm) const;

  ImplicitStepping implicit_;
  Increment increment_;
  /// Displacement at which contacts are closed that the next step closes, where the path turns with
  /// them; empty: none. Found anew after an interruption.
  std::vector<double> foreseen_;
};

}  // namespace peristat
