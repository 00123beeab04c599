#pragma once

#include <memory>
#include <optional>
#include <string>

#include "solvers/fracture/crack_tip.hpp"
#include "solvers/study/study.hpp"

namespace peristat {

/// Energy release rates [J/m2] of a crack that grows at once by a length l, in linear elasticity:
///
///   at fixed displacement  (E_0 - E_1)/(B l)
///   at fixed load          E_0 (E_0/E_1 - 1)/(B l)
///
/// with the stored energies E_0 before and E_1 after it at the same displacement of the supports.
/// Under loads alone, with E_0 and E_1 at the same load, the rates are E_0 (1 - E_0/E_1)/(B l) and
/// (E_1 - E_0)/(B l). They bracket the rate at the middle of the length.
struct ReleaseRates {
  double at_displacement = 0.0, at_load = 0.0;
};

/// Copy of a body in which a segment ahead of a crack's tip cuts further bonds.
class CutRelease {
 public:
  /// @param share J per joule of the body: 1/B, twice as much for half a body
  /// @throws InputError (key) for a length below the horizon or beyond the body, for loads beside
  ///         supports that move, and for an energy that depends on the load itself
  /// @throws what make_body and Study throw
  CutRelease(const Body& body, const CrackTipSpecification& tip, double share,
             const StudyOptions& options, const std::string& key);

  /// Rates of a state in equilibrium, with damage held; nothing if the cut body has no equilibrium.
  [[nodiscard]] std::optional<ReleaseRates> rates(const Trial& before, double stage);

 private:
  [[nodiscard]] History history_of(const History& before) const;

  const Body& body_;
  double length_, share_;
  std::unique_ptr<const Body> cut_;
  std::unique_ptr<Study> study_;
};

}  // namespace peristat
