#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "assembly/operators/block_pattern.hpp"
#include "assembly/terms/states/state_network.hpp"
#include "src/core/threads.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {

/// The sums of StateTerm. Every point gathers its own contributions in one order: results are the
/// same for any number of threads.
template <int D>
class StateKernels {
 public:
  using V = Vector<D, double>;

  StateKernels(const Points& points, const Bonds& bonds, const StateShares& shares,
               const StateNetwork& network, int threads)
      : reference_(points.reference),
        bonds_(bonds),
        shares_(shares),
        network_(network),
        threads_(threads),
        kernel_(shares.kernel) {
    const auto count = points.volume.size();
    for (std::vector<double>* per_point :
         {&dilatational_, &deviatoric_, &inverse_moment_, &pressure_, &energy_}) {
      per_point->assign(count, 0.0);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [lambda, mu] = shares.constants[i];
      // A point without neighbours has no states.
      inverse_moment_[i] = shares.moment[i] > 0.0 ? 1.0 / shares.moment[i] : 0.0;
      dilatational_[i] = points.volume[i] * (lambda - mu);
      deviatoric_[i] = points.volume[i] * D * (D + 2) * mu * inverse_moment_[i];
    }
  }

  /// Multiplies the kernel's shares by integrity(bond).
  template <class Integrity>
  void scale(const Integrity& integrity) {
    if (left_.empty()) left_.resize(shares_.kernel.size());
    const auto count = Offset(left_.size());
    for_ranges(count, [&](Offset bond) {
      left_[std::size_t(bond)] = shares_.kernel[std::size_t(bond)] * integrity(bond);
    });
    kernel_ = left_;
  }

  /// Finds the pressure V (lambda - mu) theta d / M and the energy of each point; returns the sum
  /// of the energies.
  double find_states(std::span<const double> u) {
    for_ranges(Index(energy_.size()), [&](Index i) {
      const V here = of(u, i);
      double sum = 0.0, squares = 0.0;
      for_neighbours(i, [&](Index j, Offset bond) {
        const V xi = arm(i, j);
        const double along = dot<D>(xi, minus<D>(of(u, j), here));
        const double share = kernel_[std::size_t(bond)] * along;
        sum += share;
        squares += share * along / dot<D>(xi, xi);
      });
      const double theta = D * inverse_moment_[i] * sum;
      pressure_[i] = dilatational_[i] * theta * D * inverse_moment_[i];
      energy_[i] = 0.5 * (dilatational_[i] * theta * theta + deviatoric_[i] * squares);
    });
    double total = 0.0;
    for (const double energy : energy_) total += energy;
    return total;
  }

  [[nodiscard]] std::span<const double> energies() const { return energy_; }

  /// State before bonds fail, which their losses depend on.
  struct Before {
    std::vector<double> kernel, pressure;
  };
  [[nodiscard]] Before remembered() const { return {{kernel_.begin(), kernel_.end()}, pressure_}; }

  /// Returns what Pi loses with bonds: the sum of delta kappa [(b_i + b_j) (xi . eta)^2 / (2 r^2) +
  /// (p_i + p_j) xi . eta], b = V d (d + 2) mu / M and p the mean of the pressures before and
  /// after, each bond weighted by share(i, bond, stretch). After find_states of the same field.
  template <class Share>
  [[nodiscard]] double losses(std::span<const double> u, const Before& before,
                              const Share& share) const {
    double sum = 0.0;
    for (Index i = 0; i < bonds_.points(); ++i) {
      for (Offset bond = bonds_.offset[i]; bond < bonds_.offset[i + 1]; ++bond) {
        const double lost = before.kernel[std::size_t(bond)] - kernel_[std::size_t(bond)];
        if (lost == 0.0) continue;
        const Index j = bonds_.partner[bond];
        const V xi = arm(i, j), eta = minus<D>(of(u, j), of(u, i)), now = plus<D>(xi, eta);
        const double squared = dot<D>(xi, xi), along = dot<D>(xi, eta);
        const double pressure = 0.5 * (before.pressure[std::size_t(i)] + pressure_[i] +
                                       before.pressure[std::size_t(j)] + pressure_[j]);
        const double density = 0.5 * (deviatoric_[i] + deviatoric_[j]) * along * along / squared;
        const double stretch = std::sqrt(dot<D>(now, now) / squared) - 1.0;
        sum += lost * (density + pressure * along) * share(i, bond, stretch);
      }
    }
    return sum;
  }

  /// dPi/du, after find_states of the same field.
  void write_forces(std::span<const double> u, std::span<double> force, bool onto) const {
    for_ranges(Index(energy_.size()), [&](Index i) {
      const V here = of(u, i);
      V sum{};
      for_neighbours(i, [&](Index j, Offset bond) {
        const V xi = arm(i, j);
        const double stretch = dot<D>(xi, minus<D>(of(u, j), here)) / dot<D>(xi, xi);
        const double pull =
            kernel_[std::size_t(bond)] *
            (pressure_[i] + pressure_[j] + (deviatoric_[i] + deviatoric_[j]) * stretch);
        for (int c = 0; c < D; ++c) sum[c] -= pull * xi[c];
      });
      double* to = &force[std::size_t(i) * D];
      for (int c = 0; c < D; ++c) to[c] = onto ? to[c] + sum[c] : sum[c];
    });
  }

  /// Adds V dw/dH of the points, w their energy densities and H a displacement gradient that is
  /// uniform in a neighbourhood, after find_states of the same field.
  void add_virials(std::span<const double> u, std::span<double> virials) const {
    for_ranges(Index(energy_.size()), [&](Index i) {
      const V here = of(u, i);
      double* to = &virials[std::size_t(i) * D * D];
      for_neighbours(i, [&](Index j, Offset bond) {
        const V xi = arm(i, j);
        const double stretch = dot<D>(xi, minus<D>(of(u, j), here)) / dot<D>(xi, xi);
        const double pull = kernel_[std::size_t(bond)] * (pressure_[i] + deviatoric_[i] * stretch);
        for (int r = 0; r < D; ++r) {
          for (int c = 0; c < D; ++c) to[r * D + c] += pull * xi[r] * xi[c];
        }
      });
    });
  }

  /// Adds d2Pi/du2, row by row: two points j and k with a common neighbour i get the block
  /// V (lambda - mu) g_j g_k from it, g_j = (d/M_i) kappa_ij xi and minus the sum of these for i
  /// itself.
  void add_tangent(const BlockPattern& pattern, std::span<double> off_diagonal,
                   std::span<double> diagonal) const {
    const Index count = Index(energy_.size());
    const std::vector<double> own = own_gradients();
    run_on_threads(threads_, [&](int thread) {
      std::vector<Offset> place(std::size_t(count), -1);
      const Index first = Index(std::int64_t(count) * thread / threads_);
      const Index last = Index(std::int64_t(count) * (thread + 1) / threads_);
      for (Index j = first; j < last; ++j) {
        for (Offset b = pattern.offset[j]; b < pattern.offset[j + 1]; ++b) {
          place[std::size_t(pattern.partner[b])] = b;
        }
        double* const block_of_point = &diagonal[std::size_t(j) * D * D];
        const auto block_with = [&](Index k) {
          return k == j ? block_of_point
                        : &off_diagonal[std::size_t(place[std::size_t(k)]) * D * D];
        };
        add_centre(j, j, of(own, j), own, block_with);
        for_neighbours(j, [&](Index i, Offset bond) {
          const V xi = arm(i, j);
          const double share = kernel_[std::size_t(bond)];
          if (share == 0.0) return;
          add_centre(i, j, scaled<D>(D * inverse_moment_[i] * share, xi), own, block_with);
          const double stiffness = share * (deviatoric_[i] + deviatoric_[j]) / dot<D>(xi, xi);
          add_outer(stiffness, xi, xi, block_of_point);
          if (i > j) add_outer(-stiffness, xi, xi, block_with(i));
        });
      }
    });
  }

 private:
  template <class Count, class Body>
  void for_ranges(Count count, const Body& body) const {
    run_on_threads(threads_, [&](int thread) {
      const auto first = Count(std::int64_t(count) * thread / threads_);
      const auto last = Count(std::int64_t(count) * (thread + 1) / threads_);
      for (Count i = first; i < last; ++i) body(i);
    });
  }

  [[nodiscard]] static V of(std::span<const double> field, Index i) {
    V at;
    for (int c = 0; c < D; ++c) at[c] = field[std::size_t(i) * D + std::size_t(c)];
    return at;
  }
  [[nodiscard]] V arm(Index i, Index j) const {
    return minus<D>(of(reference_, j), of(reference_, i));
  }

  /// Calls visit(neighbour, bond), neighbours ascending.
  template <class Visit>
  void for_neighbours(Index i, const Visit& visit) const {
    for (Offset e = network_.offset[i]; e < network_.offset[i + 1]; ++e) {
      visit(network_.lower[e], network_.bond[e]);
    }
    for (Offset b = bonds_.offset[i]; b < bonds_.offset[i + 1]; ++b) visit(bonds_.partner[b], b);
  }

  static void add_outer(double factor, const V& a, const V& b, double* block) {
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) block[r * D + c] += factor * a[r] * b[c];
    }
  }

  /// Adds the blocks of theta_i between j and the points k >= j.
  template <class BlockWith>
  void add_centre(Index i, Index j, const V& g_j, const std::vector<double>& own,
                  const BlockWith& block_with) const {
    const double stiffness = dilatational_[i];
    if (stiffness == 0.0) return;
    if (i >= j) add_outer(stiffness, g_j, of(own, i), block_with(i));
    for_neighbours(i, [&](Index k, Offset bond) {
      if (k < j || kernel_[std::size_t(bond)] == 0.0) return;
      const double share = stiffness * D * inverse_moment_[i] * kernel_[std::size_t(bond)];
      add_outer(share, g_j, arm(i, k), block_with(k));
    });
  }

  /// dtheta_i/du_i
  [[nodiscard]] std::vector<double> own_gradients() const {
    std::vector<double> own(energy_.size() * D);
    for_ranges(Index(energy_.size()), [&](Index i) {
      V sum{};
      for_neighbours(i, [&](Index j, Offset bond) {
        const V xi = arm(i, j);
        for (int c = 0; c < D; ++c) sum[c] -= kernel_[std::size_t(bond)] * xi[c];
      });
      for (int c = 0; c < D; ++c) {
        own[std::size_t(i) * D + std::size_t(c)] = D * inverse_moment_[i] * sum[c];
      }
    });
    return own;
  }

  const std::vector<double>& reference_;
  const Bonds& bonds_;
  const StateShares& shares_;
  const StateNetwork& network_;
  int threads_;
  std::span<const double> kernel_;  // reduced by damage
  std::vector<double> left_;
  std::vector<double> dilatational_;  // V (lambda - mu) [J]
  std::vector<double> deviatoric_;    // V d (d + 2) mu / M
  std::vector<double> inverse_moment_;
  std::vector<double> pressure_, energy_;
};

}  // namespace peristat
