#include "solvers/ranks/part_tangent.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/linear/block_jacobi.hpp"
#include "src/parallel/communicator.hpp"
#include "tests/ranks/parts_on_ranks.hpp"

namespace peristat::tests {
namespace {

TEST(AssemblerOfPart, is_that_of_the_whole_body) {
  constexpr double round_off = 1e-12;
  for (const RanksBody& body : all_bodies()) {
    for (const auto surface :
         {SurfaceCorrection::none, SurfaceCorrection::volume, SurfaceCorrection::energy}) {
      SCOPED_TRACE(body.name + ", surface correction " + std::to_string(int(surface)));
      Whole whole(body, surface);
      OnRanks ranks(body, surface);
      EXPECT_EQ(count_bonds(ranks.part.points, ranks.model.bonds(), all_ranks()),
                whole.model.bonds().count());

      const std::size_t dofs = whole.points.reference.size();
      const std::vector<double> u = Random(3).vector(dofs, 0.1 * whole.points.spacing);
      const std::vector<double> v = Random(4).vector(dofs);
      std::vector<double> forces(dofs), product(dofs);
      const Evaluation expected = whole.assembler.gradient(u, forces);
      whole.assembler.product(u, v, product);

      std::vector<double> here = ranks.part.owned > 0 ? ranks.of_part(u) : std::vector<double>();
      here.resize(ranks.part.points.reference.size());
      const auto owned = std::ptrdiff_t(ranks.without_ghosts(here).size());
      std::fill(here.begin() + owned, here.end(), 1e3);  // to be overwritten
      ranks.index_map.update_ghosts(here);
      EXPECT_EQ(here, ranks.of_part(u));
      std::vector<double> mine(here.size());
      const Evaluation found = ranks.energy.gradient(here, mine);
      EXPECT_NEAR(found.energy, expected.energy, round_off * expected.energy);
      EXPECT_FALSE(found.degenerate);
      EXPECT_EQ(ranks.energy.energy(here).energy, found.energy);
      expect_near(ranks, mine, forces, round_off);
      EXPECT_TRUE(std::all_of(mine.begin() + owned, mine.end(), [](double f) { return f == 0.0; }));

      for (TangentOperator* const tangent : ranks.tangents()) {
        tangent->linearise(ranks.energy, here, 0.0);
        std::vector<double> factor = ranks.of_part(v);
        std::fill(factor.begin() + owned, factor.end(), 1e3);
        tangent->multiply(factor, factor);
        expect_near(ranks, factor, product, round_off);
      }
    }
  }
}

TEST(AssemblerOfPart, tells_all_ranks_of_a_point_without_a_place) {
  OnRanks ranks(plate_with_hole(), SurfaceCorrection::none);
  std::vector<double> u(ranks.part.points.reference.size(), 0.0);
  const auto first = std::find(ranks.part.number.begin(), ranks.part.number.end(), 0);
  if (first != ranks.part.number.end()) {
    u[2 * std::size_t(first - ranks.part.number.begin())] = std::nan("");
  }
  EXPECT_TRUE(ranks.energy.energy(u).degenerate);
}

TEST(AssemblerOfPart, asks_for_ghosts_as_far_as_bonds_reach) {
  const RanksBody body = plate_with_hole();
  const Communicator& ranks = all_ranks();
  const Part part = distribute(make_slab(body.lattice, ranks), body.setting().horizon,
                               0.9 * body.setting().horizon, ranks, 1);
  EXPECT_THROW(
      static_cast<void>(make_bonds(part, SurfaceCorrection::none, body.setting(), ranks, 1)),
      std::logic_error);
}

std::unique_ptr<Preconditioner> blocks() {
  return std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points);
}

TEST(PartTangent, solves_for_the_displacements_of_the_whole_body) {
  const Communicator& communicator = all_ranks();
  for (const RanksBody& body : {bar(), plate_with_hole(), block()}) {
    SCOPED_TRACE(body.name);
    Whole whole(body, SurfaceCorrection::none);
    const auto d = std::size_t(whole.points.dimension);
    double low = 1e300, high = -1e300;
    for (std::size_t k = d - 1; k < whole.points.reference.size(); k += d) {
      low = std::min(low, whole.points.reference[k]);
      high = std::max(high, whole.points.reference[k]);
    }
    const Pulled pulled(whole.points, low, high);
    MatrixFreeTangent stiffness(whole.assembler);
    stiffness.linearise(whole.assembler, std::vector<double>(d * whole.points.volume.size()), 0.0);
    const Solved expected =
        solve(stiffness, pulled.flags, pulled.displacement, blocks(), sole_rank());
    EXPECT_EQ(expected.outcome, LinearOutcome::solved);

    OnRanks ranks(body, SurfaceCorrection::none);
    const Pulled mine(ranks.part.points, low, high);
    PartTangent<MatrixFreeTangent>& tangent = ranks.matrix_free;
    tangent.linearise(ranks.energy, std::vector<double>(ranks.part.points.reference.size()), 0.0);
    const Solved found =
        solve(tangent, without_ghosts(ranks.index_map, mine.flags, ranks.part.points.dimension),
              mine.displacement, blocks(), communicator);
    EXPECT_EQ(found.outcome, LinearOutcome::solved);
    EXPECT_NEAR(found.iterations, expected.iterations, 1);
    EXPECT_EQ(communicator.min(double(found.iterations)),
              communicator.max(double(found.iterations)));
    expect_near(ranks, found.displacement, expected.displacement, 1e-9);

    // Traffic is of one solve: the others come after it.
    const Traffic traffic = ranks.index_map.traffic();
    const double messages = communicator.sum(double(traffic.messages));
    const double bytes = communicator.sum(double(traffic.bytes));
    const double most = communicator.max(double(ranks.part.owned));
    const double ghosts = communicator.sum(double(ranks.part.ghosts()));
    for (const auto method : {KrylovMethod::conjugate_gradients, KrylovMethod::minres,
                              KrylovMethod::gmres, KrylovMethod::bicgstab}) {
      const Solved again =
          solve(tangent, without_ghosts(ranks.index_map, mine.flags, ranks.part.points.dimension),
                mine.displacement, blocks(), communicator, method);
      EXPECT_EQ(again.outcome, LinearOutcome::solved);
      expect_near(ranks, again.displacement, expected.displacement, 1e-9);
      if (method == KrylovMethod::conjugate_gradients) {
        EXPECT_EQ(again.displacement, found.displacement);  // to the last bit
      }
    }
    if (communicator.rank() > 0) continue;
    std::printf(
        "%s: %d ranks, %d points, at most %.0f on one, %.0f ghosts; %d iterations (%d), "
        "%d exchanges, %.0f messages, %.0f bytes\n",
        body.name.c_str(), communicator.count(), int(ranks.part.whole), most, ghosts,
        found.iterations, expected.iterations, int(traffic.exchanges), messages, bytes);
  }
}

}  // namespace
}  // namespace peristat::tests
