#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "src/conditions/slip.hpp"
#include "src/core/coordinates.hpp"
#include "src/core/types.hpp"

namespace peristat {

/// A contact of a point that is pressed on others.
struct Press {
  std::size_t contact = 0;
  Index point = 0;
  std::vector<Slip::Partner> partners{};   ///< shares add up to 1
  double force = 0.0;                      ///< [N]
  Coordinates normal{};                    ///< towards the point
  double friction = 0.0, stiffness = 0.0;  ///< mu, k_t [N/m]
};

/// Coulomb friction of points that are pressed on others, as of Obstacles: the displacement of the
/// point relative to the obstacle is X = u - sum_k w_k u_k with the partners' shares w.
class PointFriction {
 public:
  PointFriction(int dimension) : dimension_(std::size_t(dimension)) {}

  /// Friction of a contact at a state.
  struct Rubbing {
    const Slip& slip;
    Coordinates force{};                    ///< on the point, -dD/dX [N]
    double energy = 0.0;                    ///< D [J]
    double stiffness = 0.0, sliding = 0.0;  ///< [N/m]; 1 if it slides, otherwise 0
    Coordinates direction{};                ///< y / |y|
    double round_off = 0.0;                 ///< of the energy [J]

    /// Entry of d2D/dX2 = stiffness (P - sliding y y^T / |y|^2). The projection takes its share of
    /// the second part away: where all points slide nothing else resists. A light projection,
    /// which other terms may need, leaves it: a block that slides far would go there in tiny steps.
    [[nodiscard]] double second_derivative(std::size_t row, std::size_t column,
                                           double projection) const {
      constexpr double light = 0.1;
      const double share = projection > light ? projection : 0.0;
      return stiffness * ((row == column ? 1.0 : 0.0) - slip.normal[row] * slip.normal[column] -
                          (1.0 - share) * sliding * direction[row] * direction[column]);
    }
  };
  /// Visits all slips whose friction has an energy.
  template <class Visit>
  void for_each(const Slips& slips, std::span<const double> displacement,
                const Visit& visit) const {
    for (const Slip& slip : slips) {
      const double limit = slip.friction * slip.normal_force;
      if (!(limit > 0.0)) continue;
      const Coordinates y = slipped(slip, displacement);
      const double size = length(y), bearable = limit / slip.stiffness;
      const bool slides = size > bearable;
      const Coordinates direction = size > 0.0 ? scaled(1.0 / size, y) : Coordinates{};
      const double force = slides ? limit : slip.stiffness * size;
      visit(Rubbing{slip, scaled(-force, direction),
                    slides ? limit * (size - 0.5 * bearable) : 0.5 * slip.stiffness * size * size,
                    slides ? limit / size : slip.stiffness, slides ? 1.0 : 0.0, direction,
                    force * round_off_of_place(slip, displacement)});
    }
  }

  struct Committed {
    Slips slips;
    double dissipated = 0.0;  ///< [J]
  };
  /// Slips that a state leaves behind it.
  [[nodiscard]] Committed committed(const Slips& before, const std::vector<Press>& presses,
                                    std::span<const double> displacement) const;

  /// Slips of a search that begins in a state: what touches sticks, whatever its force.
  [[nodiscard]] Slips stuck(const Slips& before, const std::vector<Press>& presses,
                            std::span<const double> displacement) const;

  struct Lagged {
    Slips slips;
    double change = 0.0, largest = 0.0;  ///< of normal forces [N]
  };
  /// Slips before with the normal forces, directions and partners of a state. What has slipped so
  /// far is kept where partners change. Contacts that are new begin where they were at the start.
  [[nodiscard]] Lagged lagged(const Slips& before, const std::vector<Press>& presses,
                              std::span<const double> displacement,
                              std::span<const double> at_start) const;

 private:
  /// X [m]
  [[nodiscard]] Coordinates relative(Index point, const std::vector<Slip::Partner>& partners,
                                     std::span<const double> displacement) const;
  /// Round-off of X, a sum of products of all the displacements and shares [m].
  [[nodiscard]] double round_off_of_place(const Slip& slip,
                                          std::span<const double> displacement) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < dimension_; ++c) {
      sum += std::abs(displacement[std::size_t(slip.point) * dimension_ + c]);
      for (const auto& [partner, share] : slip.partners) {
        sum += std::abs(share * displacement[std::size_t(partner) * dimension_ + c]);
      }
    }
    return double(1 + slip.partners.size()) * std::numeric_limits<double>::epsilon() * sum;
  }
  /// y [m]
  [[nodiscard]] Coordinates slipped(const Slip& slip, std::span<const double> displacement) const {
    const Coordinates moved = minus(relative(slip.point, slip.partners, displacement), slip.start);
    return plus(slip.elastic, minus(moved, scaled(dot(moved, slip.normal), slip.normal)));
  }
  /// A contact's slip with the data of a press.
  [[nodiscard]] Slip slip_of(const Press& press, const Slip* old,
                             std::span<const double> displacement,
                             std::span<const double> at_start) const;

  std::size_t dimension_;
};

}  // namespace peristat
