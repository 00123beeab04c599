#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "assembly/terms/term.hpp"

namespace peristat {

/// The inertia of points in a step of an implicit motion: springs to where inertia alone would take
/// them, which the environment holds. There are none without it. Couples no points.
class InertiaTerm : public Term {
 public:
  explicit InertiaTerm(const Points& points)
      : dofs_(points.reference.size()), offset_(std::size_t(points.count()) + 1, 0) {}

  [[nodiscard]] Couplings couplings() const override { return {offset_, {}}; }
  [[nodiscard]] bool has_symmetric_blocks() const override { return true; }
  /// Of the points among one another, where it has no force.
  [[nodiscard]] Balances balances() const override { return {}; }
  [[nodiscard]] double stored_bytes() const override {
    return double(offset_.size() * sizeof(Offset));
  }
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

  /// Calls visit(dof, k, u - g) for every component of the points.
  template <class Visit>
  void for_each(std::span<const double> displacement, const SharedEnvironment& environment,
                const Visit& visit) const {
    if (!environment || environment->inertia.stiffness.empty()) return;
    const InertialSprings& inertia = environment->inertia;
    // Those of constraints stand behind the points'.
    for (std::size_t dof = 0; dof < dofs_; ++dof) {
      visit(dof, inertia.stiffness[dof], displacement[dof] - inertia.place[dof]);
    }
  }

 private:
  std::size_t dofs_;
  std::vector<Offset> offset_;
};

}  // namespace peristat
