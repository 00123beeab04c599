#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/convolutions/cut_lattice.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/lattice_box.hpp"
#include "tests/bodies.hpp"

/// Checks that every operator on lattice points must pass, and bodies to run them on.
namespace peristat::tests {

/// Number of points along the axes of a body with a hole, and ratio of horizon to spacing.
struct HoledSetting {
  std::vector<int> counts;
  double ratio = 2.015;
  VolumeCorrection volume = VolumeCorrection::none;
  double angle = 0.0;
  Spacing spacing = 0.1;
  bool is_cut = false;  ///< a crack runs in from the side to the middle
};

/// Boxes of odd and even sizes, before and after padding.
inline std::vector<HoledSetting> holed_settings() {
  return {{{13, 10}, 3.015, VolumeCorrection::linear},
          {{12, 11}, 3.015},
          {{10, 13}, 2.015, VolumeCorrection::none, 27.0},
          {{11, 12}, 3.015, VolumeCorrection::none, 0.0, Spacing({0.1, 0.08}, 2)},
          {{7, 6, 9}, 2.015, VolumeCorrection::linear},
          {{6, 8, 7}, 3.015},
          {{12, 11}, 3.015, VolumeCorrection::linear, 0.0, 0.1, true},
          {{10, 13}, 2.015, VolumeCorrection::none, 27.0, 0.1, true},
          {{6, 8, 7}, 2.015, VolumeCorrection::none, 0.0, 0.1, true}};
}

/// Numbers of lattice sites along the axes: one body in 2D, one in 3D.
inline std::vector<std::vector<int>> both_dimensions() { return {{13, 10}, {7, 6, 9}}; }

/// No axis is periodic.
inline constexpr std::array<bool, 3> open{};

/// A lattice's body with a hole.
struct HoledBody {
  Points points;
  CutLattice box;
  Kernel kernel;

  explicit HoledBody(const HoledSetting& setting) {
    const int d = static_cast<int>(setting.counts.size());
    Lattice lattice;
    lattice.dimension = d;
    lattice.spacing = setting.spacing;
    lattice.angle = setting.angle;
    lattice.cross_section = d == 3 ? 1.0 : 0.5;
    Box all;
    for (int c = 0; c < d; ++c) {
      all.max[c] = setting.counts[std::size_t(c)] * setting.spacing.along(c);
    }
    lattice.shapes.push_back({ShapeStep::Action::add, all});
    if (d == 2) lattice.shapes.push_back({ShapeStep::Action::subtract, Disk{{0.5, 0.5}, 0.16}});
    if (d == 3) {
      lattice.shapes.push_back({ShapeStep::Action::subtract, Sphere{{0.3, 0.3, 0.3}, 0.13}});
    }
    points = make_points(lattice);
    std::string why_not;
    box = lattice_box(points, why_not).value();
    kernel.dimension = d;
    kernel.horizon = setting.ratio * setting.spacing;
    kernel.cross_section = lattice.cross_section;
    kernel.volume_correction = setting.volume;
    if (setting.is_cut) cut();
  }

  [[nodiscard]] int dimension() const { return points.dimension; }
  [[nodiscard]] std::size_t count() const { return std::size_t(points.count()); }
  [[nodiscard]] double volume() const { return points.volume.front(); }
  [[nodiscard]] std::vector<LatticeArm> arms() const {
    return lattice_arms(kernel, points.spacing, points.angle, volume());
  }
  /// Cuts the bonds that cross the middle of the box along its first axis, in one half of it.
  void cut() {
    const auto is_above = [&](Index point) {
      const std::array<Index, 3> at = box.numbers(box.place[std::size_t(point)]);
      return std::array{2 * at[0] >= box.extent[0], 2 * at[1] >= box.extent[1]};
    };
    for (Index i = 0; i < points.count(); ++i) {
      for (Index j = i + 1; j < points.count(); ++j) {
        const auto here = is_above(i), there = is_above(j);
        const bool crosses = here[0] != there[0] && !here[1] && !there[1];
        if (crosses && are_neighbours(i, j)) box.cut.push_back({i, j});
      }
    }
  }

  /// True if i and j are neighbours on the lattice, even if their bond is cut.
  [[nodiscard]] bool are_neighbours(Index i, Index j) const {
    const std::array<Index, 3> a = box.numbers(box.place[std::size_t(i)]),
                               b = box.numbers(box.place[std::size_t(j)]);
    const LatticeStep along{b[0] - a[0], b[1] - a[1], b[2] - a[2]},
        against{-along[0], -along[1], -along[2]};
    const std::vector<LatticeArm> all = arms();
    return std::any_of(all.begin(), all.end(), [&](const LatticeArm& arm) {
      return arm.step == along || arm.step == against;
    });
  }

  /// Random displacements: strains of some ten per cent, without symmetry.
  [[nodiscard]] std::vector<double> random(std::uint64_t seed) const {
    return Random(seed).vector(points.reference.size(), 0.1 * points.spacing);
  }

  /// Integrities of every kind: zero, partial and one. All neighbours of point 0 have zero.
  [[nodiscard]] std::vector<double> mask() const {
    std::vector<double> q(count(), 1.0);
    for (std::size_t i = 0; i < q.size(); i += 5) q[i] = 0.0;
    for (std::size_t i = 2; i < q.size(); i += 7) q[i] = 0.3;
    for (Index i = 1; i < points.count(); ++i) {
      if (reference_distance(points, 0, i) < 1.5 * kernel.horizon) q[std::size_t(i)] = 0.0;
    }
    q[0] = 1.0;
    return q;
  }
};

/// A point i and its neighbour j, for direct sums without a convolution.
struct Neighbour {
  std::size_t i = 0, j = 0;
  std::array<double, 3> xi{};
  double share = 0.0;
};

/// Returns all pairs of neighbours, in both directions.
/// @param with_cut include pairs whose bonds are cut
inline std::vector<Neighbour> neighbours(const HoledBody& body, bool with_cut = false) {
  std::map<std::array<Index, 3>, std::size_t> at;
  for (std::size_t i = 0; i < body.count(); ++i) at[body.box.numbers(body.box.place[i])] = i;
  std::vector<Neighbour> found;
  for (const auto& [numbers, i] : at) {
    for (const LatticeArm& arm : body.arms()) {
      auto there = numbers;
      for (std::size_t c = 0; c < 3; ++c) there[c] += Index(arm.step[c]);
      const auto other = at.find(there);
      if (other == at.end()) continue;
      const auto is_cut = [&](const std::array<Index, 2>& pair) {
        return std::minmax(std::size_t(pair[0]), std::size_t(pair[1])) ==
               std::minmax(i, other->second);
      };
      const auto& cut = body.box.cut;
      if (!with_cut && std::any_of(cut.begin(), cut.end(), is_cut)) continue;
      const auto& xi = arm.xi;
      found.push_back({i, other->second, xi, arm.share});
      found.push_back({other->second, i, {-xi[0], -xi[1], -xi[2]}, arm.share});
    }
  }
  return found;
}

/// a . (u_j - u_i)
inline double along_difference(const std::array<double, 3>& a, const Neighbour& of,
                               const std::vector<double>& u, int d) {
  double sum = 0.0;
  for (int c = 0; c < d; ++c) {
    sum += a[std::size_t(c)] *
           (u[of.j * std::size_t(d) + std::size_t(c)] - u[of.i * std::size_t(d) + std::size_t(c)]);
  }
  return sum;
}

struct ForcesAndEnergies {
  std::vector<double> force, energy;
  [[nodiscard]] double total() const {
    double sum = 0.0;
    for (const double of_point : energy) sum += of_point;
    return sum;
  }
};

inline ForcesAndEnergies evaluate(LatticeForces& forces, const std::vector<double>& u,
                                  std::size_t points) {
  ForcesAndEnergies found{std::vector<double>(u.size(), 7.0), std::vector<double>(points, 7.0)};
  forces.find_forces_and_energies(u, found.force, found.energy);
  return found;
}

inline std::vector<double> moved(const std::vector<double>& u, double step,
                                 const std::vector<double>& v) {
  std::vector<double> at(u);
  for (std::size_t k = 0; k < at.size(); ++k) at[k] += step * v[k];
  return at;
}

inline void expect_equal(const ForcesAndEnergies& found, const ForcesAndEnergies& expected,
                         double tolerance) {
  ASSERT_GT(norm(expected.force), 0.0);
  ASSERT_GT(norm(expected.energy), 0.0);
  EXPECT_LE(distance(found.force, expected.force), tolerance * norm(expected.force));
  EXPECT_LE(distance(found.energy, expected.energy), tolerance * norm(expected.energy));
}

inline void expect_same_without_energies(LatticeForces& forces, const std::vector<double>& u,
                                         std::size_t points) {
  const ForcesAndEnergies with = evaluate(forces, u, points);
  std::vector<double> force(u.size(), 7.0);
  forces.find_forces(u, force);
  EXPECT_EQ(force, with.force);
}

/// Fourth-order central difference: exact where the function is a polynomial of degree four.
template <class At>
auto derivative_by_four(const At& at) {
  return (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / 12.0;
}

inline void expect_forces_of_energy(LatticeForces& forces, const std::vector<double>& u,
                                    const std::vector<double>& v, std::size_t points,
                                    double tolerance = 1e-12) {
  const double derivative = derivative_by_four(
      [&](double step) { return evaluate(forces, moved(u, step, v), points).total(); });
  const double scale = evaluate(forces, moved(u, 2.0, v), points).total();
  ASSERT_GT(std::abs(derivative), 1e-3 * scale);
  EXPECT_NEAR(derivative, -dot(evaluate(forces, u, points).force, v), tolerance * scale);
}

/// Expects a point's virial to be the derivative of its energy with respect to each component of a
/// uniform displacement gradient.
inline void expect_virials_of_energies(LatticeForces& forces, const HoledBody& body,
                                       double tolerance) {
  const auto d = std::size_t(body.dimension());
  const std::vector<double> u = body.random(5);
  std::vector<double> virials(u.size() * d), expected(u.size() * d);
  // add_virials() adds to its argument: half of two calls is one.
  forces.add_virials(u, virials);
  forces.add_virials(u, virials);
  for (double& entry : virials) entry *= 0.5;
  for (std::size_t ac = 0; ac < d * d; ++ac) {
    std::vector<double> v(u.size(), 0.0);
    for (std::size_t i = 0; i < body.count(); ++i) {
      v[i * d + ac / d] = 0.1 * body.points.reference[i * d + ac % d];
    }
    const auto at = [&](double step) {
      return evaluate(forces, moved(u, step, v), body.count()).energy;
    };
    const std::vector<double> a = at(1.0), b = at(-1.0), c = at(2.0), e = at(-2.0);
    for (std::size_t i = 0; i < body.count(); ++i) {
      expected[i * d * d + ac] = 10.0 * (8.0 * (a[i] - b[i]) - (c[i] - e[i])) / 12.0;
    }
  }
  ASSERT_GT(norm(expected), 0.0);
  EXPECT_LE(distance(virials, expected), tolerance * norm(expected));
}

inline void expect_tangent_of_forces(LatticeForces& forces, const std::vector<double>& u,
                                     const std::vector<double>& v, std::size_t points,
                                     double tolerance = 1e-12) {
  std::vector<double> product(u.size(), 7.0), expected(u.size());
  forces.multiply(u, v, product);
  const auto at = [&](double step) { return evaluate(forces, moved(u, step, v), points).force; };
  const std::vector<double> a = at(1.0), b = at(-1.0), c = at(2.0), d = at(-2.0);
  for (std::size_t k = 0; k < u.size(); ++k) {
    expected[k] = -(8.0 * (a[k] - b[k]) - (c[k] - d[k])) / 12.0;
  }
  ASSERT_GT(norm(product), 0.0);
  EXPECT_LE(distance(product, expected), tolerance * (norm(c) + norm(d)));
}

inline void expect_symmetric_tangent(LatticeForces& forces, const std::vector<double>& u,
                                     const std::vector<double>& v, const std::vector<double>& w) {
  std::vector<double> of_v(u.size()), of_w(u.size());
  forces.multiply(u, v, of_v);
  forces.multiply(u, w, of_w);
  const double scale = norm(of_v) * norm(w);
  ASSERT_GT(scale, 0.0);
  EXPECT_NEAR(dot(of_v, w), dot(of_w, v), 1e-13 * scale);
}

inline double sum_of_forces(const std::vector<double>& force, int dimension) {
  std::array<double, 3> sum{};
  for (std::size_t k = 0; k < force.size(); ++k) sum[k % std::size_t(dimension)] += force[k];
  return std::hypot(sum[0], sum[1], sum[2]);
}

/// Expects the same results for a body displaced by a kilometre. Displacements are binary
/// fractions, so that they lose no digits.
inline void expect_same_far_away(LatticeForces& forces, std::vector<double> u, int dimension,
                                 std::size_t points, double tolerance) {
  for (double& entry : u) entry = std::round(std::ldexp(entry, 34)) * std::ldexp(1.0, -34);
  const ForcesAndEnergies here = evaluate(forces, u, points);
  std::vector<double> product(u.size()), far_product(u.size());
  forces.multiply(u, u, product);
  for (std::size_t k = 0; k < u.size(); ++k) {
    u[k] += k % std::size_t(dimension) == 0 ? 1024.0 : -512.0;
  }
  expect_equal(evaluate(forces, u, points), here, tolerance);
  forces.multiply(u, u, far_product);
  EXPECT_LE(distance(far_product, product), tolerance * norm(product));
}

/// Expects zeros at the isolated point 0 of HoledBody::mask, and finite numbers elsewhere.
inline void expect_nothing_at_lonely_points(LatticeForces& forces, const HoledBody& body) {
  const std::vector<double> u = body.random(5), v = body.random(6);
  const auto d = std::size_t(body.dimension());
  std::vector<double> product(u.size()), diagonal(u.size() * d), sums(u.size());
  const auto expect_numbers = [](const std::vector<double>& numbers) {
    EXPECT_TRUE(std::all_of(numbers.begin(), numbers.end(),
                            [](double number) { return std::isfinite(number); }));
  };
  for (const std::vector<double>& q : {body.mask(), std::vector<double>(body.count(), 0.0)}) {
    forces.set_integrity(q);
    const ForcesAndEnergies found = evaluate(forces, u, body.count());
    forces.multiply(u, v, product);
    forces.outline_tangent(u, diagonal, sums);
    for (const std::vector<double>& all : {found.force, found.energy, product, diagonal, sums}) {
      expect_numbers(all);
    }
    EXPECT_EQ(found.energy[0], 0.0);
    for (std::size_t c = 0; c < d; ++c) {
      EXPECT_EQ(found.force[c], 0.0);
      EXPECT_EQ(product[c], 0.0);
    }
  }
}

/// Checks diagonal blocks and row-sum bounds against the columns of the tangent, at zero
/// displacement unless `at` is given.
/// @param has_blocks true if the diagonal blocks are those of this state
inline void expect_outline(LatticeForces& forces, const HoledBody& body, double most_slack,
                           std::vector<double> at = {}, bool has_blocks = true) {
  const auto d = std::size_t(body.dimension());
  const std::size_t size = body.count() * d;
  std::vector<double> diagonal(size * d), bounds(size), sums(size, 0.0);
  // outline_tangent() adds to its arguments: half of two calls is one.
  if (at.empty()) at.assign(size, 0.0);
  forces.outline_tangent(at, diagonal, bounds);
  forces.outline_tangent(at, diagonal, bounds);
  for (std::vector<double>* found : {&diagonal, &bounds}) {
    for (double& entry : *found) entry *= 0.5;
  }
  std::vector<double> blocks(size * d), column(size), unit(size, 0.0);
  for (std::size_t k = 0; k < size; ++k) {
    unit[k] = 1.0;
    forces.multiply(at, unit, column);
    unit[k] = 0.0;
    for (std::size_t row = 0; row < size; ++row) sums[row] += std::abs(column[row]);
    for (std::size_t c = 0; c < d; ++c) blocks[(k / d * d + c) * d + k % d] = column[k / d * d + c];
  }
  ASSERT_GT(norm(blocks), 0.0);
  if (has_blocks) {
    EXPECT_LE(distance(diagonal, blocks), 1e-12 * norm(blocks));
  }
  for (std::size_t row = 0; row < size; ++row) {
    // Sums over columns have the round-off of as many convolutions as there are columns.
    EXPECT_GE(bounds[row], sums[row] - 1e-11 * largest(sums));
  }
  EXPECT_LE(largest(bounds), most_slack * largest(sums));
}

/// Rotation R by 2 radians, in 3D about an axis that is not a lattice axis.
inline std::array<std::array<double, 3>, 3> turn(int d) {
  const double c = std::cos(2.0), s = std::sin(2.0);
  if (d == 2) return {{{c, -s, 0.0}, {s, c, 0.0}, {0.0, 0.0, 1.0}}};
  const std::array<double, 3> n{2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};
  const std::array<std::array<double, 3>, 3> cross{
      {{0.0, -n[2], n[1]}, {n[2], 0.0, -n[0]}, {-n[1], n[0], 0.0}}};
  std::array<std::array<double, 3>, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      result[i][j] = (i == j ? c : 0.0) + (1.0 - c) * n[i] * n[j] + s * cross[i][j];
    }
  }
  return result;
}

inline std::vector<double> turned(const std::vector<double>& field, int d) {
  const auto R = turn(d);
  std::vector<double> result(field.size());
  for (std::size_t k = 0; k < field.size(); ++k) {
    for (std::size_t c = 0; c < std::size_t(d); ++c) {
      result[k] += R[k % std::size_t(d)][c] * field[k / std::size_t(d) * std::size_t(d) + c];
    }
  }
  return result;
}

inline void expect_to_turn_with_the_body(LatticeForces& forces, const HoledBody& body,
                                         double tolerance) {
  const int d = body.dimension();
  const std::vector<double> u = body.random(5);
  const ForcesAndEnergies before = evaluate(forces, u, body.count());
  // R (x + u) - x
  std::vector<double> after = turned(moved(body.points.reference, 1.0, u), d);
  after = moved(after, -1.0, body.points.reference);
  ASSERT_GT(norm(after), 5.0 * norm(u));
  expect_equal(evaluate(forces, after, body.count()), {turned(before.force, d), before.energy},
               tolerance);
}

/// A whole rectangle of points.
inline LatticeBox rectangle(Index along, Index across) {
  LatticeBox box;
  box.dimension = 2;
  box.extent = {along, across, 1};
  for (Index place = 0; place < along * across; ++place) box.place.push_back(place);
  return box;
}

/// A row of points.
inline LatticeBox bar(Index along) {
  LatticeBox box = rectangle(along, 1);
  box.dimension = 1;
  return box;
}

using MakeForces = std::function<std::unique_ptr<LatticeForces>(
    const CutLattice& box, const std::array<bool, 3>& is_periodic)>;

/// Expects a periodic body to give the forces and energies of the middle one of three copies.
inline void expect_to_see_images(const MakeForces& make) {
  const std::size_t points = 9 * 7;
  const auto period = make(rectangle(9, 7), {true, false, false});
  const auto three = make(rectangle(27, 7), {});
  const std::vector<double> u = Random(5).vector(2 * points, 0.01);
  std::vector<double> repeated;
  for (int copy = 0; copy < 3; ++copy) repeated.insert(repeated.end(), u.begin(), u.end());
  const ForcesAndEnergies all = evaluate(*three, repeated, 3 * points);
  const auto middle = [&](const std::vector<double>& field) {
    const auto size = std::ptrdiff_t(field.size() / 3);
    return std::vector<double>(field.begin() + size, field.end() - size);
  };
  expect_equal(evaluate(*period, u, points), {middle(all.force), middle(all.energy)}, 1e-13);
}

/// Expects products that do not depend on what was evaluated before.
inline void expect_to_remember_nothing_else(LatticeForces& used, LatticeForces& fresh,
                                            const HoledBody& body) {
  const std::vector<double> u = body.random(5), v = body.random(6), w = body.random(7);
  std::vector<double> of_used(u.size()), of_fresh(u.size());
  used.find_forces(u, of_used);
  used.set_integrity(body.mask());
  fresh.set_integrity(body.mask());
  for (const std::vector<double>& at : {u, w}) {
    used.multiply(at, v, of_used);
    fresh.multiply(at, v, of_fresh);
    EXPECT_EQ(of_used, of_fresh);
    evaluate(fresh, v, body.count());  // so that the next product is computed from scratch
  }
}

}  // namespace peristat::tests
