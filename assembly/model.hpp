#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "src/neighbourhood/bonds.hpp"
#include "src/neighbourhood/interactions.hpp"
#include "src/potentials/potential.hpp"

namespace peristat {

/// Two- or three-neighbour interactions with their potential.
template <class Measure>
struct InteractionTerm {
  Interactions<Measure> interactions;
  HigherPotential potential;
};

using TriangleTerm = InteractionTerm<Area>;
using TetrahedronTerm = InteractionTerm<Volume>;

/// Where a History keeps what the terms of a model remember: bonds their largest stretch over the
/// committed states as far as it has damaged them (0 before, Degraded::never_fails where the model
/// says so), triangles and tetrahedra the integrity of every bond and then of every point.
inline constexpr std::size_t bond_history = 0, integrity_history = 1;

/// The discrete energy of a body: the sum of w psi(m; M) over its bonds (measure l), and in
/// continuum-kinematics-inspired peridynamics over its triangles (a) and tetrahedra (v)
/// ([CPD] eq. 14). Constant in a solve.
///
/// A triangle or tetrahedron loses its stiffness with the bonds it stands on: its energy is
/// multiplied by the product of the integrities T(kappa) that the committed histories leave to
/// them. These are constant between commits, so that the product has no derivative of its own, and
/// forces and tangent stay those of one energy.
struct Model {
  Bonds bonds;
  BondPotential potential;
  std::vector<char> never_fails{};  ///< per bond, 1: no damage whatever the stretch; empty: none
  std::optional<TriangleTerm> triangles{};
  std::optional<TetrahedronTerm> tetrahedra{};

  [[nodiscard]] bool has_only_bonds() const { return !triangles && !tetrahedra; }

  /// Whether its bonds can be damaged.
  [[nodiscard]] bool has_history() const {
    return std::visit([]<class P>(const P&) { return PotentialWithHistory<P>; }, potential);
  }
};

}  // namespace peristat
