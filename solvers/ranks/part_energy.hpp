#pragma once

#include <memory>
#include <span>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "solvers/ranks/ghost_exchange.hpp"
#include "src/core/communicator.hpp"
#include "src/geometry/part.hpp"

namespace peristat {

/// The energy of a body of which each rank has a part. Every interaction that an owned point takes
/// part in is computed by its rank, so that the rows of owned points are whole and nothing but the
/// displacements of ghosts ever comes from others; of the energy each point has its share, and
/// counts on the rank that owns it.
///
/// Arrays are points x dimension, of owned points and then ghosts. All ranks make the same calls.
class PartEnergy {
 public:
  /// All outlive it. The model's interactions are those with an owned point.
  PartEnergy(const Part& part, const Model& model, const Communicator& ranks, int threads);

  /// Gives ghosts what their owners have.
  void update_ghosts(std::span<double> values) const { ghosts_->update(values.data()); }

  /// E of the whole body [J].
  [[nodiscard]] Evaluation energy(const StateView& at);

  /// E of the whole body [J], and dE/dx of owned points [N]; that of ghosts is zero.
  [[nodiscard]] Evaluation gradient(const StateView& at, std::span<double> gradient);

  [[nodiscard]] Assembler& assembler() { return assembler_; }
  [[nodiscard]] const Part& part() const { return part_; }
  [[nodiscard]] const GhostExchange& ghosts() const { return *ghosts_; }

 private:
  /// Of what this rank has found.
  [[nodiscard]] Evaluation of_all(const StateView& at, const Evaluation& mine);

  const Part& part_;
  const Communicator& ranks_;
  Assembler assembler_;
  std::unique_ptr<GhostExchange> ghosts_;
  std::vector<double> of_points_;
};

/// The tangent of such an energy: rows of owned points are the whole body's, once ghosts have the
/// values that their owners multiply by. Rows and diagonal blocks of ghosts are parts of theirs,
/// and mean nothing.
struct PartTangent : TangentOperator {
  /// @throws std::logic_error unless the energy visits_rows
  explicit PartTangent(PartEnergy& energy);

  [[nodiscard]] std::vector<double> positions() const override { return tangent_.positions(); }
  void linearise(Energy& energy, const StateView& at, double projection) override;
  /// What v has for ghosts does not count; what the result has for them means nothing.
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool multiplies_in_place() const override { return true; }
  void for_each_row(const RowVisitor& visit) const override { tangent_.for_each_row(visit); }

 private:
  PartEnergy& energy_;
  MatrixFreeTangent tangent_;
  mutable std::vector<double> factor_;  // with the ghosts' values
};

/// Flags of degrees of freedom without an equation on this rank: all of ghosts, and those that are
/// prescribed.
/// @param prescribed one flag per degree of freedom of owned points, or of all
[[nodiscard]] std::vector<char> without_ghosts(const Part& part, std::vector<char> prescribed);

}  // namespace peristat
