#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "assembly/terms/model.hpp"
#include "assembly/terms/simplices/simplex_term.hpp"
#include "src/geometry/lattice.hpp"
#include "src/materials/effective_volumes.hpp"
#include "src/materials/quadrature.hpp"
#include "src/neighbourhood/neighbour_counts.hpp"

namespace peristat::tests {

/// Uniform numbers in [-1, 1), the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  [[nodiscard]] double number() { return 2.0 * (double(engine_() >> 11) * 0x1p-53) - 1.0; }

  [[nodiscard]] std::vector<double> vector(std::size_t size, double scale = 1.0) {
    std::vector<double> result(size);
    for (double& entry : result) entry = scale * number();
    return result;
  }

 private:
  std::mt19937_64 engine_;
};

[[nodiscard]] inline double dot(std::span<const double> a, std::span<const double> b) {
  double result = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) result += a[k] * b[k];
  return result;
}

[[nodiscard]] inline double norm(std::span<const double> a) { return std::sqrt(dot(a, a)); }

/// 2-norm of a - b.
[[nodiscard]] inline double distance(std::span<const double> a, std::span<const double> b) {
  double squared = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) squared += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(squared);
}

[[nodiscard]] inline double largest(std::span<const double> a) {
  double result = 0.0;
  for (double entry : a) result = std::max(result, std::abs(entry));
  return result;
}

struct Quadrature {
  VolumeCorrection volume = VolumeCorrection::none;
  SurfaceCorrection surface = SurfaceCorrection::none;
};

/// Parameters of a box of lattice points with bonds. small_box() gives a few hundred bonds in each
/// dimension.
struct BoxSetting {
  int dimension = 2;
  std::array<int, 3> extent{0, 0, 0};  ///< points per direction
  double spacing = 0.1;                ///< [m]
  double horizon_ratio = 2.015;
  double cross_section = 0.5;
  double perturbation = 0.0;  ///< in spacings
  Quadrature quadrature{};
  double youngs_modulus = 3.0;  ///< [Pa]
  PlaneState plane = PlaneState::stress;
  /// Stiffness of triangles and tetrahedra relative to that of the bonds, roughly; 0: none.
  double triangles = 0.0, tetrahedra = 0.0;
  bool stored = false;  ///< store the triangles and tetrahedra
  DamageDrive drive = DamageDrive::stretch;
  /// Potential of the bonds as a function of their micromodulus; empty: Harmonic.
  std::function<BondPotential(double micromodulus)> potential{};
};

/// The setting of a small box of unequal sides.
[[nodiscard]] inline BoxSetting small_box(int dimension) {
  BoxSetting setting;
  setting.dimension = dimension;
  if (dimension == 1) setting.extent = {23, 0, 0};
  if (dimension == 2) setting.extent = {9, 7, 0};
  if (dimension == 3) setting.extent = {6, 5, 4};
  setting.cross_section = dimension == 3 ? 1.0 : 0.5;
  return setting;
}

[[nodiscard]] inline Points box_points(const BoxSetting& setting) {
  Lattice lattice;
  lattice.dimension = setting.dimension;
  lattice.spacing = setting.spacing;
  lattice.cross_section = setting.cross_section;
  lattice.perturbation = setting.perturbation;
  lattice.seed = 7;
  Box box;
  for (int c = 0; c < setting.dimension; ++c) box.max[c] = setting.extent[c] * setting.spacing;
  lattice.shapes.push_back({ShapeStep::Action::add, box});
  return make_points(lattice);
}

[[nodiscard]] inline BondSetting bond_setting(const BoxSetting& setting) {
  return {{setting.dimension, setting.horizon_ratio * setting.spacing, setting.cross_section,
           setting.quadrature.volume},
          setting.plane};
}

[[nodiscard]] inline BondPotential bond_potential(const BoxSetting& box,
                                                  const BondSetting& setting) {
  const double modulus = micromodulus(box.youngs_modulus, setting);
  return box.potential ? box.potential(modulus) : Harmonic{modulus};
}

/// A body without supports and loads.
struct BoxBody {
  Points points;
  BondSetting setting;
  Model model;

  explicit BoxBody(const BoxSetting& box, int threads = 1)
      : BoxBody(box_points(box), box, threads) {}
  BoxBody(Points from, const BoxSetting& box, int threads = 1)
      : points(std::move(from)),
        setting(bond_setting(box)),
        model(make_bonds(points, box.quadrature.surface, setting, threads),
              bond_potential(box, setting), {}, box.drive) {
    auto triangles = simplices<Area>(box.triangles, box, threads);
    auto tetrahedra = simplices<Volume>(box.tetrahedra, box, threads);
    if (triangles || tetrahedra) {
      model.add(std::make_shared<SimplexTerm>(model.bond_failure(), std::move(triangles),
                                              std::move(tetrahedra)));
    }
  }

  /// Interactions with the weights of continuum-kinematics-inspired peridynamics.
  template <class Measure>
  [[nodiscard]] std::optional<Simplices<Measure>> simplices(double stiffness, const BoxSetting& box,
                                                            int threads) const {
    if (stiffness == 0.0) return std::nullopt;
    Interactions<Measure> interactions(points, model.bonds(), setting.cross_section, threads);
    const BulkNeighbourhood bulk =
        bulk_neighbourhood(box.dimension, box.spacing, setting.horizon, box.cross_section);
    interactions.set_shares(weight_shares<Measure>(
        points, effective_volumes(interactions, neighbour_counts(model.bonds()), bulk,
                                  InteractionWeights::mean)));
    // psi is C M e^2 / 2 with M of the order of horizon^arms, and there are V_H^arms of them.
    const double unit = std::pow(setting.horizon * bulk.volume, 1 - Measure::arms);
    const double micromodulus_of_bonds =
        std::visit([](const auto& law) { return law.modulus; }, potential());
    if (box.stored) interactions.store(points, model.bonds(), threads);
    return Simplices<Measure>{std::move(interactions),
                              Harmonic{stiffness * unit * micromodulus_of_bonds}};
  }

  [[nodiscard]] const BondPotential& potential() const { return model.bond_failure()->potential(); }

  /// Its triangles and tetrahedra, if it has any.
  [[nodiscard]] const SimplexTerm* simplex_term() const {
    return dynamic_cast<const SimplexTerm*>(model.terms().back().get());
  }

  /// The same bonds without triangles and tetrahedra.
  [[nodiscard]] Model bonds_alone() const { return Model(model.bonds(), potential()); }

  /// Other bonds with the same potentials.
  void replace_bonds(Bonds bonds, std::vector<char> never_fails = {}) {
    Model changed(std::move(bonds), potential(), std::move(never_fails),
                  model.bond_failure()->drive());
    if (const SimplexTerm* const simplices = simplex_term()) {
      changed.add(std::make_shared<SimplexTerm>(changed.bond_failure(), simplices->triangles(),
                                                simplices->tetrahedra()));
    }
    model = std::move(changed);
  }

  /// Takes away the bonds with drop(i, bond).
  template <class Drop>
  void remove_bonds(const Drop& drop) {
    Bonds bonds = model.bonds();
    bonds.remove_if(drop);
    replace_bonds(std::move(bonds));
  }

  [[nodiscard]] std::size_t dofs() const { return points.reference.size(); }

  /// Random displacements of a tenth of the spacing: strains of some ten per cent, without
  /// symmetry.
  [[nodiscard]] std::vector<double> random_state(std::uint64_t seed) const {
    return Random(seed).vector(dofs(), 0.1 * points.spacing);
  }
};

/// visit(i, j, bond) for every unique bond.
template <class Visit>
void for_each_bond(const Bonds& bonds, const Visit& visit) {
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      visit(i, bonds.partner(i, bond), bond);
    }
  }
}

/// Bonds without kinds. The partners of i are upper[offset[i]] .. upper[offset[i+1]-1].
[[nodiscard]] inline Bonds bonds_between(std::vector<Offset> offset,
                                         const std::vector<Index>& upper) {
  Partners partners(offset, upper);
  return {std::move(offset), std::move(partners), {}};
}

/// Upper points of all pairs, in their order.
[[nodiscard]] inline std::vector<Index> upper_points(const Couplings& couplings) {
  std::vector<Index> all;
  for (Index i = 0; i < couplings.points(); ++i) {
    for (const Index j : couplings.of(i)) all.push_back(j);
  }
  return all;
}

[[nodiscard]] inline std::vector<BondKind> kinds(const Bonds& bonds) {
  std::vector<BondKind> all;
  for (Offset bond = 0; bond < bonds.count(); ++bond) all.push_back(bonds.kind[bond]);
  return all;
}

/// Reference distance of two points [m].
[[nodiscard]] inline double reference_distance(const Points& points, Index i, Index j) {
  const Coordinates a = points.position(i), b = points.position(j);
  return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
}

/// True if a point is at least `margin` [m] away from the faces of the box from the origin to
/// `extent` times the spacing.
[[nodiscard]] inline bool is_inside(const Points& points, Index i, const BoxSetting& box,
                                    double margin) {
  const Coordinates at = points.position(i);
  for (int c = 0; c < points.dimension; ++c) {
    if (at[c] < margin || at[c] > box.extent[c] * box.spacing - margin) return false;
  }
  return true;
}

}  // namespace peristat::tests
