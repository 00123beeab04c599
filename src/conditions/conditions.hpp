#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "src/conditions/expression.hpp"
#include "src/conditions/specification.hpp"
#include "src/points/points.hpp"

namespace peristat {

/// Supports and loads of a body, as functions of the load factor. Arrays have one entry per degree
/// of freedom (point x dimension + component).
class Conditions {
 public:
  /// @throws InputError (keys "support[k].…", "load[k].…", k from 0) for a set that is unknown or
  ///         empty, a bad expression, or two supports that prescribe different displacements to one
  ///         point and component (compared at load factors 0, 1/2 and 1)
  Conditions(const Points& points, const std::vector<SupportSpecification>& supports,
             const std::vector<LoadSpecification>& loads);

  /// Whether a degree of freedom is prescribed.
  [[nodiscard]] const std::vector<char>& prescribed() const { return prescribed_; }

  /// Overwrites the prescribed entries with their displacement [m] at the load factor.
  void prescribe(double load_factor, std::span<double> displacement) const;

  /// External force of the loads [N] at the load factor, every entry overwritten.
  void external_force(double load_factor, std::span<double> force) const;

  /// Reaction of each support's set [N]: the sum over its prescribed degrees of freedom of what the
  /// support adds to hold them, dE/dx - external force.
  [[nodiscard]] std::map<std::string, Coordinates> reactions(
      std::span<const double> gradient, std::span<const double> external) const;

 private:
  struct Prescription {
    std::string set;
    const std::vector<Index>* points;
    int component;
    Expression displacement;
  };
  struct Load {
    const std::vector<Index>* points;
    int component;
    Expression value;    // body force [N/m3], or total force [N]
    double spread_over;  // volume that a total force is spread over [m3]; 1 for a body force
  };

  void refuse_contradictions() const;

  const Points& points_;
  std::vector<Prescription> prescriptions_;
  std::vector<Load> loads_;
  std::vector<char> prescribed_;
};

}  // namespace peristat
