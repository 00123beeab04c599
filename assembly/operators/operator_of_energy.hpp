#pragma once

#include <span>
#include <vector>

#include "assembly/energy/energy.hpp"
#include "assembly/energy/kept_state.hpp"
#include "assembly/energy/tangent_forms.hpp"

namespace peristat {

/// Tangent of a kind that stores no blocks: products are computed anew from the energy each time.
/// The energy outlives it.
template <class Kind>
struct OperatorOfEnergy : Kind {
  [[nodiscard]] std::vector<double> positions() const override {
    return at_.positions(energy_->points().reference);
  }
  void multiply(std::span<const double> v, std::span<double> result) const override {
    energy_->product(at_.view(), v, result, projection_);
  }

 protected:
  OperatorOfEnergy(Energy& energy, const BlockPattern& blocks)
      : Kind(blocks, energy.points().dimension, energy.threads(), energy.parts()),
        energy_(&energy) {}

  void keep(Energy& energy, const StateView& at, double projection) {
    energy_ = &energy;
    this->reference = energy.points().reference;
    at_.keep(at);
    projection_ = projection;
  }

  Energy* energy_;
  KeptState at_;
  double projection_ = 0.0;
};

}  // namespace peristat
