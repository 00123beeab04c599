#pragma once

#include <memory>
#include <vector>

#include "solvers/body/body.hpp"
#include "solvers/fracture/crack_tip_integrals.hpp"
#include "solvers/study/cut_release.hpp"

namespace peristat {

/// True if stress intensity factors have a meaning: no fibres, no random stiffness, and balls for
/// neighbourhoods.
[[nodiscard]] bool has_isotropic_materials(const BodySpecification& of);

/// Evaluations at a crack tip.
struct CrackTip {
  CrackTipIntegrals integrals;
  std::unique_ptr<CutRelease> release;  ///< null: not requested
};

/// @throws InputError ("crack_tips[0].…") as CrackTipIntegrals and CutRelease do, for a ring that
///         contains two materials, and for a body with eigenstrains, whose energy has a flux of its
///         own
[[nodiscard]] std::vector<CrackTip> make_crack_tips(const Body& body,
                                                    const std::vector<CrackTipSpecification>& tips,
                                                    const StudyOptions& options);

}  // namespace peristat
