#pragma once

#include <memory>
#include <span>

#include "assembly/model.hpp"
#include "assembly/state.hpp"
#include "assembly/stored.hpp"
#include "assembly/tangent.hpp"
#include "src/points/points.hpp"

namespace peristat {

struct Workspace;

/// Energy, gradient, tangent and matrix-free product of the discrete energy
/// E(u) = sum over interactions of w psi(m; M), visiting each unique bond, triangle and tetrahedron
/// once, on several threads.
///
/// All arrays are points x dimension, row major. No call but visit_tangent and commit allocates.
/// For a given number of threads every result is reproducible to the last bit. A model whose bonds
/// can be damaged is evaluated after a history (initial_history), which only `commit` changes.
class Assembler {
 public:
  /// Points and model must outlive the assembler.
  /// @throws std::logic_error for bonds with damage beside triangles or tetrahedra of a negative
  ///         constant: their loss would have to be paid with energy that nobody has put in
  Assembler(const Points& points, const Model& model, int threads);
  ~Assembler();

  /// History of a body to which nothing has happened.
  [[nodiscard]] History initial_history() const;

  /// History of a body whose bonds remember these stretches (see bond_stretches).
  [[nodiscard]] History history_of(std::span<const double> bond_stretches) const;

  /// E [J]
  [[nodiscard]] Stored energy(const StateView& at);

  /// E [J] and dE/dx [N] (minus the internal force).
  [[nodiscard]] Stored gradient(const StateView& at, std::span<double> gradient);

  /// Commits a state: moves the history of every bond that it damages to it. E is then what is
  /// stored after that. dE/dx, unless it is left out, is the bonds' as before and that of triangles
  /// and tetrahedra after their loss. Only accepted states
  /// are committed, and in relaxation that breaks bonds on the way, every iteration.
  Stored commit(std::span<const double> displacement, History& history,
                std::span<double> gradient = {});

  /// What committing a state would damage.
  [[nodiscard]] DamageGrowth growth(const StateView& at);

  /// d2E/dx2 [N/m], every entry overwritten.
  /// @param projection share in [0, 1] by which the relative Hessian of every interaction moves
  ///        towards its positive semidefinite part: 0 is exact, 1 gives a positive semidefinite
  ///        tangent
  void tangent(const StateView& at, Tangent& tangent, double projection = 0.0);

  /// product = d2E/dx2 v, without a stored tangent. For models of bonds alone both
  /// may be the same array.
  /// @param projection as of `tangent`; other than 0 only for models of bonds alone
  void product(const StateView& at, std::span<const double> v, std::span<double> product,
               double projection = 0.0);

  /// Visits the rows of the tangent of a model of bonds alone, without storing it.
  /// @param diagonal blocks as in TangentOperator; empty: not wanted
  void visit_tangent(const StateView& at, double projection,
                     const TangentOperator::RowVisitor& visit, std::span<double> diagonal);

  /// Energy of each point, an equal share of its interactions' [J], and the largest stretch l/L - 1
  /// of a bond.
  double point_energies(const StateView& at, std::span<double> energies);

  /// Largest stretch of the unbroken bonds of each point; 0 without such a bond.
  void point_stretches(const StateView& at, std::span<double> stretches) const;

  [[nodiscard]] int threads() const;
  [[nodiscard]] const Points& points() const;
  [[nodiscard]] const Model& model() const;
  [[nodiscard]] double seconds_spent() const { return seconds_; }  ///< wall time of all calls [s]

 private:
  std::unique_ptr<Workspace> workspace_;
  double seconds_ = 0.0;
};

}  // namespace peristat
