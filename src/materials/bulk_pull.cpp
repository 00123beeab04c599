#include "src/materials/bulk_pull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <span>

#include <Eigen/Core>

#include "src/core/coordinates.hpp"
#include "src/dense/square_system.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/dense/symmetric_system.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/lattice_ball.hpp"
#include "src/neighbourhood/side_influence.hpp"
#include "src/potentials/critical_of_work.hpp"

namespace peristat {
namespace {

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;
using LargeVector = Eigen::VectorXd;
using LargeMatrix = Eigen::MatrixXd;

constexpr std::array<std::ptrdiff_t, 3> entries_of_tensor{1, 3, 6};

std::span<const double> entries_of(const Matrix& matrix) {
  return {matrix.data(), std::size_t(matrix.size())};
}

/// n n^T in Kelvin's notation, times a factor.
std::array<double, 6> projector(const Coordinates& n, int dimension, double factor = 1.0) {
  std::array<double, 6> result{};
  std::size_t k = 0;
  for (int a = 0; a < dimension; ++a) result[k++] = factor * n[a] * n[a];
  for (int a = 0; a < dimension; ++a) {
    for (int b = 0; b < a; ++b) result[k++] = factor * std::numbers::sqrt2 * n[a] * n[b];
  }
  return result;
}

std::array<double, 6> sum(const std::array<double, 6>& a, const std::array<double, 6>& b) {
  std::array<double, 6> result{};
  std::ranges::transform(a, b, result.begin(), std::plus());
  return result;
}

/// A direction normal to another one.
Coordinates normal_to(const Coordinates& n, int dimension) {
  if (dimension == 2) return {-n[1], n[0], 0.0};
  const bool is_upright = std::abs(n[2]) > 0.9;
  return unit(cross(n, is_upright ? Coordinates{1, 0, 0} : Coordinates{0, 0, 1}));
}

/// Eigenvalues of a tensor in Kelvin's notation.
template <int D>
std::array<double, 3> principal_strains(const Vector& kelvin) {
  std::array<double, std::size_t(D) * D> tensor{};
  std::ptrdiff_t k = 0;
  for (int a = 0; a < D; ++a) tensor[std::size_t(a * D + a)] = kelvin[k++];
  for (int a = 0; a < D; ++a) {
    for (int b = 0; b < a; ++b) {
      tensor[std::size_t(a * D + b)] = tensor[std::size_t(b * D + a)] =
          kelvin[k++] / std::numbers::sqrt2;
    }
  }
  std::array<double, 3> values{};
  std::ranges::copy(symmetric_eigenvalues<D>(tensor.data()), values.begin());
  return values;
}

/// Numbers vectors; opposite ones and those that differ by round-off have one number.
class Numbers {
 public:
  int of(const Coordinates& vector) {
    std::array<long long, 3> rounded{};
    for (std::size_t c = 0; c < 3; ++c) rounded[c] = std::llround(vector[c] * 1e9);
    if (rounded < std::array<long long, 3>{}) {
      for (long long& part : rounded) part = -part;
    }
    return numbers_.try_emplace(rounded, int(numbers_.size())).first->second;
  }

 private:
  std::map<std::array<long long, 3>, int> numbers_;
};

}  // namespace

/// A state under the growing stress.
struct BulkPull::State {
  double along = 0.0;  // S : eps
  Vector strain{};
  double stress = 0.0;
  double theta = 0.0;             // of states
  std::vector<double> largest{};  // (equivalent) stretches of fibres so far
  std::vector<AnyLaw> laws{};     // of fibres, whose onsets move; empty: all have the given one
  LargeVector driven{};  // with simplices: equivalent stretches of fibres as far as they grow
};

/// The equilibria of one law under one form of stress.
class BulkPull::Equilibrium {
 public:
  Equilibrium(const BulkPull& bulk, const Tensor& form, const AnyLaw& law,
              const MovingOnsets* moving)
      : bulk_(bulk),
        law_(law),
        moving_(moving),
        size_(entries_of_tensor[std::size_t(bulk.dimension_ - 1)]),
        form_(vector(form)),
        drop_(law.onset() < law.critical() ? 0.0 : 1.0),
        fibres_(bulk.fibres_.size()) {
    for (const Fibre& fibre : bulk.fibres_) total_ += fibre.stiffness;
    if (moving_) work_ = law.work(Harmonic{1.0}, law.critical());
  }

  /// State in which the first bond reaches its onset; without strain if the lattice has no
  /// stiffness.
  [[nodiscard]] State first() {
    State state;
    state.largest.assign(fibres_.size(), 0.0);
    set_secants(state);
    const Matrix stiffness = secant_stiffness();
    const std::vector<double> eigenvalues =
        symmetric_modes(entries_of(stiffness), int(size_)).values;
    if (!(eigenvalues.front() > 1e-12 * eigenvalues.back())) return state;
    const Vector of_unit = strain_of_form(stiffness);
    const double theta = dilatation(of_unit);
    const double longest = std::ranges::max(driving(of_unit, theta));
    const double rho = moving_ ? moving_->utilisation(principal(of_unit)) : 0.0;
    const double begin = moving_ ? onset_at(longest, rho) : law_.onset();
    state.stress = begin / longest;
    if (!std::isfinite(state.stress)) return state;
    state.strain = state.stress * of_unit;
    state.theta = state.stress * theta;
    state.along = form_.dot(state.strain);
    if (moving_) state.laws.assign(fibres_.size(), moved_law(begin));
    return state;
  }

  /// State with another strain along the form.
  [[nodiscard]] State at(double along, const State& since) {
    State state = since;
    state.strain *= along / since.along;
    state.theta *= along / since.along;
    state.driven *= along / since.along;
    state.along = along;
    constexpr int most_iterations = 30;
    for (int k = 0; k < most_iterations; ++k) {
      const double change = improve(state, since.largest);
      if (!std::isfinite(change)) break;
      if (change > tolerance * state.strain.norm()) continue;
      if (has_stiffened(state, since)) break;
      grow(state);
      return state;
    }
    return by_secants(along, since);
  }

 private:
  static constexpr double tolerance = 1e-12;

  /// A fibre at a strain, with the slopes of its integrity by its stretch and by theta.
  struct Strained {
    double stretch, integrity, slope, slope_by_theta;
  };

  /// An equivalent stretch with its derivatives by stretch and theta.
  struct Driving {
    double stretch = 0.0, by_stretch = 0.0, by_theta = 0.0;
  };

  [[nodiscard]] Driving driving(const Fibre& fibre, double s, double theta) const {
    if (bulk_.zeta_ == 0.0) return {s, 1.0, 0.0};
    const double along = (1.0 - drop_ * fibre.drop) * s,
                 squared = s * (along + bulk_.zeta_ * theta);
    constexpr double round_off = 1e-12;
    if (!(s > 0.0 && squared > round_off * s * s)) return {};
    const double root = std::sqrt(squared);
    return {root, (along + 0.5 * bulk_.zeta_ * theta) / root, 0.5 * bulk_.zeta_ * s / root};
  }

  /// d (sum a T s) / sum a, with the integrities of the fibres.
  [[nodiscard]] double dilatation(const Vector& strain) const {
    return bulk_.dimension_ / total_ * dilatational().dot(strain);
  }

  /// sum a T n n
  [[nodiscard]] Vector dilatational() const {
    Vector sum = Vector::Zero(size_);
    for (std::size_t k = 0; k < fibres_.size(); ++k) {
      const Fibre& fibre = bulk_.fibres_[k];
      sum += fibre.stiffness * fibres_[k].integrity * vector(fibre.dyad);
    }
    return sum;
  }

  /// True if stress over strain has grown. Integrities fall, and the ratio with them (where
  /// triangles of negative stiffness fail it could rise; no lattice is known where it does). A
  /// state that carries more is no equilibrium but round-off in a lattice that has lost its
  /// stiffness.
  [[nodiscard]] static bool has_stiffened(const State& state, const State& since) {
    return state.stress * since.along > (1.0 + 1e-9) * since.stress * state.along;
  }

  [[nodiscard]] const AnyLaw& law_of(const State& state, std::size_t fibre) const {
    return state.laws.empty() ? law_ : state.laws[fibre];
  }

  /// Principal strains, in 2D those in the plane.
  [[nodiscard]] std::array<double, 3> principal(const Vector& strain) const {
    return bulk_.dimension_ == 2 ? principal_strains<2>(strain) : principal_strains<3>(strain);
  }

  /// Onset of bonds that have not started, where the longest one has this stretch.
  [[nodiscard]] double onset_at(double longest, double rho) const {
    const double moved = rho > 0.0 ? longest / rho : std::numeric_limits<double>::infinity();
    return std::clamp(moved, moving_->range[0] * law_.onset(), moving_->range[1] * law_.onset());
  }

  [[nodiscard]] AnyLaw moved_law(double onset) const {
    return law_.between(onset, critical_of_work(bond_law(law_), onset, work_, law_.critical()));
  }

  /// Moves the onsets of fibres that have not started.
  /// @param now (equivalent) stretches
  void renew(State& state, const std::vector<double>& now) const {
    double longest = 0.0;
    bool has_started = false;
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (state.largest[k] < state.laws[k].critical()) longest = std::max(longest, now[k]);
      has_started |= state.largest[k] > state.laws[k].onset();
    }
    const double onset = onset_at(longest, moving_->utilisation(principal(state.strain)));
    const AnyLaw moved = moved_law(has_started ? std::min(onset, law_.onset()) : onset);
    for (std::size_t k = 0; k < fibres_.size(); ++k) {
      if (state.largest[k] <= state.laws[k].onset()) state.laws[k] = moved;
    }
  }

  [[nodiscard]] Vector vector(const Tensor& of) const {
    return Eigen::Map<const Eigen::VectorXd>(of.data(), size_);
  }

  [[nodiscard]] Vector strain_of_form(const Matrix& stiffness) const {
    Vector strain = form_;
    solve_symmetric(entries_of(stiffness), {strain.data(), std::size_t(strain.size())});
    return strain;
  }

  /// (Equivalent) stretches of the fibres, with their integrities.
  [[nodiscard]] std::vector<double> driving(const Vector& strain, double theta) {
    std::vector<double> all(fibres_.size());
    if (bulk_.releases_simplices_) find_releases(strain);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Fibre& fibre = bulk_.fibres_[k];
      const double s = vector(fibre.dyad).dot(strain);
      all[k] = bulk_.releases_simplices_ ? release(k, s) : driving(fibre, s, theta).stretch;
    }
    return all;
  }

  void grow(State& state) {
    const std::vector<double> now = driving(state.strain, state.theta);
    for (std::size_t k = 0; k < now.size(); ++k) {
      state.largest[k] = std::max(state.largest[k], now[k]);
    }
    if (moving_) renew(state, now);
  }

  /// Finds the derivatives of twice the energy density W by the integrities T_b of fibres, and
  /// those of W by T_b and the strain, and by T_b and another integrity, of fibres that soften.
  void find_releases(const Vector& strain) {
    const auto count = std::ptrdiff_t(fibres_.size());
    released_.resize(count);
    by_strain_.resize(count, size_);
    by_integrity_.setZero(count, count);
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      const auto& [dyad, stiffness, drop] = bulk_.fibres_[std::size_t(k)];
      const double force = stiffness * vector(dyad).dot(strain);
      by_strain_.row(k) = force * vector(dyad).transpose();
      released_[k] = force * vector(dyad).dot(strain);
    }
    for (const auto& [sides, of_measure, all] : bulk_.simplices_) {
      const Vector measure = vector(of_measure);
      const double change = measure.dot(strain);
      for (const Simplex& simplex : all) {
        for (int k = 0; k < sides; ++k) {
          const double others = simplex.stiffness * integrity(simplex, sides, k) * change;
          by_strain_.row(simplex.side[k]) += others * measure.transpose();
          released_[simplex.side[k]] += others * change;
          for (int l = 0; l < k && softens(simplex.side[k]); ++l) {
            if (!softens(simplex.side[l])) continue;
            const double rest =
                0.5 * simplex.stiffness * integrity(simplex, sides, k, l) * change * change;
            by_integrity_(simplex.side[k], simplex.side[l]) += rest;
            by_integrity_(simplex.side[l], simplex.side[k]) += rest;
          }
        }
      }
    }
  }

  [[nodiscard]] bool softens(int fibre) const { return fibres_[std::size_t(fibre)].slope != 0.0; }

  /// Equivalent stretch of a fibre of stretch s, after find_releases.
  [[nodiscard]] double release(std::size_t k, double s) const {
    const double released = released_[std::ptrdiff_t(k)];
    const bool drives = s > 0.0 && released > 0.0;
    return drives ? std::sqrt(released / bulk_.fibres_[k].stiffness) : 0.0;
  }

  void set_secants(const State& state) {
    for (std::size_t k = 0; k < fibres_.size(); ++k) {
      fibres_[k] = {0.0, law_of(state, k).integrity(state.largest[k]), 0.0, 0.0};
    }
  }

  /// Product of the integrities of the sides, except two.
  [[nodiscard]] double integrity(const Simplex& of, int sides, int one = -1, int other = -1) const {
    double product = 1.0;
    for (int k = 0; k < sides; ++k) {
      if (k != one && k != other) product *= fibres_[std::size_t(of.side[k])].integrity;
    }
    return product;
  }

  [[nodiscard]] Matrix secant_stiffness() const {
    Matrix result = Matrix::Zero(size_, size_);
    for (std::size_t k = 0; k < fibres_.size(); ++k) {
      const Vector n = vector(bulk_.fibres_[k].dyad);
      result += bulk_.fibres_[k].stiffness * fibres_[k].integrity * n * n.transpose();
    }
    for (const auto& [sides, of_measure, all] : bulk_.simplices_) {
      const Vector measure = vector(of_measure);
      double sum = 0.0;
      for (const Simplex& simplex : all) sum += simplex.stiffness * integrity(simplex, sides);
      result += sum * measure * measure.transpose();
    }
    if (bulk_.zeta_ != 0.0) {
      const Vector sum = dilatational();
      result += 0.5 * bulk_.zeta_ * bulk_.dimension_ / total_ * sum * sum.transpose();
    }
    return result;
  }

  /// One step of Newton's method for strain, stress and, of states, theta. Returns the change of
  /// the strain.
  double improve(State& state, const std::vector<double>& largest) {
    if (bulk_.releases_simplices_) return improve_by_release(state, largest);
    const std::ptrdiff_t unknowns = size_ + (bulk_.zeta_ == 0.0 ? 1 : 2);
    Matrix tangent = Matrix::Zero(unknowns, unknowns);
    Vector residual = Vector::Zero(unknowns);
    auto stiffness = tangent.topLeftCorner(size_, size_);
    auto stress = residual.head(size_);
    for (std::size_t k = 0; k < fibres_.size(); ++k) {
      const Vector n = vector(bulk_.fibres_[k].dyad);
      const double s = n.dot(state.strain), a = bulk_.fibres_[k].stiffness;
      const Driving drive = driving(bulk_.fibres_[k], s, state.theta);
      const bool grows = drive.stretch > largest[k];
      const AnyLaw& law = law_of(state, k);
      const double slope = grows ? law.slope(drive.stretch) : 0.0;
      Strained& fibre = fibres_[k];
      fibre = {s, law.integrity(grows ? drive.stretch : largest[k]), slope * drive.by_stretch,
               slope * drive.by_theta};
      const double force = s + 0.5 * bulk_.zeta_ * state.theta;
      stress += a * fibre.integrity * force * n;
      stiffness += a * (fibre.integrity + force * fibre.slope) * n * n.transpose();
    }
    add_simplices(state, stress, stiffness);
    if (bulk_.zeta_ != 0.0) add_dilatation(state, residual, tangent);
    stress -= state.stress * form_;
    residual[size_] = form_.dot(state.strain) - state.along;
    tangent.block(0, size_, size_, 1) = -form_;
    tangent.block(size_, 0, 1, size_) = form_.transpose();
    Vector change = residual;
    solve_square(entries_of(tangent), {change.data(), std::size_t(change.size())});
    state.strain -= change.head(size_);
    state.stress -= change[size_];
    if (bulk_.zeta_ != 0.0) state.theta -= change[size_ + 1];
    return change.head(size_).norm();
  }

  /// The same with simplices that are released: the equivalent stretches k_b of fibres that soften
  /// are unknown, too, with the equations k_b^2 a_b / 2 = dW/dT_b.
  double improve_by_release(State& state, const std::vector<double>& largest) {
    bool is_new = false;  // a fibre begins or ceases to soften
    const std::vector<std::ptrdiff_t> growing = find_growing(state, largest, is_new);
    const auto count = std::ptrdiff_t(growing.size()), first = size_ + 1;
    LargeMatrix tangent = LargeMatrix::Zero(first + count, first + count);
    LargeVector residual = LargeVector::Zero(first + count);
    const Matrix stiffness = secant_stiffness();
    tangent.topLeftCorner(size_, size_) = stiffness;
    tangent.block(0, size_, size_, 1) = -form_;
    tangent.block(size_, 0, 1, size_) = form_.transpose();
    residual.head(size_) = stiffness * state.strain - state.stress * form_;
    residual[size_] = form_.dot(state.strain) - state.along;
    for (std::ptrdiff_t row = 0; row < count; ++row) {
      const std::ptrdiff_t k = growing[std::size_t(row)], here = first + row;
      const double a = bulk_.fibres_[std::size_t(k)].stiffness, driven = state.driven[k];
      residual[here] = 0.5 * (a * driven * driven - released_[k]);
      tangent.block(here, 0, 1, size_) = -by_strain_.row(k);
      for (std::ptrdiff_t column = 0; column < count; ++column) {
        const std::ptrdiff_t l = growing[std::size_t(column)];
        tangent(here, first + column) = -by_integrity_(k, l) * fibres_[std::size_t(l)].slope;
      }
      tangent(here, here) += a * driven;
      tangent.block(0, here, size_, 1) =
          by_strain_.row(k).transpose() * fibres_[std::size_t(k)].slope;
    }
    solve_square({tangent.data(), std::size_t(tangent.size())},
                 {residual.data(), std::size_t(residual.size())});
    state.strain -= residual.head(size_);
    state.stress -= residual[size_];
    for (std::ptrdiff_t row = 0; row < count; ++row) {
      state.driven[growing[std::size_t(row)]] -= residual[first + row];
    }
    return is_new ? std::numeric_limits<double>::max() : residual.head(size_).norm();
  }

  /// Fibres that are driven beyond what they have been, and releases with the integrities of all.
  std::vector<std::ptrdiff_t> find_growing(State& state, const std::vector<double>& largest,
                                           bool& is_new) {
    if (state.driven.size() == 0) state.driven = LargeVector::Zero(std::ptrdiff_t(fibres_.size()));
    const auto set_integrity = [&](std::size_t k) {
      const double driven = state.driven[std::ptrdiff_t(k)];
      const AnyLaw& law = law_of(state, k);
      fibres_[k].integrity = law.integrity(std::max(driven, largest[k]));
      fibres_[k].slope = driven > 0.0 ? law.slope(driven) : 0.0;
    };
    for (std::size_t k = 0; k < fibres_.size(); ++k) set_integrity(k);
    const std::vector<double> now = driving(state.strain, 0.0);
    std::vector<std::ptrdiff_t> growing;
    for (std::size_t k = 0; k < now.size(); ++k) {
      double& driven = state.driven[std::ptrdiff_t(k)];
      const bool grew = driven > 0.0, grows = now[k] > largest[k];
      if (grows) growing.push_back(std::ptrdiff_t(k));
      if (grows == grew) continue;
      is_new = true;
      driven = grows ? now[k] : 0.0;
      set_integrity(k);
    }
    if (is_new) find_releases(state.strain);
    return growing;
  }

  /// The equation of theta, times sum a / d, and the derivatives by it.
  void add_dilatation(const State& state, Vector& residual, Matrix& tangent) const {
    const std::ptrdiff_t last = size_ + 1;
    residual[last] = total_ / bulk_.dimension_ * state.theta;
    tangent(last, last) = total_ / bulk_.dimension_;
    for (std::size_t k = 0; k < fibres_.size(); ++k) {
      const Vector n = vector(bulk_.fibres_[k].dyad);
      const double a = bulk_.fibres_[k].stiffness;
      const auto& [s, integrity, slope, slope_by_theta] = fibres_[k];
      const double force = s + 0.5 * bulk_.zeta_ * state.theta;
      residual[last] -= a * integrity * s;
      tangent.block(0, last, size_, 1) +=
          a * (0.5 * bulk_.zeta_ * integrity + force * slope_by_theta) * n;
      tangent.block(last, 0, 1, size_) -= a * (integrity + s * slope) * n.transpose();
      tangent(last, last) -= a * s * slope_by_theta;
    }
  }

  void add_simplices(const State& state, auto& stress, auto& stiffness) {
    for (const auto& [sides, of_measure, all] : bulk_.simplices_) {
      const Vector measure = vector(of_measure);
      const double change = measure.dot(state.strain);
      double sum = 0.0;
      slopes_.assign(fibres_.size(), 0.0);  // derivatives of the sum by the fibres' stretches
      for (const Simplex& simplex : all) {
        const double product = simplex.stiffness * integrity(simplex, sides);
        sum += product;
        if (product == 0.0 || product == simplex.stiffness) continue;
        for (int k = 0; k < sides; ++k) {
          const auto side = std::size_t(simplex.side[k]);
          slopes_[side] += product / fibres_[side].integrity * fibres_[side].slope;
        }
      }
      stress += sum * change * measure;
      stiffness += sum * measure * measure.transpose();
      for (std::size_t k = 0; k < slopes_.size(); ++k) {
        if (slopes_[k] == 0.0) continue;
        stiffness += change * slopes_[k] * measure * vector(bulk_.fibres_[k].dyad).transpose();
      }
    }
  }

  /// Fallback where Newton's method finds no state, as for laws that jump: damage grows in secant
  /// steps until it suffices.
  [[nodiscard]] State by_secants(double along, const State& since) {
    State state = since;
    state.along = along;
    constexpr int most_iterations = 3000;
    for (int k = 0; k < most_iterations; ++k) {
      set_secants(state);
      const Vector of_unit = strain_of_form(secant_stiffness());
      state.stress = along / form_.dot(of_unit);
      // No resistance is left.
      if (!(state.stress > 1e-6 * since.stress) || has_stiffened(state, since)) {
        state.stress = 0.0;
        return state;
      }
      state.strain = state.stress * of_unit;
      state.theta = dilatation(state.strain);
      const std::vector<double> before = state.largest;
      grow(state);
      double growth = 0.0;
      for (std::size_t b = 0; b < before.size(); ++b) {
        const AnyLaw& law = law_of(state, b);
        growth = std::max(growth, law.integrity(before[b]) - law.integrity(state.largest[b]));
      }
      if (growth < tolerance) break;
    }
    return state;
  }

  const BulkPull& bulk_;
  const AnyLaw& law_;
  const MovingOnsets* moving_;  // null: onsets stay
  double work_ = 0.0;           // of the law, where they move
  std::ptrdiff_t size_;
  Vector form_;
  double drop_;         // 1: bonds are brittle
  double total_ = 0.0;  // sum a
  std::vector<Strained> fibres_;
  std::vector<double> slopes_;
  LargeVector released_;  // see find_releases
  LargeMatrix by_strain_, by_integrity_;
};

BulkPull::BulkPull(const BondSetting& setting, double micromodulus, double lame_ratio)
    : dimension_(setting.dimension), zeta_(2.0 * (lame_ratio - 1.0) / (setting.dimension + 2)) {
  if (!setting.lattice) {
    spread_evenly(micromodulus * setting.moment(1));
    return;
  }
  const BulkBonds bulk(setting);
  Numbers numbers;
  const double per_moment = 0.5 * zeta_ * dimension_ / bulk.moment(1);
  for (const BulkBonds::Bond& bond : bulk.bonds()) {
    const double share = 0.5 * bond.weight * bond.length;  // of one of the two
    const std::size_t number =
        zeta_ == 0.0 ? std::size_t(numbers.of(bond.direction)) : fibres_.size();
    if (number == fibres_.size()) {
      fibres_.push_back({projector(bond.direction, dimension_), 0.0, per_moment * share});
    }
    fibres_[number].stiffness += micromodulus * share;
  }
  if (fibres_.size() > most_directions) {
    spread_evenly(micromodulus * bulk.moment(1));
    return;
  }
  // A correction by energy along the body's axes takes the cubic symmetry from a cubic lattice that
  // is turned about one axis.
  const bool repeats =
      setting.lattice->spacing.is_square() && (dimension_ < 3 || setting.lattice->angle == 0.0);
  if (repeats || dimension_ == 1) {
    directions_ = sector_directions(dimension_);
    for (const Coordinates& corner : sector_corners(dimension_)) directions_.push_back({corner, 0});
  } else {
    const std::vector<Coordinates> even = even_directions(dimension_, dimension_ == 2 ? 24 : 60);
    for (const Coordinates& n : even) directions_.push_back({n, 1.0 / double(even.size())});
  }
  for (WeightedDirection& of : directions_) of.normal = bulk.turned(of.normal);
}

BulkPull::BulkPull(const Kernel& kernel, double spacing, const CpdConstants& constants,
                   bool by_release)
    : dimension_(kernel.dimension),
      releases_simplices_(by_release && (constants.c2 != 0.0 || constants.c3 != 0.0)),
      directions_(sector_directions(kernel.dimension)) {
  for (const Coordinates& corner : sector_corners(dimension_)) directions_.push_back({corner, 0});
  const BulkNeighbourhood bulk =
      bulk_neighbourhood(dimension_, spacing, kernel.horizon, kernel.cross_section);
  const LatticeBall ball(dimension_, spacing, kernel.horizon);
  Numbers numbers;
  const auto number_of = [&](const Coordinates& arm) {
    const Coordinates n = unit(arm),
                      in_spacings{arm[0] / spacing, arm[1] / spacing, arm[2] / spacing};
    const int number = numbers.of(releases_simplices_ ? in_spacings : n);
    if (std::size_t(number) == fibres_.size()) fibres_.push_back({projector(n, dimension_), 0.0});
    return number;
  };
  // w = V V1, 2 V V2 and 6 V V3, see effective_volumes; one of each two opposite bonds counts.
  const double of_bonds = 0.5 * bulk.volume / double(bulk.neighbours) * constants.c1;
  for (const Coordinates& arm : ball.arms()) {
    const double length = std::sqrt(dot(arm, arm));
    fibres_[std::size_t(number_of(arm))].stiffness +=
        of_bonds * length * kernel.influence_at(length);
  }
  std::map<Tensor, std::map<std::array<int, 6>, double>> found;  // stiffnesses
  const auto add = [&](std::array<int, 6> side, int sides, const Tensor& measure,
                       double stiffness) {
    std::sort(side.begin(), side.begin() + sides);
    std::fill(side.begin() + sides, side.end(), -1);
    found[measure][side] += stiffness;
  };
  constexpr Coordinates here{};
  Tensor identity{};
  for (int c = 0; c < dimension_; ++c) identity[std::size_t(c)] = 1.0;
  if (constants.c2 != 0.0) {
    const double weight = 2.0 * std::pow(bulk.volume, 2) / double(bulk.pairs) * constants.c2;
    ball.for_each_triangle([&](const Coordinates& b, const Coordinates& c, double area) {
      const Tensor measure = dimension_ == 2
                                 ? identity
                                 : sum(identity, projector(unit(cross(b, c)), dimension_, -1.0));
      add({number_of(b), number_of(c), number_of(minus(b, c))}, 3, measure,
          weight * area * influence_of_sides(kernel, std::array{here, b, c}));
    });
  }
  if (constants.c3 != 0.0) {
    const double weight = 6.0 * std::pow(bulk.volume, 3) / double(bulk.triplets) * constants.c3;
    ball.for_each_tetrahedron(
        [&](const Coordinates& b, const Coordinates& c, const Coordinates& d, double volume) {
          add({number_of(b), number_of(c), number_of(d), number_of(minus(b, c)),
               number_of(minus(b, d)), number_of(minus(c, d))},
              6, identity, weight * volume * influence_of_sides(kernel, std::array{here, b, c, d}));
        });
  }
  for (const auto& [measure, of_sides] : found) {
    // In 3D triangles and tetrahedra never have the same measure.
    const int sides = of_sides.begin()->first[3] < 0 ? 3 : 6;
    simplices_.push_back({sides, measure, {}});
    for (const auto& [side, stiffness] : of_sides) {
      simplices_.back().all.push_back({side, stiffness});
    }
  }
}

/// @param first_moment m_1 of all bonds, times c
void BulkPull::spread_evenly(double first_moment) {
  fibres_.clear();
  const auto add = [&](const Coordinates& n) {
    fibres_.push_back({projector(n, dimension_), 0.0});
  };
  constexpr double pi = std::numbers::pi;
  if (dimension_ == 1) add({1, 0, 0});
  constexpr int in_plane = 180, rings = 60, in_ring = 6;
  for (int k = 0; dimension_ == 2 && k < in_plane; ++k) {
    add({std::cos(pi * (k + 0.5) / in_plane), std::sin(pi * (k + 0.5) / in_plane), 0.0});
  }
  for (int k = 0; dimension_ == 3 && k < rings * in_ring; ++k) {
    const double height = (k / in_ring + 0.5) / rings, ring = std::sqrt(1.0 - height * height);
    const double angle = 2.0 * pi * (k % in_ring) / in_ring;
    add({height, ring * std::cos(angle), ring * std::sin(angle)});
  }
  for (Fibre& fibre : fibres_) fibre.stiffness = 0.5 * first_moment / double(fibres_.size());
  directions_ = {{{1.0, 0.0, 0.0}, 1.0}};
}

std::vector<BulkPull::Form> BulkPull::forms(Loading loading) const {
  if (dimension_ == 1) {
    return {{projector({1, 0, 0}, 1, loading == Loading::compression ? -1.0 : 1.0), 1.0}};
  }
  Tensor identity{};
  for (int c = 0; c < dimension_; ++c) identity[std::size_t(c)] = 1.0;
  if (loading == Loading::biaxial && dimension_ == 2) return {{identity, 1.0}};
  std::vector<Form> result;
  for (const auto& [n, weight] : directions_) {
    const Tensor along = projector(n, dimension_), against = projector(n, dimension_, -1.0);
    if (loading == Loading::tension) result.push_back({along, weight});
    if (loading == Loading::compression) result.push_back({against, weight});
    if (loading == Loading::biaxial) result.push_back({sum(identity, against), weight});
    if (loading != Loading::shear) continue;
    const Coordinates t = normal_to(n, dimension_);
    result.push_back(
        {sum(along, projector(t, dimension_, -1.0)), dimension_ == 2 ? weight : 0.5 * weight});
    if (dimension_ == 2) continue;
    const Coordinates b = cross(n, t);
    const Coordinates between = unit({t[0] + b[0], t[1] + b[1], t[2] + b[2]});
    result.push_back({sum(along, projector(between, dimension_, -1.0)), 0.5 * weight});
  }
  return result;
}

double BulkPull::onset(const Tensor& form, const AnyLaw& law, const MovingOnsets* moving) const {
  return Equilibrium(*this, form, law, moving).first().stress;
}

/// Follows the strain in steps of 2 %, and around each peak in finer and finer ones, until the
/// stress is below 0.9 of the peak.
double BulkPull::peak(const Tensor& form, const AnyLaw& law, const MovingOnsets* moving) const {
  constexpr double coarsest = 0.02, finest = 1e-10, finer = 0.125;
  constexpr double left = 0.9;  // of the peak: a body that has lost a tenth breaks
  Equilibrium equilibrium(*this, form, law, moving);
  const State first = equilibrium.first();
  double farthest = law.critical();
  for (const AnyLaw& of : first.laws) farthest = std::max(farthest, of.critical());
  double best = first.stress;
  const auto march = [&](const auto& again, State here, double step, double end) -> void {
    State before = here;
    constexpr int most_steps = 2000;
    for (int k = 0; k < most_steps && here.along < end; ++k) {
      State there = equilibrium.at(here.along * (1.0 + step), here);
      const bool is_summit = before.stress <= here.stress && here.stress > there.stress;
      if (is_summit && here.stress > 0.98 * best && step > finest) {
        again(again, before, finer * step, there.along);
      }
      best = std::max(best, there.stress);
      if (there.stress < left * best) return;
      // Triangles that are left under compression would carry more and more as the strain grows.
      if (*std::ranges::max_element(there.largest) > 4.0 * farthest) return;
      before = std::move(here);
      here = std::move(there);
    }
  };
  if (best > 0.0 && std::isfinite(best))
    march(march, first, coarsest, std::numeric_limits<double>::infinity());
  return best;
}

template <class Quantity>
DirectionalSpread BulkPull::over(Loading loading, const Quantity& of_form) const {
  DirectionalSpread result{0.0, std::numeric_limits<double>::infinity(), 0.0};
  for (const auto& [form, weight] : forms(loading)) {
    const double value = of_form(form);
    if (weight > 0.0) result.mean += weight * value;
    result.least = std::min(result.least, value);
    result.most = std::max(result.most, value);
  }
  return result;
}

DirectionalSpread BulkPull::peak(Loading loading, const AnyLaw& law) const {
  return over(loading, [&](const Tensor& form) { return peak(form, law); });
}

bool BulkPull::is_quick() const {
  constexpr std::size_t most_simplices = 10'000;
  std::size_t count = 0;
  for (const Simplices& of : simplices_) count += of.all.size();
  return count <= most_simplices;
}

template <class Quantity>
double BulkPull::mean(const std::array<double, 2>& principal, const Quantity& of_form) const {
  double mean = 0.0;
  for (const auto& [n, weight] : directions_) {
    if (weight == 0.0) continue;
    mean += weight * of_form(sum(projector(n, dimension_, principal[0]),
                                 projector(normal_to(n, dimension_), dimension_, principal[1])));
  }
  return mean;
}

double BulkPull::peak(const std::array<double, 2>& principal, const AnyLaw& law,
                      const MovingOnsets* moving) const {
  return mean(principal, [&](const Tensor& form) { return peak(form, law, moving); });
}

double BulkPull::onset(const std::array<double, 2>& principal, const AnyLaw& law,
                       const MovingOnsets* moving) const {
  return mean(principal, [&](const Tensor& form) { return onset(form, law, moving); });
}

DirectionalSpread BulkPull::onset(Loading loading, const AnyLaw& law) const {
  return over(loading, [&](const Tensor& form) { return onset(form, law); });
}

}  // namespace peristat
