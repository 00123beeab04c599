#pragma once

#include <memory>
#include <span>

#include "assembly/model.hpp"
#include "assembly/stored.hpp"
#include "assembly/tangent.hpp"
#include "src/points/points.hpp"

namespace peristat {

struct Workspace;

/// Energy, gradient, tangent and matrix-free product of the discrete energy
/// E(u) = sum over interactions of w psi(m; M), visiting each unique bond, triangle and tetrahedron
/// once, on several threads.
///
/// All arrays are points x dimension, row major. No call but visit_tangent allocates. For a given
/// number of threads every result is reproducible to the last bit.
class Assembler {
 public:
  /// Points and model must outlive the assembler.
  /// @throws std::logic_error for bonds with damage beside triangles or tetrahedra of a negative
  ///         constant: their loss would have to be paid with energy that nobody has put in
  Assembler(const Points& points, const Model& model, int threads);
  ~Assembler();

  /// E [J]
  [[nodiscard]] Stored energy(std::span<const double> displacement);

  /// E [J] and dE/dx [N] (minus the internal force).
  [[nodiscard]] Stored gradient(std::span<const double> displacement, std::span<double> gradient);

  /// Commits a state: moves the history of every bond that it damages to it. E is then what is
  /// stored after that. dE/dx, unless it is left out, is the bonds' as before and that of triangles
  /// and tetrahedra after their loss. Only accepted states
  /// are committed, and in relaxation that breaks bonds on the way, every iteration.
  Stored commit(std::span<const double> displacement, std::span<double> gradient = {});

  /// What committing a state would damage.
  [[nodiscard]] DamageGrowth growth(std::span<const double> displacement);

  /// Largest stretch of each bond over the committed states, as far as it has damaged the bond (0
  /// before, Degraded::never_fails where the model says so); empty for a potential without history.
  [[nodiscard]] std::span<const double> history() const;

  /// Whether bonds follow their secants beyond their histories, too: a state in which `growth` is
  /// then zero is one of the body. Use DamageHold.
  void hold_damage(bool holds);
  [[nodiscard]] bool holds_damage() const;

  /// Takes up a history again that was read before.
  void restore(std::span<const double> history);

  /// d2E/dx2 [N/m], every entry overwritten.
  /// @param projection share in [0, 1] by which the relative Hessian of every interaction moves
  ///        towards its positive semidefinite part: 0 is exact, 1 gives a positive semidefinite
  ///        tangent
  void tangent(std::span<const double> displacement, Tangent& tangent, double projection = 0.0);

  /// product = d2E/dx2(displacement) v, without a stored tangent. For models of bonds alone both
  /// may be the same array.
  /// @param projection as of `tangent`; other than 0 only for models of bonds alone
  void product(std::span<const double> displacement, std::span<const double> v,
               std::span<double> product, double projection = 0.0);

  /// Visits the rows of the tangent of a model of bonds alone, without storing it.
  /// @param diagonal blocks as in TangentOperator; empty: not wanted
  void visit_tangent(std::span<const double> displacement, double projection,
                     const TangentOperator::RowVisitor& visit, std::span<double> diagonal);

  /// Energy of each point, an equal share of its interactions' [J], and the largest stretch l/L - 1
  /// of a bond.
  double point_energies(std::span<const double> displacement, std::span<double> energies);

  /// Largest stretch of the unbroken bonds of each point; 0 without such a bond.
  void point_stretches(std::span<const double> displacement, std::span<double> stretches) const;

  [[nodiscard]] int threads() const;
  [[nodiscard]] const Points& points() const;
  [[nodiscard]] const Model& model() const;
  [[nodiscard]] double seconds_spent() const { return seconds_; }  ///< wall time of all calls [s]

 private:
  template <bool commits>
  Stored pass(std::span<const double> displacement, std::span<double> gradient);

  std::unique_ptr<Workspace> workspace_;
  double seconds_ = 0.0;
};

/// Holds the damage of a body as long as it lives.
class DamageHold {
 public:
  explicit DamageHold(Assembler& assembler, bool holds = true)
      : assembler_(assembler), held_before_(assembler.holds_damage()) {
    assembler_.hold_damage(held_before_ || holds);
  }
  ~DamageHold() { assembler_.hold_damage(held_before_); }
  DamageHold(const DamageHold&) = delete;
  DamageHold& operator=(const DamageHold&) = delete;

 private:
  Assembler& assembler_;
  bool held_before_;
};

}  // namespace peristat
