#include "assembly/terms/collocation/collocation_operator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "assembly/terms/collocation/make_collocation_network.hpp"
#include "src/geometry/lattice.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/neighbourhood/ghost_sites.hpp"
#include "src/neighbourhood/search.hpp"

namespace peristat {
namespace {

/// A square or cube of side 1 with free surfaces all round.
struct Block {
  Points points;
  Bonds bonds{{0}, {}, {}};
  CollocationSetting whole, local;

  Block(int dimension, int per_side, double horizon_ratio, double perturbation,
        LamePair constants = lame_constants(1.0, 0.3, 3, PlaneState::strain)) {
    Lattice lattice;
    lattice.dimension = dimension;
    lattice.spacing = 1.0 / per_side;
    lattice.perturbation = perturbation;
    lattice.shapes = {{ShapeStep::Action::add, Box{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}}};
    points = make_points(lattice);
    const double horizon = horizon_ratio / per_side;
    points.ghosts = ghost_sites(lattice, points, horizon).reference;
    bonds = search_bonds(points, horizon, 1);
    auto of_points = std::make_shared<LameConstants>();
    of_points->lambda.assign(points.volume.size(), constants.lambda);
    of_points->mu.assign(points.volume.size(), constants.mu);
    auto made = make_collocation_network(points, bonds, horizon, 5, 2);
    whole = {std::make_shared<CollocationNetwork>(std::move(made.network)), of_points,
             TractionForm::full};
    local = {std::make_shared<CollocationNetwork>(make_local_network(points, bonds)), of_points,
             TractionForm::full};
  }

  [[nodiscard]] std::size_t dofs() const { return points.reference.size(); }

  /// A share of the bonds, by chance.
  [[nodiscard]] std::vector<char> broken(double share, unsigned seed) const {
    std::mt19937 random(seed);
    std::vector<char> flags(std::size_t(bonds.count()));
    for (char& flag : flags) flag = double(random()) < share * 4294967296.0;
    return flags;
  }
};

Eigen::MatrixXd dense(const SparseRows& rows) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
  for (Index r = 0; r < rows.rows(); ++r) {
    for (Offset e = rows.offset[std::size_t(r)]; e < rows.offset[std::size_t(r) + 1]; ++e) {
      matrix(r, rows.column[std::size_t(e)]) += rows.value[std::size_t(e)];
    }
  }
  return matrix;
}

Eigen::MatrixXd by_columns(CollocationOperator& of, std::size_t dofs) {
  Eigen::MatrixXd matrix(dofs, dofs);
  std::vector<double> unit(dofs), force(dofs);
  for (std::size_t c = 0; c < dofs; ++c) {
    unit.assign(dofs, 0.0);
    unit[c] = 1.0;
    of.forces(unit, {}, force);
    matrix.col(Eigen::Index(c)) =
        Eigen::Map<const Eigen::VectorXd>(force.data(), Eigen::Index(dofs));
  }
  return matrix;
}

void expect_rows_to_be_the_operator(const Block& block, const CollocationSetting& setting,
                                    const std::vector<char>& broken) {
  CollocationOperator of(block.points, setting, 2);
  of.update(broken);
  const Eigen::MatrixXd expected = by_columns(of, block.dofs()), rows = dense(of.rows());
  const double size = expected.cwiseAbs().maxCoeff();
  EXPECT_LT((rows - expected).cwiseAbs().maxCoeff(), 1e-13 * size);
  const auto d = Eigen::Index(block.points.dimension);
  const std::vector<double>& diagonal = of.diagonal();
  const std::vector<double>& bounds = of.bounds_of_row_sums();
  for (Eigen::Index r = 0; r < expected.rows(); ++r) {
    for (Eigen::Index c = 0; c < d; ++c) {
      EXPECT_NEAR(diagonal[std::size_t(r * d + c)], expected(r, r / d * d + c), 1e-13 * size);
    }
    EXPECT_GE(bounds[std::size_t(r)] * (1.0 + 1e-12), expected.row(r).cwiseAbs().sum());
  }
}

TEST(CollocationOperator, TellsItsRows) {
  for (const double perturbation : {0.0, 0.2}) {
    const Block plane(2, 7, 3.5, perturbation);
    expect_rows_to_be_the_operator(plane, plane.whole, {});
    expect_rows_to_be_the_operator(plane, plane.whole, plane.broken(0.3, 1));
    expect_rows_to_be_the_operator(plane, plane.local, plane.broken(0.3, 1));
  }
  const Block cube(3, 4, 3.2, 0.1);
  expect_rows_to_be_the_operator(cube, cube.whole, cube.broken(0.2, 2));
  expect_rows_to_be_the_operator(cube, cube.local, {});
}

TEST(CollocationOperator, TakesUpWhatChangesAsIfItHadAlwaysBeenSo) {
  const Block block(2, 9, 3.5, 0.1);
  CollocationOperator in_steps(block.points, block.whole, 2);
  std::vector<double> displacement(block.dofs()), first(block.dofs()), second(block.dofs());
  for (std::size_t k = 0; k < displacement.size(); ++k)
    displacement[k] = std::sin(1.0 + 7.0 * double(k));
  const std::vector<char> some = block.broken(0.1, 3);
  std::vector<char> more = block.broken(0.2, 4);
  std::transform(some.begin(), some.end(), more.begin(), more.begin(),
                 [](char a, char b) { return char(a | b); });
  for (const std::vector<char>& broken : {some, more, some, std::vector<char>()}) {
    in_steps.update(broken);
    CollocationOperator anew(block.points, block.whole, 1);
    anew.update(broken);
    in_steps.forces(displacement, {}, first);
    anew.forces(displacement, {}, second);
    EXPECT_EQ(first, second);
  }
}

/// Debris with few bonds: the inverse of its tensor would make the operator unstable, most of all
/// where lambda < mu.
TEST(CollocationOperator, StaysPositiveHoweverFewBondsAreLeft) {
  const Block block(2, 7, 3.5, 0.1, lame_constants(1.0, 0.1, 2, PlaneState::stress));
  for (const double share : {0.5, 0.8, 0.95}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      CollocationOperator of(block.points, block.whole, 1);
      of.update(block.broken(share, seed));
      const Eigen::EigenSolver<Eigen::MatrixXd> spectrum(dense(of.rows()), false);
      const Eigen::VectorXd real = spectrum.eigenvalues().real();
      EXPECT_GT(real.minCoeff(), -1e-12 * real.maxCoeff()) << share << ' ' << seed;
    }
  }
}

TEST(CollocationOperator, HasItsEnergyWhereBallsAreWholeAndAlike) {
  const Block block(2, 15, 3.0, 0.0);
  CollocationOperator of(block.points, block.whole, 1);
  std::vector<double> displacement(block.dofs(), 0.0), force(block.dofs());
  std::vector<double> energies(block.points.volume.size());
  for (std::size_t i = 0; i < energies.size();
       ++i) {  // nothing moves within two horizons of a side
    for (std::size_t c = 0; c < 2; ++c) {
      const double x = block.points.reference[2 * i], y = block.points.reference[2 * i + 1];
      const bool is_inside = std::min({x, y, 1.0 - x, 1.0 - y}) > 6.0 / 15.0;
      if (is_inside) displacement[2 * i + c] = std::sin(1.0 + 5.0 * double(2 * i + c));
    }
  }
  of.forces(displacement, {}, force);
  of.energies(displacement, energies);
  double energy = 0.0, work = 0.0;
  for (const double of_point : energies) energy += of_point;
  for (std::size_t k = 0; k < force.size(); ++k) work += 0.5 * force[k] * displacement[k];
  EXPECT_NEAR(energy, work, 1e-13 * work);
}

}  // namespace
}  // namespace peristat
