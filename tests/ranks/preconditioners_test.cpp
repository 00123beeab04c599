#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/linear/assembled_preconditioner.hpp"
#include "solvers/linear/gathered_pieces.hpp"
#include "solvers/linear/rigid_pieces.hpp"
#include "solvers/linear/surrogate.hpp"
#include "src/parallel/index_map.hpp"
#include "tests/ranks/parts_on_ranks.hpp"

namespace peristat::tests {
namespace {

/// Longer than wide, with parts across its longer direction.
RanksBody slender_bar() { return {"slender bar", lattice_box(3, {3, 3, 40}, {0.1, 0.1, 0.1})}; }

/// Thinner than the horizon.
RanksBody sheet() { return {"sheet", lattice_box(3, {2, 8, 18}, {0.1, 0.1, 0.1})}; }

/// With a slot half through that no bond crosses, where parts meet.
RanksBody notched_plate() {
  RanksBody body{"notched plate", lattice_box(2, {24, 40, 0}, {0.1, 0.1, 0.1})};
  body.lattice.shapes.push_back({ShapeStep::Action::subtract, Box{{0.0, 2.1}, {1.5, 2.5}}});
  return body;
}

/// That no bond joins, held at one end each.
RanksBody two_plates() {
  RanksBody body{"two plates", lattice_box(2, {24, 40, 0}, {0.1, 0.1, 0.1})};
  body.lattice.shapes.push_back({ShapeStep::Action::subtract, Box{{0.0, 2.1}, {3.0, 2.5}}});
  return body;
}

struct Kind {
  std::string name;
  std::function<std::unique_ptr<Preconditioner>(const IndexMap&)> make;
  /// Iterations on several ranks beyond those on one: what is added, and the factor.
  int added;
  double factor;
};

std::vector<Kind> all_kinds() {
  const auto assembled = [](MatrixPreconditionerKind kind) {
    return [kind](const IndexMap& index_map) {
      return std::make_unique<AssembledPreconditioner>(kind, index_map);
    };
  };
  return {
      // The same pieces on any number of ranks.
      {"rigid pieces",
       [](const IndexMap& index_map) { return std::make_unique<RigidPieces>(index_map); }, 1, 1.0},
      // A cycle for the springs where one rank has their factor.
      {"surrogate",
       [](const IndexMap& index_map) { return std::make_unique<Surrogate>(index_map); }, 6, 1.2},
      // The same polynomial.
      {"chebyshev", assembled(MatrixPreconditionerKind::chebyshev), 2, 1.0},
      // Factors within the rows of a rank tell nothing of what is beyond: it is no two-level
      // method.
      {"riluk", assembled(MatrixPreconditionerKind::riluk), 150, 1.0},
      // One rank smooths by Gauss and Seidel, and factorises a small body.
      {"multigrid", assembled(MatrixPreconditionerKind::multigrid), 6, 1.2},
  };
}

/// Ends along the last axis.
std::pair<double, double> ends_of(const Points& points) {
  const auto d = std::size_t(points.dimension);
  double low = 1e300, high = -1e300;
  for (std::size_t k = d - 1; k < points.reference.size(); k += d) {
    low = std::min(low, points.reference[k]);
    high = std::max(high, points.reference[k]);
  }
  return {low, high};
}

void expect_same_solution(const RanksBody& body, const Kind& kind, double depth) {
  SCOPED_TRACE(body.name + ", " + kind.name);
  const Communicator& communicator = all_ranks();
  Whole whole(body, SurfaceCorrection::none);
  const auto [low, high] = ends_of(whole.points);
  const Pulled pulled(whole.points, low, high, depth);
  Tangent stiffness(whole.assembler);
  const std::vector<double> rest(whole.points.reference.size(), 0.0);
  stiffness.linearise(whole.assembler, rest, 0.0);
  const Solved expected =
      solve(stiffness, pulled.flags, pulled.displacement, kind.make(whole_body()), sole_rank());
  EXPECT_EQ(expected.outcome, LinearOutcome::solved);

  OnRanks ranks(body, SurfaceCorrection::none);
  const Pulled mine(ranks.part.points, low, high, depth);
  const std::vector<double> rest_here(ranks.part.points.reference.size(), 0.0);
  ranks.stored.linearise(ranks.energy, rest_here, 0.0);
  const auto no_equation = without_ghosts(ranks.index_map, mine.flags, ranks.part.points.dimension);
  const Solved found =
      solve(ranks.stored, no_equation, mine.displacement, kind.make(ranks.index_map), communicator);
  EXPECT_EQ(found.outcome, LinearOutcome::solved);
  EXPECT_LE(found.iterations, kind.factor * expected.iterations + kind.added);
  EXPECT_EQ(communicator.min(double(found.iterations)), double(found.iterations));
  expect_near(ranks, found.displacement, expected.displacement, 1e-9);
  if (communicator.rank() == 0) {
    std::printf("%s, %s: %d iterations on %d ranks, %d on one\n", body.name.c_str(),
                kind.name.c_str(), found.iterations, communicator.count(), expected.iterations);
  }
}

TEST(PreconditionersOnRanks, solve_for_the_displacements_of_the_whole_body) {
  for (const RanksBody& body :
       {bar(), plate_with_hole(), block(), slender_bar(), sheet(), notched_plate()}) {
    for (const Kind& kind : all_kinds()) expect_same_solution(body, kind, 3.0);
  }
}

TEST(PreconditionersOnRanks, take_a_body_in_two) {
  expect_same_solution(two_plates(), all_kinds().front(), 3.0);
}

TEST(PreconditionersOnRanks, do_with_ranks_without_an_equation_and_without_a_point) {
  for (const Kind& kind : all_kinds()) {
    expect_same_solution(short_bar(), kind, 2.0);
    expect_same_solution(three_points(), kind, 0.5);
  }
}

TEST(PreconditionersOnRanks, need_no_stored_tangent_where_they_look_at_rows_alone) {
  const Communicator& communicator = all_ranks();
  OnRanks ranks(plate_with_hole(), SurfaceCorrection::volume);  // with ghosts that no bond reaches
  const Pulled mine(ranks.part.points, 0.35, 2.85);
  const std::vector<double> rest(ranks.part.points.reference.size(), 0.0);
  const auto no_equation = without_ghosts(ranks.index_map, mine.flags, 2);
  for (const bool is_surrogate : {false, true}) {
    std::vector<Solved> solved;
    for (TangentOperator* const tangent : ranks.tangents()) {
      tangent->linearise(ranks.energy, rest, 0.0);
      std::unique_ptr<Preconditioner> preconditioner;
      if (is_surrogate) {
        preconditioner = std::make_unique<Surrogate>(ranks.index_map);
      } else {
        preconditioner = std::make_unique<RigidPieces>(ranks.index_map);
      }
      solved.push_back(
          solve(*tangent, no_equation, mine.displacement, std::move(preconditioner), communicator));
      EXPECT_EQ(solved.back().outcome, LinearOutcome::solved);
    }
    EXPECT_NEAR(solved[0].iterations, solved[1].iterations, 1);
    EXPECT_LT(solved[0].iterations, 60);
    EXPECT_LT(distance(ranks.without_ghosts(solved[0].displacement),
                       ranks.without_ghosts(solved[1].displacement)),
              1e-9);
  }
}

TEST(PreconditionersOnRanks, tell_all_ranks_of_a_diagonal_that_is_not_positive) {
  OnRanks ranks(plate_with_hole(), SurfaceCorrection::none);
  const std::vector<double> rest(ranks.part.points.reference.size(), 0.0);
  ranks.stored.linearise(ranks.energy, rest, 0.0);
  if (all_ranks().rank() == all_ranks().count() - 1 && ranks.part.owned > 0) {
    for (double& entry : ranks.stored.diagonal) entry = -entry;
  }
  const FreeDofs free(without_ghosts(ranks.index_map, std::vector<char>(rest.size(), 0), 2), 2);
  for (const Kind& kind : all_kinds()) {
    SCOPED_TRACE(kind.name);
    IterativeSolver solver(KrylovMethod::conjugate_gradients, kind.make(ranks.index_map), 100,
                           KrylovOptions{}.restart, all_ranks());
    EXPECT_EQ(solver.analyze(ranks.stored.pattern, free), LinearOutcome::solved);
    EXPECT_NE(solver.factorize(ranks.stored, FactorUse::factorize_now), LinearOutcome::solved);
  }
}

TEST(GatheredPieces, add_up_what_ranks_have_of_a_piece) {
  const Communicator& ranks = all_ranks();
  // A chain: each rank has a piece of its own, and one with the next.
  const std::int64_t me = ranks.rank();
  const std::vector<std::int64_t> labels{100 * me + 100, 100 * me};
  const GatheredPieces pieces(ranks, labels);
  EXPECT_EQ(pieces.count(), ranks.count() + 1);
  const std::vector<double> sums = pieces.sum({1.0, 10.0, 2.0, 20.0}, 2);
  EXPECT_EQ(sums.empty(), !pieces.gathers());
  const std::vector<double> mine = pieces.share_out(sums, 2);
  EXPECT_EQ(mine[0], me + 1 < ranks.count() ? 3.0 : 1.0);
  EXPECT_EQ(mine[3], me > 0 ? 30.0 : 20.0);
}

}  // namespace
}  // namespace peristat::tests
