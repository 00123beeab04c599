#pragma once

#include <array>
#include <memory>
#include <vector>

#include "assembly/terms/model.hpp"
#include "assembly/terms/states/state_term.hpp"
#include "src/geometry/lattice.hpp"
#include "src/materials/quadrature.hpp"

namespace peristat::benchmark_bodies {

/// A box of unit-spaced lattice points with horizon 3.015, the setting of all benchmarks.
inline constexpr double horizon = 3.015;

[[nodiscard]] inline Points box(int dimension, const std::array<int, 3>& extent,
                                const std::vector<ShapeStep>& changes = {}) {
  Lattice lattice;
  lattice.dimension = dimension;
  lattice.spacing = 1.0;
  Box shape;
  for (int c = 0; c < dimension; ++c) shape.max[c] = extent[c];
  lattice.shapes.push_back({ShapeStep::Action::add, shape});
  lattice.shapes.insert(lattice.shapes.end(), changes.begin(), changes.end());
  return make_points(lattice);
}

[[nodiscard]] inline BondSetting setting(int dimension, double reach = horizon) {
  return {{dimension, reach}};
}

/// Bonds with the micromodulus of a unit Young's modulus.
[[nodiscard]] inline Model model(const Points& points, double reach = horizon) {
  const BondSetting bond = setting(points.dimension, reach);
  return Model(make_bonds(points, SurfaceCorrection::none, bond, 1),
               Harmonic{micromodulus(1.0, bond)});
}

/// The state-based solid at finite strain on the same bonds, lambda = 1.5 mu.
[[nodiscard]] inline Model state_model(const Points& points, int threads, double reach = horizon) {
  BondSetting bond = setting(points.dimension, reach);
  bond.influence = [](double x) { return x; };
  Bonds bonds = make_bonds(points, SurfaceCorrection::none, bond, 1);
  StateShares shares;
  shares.whole = bonds.kind;
  shares.moment = moments_of(points, bonds);
  shares.constants.assign(std::size_t(points.count()), LamePair{0.6, 0.4});
  return Model(std::make_shared<StateTerm>(
      std::make_shared<const Bonds>(std::move(bonds)), Harmonic{1.0}, std::vector<char>(),
      std::move(shares), StateRules{Extension::finite, DamageDrive::release}, threads));
}

}  // namespace peristat::benchmark_bodies
