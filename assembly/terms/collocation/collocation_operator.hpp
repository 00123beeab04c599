#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "assembly/operators/unsymmetric_tangent.hpp"
#include "assembly/terms/collocation/collocation_network.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Inputs of a collocation operator; constant during a solve.
struct CollocationSetting {
  std::shared_ptr<const CollocationNetwork> network;
  std::shared_ptr<const LameConstants> constants;
  TractionForm form = TractionForm::full;
};

/// The linear peridynamic solid at the points themselves ([LPS] sec. 4), with d the dimension:
///
///   theta_i = d sum_j k_ij xi . M_i eta,   M_i = (d sum_j k_ij xi xi)^-1
///   (L u)_i = sum_j k_ij (-d (lambda_ij - mu_ij) xi (theta_i + theta_j)
///                         - 2 d (d + 2) mu_ij xi (xi . eta) / r^2) + B_i(theta_i, T_i)
///
/// over the unbroken bonds, xi the reference vector to the neighbour and eta the difference of the
/// displacements: both are linear in u. In the missing part of the ball, outside the body or beyond
/// broken bonds, u is continued linearly with the dilatation theta_i and the traction T_i on the
/// surface there, whose normal n_i = -sum_j omega_ij xi / |...| is outward:
///
///   B_i = -2 d (lambda - mu) theta_i a_i - 2 d (d + 2) S_i : mu E_i
///
/// with a_i = sum k xi and S_i = sum k xi xi xi / r^2 over what is missing, and mu E_i from
/// sigma_i n_i = T_i and tr E_i = theta_i ([LPS] eq. 4.6-4.8 is the form `paper`). In 3D these fix
/// only the mean of the tangential strains: their deviator is that of the nonlocal strain with the
/// form `full`, and zero with `paper`. Patch tests are exact with the form `full`.
///
/// Points that have lost more than three fifths of their initial balls are torn: debris, of which
/// nothing is continued. There M_i = 1 and B_i = B_i(0, T_i), with which the operator stays
/// positive however few bonds are left; with the inverse of a tensor of few bonds it would not.
///
/// On a part of a body results are those of the points that its rank owns, and 0 at others.
///
/// The rows have no common energy, and the operator is not symmetric except where neighbourhoods
/// are alike and whole.
class CollocationOperator {
 public:
  /// All references outlive it; `broken` may change with `update`.
  CollocationOperator(const Points& points, CollocationSetting setting, int threads);
  ~CollocationOperator();

  /// Sets which bonds are broken, by their numbers in the model's network; empty: none. Does
  /// nothing if that has not changed.
  void update(std::span<const char> broken);

  /// V (L u) [N], including the tractions' part.
  /// @param traction at points, points x dimension [Pa]; empty: free surfaces
  void forces(std::span<const double> displacement, std::span<const double> traction,
              std::span<double> force);
  /// Adds the part of the tractions alone, -V B(0, T), to the forces of the loads [N].
  void add_traction_forces(std::span<const double> traction, std::span<double> force);

  /// Nonlocal displacement gradients H_i = d sum_j k_ij eta (M_i xi), points x d x d, row major,
  /// exact for linear fields; their trace is the dilatation.
  void displacement_gradients(std::span<const double> displacement, std::span<double> gradients);
  /// V w of points [J],
  ///
  ///   w = (lambda - mu) theta^2 / 2 + d (d + 2) mu / 2 sum k (xi . eta)^2 / r^2
  ///
  /// ([LPS] sec. 2; the printed W is twice the energy), with the nonlocal strain in the missing
  /// part of the ball.
  void energies(std::span<const double> displacement, std::span<double> energy);

  /// Outward normals, points x dimension; zero where nothing is missing, or as much on all sides.
  [[nodiscard]] std::span<const double> normals() const { return normal_; }

  /// All rows of dV(L u)/du [N/m].
  [[nodiscard]] SparseRows rows();
  /// Blocks (i, i) of it, points x d x d.
  [[nodiscard]] const std::vector<double>& diagonal() { return outline().diagonal; }
  /// Upper bounds of the sums of the absolute entries of rows [N/m].
  [[nodiscard]] const std::vector<double>& bounds_of_row_sums() { return outline().row_sums; }
  /// Approximate memory of rows() [bytes].
  [[nodiscard]] double bytes_of_rows() const;

 private:
  template <int D>
  struct Kernels;
  struct Outline {
    std::vector<double> diagonal, row_sums;
  };
  const Outline& outline();
  /// Number of points, the first ones, that results are found for.
  [[nodiscard]] Index owned() const { return points_.owned.value_or(setting_.network->points()); }
  /// Sets which bonds are broken.
  /// @return per point, whether one of its bonds has changed
  std::vector<char> take_up(std::span<const char> broken);
  /// Calls visit(Kernels<D>{*this}).
  template <class Visit>
  auto dispatch(const Visit& visit);

  const Points& points_;
  CollocationSetting setting_;
  std::span<const double> reference_;  // positions
  int threads_;
  std::vector<char> broken_;  // as last set
  bool is_up_to_date_ = false;
  bool is_uniform_ = false;         // one pair of constants
  std::optional<Outline> outline_;  // of the present bonds
  std::vector<double> share_;       // k_ij of unbroken neighbours, 0 of others; empty: all unbroken
  std::vector<double> shape_;       // M, points x d x d
  std::vector<double> first_;       // a, points x d
  std::vector<double> third_;       // S, points x entries
  std::vector<double> dilation_;    // t_ij = d k_ij M_i xi: theta_i = sum t_ij . (u_j - u_i)
  std::vector<char> torn_, whole_;  // per point
  std::vector<double> normal_;      // points x d
  std::vector<double> theta_;       // of forces()
};

}  // namespace peristat
