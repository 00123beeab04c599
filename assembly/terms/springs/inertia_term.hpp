#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "assembly/terms/springs/spring_term.hpp"

namespace peristat {

/// The inertia of points in a step of an implicit motion, as springs to the positions that inertia
/// alone would take them to. The environment holds these; without it there are none.
class InertiaTerm : public SpringTerm {
 public:
  explicit InertiaTerm(const Points& points) : SpringTerm(points), dofs_(points.reference.size()) {}

  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

  /// Calls visit(dof, k, u - g) for every component of the points.
  template <class Visit>
  void for_each(std::span<const double> displacement, const SharedEnvironment& environment,
                const Visit& visit) const {
    if (!environment || environment->inertia.stiffness.empty()) return;
    const InertialSprings& inertia = environment->inertia;
    // Entries of handles come after those of the points.
    for (std::size_t dof = 0; dof < dofs_; ++dof) {
      visit(dof, inertia.stiffness[dof], displacement[dof] - inertia.place[dof]);
    }
  }

 private:
  std::size_t dofs_;
};

}  // namespace peristat
