#include "assembly/terms/foundation/foundation_term.hpp"

#include <algorithm>

namespace peristat {
namespace {

class FoundationPasses : public TermPasses {
 public:
  FoundationPasses(const Foundations& foundations, int dimension)
      : foundations_(foundations), dimension_(std::size_t(dimension)) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    if (how == Write::over) std::fill(gradient.begin(), gradient.end(), 0.0);
    if (!gradient.empty()) {
      foundations_.add_force(at.displacement, at.environment, -1.0, gradient);
    }
    Evaluation found;
    found.energy = foundations_.energy(at.displacement, at.environment);
    return found;
  }

  /// Springs are stable: projection changes nothing.
  void tangent(const StateView& at, double, Tangent& tangent, Write how) override {
    if (how == Write::over) tangent.clear();
    foundations_.for_each(at.displacement, at.environment,
                          [&](std::size_t dof, double stiffness, double) {
                            const std::size_t c = dof % dimension_;
                            tangent.diagonal[dof * dimension_ + c] += stiffness;
                          });
  }

  void product(const StateView& at, std::span<const double> v, double, std::span<double> product,
               Write how) override {
    if (how == Write::over) std::fill(product.begin(), product.end(), 0.0);
    foundations_.for_each(
        at.displacement, at.environment,
        [&](std::size_t dof, double stiffness, double) { product[dof] += stiffness * v[dof]; });
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    if (how == Write::over) std::fill(energies.begin(), energies.end(), 0.0);
    foundations_.for_each(at.displacement, at.environment,
                          [&](std::size_t dof, double stiffness, double moved) {
                            energies[dof / dimension_] += 0.5 * stiffness * moved * moved;
                          });
  }

 private:
  const Foundations& foundations_;
  std::size_t dimension_;
};

}  // namespace

std::unique_ptr<TermPasses> FoundationTerm::passes(const TermSetting& setting) const {
  return std::make_unique<FoundationPasses>(foundations_, setting.points.dimension);
}

}  // namespace peristat
