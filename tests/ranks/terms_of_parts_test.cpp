#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "assembly/operators/rows_of_energy.hpp"
#include "assembly/operators/tangent.hpp"
#include "solvers/body/body.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/part_bonds.hpp"
#include "solvers/ranks/part_tangent.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/slab.hpp"
#include "src/neighbourhood/ghost_sites.hpp"
#include "src/parallel/communicator.hpp"
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
  const double reach = reach_of_bonds(slab.points, of.surface_correction, setting, ranks,
                                      formulation_of(of).part_bonds);
  return make_body(distribute(std::move(slab), of.horizon, reach, ranks, 1), of, ranks, 1);
}

/// A body as one rank has it, and this rank's part of it.
struct Both {
  Both(const RanksBody& body, const BodySpecification& of)
      : Both(whole_body(body, of), part_of_body(body, of)) {}
  Both(std::unique_ptr<const Body> all, std::unique_ptr<const Body> here)
      : whole(std::move(all)),
        part(std::move(here)),
        energy(whole->points, whole->model, 1),
        mine(part->points, part->model, 1, *part->index_map) {}

  /// What the whole body has, of owned points; ghosts have what has to be overwritten.
  [[nodiscard]] std::vector<double> of_part(const std::vector<double>& field) const {
    const std::size_t width = field.size() / whole->points.volume.size();
    std::vector<double> result(part->points.volume.size() * width, 1e3);
    for (std::size_t i = 0; i < part->index_map->numbered().owned.size(); ++i) {
      const auto number = std::size_t(part->index_map->numbered().owned[i]);
      std::copy_n(field.begin() + std::ptrdiff_t(number * width), width,
                  result.begin() + std::ptrdiff_t(i * width));
    }
    return result;
  }

  void expect_near(std::span<const double> found, const std::vector<double>& field,
                   const std::string& what, double tolerance = round_off) const {
    const std::vector<double> expected = of_part(field);
    const std::size_t width = field.size() / whole->points.volume.size();
    const double scale = largest(field);
    EXPECT_GT(scale, 0.0) << what;
    double difference = 0.0;
    for (std::size_t k = 0; k < width * part->index_map->numbered().owned.size(); ++k) {
      difference = std::max(difference, std::abs(found[k] - expected[k]));
    }
    EXPECT_LE(difference, tolerance * scale) << what;
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
  both.part->index_map->update_ghosts(here);
  both.part->index_map->update_ghosts(direction);

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
  const Index owned = both.part->index_map->owned();
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
                  counts[kind].per_point[std::size_t(both.part->index_map->numbered().owned[i])]);
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

TEST(TermsOfPart, contacts_are_those_of_the_whole_body) {
  for (RanksBody body : {perturbed(square_with_hole()), cube()}) {
    SCOPED_TRACE(body.name);
    BodySpecification of = specification(body, MaterialModel::bond);
    of.material.youngs_modulus = 3.0;
    if (body.lattice.dimension == 2) {
      of.cracks = {CrackSegment{{0.2, 1.31}, {1.1, 1.43}}};
    } else {
      of.cracks = {
          CrackPolygon{{{0.2, 0.2, 0.6}, {0.9, 0.2, 0.6}, {0.9, 0.9, 0.6}, {0.2, 0.9, 0.6}}}};
    }
    of.contacts = {{.softness = 1e-3}};
    BodySpecification without = of;
    without.contacts.clear();
    Both both(body, of), bare(body, without);
    const std::vector<double> u =
        Random(3).vector(both.whole->points.reference.size(), 0.05 * both.whole->points.spacing);
    EXPECT_GT(both.energy.energy(u).energy, 1.0001 * bare.energy.energy(u).energy);  // some press
    expect_same_energies(both, 0.05);
  }
}

TEST(TermsOfPart, contacts_take_over_bonds_that_another_rank_counts) {
  const RanksBody body = bar();
  const double spacing = body.lattice.spacing, middle = 0.3 + 20.0 * spacing;
  BodySpecification of = specification(body, MaterialModel::bond);
  of.material.youngs_modulus = 3.0;
  of.material.damage.law = DamageLaw::critical_stretch;
  of.material.damage.critical = 0.004;
  of.contacts = {{.softness = 1e-3}};
  Both both(body, of);
  // So little that the pairs that are near are kept.
  const auto opened_by = [&](const Points& points, double gap) {
    std::vector<double> u(points.reference.size(), 0.0);
    for (std::size_t k = 0; k < u.size(); ++k) {
      if (points.reference[k] > middle) u[k] = gap;
    }
    return u;
  };
  const auto energy_after_tearing = [&](Assembler& assembler, const Points& points) {
    History history = assembler.initial_history();
    const std::vector<double> pressed = opened_by(points, -0.05 * spacing);
    const double whole = assembler.energy({pressed, history}).energy;
    static_cast<void>(assembler.commit(opened_by(points, 0.05 * spacing), history));
    std::vector<double> forces(points.reference.size());
    const double torn = assembler.gradient({pressed, history}, forces).energy;
    EXPECT_GT(std::abs(torn - whole), 0.1 * whole);  // contact of one pair in place of six bonds
    return std::pair(torn, forces);
  };
  const auto [energy, forces] = energy_after_tearing(both.energy, both.whole->points);
  const auto [found, mine] = energy_after_tearing(both.mine, both.part->points);
  EXPECT_NEAR(found, energy, round_off * energy);
  both.expect_near(mine, forces, "forces of contact");
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

BodySpecification linear(const RanksBody& body) {
  BodySpecification of = specification(body, MaterialModel::bond);
  of.material.kinematics = Kinematics::linear;
  of.material.youngs_modulus = 3.0;
  return of;
}

TEST(TermsOfPart, linear_bonds_are_those_of_the_whole_body) {
  for (const RanksBody& body : {bar(), three_points(), short_bar(), strip(), plate_with_hole(),
                                wide_layers(), cube(), block()}) {
    SCOPED_TRACE(body.name);
    Both both(body, linear(body));
    expect_same_energies(both, 0.05);
    expect_same_counts(both);
  }
}

/// Commits states that damage more and more.
/// @return bonds that break
Index expect_same_damage(Both& both) {
  const std::size_t dofs = both.whole->points.reference.size();
  History of_whole = both.energy.initial_history(), of_part = both.mine.initial_history();
  Index broken = 0;
  for (int pass = 0; pass < 4; ++pass) {
    SCOPED_TRACE("pass " + std::to_string(pass));
    const std::vector<double> u =
        Random(unsigned(5 + pass)).vector(dofs, (0.02 + 0.02 * pass) * both.whole->points.spacing);
    std::vector<double> here = both.of_part(u);
    both.part->index_map->update_ghosts(here);
    const DamageGrowth expected = both.energy.growth({u, of_whole});
    const DamageGrowth growth = both.mine.growth({here, of_part});
    EXPECT_EQ(growth.degrading, expected.degrading);
    EXPECT_EQ(growth.breaking, expected.breaking);
    EXPECT_NEAR(growth.utilisation, expected.utilisation, round_off * expected.utilisation);

    std::vector<double> forces(dofs), mine(here.size());
    const bool in_steps = pass % 2 == 1;
    const Evaluation committed = in_steps ? both.energy.commit_forces(u, of_whole, forces)
                                          : both.energy.commit(u, of_whole, forces);
    const Evaluation found = in_steps ? both.mine.commit_forces(here, of_part, mine)
                                      : both.mine.commit(here, of_part, mine);
    EXPECT_EQ(found.growth.degrading, committed.growth.degrading);
    EXPECT_EQ(found.growth.breaking, committed.growth.breaking);
    EXPECT_EQ(found.moves_equilibrium, committed.moves_equilibrium);
    EXPECT_NEAR(found.released, committed.released, round_off * std::abs(committed.released));
    if (largest(forces) > 0.0) {
      both.expect_near(mine, forces, "forces");
    } else {
      EXPECT_EQ(largest(mine), 0.0);  // nothing is left
    }
    if (!in_steps) {
      EXPECT_NEAR(found.energy, committed.energy, round_off * committed.energy);
    }
    std::vector<double> damage(both.whole->points.volume.size());
    std::vector<double> damage_here(both.part->points.volume.size());
    const DamageState state = both.energy.assess(of_whole, both.whole->cut_weight, damage);
    const DamageState state_here = both.mine.assess(of_part, both.part->cut_weight, damage_here);
    EXPECT_EQ(state_here.broken_bonds, state.broken_bonds);
    EXPECT_NEAR(state_here.dissipated_energy, state.dissipated_energy,
                round_off * state.dissipated_energy);
    EXPECT_NEAR(state_here.max_damage, state.max_damage, round_off);
    if (state.max_damage > 0.0) both.expect_near(damage_here, damage, "damage");
    broken = state.broken_bonds;
  }
  return broken;
}

TEST(TermsOfPart, points_fail_as_those_of_the_whole_body) {
  for (const RanksBody& body :
       {bar(), three_points(), short_bar(), strip(), plate_with_hole(), block()}) {
    SCOPED_TRACE(body.name);
    BodySpecification of = linear(body);
    of.material.damage.law = DamageLaw::energy_density;
    of.material.damage.fracture_energy = 2e-3 * of.horizon;
    Both both(body, of);
    EXPECT_GT(expect_same_damage(both), 0);
  }
}

TEST(TermsOfPart, states_lose_what_those_of_the_whole_body_do) {
  for (const RanksBody& body :
       {strip(), plate_with_hole(), perturbed(square_with_hole()), wide_layers(), cube()}) {
    SCOPED_TRACE(body.name);
    BodySpecification of = states(body, VolumeCorrection::none);
    of.material.damage.law = DamageLaw::critical_stretch;
    of.material.damage.critical = 0.06;
    Both both(body, of);
    EXPECT_GT(expect_same_damage(both), 0);
  }
}

/// Two balls of bonds thick.
RanksBody thick_plate() {
  RanksBody body{"thick plate", lattice_box(2, {17, 15, 0}, {0.1, 0.1, 0.1}), 2.515};
  body.lattice.layers = {{"below", {1, -1}, 3}};
  return body;
}

BodySpecification collocated(const RanksBody& body) {
  BodySpecification of = specification(body, MaterialModel::lps);
  of.material.youngs_modulus = 3.0;
  of.material.poisson_ratio = 0.3;
  return of;
}

/// With the places that hold no point, which fill the balls of points.
struct BothCollocated : Both {
  static Points whole_points(const RanksBody& body, const BodySpecification& of) {
    Points points = make_points(body.lattice);
    points.ghosts = ghost_sites(body.lattice, points, of.horizon).reference;
    return points;
  }
  static std::unique_ptr<const Body> part_of(const RanksBody& body, const BodySpecification& of) {
    const Communicator& ranks = all_ranks();
    Part slab = make_slab(body.lattice, ranks);
    const BondSetting setting = bond_setting(of, slab.points);
    const double reach = reach_of_bonds(slab.points, of.surface_correction, setting, ranks,
                                        formulation_of(of).part_bonds) +
                         ranks.max(reach_beyond_balls(body.lattice, slab.points));
    Part part = distribute(std::move(slab), of.horizon, reach, ranks, 1);
    part.points.ghosts = ghost_sites(body.lattice, part.points, of.horizon).reference;
    return make_body(std::move(part), of, ranks, 1);
  }
  BothCollocated(const RanksBody& body, const BodySpecification& of)
      : Both(make_body(whole_points(body, of), of, 1), part_of(body, of)) {}
};

TEST(TermsOfPart, collocation_is_that_of_the_whole_body) {
  for (const double perturbation : {0.0, 0.1, 0.3}) {
    SCOPED_TRACE("perturbation " + std::to_string(perturbation));
    RanksBody body = thick_plate();
    body.lattice.perturbation = perturbation;
    BodySpecification of = collocated(body);
    of.cracks = {CrackSegment{{0.2, 1.31}, {0.7, 1.33}}};
    BothCollocated both(body, of);
    const std::size_t dofs = both.whole->points.reference.size();
    const std::size_t points = both.whole->points.volume.size();
    const std::vector<double> u = Random(3).vector(dofs, 0.05 * both.whole->points.spacing);
    std::vector<double> here = both.of_part(u);
    both.part->index_map->update_ghosts(here);

    std::vector<double> forces(dofs), mine(here.size());
    const Evaluation expected = both.energy.gradient(u, forces);
    const Evaluation found = both.mine.gradient(here, mine);
    EXPECT_NEAR(found.energy, expected.energy, 1e-11 * std::abs(expected.energy));
    both.expect_near(mine, forces, "forces", 1e-11);

    std::vector<double> energies(points), my_energies(both.part->points.volume.size());
    both.energy.point_energies(u, energies);
    both.mine.point_energies(here, my_energies);
    both.expect_near(my_energies, energies, "energies of points", 1e-11);

    std::vector<double> virials(points * 4), my_virials(my_energies.size() * 4);
    both.energy.virials(u, virials);
    both.mine.virials(here, my_virials);
    both.expect_near(my_virials, virials, "virials", 1e-11);

    RowsOfEnergy rows(both.energy);
    PartTangent<RowsOfEnergy> my_rows(both.mine);
    const History none;
    rows.linearise(both.energy, {u, none}, 0.0);
    my_rows.linearise(both.mine, {here, none}, 0.0);
    const std::vector<double> v = Random(4).vector(dofs);
    std::vector<double> product(dofs), my_product(here.size());
    rows.multiply(v, product);
    my_rows.multiply(both.of_part(v), my_product);
    both.expect_near(my_product, product, "product", 1e-11);
    both.expect_near(my_rows.diagonal, rows.diagonal, "diagonal blocks", 1e-11);
  }
}

TEST(TermsOfPart, thin_bodies_are_refused_by_all_ranks_at_one_place) {
  RanksBody body = thick_plate();
  body.lattice.shapes.push_back({ShapeStep::Action::add, Box{{2.0, 1.0, 0.0}, {4.0, 1.2, 0.0}}});
  const BodySpecification of = collocated(body);
  const auto said = [](const auto& make) {
    try {
      static_cast<void>(make());
    } catch (const InputError& error) {
      return error.allowed();
    }
    return std::string("nothing");
  };
  const std::string whole =
      said([&] { return make_body(BothCollocated::whole_points(body, of), of, 1); });
  EXPECT_NE(whole.find("thicker than two horizons"), std::string::npos);
  EXPECT_EQ(said([&] { return BothCollocated::part_of(body, of); }), whole);
}

}  // namespace
}  // namespace peristat::tests
