#include "assembly/terms/points/point_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "assembly/convolutions/forces_with_images.hpp"
#include "assembly/convolutions/linear_bonds.hpp"
#include "assembly/energy/tangent_forms.hpp"
#include "assembly/terms/bonds/bond_count.hpp"
#include "assembly/terms/linear/linear_bond_sums.hpp"
#include "assembly/terms/model.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

class PointPasses : public TermPasses, BlockTangent, RowVisits, ProductOperator {
 public:
  PointPasses(const PointTerm& term, const TermSetting& setting)
      : term_(term),
        failure_(term.point_failure()),
        slot_(setting.model.slot_of(term)),
        workspace_(setting.workspace),
        places_(setting.pattern.places_of(term.couplings())),
        volume_(setting.points.volume),
        points_(setting.points),
        index_map_(setting.index_map),
        dimension_(std::size_t(setting.points.dimension)),
        force_(setting.points.reference.size()),
        has_half_work_(index_map_.is_whole() && term.balances().linear &&
                       term.balances().potential) {
    forces_ = term.forces(setting.points, setting.workspace);
    bonds_ = dynamic_cast<LinearBondSums*>(forces_.get());
  }

  Evaluation gradient(const StateView& at, std::span<double> gradient, Write how) override {
    return gradient_at(at, gradient, how);
  }

  /// All points that exceed what they bear fail together; an equilibrium is found before others do.
  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how) override {
    return commit(displacement, environment, history, gradient, how, Failing::once);
  }

  /// In motion no equilibrium is found in between. Where failed points make their neighbours
  /// stiffer, as in the linear solid, neighbours that exceed what they bear fail at once, too.
  Evaluation commit_forces(std::span<const double> displacement,
                           const SharedEnvironment& environment, History& history,
                           std::span<double> gradient, Write how) override {
    if (failure_.can_fail() || term_.has_lattice()) {
      return commit(displacement, environment, history, gradient, how, Failing::until_none_does);
    }
    forces_->find_forces(own(displacement), force_);
    write(force_, -1.0, gradient, how);
    Evaluation found;
    found.degenerate = !std::isfinite(std::reduce(force_.begin(), force_.end()));
    return found;
  }

  [[nodiscard]] bool shares_energy() const override { return true; }

  DamageGrowth growth(const StateView& at) override {
    if (!failure_.can_fail()) return {};
    take_integrity(at.history);
    find_energies(at.displacement);
    return judge();
  }

  [[nodiscard]] TangentForms forms() override {
    if (bonds_ == nullptr) return {.products = this};
    return {.blocks = this, .visits = this};
  }

  /// @param projection ignored: a term with rows is convex
  void tangent(const StateView& at, Tangent& tangent, double /*projection*/, Write how) override {
    if (how == Write::over) tangent.clear();
    const std::size_t entries = dimension_ * dimension_;
    std::vector<double> diagonal(tangent.diagonal.size());
    visit_tangent(
        at, 0.0,
        [&](int, Index i, std::span<const double> blocks) {
          Offset bond = term_.bonds().offset[i];
          for (std::size_t k = 0; k < blocks.size(); k += entries, ++bond) {
            tangent.add_to_block(places_.empty() ? bond : places_[std::size_t(bond)],
                                 blocks.subspan(k, entries));
          }
        },
        diagonal);
    for (std::size_t k = 0; k < diagonal.size(); ++k) tangent.diagonal[k] += diagonal[k];
  }

  void visit_tangent(const StateView& at, double /*projection*/, const RowVisitor& visit,
                     std::span<double> diagonal) override {
    take_integrity(at.history);
    bonds_->visit_tangent(visit, diagonal);
  }

  void outline(const StateView& at, std::span<double> diagonal,
               std::span<double> row_sums) override {
    take_integrity(at.history);
    forces_->outline_tangent(own(at.displacement), diagonal, row_sums);
  }

  LatticeStencil stencil(const StateView& at) override {
    take_integrity(at.history);
    LatticeStencil own = forces_->stencil();
    if (!own.empty()) return own;
    const std::vector<double> whole(volume_.size(), 1.0);
    const auto& integrity = integrity_.empty() ? whole : integrity_;
    return lattice_stencil(term_.lattice()->box, term_.lattice()->springs, integrity,
                           workspace_.threads());
  }

  /// @param projection share of the tangent at rest, which has no negative eigenvalue
  void product(const StateView& at, std::span<const double> v, double projection,
               std::span<double> product, Write how) override {
    take_integrity(at.history);
    const bool is_mixed = projection > 0.0 && !term_.balances().linear;
    if (how == Write::over && !is_mixed) {
      forces_->multiply(own(at.displacement), own(v), product.first(force_.size()));
      std::ranges::fill(product.subspan(force_.size()), 0.0);
      return;
    }
    forces_->multiply(own(at.displacement), own(v), force_);
    if (is_mixed) mix_in_rest(own(v), projection);
    write(force_, 1.0, product, how);
  }

  void point_energies(const StateView& at, std::span<double> energies, Write how) override {
    take_integrity(at.history);
    find_energies(at.displacement);
    write(energy_, 1.0, energies, how);
  }

  void add_virials(const StateView& at, std::span<double> virials) override {
    take_integrity(at.history);
    forces_->add_virials(own(at.displacement), virials);
  }

 private:
  enum class Failing { once, until_none_does };

  Evaluation commit(std::span<const double> displacement, const SharedEnvironment& environment,
                    History& history, std::span<double> gradient, Write how, Failing failing) {
    if (!failure_.can_fail()) {
      return gradient_at({displacement, history, Damage::grows, environment}, gradient, how);
    }
    take_integrity(history);
    find_energies(displacement);
    const double before = stored(displacement);
    DamageGrowth grown;
    bool any_has_failed = false;
    do {
      const DamageGrowth more = judge();
      if (!any_of_all(index_map_.ranks(), more.degrading > 0)) break;
      any_has_failed = true;
      grown.degrading += more.degrading;
      grown.breaking += more.breaking;
      fail(history);
      find_energies(displacement);
    } while (failing == Failing::until_none_does);
    Evaluation found = evaluation(displacement, gradient, how);
    if (!any_has_failed) return found;
    history.change(slot_).back() += index_map_.ranks().sum(before - found.energy);
    found.growth = grown;
    found.moves_equilibrium = true;
    return found;
  }

  Evaluation gradient_at(const StateView& at, std::span<double> gradient, Write how) {
    take_integrity(at.history);
    find_forces(at.displacement);
    return evaluation(at.displacement, gradient, how);
  }

  /// Sets the integrity of failing points to 0, also of their ghosts and images.
  void fail(History& history) {
    const std::span<double> remembered = history.change(slot_).first(volume_.size());
    const std::span<const double> energy = whole_energies();
    for (std::size_t i = 0; i < judged(); ++i) {
      if (fails(i, energy)) remembered[i] = 0.0;
    }
    index_map_.update_ghost_values(remembered);
    for (Index image = points_.own(); image < points_.count(); ++image) {
      remembered[std::size_t(image)] = remembered[std::size_t(points_.source(image))];
    }
    take_integrity(history);
  }

  /// Number of points, the first ones, whose energies are complete on this rank.
  [[nodiscard]] std::size_t judged() const {
    return std::size_t(points_.owned.value_or(points_.own()));
  }

  /// Energies, with those that images have of their sources' bonds.
  [[nodiscard]] std::span<const double> whole_energies() {
    if (points_.own() == points_.count()) return energy_;
    whole_energy_ = energy_;
    for (Index image = points_.own(); image < points_.count(); ++image) {
      whole_energy_[std::size_t(points_.source(image))] += energy_[std::size_t(image)];
    }
    return whole_energy_;
  }

  void take_integrity(const History& history) {
    if (!failure_.can_fail()) return;
    const std::span<const double> remembered = history.of(slot_);
    if (remembered.size() != volume_.size() + 1) {
      throw std::logic_error("points that can be damaged are evaluated after their history");
    }
    const std::span<const double> now = remembered.first(volume_.size());
    if (std::ranges::equal(now, integrity_)) return;
    integrity_.assign(now.begin(), now.end());
    forces_->set_integrity(integrity_);
  }

  void mix_in_rest(std::span<const double> v, double share) {
    const std::vector<double> rest(v.size(), 0.0);
    std::vector<double> at_rest(v.size());
    forces_->multiply(rest, v, at_rest);
    for (std::size_t k = 0; k < v.size(); ++k) {
      force_[k] = (1.0 - share) * force_[k] + share * at_rest[k];
    }
  }

  /// Displacements of the points, without the handles of rollers and rigid sets after them.
  [[nodiscard]] std::span<const double> own(std::span<const double> displacement) const {
    return displacement.first(force_.size());
  }

  static void write(std::span<const double> values, double factor, std::span<double> to,
                    Write how) {
    if (how == Write::over) std::ranges::fill(to, 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) to[k] += factor * values[k];
  }

  /// Finds forces, and whatever else `stored` needs.
  void find_forces(std::span<const double> displacement) {
    if (!has_half_work_) return find_energies(displacement);
    forces_->find_forces(own(displacement), force_);
  }

  void find_energies(std::span<const double> displacement) {
    energy_.resize(volume_.size());
    forces_->find_forces_and_energies(own(displacement), force_, energy_);
  }

  [[nodiscard]] Coordinates mean_of(std::span<const double> displacement) const {
    Coordinates mean{};
    for (std::size_t k = 0; k < force_.size(); ++k) mean[k % dimension_] += displacement[k];
    for (double& of_component : mean) of_component /= double(volume_.size());
    return mean;
  }

  /// The energy is a difference of sums of squared displacements times the stiffness of all
  /// springs.
  [[nodiscard]] double round_off_at(std::span<const double> displacement) const {
    const Coordinates mean = mean_of(displacement);
    double squares = 0.0, stiffness = 0.0;
    for (std::size_t k = 0; k < force_.size(); ++k) {
      squares +=
          (displacement[k] - mean[k % dimension_]) * (displacement[k] - mean[k % dimension_]);
    }
    for (const LatticeSpring& spring : term_.lattice()->springs)
      stiffness += 2.0 * spring.stiffness;
    return std::numeric_limits<double>::epsilon() * stiffness * squares;
  }

  /// Stored energy. Linear forces with a potential have -u.f/2, with u without its mean, since
  /// forces add up to zero only to round-off.
  [[nodiscard]] double stored(std::span<const double> displacement) const {
    if (!has_half_work_) return sum_of_energies();
    const Coordinates mean = mean_of(displacement);
    double work = 0.0;
    for (std::size_t k = 0; k < force_.size(); ++k) {
      work += (displacement[k] - mean[k % dimension_]) * force_[k];
    }
    return -0.5 * work;
  }

  [[nodiscard]] double sum_of_energies() const {
    double sum = 0.0;
    for (Index i = 0; i < points_.count(); ++i) {
      if (points_.owns(i)) sum += energy_[std::size_t(i)];
    }
    return sum;
  }

  /// Evaluation from the forces that were found.
  [[nodiscard]] Evaluation evaluation(std::span<const double> displacement,
                                      std::span<double> gradient, Write how) const {
    if (!gradient.empty()) write(force_, -1.0, gradient, how);
    Evaluation found;
    found.energy = stored(displacement);
    if (!has_half_work_ && term_.has_lattice()) found.round_off = round_off_at(displacement);
    found.degenerate = !std::isfinite(found.energy);
    return found;
  }

  [[nodiscard]] bool fails(std::size_t point, std::span<const double> energy) const {
    return energy[point] > (*failure_.bearable())[point] && integrity_[point] > 0.0;
  }

  /// Utilisation is the root of an energy ratio: energies go with the square of a load, as long as
  /// strains are small.
  [[nodiscard]] DamageGrowth judge() {
    DamageGrowth found;
    const std::span<const double> energy = whole_energies();
    for (std::size_t i = 0; i < judged(); ++i) {
      if (integrity_[i] == 0.0) continue;
      found.utilisation = std::max(found.utilisation, energy[i] / (*failure_.bearable())[i]);
      if (fails(i, energy)) ++found.degrading;
    }
    found.breaking = found.degrading;
    found.utilisation = std::sqrt(std::max(found.utilisation, 0.0));
    return found;
  }

  const PointTerm& term_;
  const PointFailure& failure_;
  std::size_t slot_;
  const Workspace& workspace_;
  std::vector<Offset> places_;
  std::span<const double> volume_;
  const Points& points_;
  const IndexMap& index_map_;
  std::size_t dimension_;
  std::unique_ptr<LatticeForces> forces_;
  LinearBondSums* bonds_ = nullptr;  // forces_, if it has rows
  std::vector<double> integrity_, force_, energy_, whole_energy_;
  bool has_half_work_;
};

}  // namespace

std::unique_ptr<LatticeForces> with_images(
    const ConvolvedLattice& lattice, const std::function<std::unique_ptr<LatticeForces>()>& make) {
  if (!lattice.has_images()) return make();
  return std::make_unique<ForcesWithImages>(make(), make(), lattice.box.place.size(), lattice.own);
}

PointTerm::PointTerm(std::shared_ptr<const Bonds> bonds, double micromodulus,
                     BearableEnergies bearable, std::optional<ConvolvedLattice> lattice,
                     int threads)
    : micromodulus_(micromodulus),
      failure_(std::make_shared<PointFailure>(std::move(bonds), micromodulus, std::move(bearable),
                                              std::move(lattice), threads)) {
  if (has_lattice()) no_couplings_.assign(std::size_t(this->bonds().points()) + 1, 0);
}

std::vector<InteractionCount> PointTerm::counts() const {
  if (!has_lattice()) return {bond_count(bonds())};
  return {{"bonds", failure_->count_of_bonds(), "neighbours", "neighbours within the horizon, #N1",
           failure_->neighbours()}};
}

Couplings PointTerm::couplings() const {
  if (!has_lattice()) return bonds();
  return {no_couplings_, {}};
}

double PointTerm::stored_bytes() const {
  const double points = double(bonds().points());
  const double own = 8.0 * points * double(4 + (failure_->can_fail() ? 3 : 0));
  return own + (has_lattice() ? bytes_of_forces() : 0.0);
}

std::unique_ptr<TermPasses> PointTerm::passes(const TermSetting& setting) const {
  return std::make_unique<PointPasses>(*this, setting);
}

}  // namespace peristat
