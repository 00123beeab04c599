#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assembly/assembler.hpp"
#include "solvers/fracture/crack_tip.hpp"
#include "solvers/fracture/williams_fields.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/index_map.hpp"
#include "src/parallel/sums.hpp"

namespace peristat {

/// Inputs of the integrals about a crack's tip, beside the tip.
struct CrackTipSetting {
  double horizon = 0.0;        ///< [m]
  double cross_section = 1.0;  ///< 2D: thickness [m]
  /// All calls are collective, with the same results on all ranks.
  const IndexMap& index_map = whole_body();
};

/// J, stress intensity factors and T-stress of a crack's tip.
///
/// J is the flux of energy into the tip along e1 in the domain form, without a local stress: with a
/// weight q from 1 within the ring to 0 outside, the energies e_i of the points, the forces p_a of
/// an interaction on its points and g = (F - I) e1
///
///   J = 1/B ( sum_int sum_a (q_a - mean q) p_a . g_a  -  sum_i e_i dq/dX1 ),
///
/// whose first sum is sum_a q_a g_a . dE/du_a - d/ds sum_i q_i e_i(u + s g): points that move along
/// e1 carry their energy with them. It holds for every term of the energy, at finite strain, and
/// with damage held. B is the length of the front (2D: the thickness). In the continuum limit it is
/// int (P : g (x) grad q - W dq/dX1) dA (Li, Shih and Needleman 1985 at finite strain).
///
/// K and T follow from the interaction with an auxiliary field v at small strain, M = dJ(u + s
/// v)/ds at s = 0: K_I = E' M/2, K_III = mu M, T = E' M. T* relates T to the stress of the singular
/// field at a distance of half a horizon, K/sqrt(pi delta).
class CrackTipIntegrals {
 public:
  /// @param key of the tip, for errors
  /// @throws InputError for an invalid ring, for one that reaches the body's edge or a hole, or is
  ///         cut by a plane of symmetry, unless the crack lies in this plane or its front is at
  ///         right angles to it
  CrackTipIntegrals(const Points& points, const CrackTipSpecification& tip,
                    const CrackTipSetting& setting, const std::string& key);

  /// Sets the constants of the ring's material; without them there is a J, but neither K nor T.
  void set_elasticity(const TipElasticity& elasticity) { elasticity_ = elasticity; }

  /// J per joule of the sums: 1/B, 2/B where a plane of symmetry halves the crack [1/m].
  [[nodiscard]] double share() const { return factor_; }

  /// Owned points within the outer radius of the ring; at least one rank has some.
  [[nodiscard]] std::vector<Index> points() const;
  [[nodiscard]] CrackTipValues values(Assembler& assembler, const StateView& at) const;

 private:
  static constexpr std::size_t rings = 4;  // the whole ring, and its thirds
  using Rings = std::array<double, rings>;

  /// Weights of a point.
  struct Weighted {
    Index point = 0;
    Rings q{}, slope{};  // dq/dX1
  };

  /// Kinds of all images that any rank has. Collective.
  [[nodiscard]] std::vector<ImageKind> kinds_of_images() const;
  void check_planes(const std::string& key);
  void check_ring(const std::string& key) const;
  void weigh();
  [[nodiscard]] double front_length(Index points) const;
  [[nodiscard]] double largest_horizon_within(double distance) const;
  [[nodiscard]] double horizon_of_ring();
  [[nodiscard]] Sums sums() const { return {setting_.index_map, points_.dimension}; }
  [[nodiscard]] double largest(std::span<const double> values) const;
  [[nodiscard]] Rings fluxes(Assembler& assembler, const StateView& at,
                             std::span<const double> translation) const;
  [[nodiscard]] std::vector<double> translation_of(Assembler& assembler, const StateView& at) const;
  [[nodiscard]] std::vector<double> field(std::size_t size, int mode) const;
  [[nodiscard]] double interaction(Assembler& assembler, const StateView& at,
                                   std::span<const double> translation,
                                   const std::vector<double>& with) const;

  const Points& points_;
  CrackTipSpecification tip_;
  CrackTipSetting setting_;
  std::optional<TipElasticity> elasticity_;
  CrackTipFrame frame_;
  bool is_on_plane_ = false;      // the crack lies in a plane of symmetry
  bool is_front_halved_ = false;  // a plane of symmetry crosses the front
  std::vector<Weighted> weighted_;
  double factor_ = 1.0;   // from sums over the points to J
  double horizon_ = 0.0;  // at the tip [m]
};

}  // namespace peristat
