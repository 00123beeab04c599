#include "assembly/terms/collocation/collocation_operator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "src/core/threads.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// A sum of vectors that is less than this share of the sum of their lengths has no direction.
constexpr double no_direction = 1e-9;

/// Eigenvalues of a shape tensor below this share of the largest count as zero: bonds along one
/// line determine nothing across it.
constexpr double flat_shape = 1e-10;

/// Position of each entry in storage of a symmetric tensor of third order.
template <int D>
struct ThirdOrder {
  std::array<std::array<std::array<int, D>, D>, D> place{};
  constexpr ThirdOrder() {
    int next = 0;
    for (int a = 0; a < D; ++a) {
      for (int b = a; b < D; ++b) {
        for (int c = b; c < D; ++c, ++next) {
          place[a][b][c] = place[a][c][b] = place[b][a][c] = next;
          place[b][c][a] = place[c][a][b] = place[c][b][a] = next;
        }
      }
    }
  }
};
template <int D>
constexpr ThirdOrder<D> third_order{};

/// S : A
template <int D>
Vector<D, double> contracted(const double* third, const Matrix<D, double>& tensor) {
  Vector<D, double> result{};
  for (int a = 0; a < D; ++a) {
    for (int b = 0; b < D; ++b) {
      for (int c = 0; c < D; ++c) {
        result[a] += third[third_order<D>.place[a][b][c]] * tensor[b][c];
      }
    }
  }
  return result;
}

/// Pseudo-inverse of a positive semidefinite matrix, written row by row.
template <int D>
void write_inverse(const Matrix<D, double>& shape, double* inverse) {
  const SymmetricSpectrum<D> spectrum = symmetric_spectrum<D>(shape.front().data());
  std::fill_n(inverse, D * D, 0.0);
  for (int k = 0; k < D; ++k) {
    const double value = spectrum.values[k];
    if (!(value > flat_shape * spectrum.values[D - 1])) continue;
    const auto& vector = spectrum.vectors[k];
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) inverse[r * D + c] += vector[r] * vector[c] / value;
    }
  }
}

/// Share of sum k r^2 below which a point is torn: a straight crack leaves half of the ball.
constexpr double torn_share = 0.4;

double harmonic_mean(double a, double b) {
  if (a == b) return a;
  const double sum = a + b;
  return sum != 0.0 ? 2.0 * a * b / sum : 0.0;
}

}  // namespace

template <int D>
struct CollocationOperator::Kernels {
  using V = Vector<D, double>;
  using M = Matrix<D, double>;
  static constexpr double bond_factor = 2.0 * D * (D + 2);  // C_beta

  CollocationOperator& op;
  const CollocationNetwork& net;
  const LameConstants& material;

  explicit Kernels(CollocationOperator& of)
      : op(of), net(*of.setting_.network), material(*of.setting_.constants) {}

  template <class Body>
  void for_points(const Body& body) const {
    for_first(net.points(), body);
  }
  /// On a part of a body only the points that its rank owns: data of others are incomplete here.
  template <class Body>
  void for_owned(const Body& body) const {
    for_first(op.owned(), body);
  }
  template <class Body>
  void for_first(Index count, const Body& body) const {
    run_on_threads(op.threads_, [&](int thread) {
      const Index first = Index(std::int64_t(count) * thread / op.threads_);
      const Index last = Index(std::int64_t(count) * (thread + 1) / op.threads_);
      for (Index i = first; i < last; ++i) body(i);
    });
  }

  [[nodiscard]] V place(Index i) const {
    V at;
    for (int c = 0; c < D; ++c) at[c] = op.reference_[std::size_t(i) * D + c];
    return at;
  }
  [[nodiscard]] static V of(std::span<const double> field, Index i) {
    V at;
    for (int c = 0; c < D; ++c) at[c] = field[std::size_t(i) * D + c];
    return at;
  }

  /// Calls visit(entry, j, k, xi) for the unbroken neighbours.
  template <class Visit>
  void for_neighbours(Index i, const Visit& visit) const {
    const double* share = op.share_.empty() ? net.kernel_share.data() : op.share_.data();
    const V here = place(i);
    for (Offset e = net.offset[i]; e < net.offset[i + 1]; ++e) {
      if (share[e] == 0.0) continue;
      const Index j = net.neighbour[e];
      visit(e, j, share[e], minus<D>(place(j), here));
    }
  }

  [[nodiscard]] V shaped(Index i, const V& xi) const {
    const double* inverse = &op.shape_[std::size_t(i) * D * D];
    V result{};
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) result[r] += inverse[r * D + c] * xi[c];
    }
    return result;
  }

  [[nodiscard]] double mean_mu(Index i, Index j) const {
    return harmonic_mean(material.mu[i], material.mu[j]);
  }
  [[nodiscard]] double mean_lambda(Index i, Index j) const {
    return harmonic_mean(material.lambda[i], material.lambda[j]);
  }

  /// @param shape d sum k xi xi of what is unbroken
  [[nodiscard]] bool is_torn(Index i, const M& shape) const {
    if (op.share_.empty()) return false;
    double left = 0.0, had = 0.0;
    for (int c = 0; c < D; ++c) left += shape[c][c] / D;
    const V here = place(i);
    for (Offset e = net.offset[i]; e < net.offset[i + 1]; ++e) {
      const V xi = minus<D>(place(net.neighbour[e]), here);
      had += net.kernel_share[e] * dot<D>(xi, xi);
    }
    return left < torn_share * had;
  }

  void use_known_normal(Index i, double* normal) const {
    if (net.normals.empty()) return;
    const double* known = &net.normals[std::size_t(i) * D];
    if (std::any_of(known, known + D, [](double c) { return c != 0.0; })) {
      std::copy_n(known, D, normal);
    }
  }

  void update_point(Index i) const {
    M shape{};
    V out{};
    double lengths = 0.0;
    for_neighbours(i, [&](Offset, Index, double k, const V& xi) {
      add_outer<D>(double(D) * k, xi, xi, shape);
      const double r = std::sqrt(dot<D>(xi, xi));
      for (int c = 0; c < D; ++c) out[c] -= k * r * xi[c];
      lengths += std::abs(k) * r * r;
    });
    op.torn_[i] = is_torn(i, shape);
    if (op.torn_[i]) {
      shape = {};
      for (int c = 0; c < D; ++c) shape[c][c] = 1.0;
    }
    write_inverse<D>(shape, &op.shape_[std::size_t(i) * D * D]);
    double* t = &op.dilation_[std::size_t(net.offset[i]) * D];
    std::fill_n(t, std::size_t(net.offset[i + 1] - net.offset[i]) * D, 0.0);
    for_neighbours(i, [&](Offset e, Index, double k, const V& xi) {
      const V direction = scaled<D>(double(D) * k, shaped(i, xi));
      std::copy_n(direction.begin(), D, t + (e - net.offset[i]) * D);
    });
    constexpr int entries = third_moment_entries(D);
    double* first = &op.first_[std::size_t(i) * D];
    double* third = &op.third_[std::size_t(i) * entries];
    std::copy_n(&net.missing_first[std::size_t(i) * D], D, first);
    std::copy_n(&net.missing_third[std::size_t(i) * entries], entries, third);
    bool is_whole = net.is_whole[i] != 0, has_lost_bonds = false;
    if (!op.share_.empty()) {
      const V here = place(i);
      for (Offset e = net.offset[i]; e < net.offset[i + 1]; ++e) {
        if (op.share_[e] != 0.0) continue;
        const V xi = minus<D>(place(net.neighbour[e]), here);
        add_missing<D>(xi.data(), net.kernel_share[e], first, third);
        is_whole = false;
        has_lost_bonds = true;
      }
    }
    double* normal = &op.normal_[std::size_t(i) * D];
    const double size = std::sqrt(dot<D>(out, out));
    op.whole_[i] = is_whole;
    const bool has_normal = !is_whole && size > no_direction * lengths;
    for (int c = 0; c < D; ++c) normal[c] = has_normal ? out[c] / size : 0.0;
    if (!has_lost_bonds) use_known_normal(i, normal);
  }

  /// B(theta, T)
  [[nodiscard]] V missing_force(Index i, double theta, const V& traction) const {
    const double lambda = material.lambda[i], mu = material.mu[i];
    const V n = of(op.normal_, i);
    if (op.torn_[i]) theta = 0.0;
    V force;
    for (int c = 0; c < D; ++c) {
      force[c] = -2.0 * D * (lambda - mu) * theta * op.first_[std::size_t(i) * D + c];
    }
    if (dot<D>(n, n) == 0.0) return force;
    const double normal_traction = dot<D>(traction, n);
    const double along = 0.5 * (normal_traction - lambda * theta);
    const double across =
        D == 2 ? 0.5 * ((lambda + 2.0 * mu) * theta - normal_traction) : 0.5 * (mu * theta - along);
    M even{}, odd{};
    for (int r = 0; r < D; ++r) {
      const double tangential = traction[r] - normal_traction * n[r];
      for (int c = 0; c < D; ++c) {
        even[r][c] += (along - across) * n[r] * n[c] + (r == c ? across : 0.0);
        odd[r][c] += 0.5 * tangential * n[c];
        odd[c][r] += 0.5 * tangential * n[c];
      }
    }
    const double* third = &op.third_[std::size_t(i) * third_moment_entries(D)];
    const V of_even = contracted<D>(third, even), of_odd = contracted<D>(third, odd);
    V q = plus<D>(of_even, of_odd);
    if (op.setting_.form == TractionForm::paper) {
      const double from_even = dot<D>(n, of_even), from_odd = dot<D>(n, of_odd);
      for (int c = 0; c < D; ++c) q[c] = (from_even - from_odd) * n[c] + of_odd[c];
    }
    for (int c = 0; c < D; ++c) force[c] -= bond_factor * q[c];
    return force;
  }

  /// True if the force on a point has a part of missing_shear.
  [[nodiscard]] bool has_missing_shear(Index i) const {
    if (D == 2 || op.setting_.form == TractionForm::paper || op.torn_[i]) return false;
    const V n = of(op.normal_, i);
    return dot<D>(n, n) != 0.0;
  }

  /// Part of B that stems from the tangential deviator of a nonlocal strain.
  [[nodiscard]] V missing_shear(Index i, const M& gradient) const {
    const V n = of(op.normal_, i);
    V along{};  // E n
    M strain;
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) {
        strain[r][c] = 0.5 * (gradient[r][c] + gradient[c][r]);
        along[r] += strain[r][c] * n[c];
      }
    }
    const double normal = dot<D>(along, n);
    double trace = -normal;
    for (int c = 0; c < D; ++c) trace += strain[c][c];
    M deviator;
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) {
        deviator[r][c] = strain[r][c] - along[r] * n[c] - n[r] * along[c] +
                         (normal + 0.5 * trace) * n[r] * n[c] - (r == c ? 0.5 * trace : 0.0);
      }
    }
    const double* third = &op.third_[std::size_t(i) * third_moment_entries(D)];
    return scaled<D>(-bond_factor * material.mu[i], contracted<D>(third, deviator));
  }

  /// Calls visit(l, block): missing_shear of the gradient of u is sum_l block (u_l - u_i).
  template <class Visit>
  void for_missing_shear(Index i, const Visit& visit) const {
    if (!has_missing_shear(i)) return;
    for_dilatation(i, [&](Index l, const V& t) {
      M block;
      for (int c = 0; c < D; ++c) {
        M gradient{};
        gradient[c] = t;
        const V column = missing_shear(i, gradient);
        for (int r = 0; r < D; ++r) block[r][c] = column[r];
      }
      visit(l, block);
    });
  }

  [[nodiscard]] double theta_at(std::span<const double> u, Index i) const {
    const V here = of(u, i);
    const double* t = &op.dilation_[std::size_t(net.offset[i]) * D];
    double theta = 0.0;
    for (Offset e = net.offset[i]; e < net.offset[i + 1]; ++e, t += D) {
      const double* there = &u[std::size_t(net.neighbour[e]) * D];
      for (int c = 0; c < D; ++c) theta += t[c] * (there[c] - here[c]);
    }
    return theta;
  }

  [[nodiscard]] V force_at(std::span<const double> u, std::span<const double> traction,
                           Index i) const {
    const V here = of(u, i);
    const double lambda = material.lambda[i], mu = material.mu[i], theta = op.theta_[i];
    V force{};
    for_neighbours(i, [&](Offset, Index j, double k, const V& xi) {
      const double mu_ij = op.is_uniform_ ? mu : harmonic_mean(mu, material.mu[j]);
      const double lambda_ij = op.is_uniform_ ? lambda : harmonic_mean(lambda, material.lambda[j]);
      const double squared = dot<D>(xi, xi);
      const double stretch = dot<D>(xi, minus<D>(of(u, j), here)) / squared;
      const double factor =
          -k * (D * (lambda_ij - mu_ij) * (theta + op.theta_[j]) + bond_factor * mu_ij * stretch);
      for (int c = 0; c < D; ++c) force[c] += factor * xi[c];
    });
    const V pulled = traction.empty() ? V{} : of(traction, i);
    force = plus<D>(force, missing_force(i, theta, pulled));
    return has_missing_shear(i) ? plus<D>(force, missing_shear(i, gradient_at(u, i))) : force;
  }

  void forces(std::span<const double> u, std::span<const double> traction,
              std::span<double> force) const {
    op.theta_.resize(std::size_t(net.points()));
    for_points([&](Index i) { op.theta_[i] = theta_at(u, i); });
    for_owned([&](Index i) {
      const V at = force_at(u, traction, i);
      for (int c = 0; c < D; ++c) force[std::size_t(i) * D + c] = op.points_.volume[i] * at[c];
    });
    std::ranges::fill(force.subspan(std::size_t(op.owned()) * D), 0.0);
  }

  void add_traction_forces(std::span<const double> traction, std::span<double> force) const {
    for_owned([&](Index i) {
      const V at = missing_force(i, 0.0, of(traction, i));
      for (int c = 0; c < D; ++c) force[std::size_t(i) * D + c] -= op.points_.volume[i] * at[c];
    });
  }

  [[nodiscard]] M gradient_at(std::span<const double> u, Index i) const {
    const V here = of(u, i);
    M gradient{};
    for_neighbours(i, [&](Offset, Index j, double k, const V& xi) {
      add_outer<D>(double(D) * k, minus<D>(of(u, j), here), shaped(i, xi), gradient);
    });
    return gradient;
  }

  [[nodiscard]] double whole_energy_density(std::span<const double> u, Index i) const {
    const V here = of(u, i);
    double theta = 0.0, bonds = 0.0;
    for_neighbours(i, [&](Offset, Index j, double k, const V& xi) {
      const double along = dot<D>(xi, minus<D>(of(u, j), here));
      theta += k * along;
      bonds += k * along * along / dot<D>(xi, xi);
    });
    theta *= D;
    const double lambda = material.lambda[i], mu = material.mu[i];
    return 0.5 * (lambda - mu) * theta * theta + 0.25 * bond_factor * mu * bonds;
  }

  /// w; the bonds' part in the missing part of the ball is that of the whole ball under the
  /// nonlocal strain, which the quadrature integrates exactly, less that of the existing
  /// neighbours.
  [[nodiscard]] double energy_density(std::span<const double> u, Index i) const {
    if (op.whole_[i] != 0) return whole_energy_density(u, i);
    const M gradient = gradient_at(u, i);
    M strain;
    double theta = 0.0, squared_strain = 0.0;
    for (int r = 0; r < D; ++r) {
      theta += gradient[r][r];
      for (int c = 0; c < D; ++c) {
        strain[r][c] = 0.5 * (gradient[r][c] + gradient[c][r]);
        squared_strain += strain[r][c] * strain[r][c];
      }
    }
    const V here = of(u, i);
    double bonds = (theta * theta + 2.0 * squared_strain) / (D * (D + 2));
    for_neighbours(i, [&](Offset, Index j, double k, const V& xi) {
      const double squared = dot<D>(xi, xi);
      const double along = dot<D>(xi, minus<D>(of(u, j), here));
      double linear = 0.0;
      for (int r = 0; r < D; ++r) linear += xi[r] * dot<D>(strain[r], xi);
      bonds += k * (along - linear) * (along + linear) / squared;
    });
    const double lambda = material.lambda[i], mu = material.mu[i];
    return 0.5 * (lambda - mu) * theta * theta + 0.25 * bond_factor * mu * bonds;
  }

  // --- rows -------------------------------------------------------------------------------------

  /// Coefficients of theta in the force on a point: returns g of the point itself, and calls
  /// visit(entry, j, g, bond block factor, xi) for its neighbours.
  template <class Visit>
  V for_couplings(Index i, const Visit& visit) const {
    V own = missing_force(i, 1.0, V{});
    for_neighbours(i, [&](Offset e, Index j, double k, const V& xi) {
      const double mu = mean_mu(i, j);
      const V g = scaled<D>(-D * k * (mean_lambda(i, j) - mu), xi);
      own = plus<D>(own, g);
      visit(e, j, g, -bond_factor * mu * k / dot<D>(xi, xi), xi);
    });
    return own;
  }

  /// k_ij of an unbroken neighbour; two points are neighbours of each other.
  [[nodiscard]] double share_of(Index i, Index j) const {
    const auto first = net.neighbour.begin() + net.offset[i];
    const auto last = net.neighbour.begin() + net.offset[i + 1];
    const auto entry = std::lower_bound(first, last, j) - net.neighbour.begin();
    return (op.share_.empty() ? net.kernel_share : op.share_)[std::size_t(entry)];
  }

  /// Calls visit(l, t_l): theta of a point is sum_l t_l . (u_l - u_i).
  template <class Visit>
  void for_dilatation(Index i, const Visit& visit) const {
    for_neighbours(i, [&](Offset, Index j, double k, const V& xi) {
      visit(j, scaled<D>(D * k, shaped(i, xi)));
    });
  }

  /// Blocks of one row, found by their column.
  struct RowBuffer {
    std::vector<Index> place;  // per point; -1: none
    std::vector<Index> columns;
    std::vector<M> blocks;
    explicit RowBuffer(Index points) : place(std::size_t(points), -1) {}
    M& at(Index column) {
      Index& where = place[std::size_t(column)];
      if (where < 0) {
        where = Index(columns.size());
        columns.push_back(column);
        blocks.emplace_back();
      }
      return blocks[std::size_t(where)];
    }
    void clear() {
      for (const Index column : columns) place[std::size_t(column)] = -1;
      columns.clear();
      blocks.clear();
    }
  };

  void add_dilatation(Index m, const V& g, RowBuffer& row) const {
    for_dilatation(m, [&](Index l, const V& t) {
      add_outer<D>(1.0, g, t, row.at(l));
      add_outer<D>(-1.0, g, t, row.at(m));
    });
  }

  void fill_row(Index i, RowBuffer& row) const {
    row.clear();
    // All couplings, whatever is broken, so that the rows keep their pattern.
    row.at(i);
    for (Offset e = net.offset[i]; e < net.offset[i + 1]; ++e) {
      const Index j = net.neighbour[e];
      row.at(j);
      for (Offset f = net.offset[j]; f < net.offset[j + 1]; ++f) row.at(net.neighbour[f]);
    }
    const V own = for_couplings(i, [&](Offset, Index j, const V& g, double factor, const V& xi) {
      add_outer<D>(factor, xi, xi, row.at(j));
      add_outer<D>(-factor, xi, xi, row.at(i));
      add_dilatation(j, g, row);
    });
    add_dilatation(i, own, row);
    for_missing_shear(i, [&](Index l, const M& block) {
      add_block(1.0, block, row.at(l));
      add_block(-1.0, block, row.at(i));
    });
  }

  static void add_block(double factor, const M& block, M& sum) {
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) sum[r][c] += factor * block[r][c];
    }
  }

  [[nodiscard]] SparseRows rows() const {
    if (op.points_.owned) throw std::logic_error("a part of a body has no matrix of its own");
    const auto count = std::size_t(net.points());
    std::vector<Offset> blocks(count);
    SparseRows result;
    const auto sweep = [&](const auto& use) {
      run_on_threads(op.threads_, [&](int thread) {
        RowBuffer row(net.points());
        const Index first = Index(std::int64_t(count) * thread / op.threads_);
        const Index last = Index(std::int64_t(count) * (thread + 1) / op.threads_);
        for (Index i = first; i < last; ++i) {
          fill_row(i, row);
          use(i, row);
        }
      });
    };
    sweep([&](Index i, RowBuffer& row) { blocks[std::size_t(i)] = Offset(row.columns.size()); });
    result.offset.assign(count * D + 1, 0);
    for (std::size_t i = 0; i < count; ++i) {
      for (int r = 0; r < D; ++r) {
        result.offset[i * D + r + 1] = result.offset[i * D + r] + blocks[i] * D;
      }
    }
    result.column.resize(std::size_t(result.offset.back()));
    result.value.resize(std::size_t(result.offset.back()));
    sweep([&](Index i, RowBuffer& row) {
      std::vector<Index> ascending = row.columns;
      std::sort(ascending.begin(), ascending.end());
      for (int r = 0; r < D; ++r) {
        auto to = std::size_t(result.offset[std::size_t(i) * D + r]);
        for (const Index j : ascending) {
          const M& block = row.blocks[std::size_t(row.place[std::size_t(j)])];
          for (int c = 0; c < D; ++c, ++to) {
            result.column[to] = j * D + c;
            result.value[to] = op.points_.volume[i] * block[r][c];
          }
        }
      }
    });
    return result;
  }

  [[nodiscard]] std::vector<double> diagonal() const {
    std::vector<double> blocks(std::size_t(net.points()) * D * D);
    for_owned([&](Index i) {
      M block{};
      const V own = for_couplings(i, [&](Offset, Index j, const V& g, double factor, const V& xi) {
        add_outer<D>(-factor, xi, xi, block);
        const double back = share_of(j, i);
        add_outer<D>(1.0, g, scaled<D>(-D * back, shaped(j, xi)), block);
      });
      for_dilatation(i, [&](Index, const V& t) { add_outer<D>(-1.0, own, t, block); });
      for_missing_shear(i, [&](Index, const M& of_pair) { add_block(-1.0, of_pair, block); });
      for (int r = 0; r < D; ++r) {
        for (int c = 0; c < D; ++c) {
          blocks[std::size_t(i) * D * D + r * D + c] = op.points_.volume[i] * block[r][c];
        }
      }
    });
    return blocks;
  }

  [[nodiscard]] std::vector<double> bounds_of_row_sums() const {
    std::vector<double> of_dilatation(std::size_t(net.points()));
    for_points([&](Index i) {
      double sum = 0.0;
      for_dilatation(i, [&](Index, const V& t) {
        for (int c = 0; c < D; ++c) sum += 2.0 * std::abs(t[c]);
      });
      of_dilatation[i] = sum;
    });
    std::vector<double> bounds(std::size_t(net.points()) * D);
    for_owned([&](Index i) {
      V sum{};
      const V own = for_couplings(i, [&](Offset, Index j, const V& g, double factor, const V& xi) {
        for (int r = 0; r < D; ++r) {
          sum[r] += std::abs(g[r]) * of_dilatation[j];
          for (int c = 0; c < D; ++c) sum[r] += 2.0 * std::abs(factor * xi[r] * xi[c]);
        }
      });
      for_missing_shear(i, [&](Index, const M& block) {
        for (int r = 0; r < D; ++r) {
          for (int c = 0; c < D; ++c) sum[r] += 2.0 * std::abs(block[r][c]);
        }
      });
      for (int r = 0; r < D; ++r) {
        bounds[std::size_t(i) * D + r] =
            op.points_.volume[i] * (sum[r] + std::abs(own[r]) * of_dilatation[i]);
      }
    });
    return bounds;
  }
};

CollocationOperator::CollocationOperator(const Points& points, CollocationSetting setting,
                                         int threads)
    : points_(points), setting_(std::move(setting)), threads_(threads) {
  const std::vector<double>& places = setting_.network->places;
  reference_ = places.empty() ? std::span<const double>(points.reference) : places;
  const auto count = std::size_t(setting_.network->points());
  const auto d = std::size_t(setting_.network->dimension);
  shape_.resize(count * d * d);
  first_.resize(count * d);
  normal_.resize(count * d);
  torn_.resize(count);
  whole_.resize(count);
  dilation_.resize(setting_.network->neighbour.size() * d);
  third_.resize(count * std::size_t(third_moment_entries(setting_.network->dimension)));
  const LameConstants& constants = *setting_.constants;
  const auto are_equal = [](const std::vector<double>& values) {
    return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end();
  };
  is_uniform_ = are_equal(constants.lambda) && are_equal(constants.mu);
  update({});
}
CollocationOperator::~CollocationOperator() = default;

template <class Visit>
auto CollocationOperator::dispatch(const Visit& visit) {
  if (setting_.network->dimension == 2) return visit(Kernels<2>(*this));
  return visit(Kernels<3>(*this));
}

void CollocationOperator::update(std::span<const char> broken) {
  const bool is_known =
      is_up_to_date_ && std::equal(broken.begin(), broken.end(), broken_.begin(), broken_.end());
  if (is_known) return;
  const std::vector<char> changed = take_up(broken);
  outline_.reset();
  dispatch([&](const auto& kernels) {
    kernels.for_points([&](Index i) {
      if (changed[std::size_t(i)]) kernels.update_point(i);
    });
  });
}

std::vector<char> CollocationOperator::take_up(std::span<const char> broken) {
  const CollocationNetwork& network = *setting_.network;
  const std::vector<char> before = std::exchange(broken_, {broken.begin(), broken.end()});
  const auto is_broken = [](const std::vector<char>& bonds, Offset bond) {
    return !bonds.empty() && bonds[std::size_t(bond)] != 0;
  };
  const bool is_first = !std::exchange(is_up_to_date_, true);
  const bool are_some = std::find(broken_.begin(), broken_.end(), char(1)) != broken_.end();
  if (are_some && share_.empty()) share_ = network.kernel_share;
  std::vector<char> changed(std::size_t(network.points()), is_first);
  for (Index i = 0; i < network.points(); ++i) {
    for (Offset e = network.offset[i]; e < network.offset[i + 1]; ++e) {
      const bool is = is_broken(broken_, network.bond[e]);
      if (is == is_broken(before, network.bond[e])) continue;
      changed[std::size_t(i)] = 1;
      share_[std::size_t(e)] = is ? 0.0 : network.kernel_share[std::size_t(e)];
    }
  }
  return changed;
}

void CollocationOperator::forces(std::span<const double> displacement,
                                 std::span<const double> traction, std::span<double> force) {
  dispatch([&](const auto& kernels) { kernels.forces(displacement, traction, force); });
}

void CollocationOperator::add_traction_forces(std::span<const double> traction,
                                              std::span<double> force) {
  dispatch([&](const auto& kernels) { kernels.add_traction_forces(traction, force); });
}

void CollocationOperator::displacement_gradients(std::span<const double> displacement,
                                                 std::span<double> gradients) {
  dispatch([&](const auto& kernels) {
    kernels.for_owned([&](Index i) {
      const auto gradient = kernels.gradient_at(displacement, i);
      const std::size_t d = gradient.size();
      for (std::size_t r = 0; r < d; ++r) {
        std::copy_n(gradient[r].begin(), d, &gradients[std::size_t(i) * d * d + r * d]);
      }
    });
  });
}

void CollocationOperator::energies(std::span<const double> displacement, std::span<double> energy) {
  dispatch([&](const auto& kernels) {
    kernels.for_owned(
        [&](Index i) { energy[i] = points_.volume[i] * kernels.energy_density(displacement, i); });
  });
  std::ranges::fill(energy.subspan(std::size_t(owned())), 0.0);
}

SparseRows CollocationOperator::rows() {
  return dispatch([](const auto& kernels) { return kernels.rows(); });
}

const CollocationOperator::Outline& CollocationOperator::outline() {
  if (!outline_) {
    outline_ = dispatch([](const auto& kernels) {
      return Outline{kernels.diagonal(), kernels.bounds_of_row_sums()};
    });
  }
  return *outline_;
}

double CollocationOperator::bytes_of_rows() const {
  const CollocationNetwork& network = *setting_.network;
  const double points = network.points(), d = network.dimension;
  // Couplings reach two horizons: 2^d as many points as one.
  const double per_point = double(network.neighbour.size()) / std::max(points, 1.0) + 1.0;
  const double blocks = points * std::min(points, std::pow(2.0, d) * per_point);
  return blocks * d * d * double(sizeof(Index) + sizeof(double));
}

}  // namespace peristat
