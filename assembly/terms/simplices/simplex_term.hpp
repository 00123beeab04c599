#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "assembly/terms/failure/bond_failure.hpp"
#include "assembly/terms/term.hpp"
#include "src/neighbourhood/alike_bonds.hpp"
#include "src/neighbourhood/interactions.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Triangles or tetrahedra with their potential.
template <class Measure>
struct Simplices {
  Interactions<Measure> interactions;
  HigherPotential potential;
};

/// Numbers of a part's points in the whole body; empty: the body is whole.
using PointNumbers = std::vector<GlobalIndex>;

/// The energies of triangles and tetrahedra, sums of w psi(a; A) and w psi(v; V) ([CPD] eq. 14, two
/// and three neighbours). Both are passed over at once: they share the neighbourhoods of their
/// points.
///
/// A triangle or tetrahedron loses its stiffness with the bonds that are its edges: its energy is
/// multiplied by the product of the integrities T(kappa) that the committed histories leave to
/// them. These are constant between commits, so that the product has no derivative, and forces and
/// tangent are those of one energy. The history is the integrity of every bond, followed by that of
/// every point, the smallest of its bonds'.
///
/// By stretch, their energy is lost as their bonds fail, whatever it was. By release, a bond is
/// driven by what it would set free with all that stands on it,
///
///   Y_b = w_b psi_1(e_b) + sum over I on b of w_I psi_I times the integrities of I's other bonds,
///
/// so that constants may be negative: see BondFailure. The drop of energy is exactly Y_b times the
/// loss of integrity, as the energy is linear in each of them. Beyond planes of symmetry and
/// periods Y_b is the sum over the bonds that are one, which are damaged together.
class SimplexTerm : public Term {
 public:
  /// @param bonds that are their edges
  /// @param numbers from which projected tangents choose the same origin of arms on all ranks
  /// @param alike bonds that are one
  /// @throws std::logic_error for a negative constant if the bonds can be damaged by stretch: their
  ///         loss would then raise the energy without any supply
  SimplexTerm(std::shared_ptr<const BondFailure> bonds, std::optional<Simplices<Area>> triangles,
              std::optional<Simplices<Volume>> tetrahedra, PointNumbers numbers = {},
              AlikeBonds alike = {});

  [[nodiscard]] const Bonds& bonds() const { return bonds_->bonds(); }
  [[nodiscard]] const std::optional<Simplices<Area>>& triangles() const { return triangles_; }
  [[nodiscard]] const std::optional<Simplices<Volume>>& tetrahedra() const { return tetrahedra_; }

  [[nodiscard]] const BondFailure& bond_failure() const { return *bonds_; }
  [[nodiscard]] const PointNumbers& numbers() const { return numbers_; }
  [[nodiscard]] const AlikeBonds& alike() const { return alike_; }

  /// Calls visit(simplices) for the triangles and for the tetrahedra, if there are any.
  template <class Visit>
  void for_each_kind(const Visit& visit) const {
    if (triangles_) visit(*triangles_);
    if (tetrahedra_) visit(*tetrahedra_);
  }

  [[nodiscard]] Couplings couplings() const override { return bonds(); }
  [[nodiscard]] bool spills_bonds() const override { return true; }
  [[nodiscard]] bool drives_bonds() const override { return true; }
  [[nodiscard]] Balances balances() const override;
  void follow(const Model& model, History& history) const override;
  [[nodiscard]] std::vector<InteractionCount> counts() const override;
  [[nodiscard]] double bytes_to_store() const override;
  [[nodiscard]] double stored_bytes() const override;
  void store(const Points& points, int threads) override;
  [[nodiscard]] std::unique_ptr<TermPasses> passes(const TermSetting& setting) const override;

 private:
  void show(std::size_t slot_of_bonds, History& history) const;

  std::shared_ptr<const BondFailure> bonds_;
  std::optional<Simplices<Area>> triangles_;
  std::optional<Simplices<Volume>> tetrahedra_;
  PointNumbers numbers_;
  AlikeBonds alike_;
};

}  // namespace peristat
