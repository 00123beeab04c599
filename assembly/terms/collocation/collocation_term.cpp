#include "assembly/terms/collocation/collocation_term.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "assembly/energy/tangent_forms.hpp"
#include "assembly/terms/bonds/bond_passes.hpp"
#include "assembly/terms/damage.hpp"
#include "assembly/terms/workspace.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

class CollocationPasses : public TermPasses, RowOperator {
 public:
  CollocationPasses(const CollocationTerm& term, const TermSetting& setting)
      : term_(term),
        setting_(setting),
        stretches_(make_bond_passes(term.bond_failure(), setting)),
        whole_(setting.points, term.whole(), setting.workspace.threads()) {}

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    add_forces(at, gradient, how);
    return energy(at);
  }

  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override {
    const DamageGrowth growth = break_bonds(displacement, environment, history);
    const StateView at{displacement, history, Damage::grows, environment};
    return with_growth(this->gradient(at, gradient, how), growth);
  }

  Evaluation commit_forces(std::span<const double> displacement,
                           const SharedEnvironment& environment, History& history,
                           std::span<double> gradient, Write how) override {
    const DamageGrowth growth = break_bonds(displacement, environment, history);
    add_forces({displacement, history, Damage::grows, environment}, gradient, how);
    return with_growth({}, growth);
  }

  void follower_force(const StateView& at, std::span<double> force) override {
    if (!is_pulled(at)) return;
    update(at);
    whole_.add_traction_forces(at.environment->traction, force);
  }

  DamageGrowth growth(const StateView& at) override {
    return term_.bond_failure().can_fail() ? stretches_->growth(at) : DamageGrowth{};
  }

  [[nodiscard]] TangentForms forms() override { return {.rows = this, .products = this}; }

  void product(const StateView& at, std::span<const double> v, double, std::span<double> product,
               Write how) override {
    update(at);
    write(how, product, [&](std::span<double> to) { whole_.forces(v, {}, to); });
  }

  [[nodiscard]] SparseRows rows(const StateView& at, RowReach reach) override {
    update(at);
    if (reach == RowReach::whole) return whole_.rows();
    CollocationOperator local(setting_.points, term_.local(), setting_.workspace.threads());
    local.update(broken_);
    return local.rows();
  }
  [[nodiscard]] double bytes_of_rows() const override { return whole_.bytes_of_rows(); }

  void outline(const StateView& at, std::span<double> diagonal,
               std::span<double> row_sums) override {
    update(at);
    add_scaled(diagonal, 1.0, whole_.diagonal());
    add_scaled(row_sums, 1.0, whole_.bounds_of_row_sums());
  }
  [[nodiscard]] LatticeStencil stencil(const StateView&) override { return {}; }

  [[nodiscard]] bool shares_energy() const override { return true; }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    update(at);
    write(how, energies, [&](std::span<double> to) { whole_.energies(at.displacement, to); });
  }

  /// V sigma with sigma = lambda tr(E) 1 + 2 mu E of the nonlocal strain.
  void add_virials(const StateView& at, std::span<double> virials) override {
    update(at);
    const auto d = std::size_t(setting_.points.dimension);
    std::vector<double> gradients(virials.size());
    whole_.displacement_gradients(at.displacement, gradients);
    const LameConstants& material = *term_.whole().constants;
    for (std::size_t i = 0; i < setting_.points.volume.size(); ++i) {
      const double* gradient = &gradients[i * d * d];
      double theta = 0.0;
      for (std::size_t c = 0; c < d; ++c) theta += gradient[c * d + c];
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          const double stress = material.mu[i] * (gradient[r * d + c] + gradient[c * d + r]) +
                                (r == c ? material.lambda[i] * theta : 0.0);
          virials[i * d * d + r * d + c] += setting_.points.volume[i] * stress;
        }
      }
    }
  }

 private:
  static bool is_pulled(const StateView& at) {
    return at.environment && !at.environment->traction.empty();
  }

  void update(const StateView& at) {
    broken_ = broken_bonds(setting_.model, at.history);
    whole_.update(broken_);
  }

  template <class Find>
  void write(Write how, std::span<double> result, const Find& find) {
    if (how == Write::over) return find(result);
    buffer_.resize(result.size());
    find(buffer_);
    for (std::size_t k = 0; k < result.size(); ++k) result[k] += buffer_[k];
  }

  void add_forces(const StateView& at, std::span<double> gradient, Write how) {
    if (gradient.empty()) return;
    update(at);
    const std::span<const double> traction = is_pulled(at)
                                                 ? std::span<const double>(at.environment->traction)
                                                 : std::span<const double>();
    write(how, gradient,
          [&](std::span<double> to) { whole_.forces(at.displacement, traction, to); });
  }

  Evaluation energy(const StateView& at) {
    update(at);
    std::vector<double> energies(setting_.points.volume.size());
    whole_.energies(at.displacement, energies);
    Evaluation found;
    for (const double energy : energies) found.energy += energy;
    found.degenerate = !std::isfinite(found.energy);
    return found;
  }

  DamageGrowth break_bonds(std::span<const double> displacement,
                           const SharedEnvironment& environment, History& history) {
    if (!term_.bond_failure().can_fail()) return {};
    buffer_.resize(displacement.size());
    return stretches_->commit_forces(displacement, environment, history, buffer_, Write::over)
        .growth;
  }

  static Evaluation with_growth(Evaluation found, const DamageGrowth& growth) {
    found.growth = growth;
    found.moves_equilibrium = growth.degrading > 0;
    return found;
  }

  const CollocationTerm& term_;
  TermSetting setting_;
  std::unique_ptr<TermPasses> stretches_;  // damage of its bonds; their forces are unused
  CollocationOperator whole_;
  std::vector<char> broken_;
  std::vector<double> buffer_;
};

}  // namespace

CollocationTerm::CollocationTerm(std::shared_ptr<const Bonds> bonds, BondPotential potential,
                                 std::vector<char> never_fails, CollocationSetting whole,
                                 CollocationSetting local)
    : failure_(std::make_shared<BondFailure>(std::move(bonds), std::move(potential),
                                             std::move(never_fails))),
      whole_(std::move(whole)),
      local_(std::move(local)) {}

double CollocationTerm::stored_bytes() const {
  const CollocationNetwork &whole = *whole_.network, &local = *local_.network;
  const double entries = double(whole.neighbour.size() + local.neighbour.size());
  const double d = whole.dimension, third = third_moment_entries(whole.dimension);
  // Per entry: neighbour, bond, share (twice once bonds break), dilatation coefficient. Per point:
  // missing moments at the start and now, shape, normal, dilatation, constants.
  return failure_->bytes() +
         entries * (double(sizeof(Index) + sizeof(Offset)) + (2.0 + d) * sizeof(double)) +
         8.0 * double(whole.points()) * (4.0 * d + 3.0 * third + d * d + 4.0);
}

std::unique_ptr<TermPasses> CollocationTerm::passes(const TermSetting& setting) const {
  return std::make_unique<CollocationPasses>(*this, setting);
}

}  // namespace peristat
