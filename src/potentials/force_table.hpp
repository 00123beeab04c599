#pragma once

#include <memory>
#include <span>
#include <vector>

#include "src/potentials/harmonic.hpp"

namespace peristat {

/// A curve through given pairs of a stretch and a force over c, linear between them and from 0 to
/// the first one. Both are in units of the last stretch.
class ForceCurve {
 public:
  struct Knot {
    double stretch, force;
    double work;  ///< int_0^stretch f ds
  };

  /// @param stretches positive and ascending
  /// @param forces    as many
  ForceCurve(std::span<const double> stretches, std::span<const double> forces);

  [[nodiscard]] const std::vector<Knot>& knots() const { return knots_; }
  /// Last stretch up to which the force is the stretch, as that of an undamaged bond.
  [[nodiscard]] double onset() const { return onset_; }
  [[nodiscard]] double largest_force() const;
  /// The first knot beyond a stretch below 1.
  [[nodiscard]] const Knot& beyond(double stretch) const;
  /// The knot before one, or the origin.
  [[nodiscard]] Knot before(const Knot& knot) const;

 private:
  std::vector<Knot> knots_;
  double onset_ = 0.0;
};

/// Part of a stretch by which the force of an undamaged bond may differ from it.
inline constexpr double round_off_of_elastic_pairs = 1e-6;

/// Bond whose force c f(s) is a given curve up to its last stretch s_c, where the bond breaks; if
/// the force is not zero there, it jumps. T = f/s, which must not grow.
struct ForceTable {
  std::shared_ptr<const ForceCurve> curve;
  double critical_stretch = 0.0;  ///< s_c

  [[nodiscard]] double onset() const { return curve->onset() * critical_stretch; }
  [[nodiscard]] double critical() const { return critical_stretch; }
  [[nodiscard]] double integrity(double s) const;
  [[nodiscard]] double slope(double s) const;

  /// For the modulus 1, in closed form.
  [[nodiscard]] double work(const Harmonic& whole, double s) const;

  /// The same curve with another last stretch, to which the onset has the same ratio.
  [[nodiscard]] ForceTable between(double, double critical) const { return {curve, critical}; }

  /// f_p, the largest force over c.
  [[nodiscard]] double peak_force() const { return curve->largest_force() * critical_stretch; }
};

}  // namespace peristat
