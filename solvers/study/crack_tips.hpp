#pragma once

#include <memory>
#include <vector>

#include "solvers/fracture/crack_tip_integrals.hpp"
#include "solvers/study/body.hpp"
#include "solvers/study/cut_release.hpp"

namespace peristat {

/// Whether stress intensity factors have a meaning: no fibres, no random stiffness, and
/// balls for neighbourhoods.
[[nodiscard]] bool has_isotropic_materials(const BodySpecification& of);

/// What is told of a crack's tip.
struct CrackTip {
  CrackTipIntegrals integrals;
  std::unique_ptr<CutRelease> release;  ///< null: not asked for
};

/// @throws InputError ("crack_tips[0].…") as CrackTipIntegrals and CutRelease do, for a ring that
///         holds two materials, and for a body with eigenstrains, whose energy flows by itself
[[nodiscard]] std::vector<CrackTip> make_crack_tips(const Body& body,
                                                    const std::vector<CrackTipSpecification>& tips,
                                                    const StudyOptions& options);

}  // namespace peristat
