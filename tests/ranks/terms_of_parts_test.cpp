#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/tangent.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "solvers/study/body.hpp"
#include "solvers/study/bonds_of_part.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/slab.hpp"
#include "tests/bodies.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

constexpr double round_off = 1e-12;

RanksBody perturbed(RanksBody body) {
  body.name += ", perturbed";
  body.lattice.perturbation = 0.1;
  return body;
}

RanksBody square_with_hole() {
  RanksBody body{"square with a hole", lattice_box(2, {13, 15, 0}, {0.1, 0.1, 0.1}), 2.415};
  body.lattice.shapes.push_back({ShapeStep::Action::subtract, Disk{{0.9, 1.1}, 0.32}});
  body.lattice.layers = {{"below", {1, -1}, 2}};
  return body;
}

RanksBody cube() { return {"cube", lattice_box(3, {5, 4, 6}, {0.1, 0.1, 0.1}), 1.815}; }

/// Fewer points than there may be ranks, but for a triangle.
RanksBody three_in_a_corner() {
  RanksBody body{"three in a corner", lattice_box(2, {2, 2, 0}, {0.1, 0.1, 0.1}), 1.515};
  Box box;
  box.min = {0.4, 0.4};
  box.max = {0.5, 0.5};
  body.lattice.shapes.push_back({ShapeStep::Action::subtract, box});
  return body;
}

BodySpecification specification(const RanksBody& body, MaterialModel model) {
  BodySpecification of;
  of.horizon = body.setting().horizon;
  of.material.model = model;
  return of;
}

BodySpecification cpd(const RanksBody& body) {
  BodySpecification of = specification(body, MaterialModel::cpd);
  of.material.c1 = 2.0;
  of.material.c2 = 3e3;
  if (body.lattice.dimension == 3) of.material.c3 = 5e7;
  return of;
}

BodySpecification states(const RanksBody& body, VolumeCorrection volume) {
  BodySpecification of = specification(body, MaterialModel::lps);
  of.form = SolidForm::energy;
  of.material.youngs_modulus = 3.0;
  of.material.poisson_ratio = 0.37;
  of.material.influence = "gaussian";
  of.volume_correction = volume;
  return of;
}

std::unique_ptr<const Body> whole_body(const RanksBody& body, const BodySpecification& of) {
  return make_body(make_points(body.lattice), of, 1);
}

std::unique_ptr<const Body> part_of_body(const RanksBody& body, const BodySpecification& of) {
  const Communicator& ranks = all_ranks();
  Part slab = make_slab(body.lattice, ranks);
  const BondSetting setting = bond_setting(of, slab.points);
  const double reach =
      reach_of_bonds(slab.points, of.surface_correction, setting, ranks, bonds_of_part(of));
  return make_body(distribute(std::move(slab), of.horizon, reach, ranks, 1), of, ranks, 1);
}

/// A body as one rank has it, and this rank's part of it.
struct Both {
  Both(const RanksBody& body, const BodySpecification& of)
      : whole(whole_body(body, of)),
        part(part_of_body(body, of)),
        energy(whole->points, whole->model, 1),
        mine(part->points, part->model, 1, part->part.get()) {}

  /// What the whole body has, of owned points; ghosts have what has to be overwritten.
  [[nodiscard]] std::vector<double> of_part(const std::vector<double>& field) const {
    const std::size_t width = field.size() / whole->points.volume.size();
    std::vector<double> result(part->points.volume.size() * width, 1e3);
    for (std::size_t i = 0; i < part->part->number().size(); ++i) {
      const auto number = std::size_t(part->part->number()[i]);
      std::copy_n(field.begin() + std::ptrdiff_t(number * width), width,
                  result.begin() + std::ptrdiff_t(i * width));
    }
    return result;
  }

  void expect_near(std::span<const double> found, const std::vector<double>& field,
                   const std::string& what) const {
    const std::vector<double> expected = of_part(field);
    const std::size_t width = field.size() / whole->points.volume.size();
    const double scale = largest(field);
    EXPECT_GT(scale, 0.0) << what;
    double difference = 0.0;
    for (std::size_t k = 0; k < width * part->part->number().size(); ++k) {
      difference = std::max(difference, std::abs(found[k] - expected[k]));
    }
    EXPECT_LE(difference, round_off * scale) << what;
  }

  std::unique_ptr<const Body> whole, part;
  Assembler energy, mine;
};

/// A product with a tangent that is stored, and its diagonal blocks.
struct Stored {
  Stored(Assembler& energy, const std::vector<double>& u, double projection)
      : tangent(energy), history(energy.initial_history()) {
    tangent.linearise(energy, {u, history}, projection);
  }
  [[nodiscard]] std::vector<double> times(const std::vector<double>& v) const {
    std::vector<double> product(v.size());
    tangent.multiply(v, product);
    return product;
  }
  Tangent tangent;
  History history;
};

void expect_same_energies(Both& both, double scale) {
  const std::size_t dofs = both.whole->points.reference.size();
  const std::size_t points = both.whole->points.volume.size();
  const auto d = std::size_t(both.whole->points.dimension);
  const std::vector<double> u = Random(3).vector(dofs, scale * both.whole->points.spacing);
  const std::vector<double> v = Random(4).vector(dofs);
  std::vector<double> here = both.of_part(u), direction = both.of_part(v);
  both.part->part->update_ghosts(here);
  both.part->part->update_ghosts(direction);

  std::vector<double> forces(dofs), mine(here.size());
  const Evaluation expected = both.energy.gradient(u, forces);
  const Evaluation found = both.mine.gradient(here, mine);
  EXPECT_NEAR(found.energy, expected.energy, round_off * std::abs(expected.energy));
  EXPECT_EQ(both.mine.energy(here).energy, found.energy);
  EXPECT_FALSE(found.degenerate);
  both.expect_near(mine, forces, "forces");

  std::vector<double> energies(points), my_energies(both.part->points.volume.size());
  both.energy.point_energies(u, energies);
  both.mine.point_energies(here, my_energies);
  both.expect_near(my_energies, energies, "energies of points");

  std::vector<double> virials(points * d * d), my_virials(my_energies.size() * d * d);
  both.energy.virials(u, virials);
  both.mine.virials(here, my_virials);
  both.expect_near(my_virials, virials, "virials");

  std::vector<double> product(dofs), my_product(here.size());
  both.energy.product(u, v, product);
  both.mine.product(here, direction, my_product);
  both.expect_near(my_product, product, "product");
  for (const double projection : {0.0, 1.0}) {
    const Stored tangent(both.energy, u, projection), my_tangent(both.mine, here, projection);
    both.expect_near(my_tangent.times(direction), tangent.times(v), "product of a stored tangent");
    both.expect_near(my_tangent.tangent.diagonal, tangent.tangent.diagonal, "diagonal blocks");
  }
}

void expect_same_counts(const Both& both) {
  const Communicator& ranks = all_ranks();
  const Index owned = both.part->part->owned();
  EXPECT_EQ(count_bonds(both.part->points, both.part->model.bonds(), ranks),
            both.whole->model.bonds().count());
  const auto& terms = both.whole->model.terms();
  EXPECT_EQ(both.part->model.terms().size(), terms.size());
  for (std::size_t slot = 0; slot < terms.size(); ++slot) {
    const auto counts = terms[slot]->counts(), mine = both.part->model.terms()[slot]->counts();
    EXPECT_EQ(mine.size(), counts.size());
    for (std::size_t kind = 0; kind < counts.size(); ++kind) {
      EXPECT_EQ(mine[kind].name, counts[kind].name);
      EXPECT_EQ(count_interactions(both.part->points, mine[kind], ranks), counts[kind].count)
          << mine[kind].name;
      for (std::size_t i = 0; i < std::size_t(owned); ++i) {
        EXPECT_EQ(mine[kind].per_point[i],
                  counts[kind].per_point[std::size_t(both.part->part->number()[i])]);
      }
    }
  }
}

TEST(TermsOfPart, triangles_and_tetrahedra_are_those_of_the_whole_body) {
  for (const RanksBody& body :
       {strip(), three_in_a_corner(), square_with_hole(), perturbed(square_with_hole()),
        wide_layers(), cube(), perturbed(cube())}) {
    for (const auto weights : {InteractionWeights::mean, InteractionWeights::bulk}) {
      SCOPED_TRACE(body.name + ", weights " + std::to_string(int(weights)));
      BodySpecification of = cpd(body);
      of.weights = weights;
      if (weights == InteractionWeights::bulk) of.material.influence = "gaussian";
      Both both(body, of);
      expect_same_energies(both, 0.05);
      expect_same_counts(both);
    }
  }
}

TEST(TermsOfPart, constants_from_moduli_are_those_of_the_whole_lattice) {
  const RanksBody body = cube();
  BodySpecification of = specification(body, MaterialModel::cpd);
  of.material.youngs_modulus = 2e9;
  of.material.poisson_ratio = 0.35;
  Both both(body, of);
  expect_same_energies(both, 0.02);
}

TEST(TermsOfPart, states_are_those_of_the_whole_body) {
  for (const RanksBody& body : {strip(), plate_with_hole(), perturbed(square_with_hole()),
                                wide_layers(), cube(), block()}) {
    for (const auto volume : {VolumeCorrection::none, VolumeCorrection::linear}) {
      if (volume != VolumeCorrection::none && !body.lattice.spacing.is_square()) continue;
      SCOPED_TRACE(body.name + ", volume correction " + std::to_string(int(volume)));
      Both both(body, states(body, volume));
      expect_same_energies(both, 0.05);
      expect_same_counts(both);
    }
  }
}

TEST(TermsOfPart, are_those_that_pre_cracks_leave) {
  const RanksBody body = perturbed(square_with_hole());
  for (BodySpecification of : {cpd(body), states(body, VolumeCorrection::none)}) {
    of.cracks = {CrackSegment{{0.2, 1.31}, {1.1, 1.43}}};
    Both both(body, of);
    EXPECT_GT(both.whole->cut_bonds.size(), 0U);
    expect_same_energies(both, 0.05);
    expect_same_counts(both);
    both.expect_near(both.part->cut_weight, both.whole->cut_weight, "what is cut");
  }
}

TEST(TermsOfPart, without_triangles_are_refused_by_all_ranks) {
  const RanksBody row{"row", lattice_box(2, {9, 1, 0}, {0.1, 0.1, 0.1}), 3.015};
  const BodySpecification of = cpd(row);
  const auto key_of = [&] {
    try {
      static_cast<void>(part_of_body(row, of));
    } catch (const InputError& error) {
      return std::string(error.key());
    }
    return std::string("none");
  };
  EXPECT_EQ(key_of(), "material.c2");
}

}  // namespace
}  // namespace peristat::tests
