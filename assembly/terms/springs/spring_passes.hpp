#pragma once

#include <algorithm>
#include <cstddef>

#include "assembly/terms/term.hpp"

namespace peristat {

/// The passes of springs from points to given positions: k (u - g)^2 / 2 per component. They are
/// convex: projection changes nothing.
/// @tparam Springs has for_each(displacement, environment, visit), which calls visit(dof, k, u - g)
template <class Springs>
class SpringPasses : public TermPasses, BlockTangent {
 public:
  SpringPasses(const Springs& springs, int dimension)
      : springs_(springs), dimension_(std::size_t(dimension)) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::fill(gradient.begin(), gradient.end(), 0.0);
    Evaluation found;
    springs_.for_each(at.displacement, at.environment,
                      [&](std::size_t dof, double stiffness, double moved) {
                        found.energy += 0.5 * stiffness * moved * moved;
                        if (!gradient.empty()) gradient[dof] += stiffness * moved;
                      });
    return found;
  }

  [[nodiscard]] TangentForms forms() override { return {.blocks = this}; }

  void tangent(const StateView& at, Tangent& tangent, double, Write how) override {
    if (how == Write::over) tangent.clear();
    springs_.for_each(at.displacement, at.environment,
                      [&](std::size_t dof, double stiffness, double) {
                        const std::size_t c = dof % dimension_;
                        tangent.diagonal[dof * dimension_ + c] += stiffness;
                      });
  }

  void product(const StateView& at, std::span<const double> v, double, std::span<double> product,
               Write how) override {
    if (how == Write::over) std::fill(product.begin(), product.end(), 0.0);
    springs_.for_each(
        at.displacement, at.environment,
        [&](std::size_t dof, double stiffness, double) { product[dof] += stiffness * v[dof]; });
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (how == Write::over) std::fill(energies.begin(), energies.end(), 0.0);
    springs_.for_each(at.displacement, at.environment,
                      [&](std::size_t dof, double stiffness, double moved) {
                        energies[dof / dimension_] += 0.5 * stiffness * moved * moved;
                      });
  }

 private:
  const Springs& springs_;
  std::size_t dimension_;
};

}  // namespace peristat
