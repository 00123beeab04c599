#include "assembly/assembler.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "assembly/terms/bonds/point_stretches.hpp"
#include "tests/bodies.hpp"
#include "tests/finite_differences.hpp"

namespace peristat {
namespace {

using tests::BoxBody;
using tests::distance;
using tests::dot;
using tests::norm;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Bodies of every dimension without symmetry: perturbed points, with corrections and without, with
/// triangles and tetrahedra.
std::vector<tests::BoxSetting> uneven_boxes() {
  std::vector<tests::BoxSetting> boxes;
  for (const auto& [dimension, triangles, tetrahedra, stored] :
       {std::tuple{2, 1.0, 0.0, false}, std::tuple{3, 1.0, 0.0, true},
        std::tuple{3, 0.0, 1.0, false}, std::tuple{3, 0.5, 2.0, true}}) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.perturbation = 0.2;
    box.triangles = triangles;
    box.tetrahedra = tetrahedra;
    box.stored = stored;
    boxes.push_back(box);
  }
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const tests::Quadrature& quadrature :
         {tests::Quadrature{},
          tests::Quadrature{VolumeCorrection::linear, SurfaceCorrection::volume},
          tests::Quadrature{VolumeCorrection::linear, SurfaceCorrection::energy}}) {
      tests::BoxSetting box = tests::small_box(dimension);
      box.quadrature = quadrature;
      box.perturbation = 0.2;
      boxes.push_back(box);
    }
  }
  return boxes;
}

std::vector<double> moved(const std::vector<double>& from, double t,
                          const std::vector<double>& along) {
  std::vector<double> result = from;
  for (std::size_t k = 0; k < result.size(); ++k) result[k] += t * along[k];
  return result;
}

TEST(Assembler, GradientIsDerivativeOfEnergy) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(1);
    const std::vector<double> along = tests::Random(2).vector(body.dofs(), body.points.spacing);
    std::vector<double> gradient(body.dofs());
    ASSERT_FALSE(assembler.gradient(state, gradient).degenerate);
    const auto energy = [&](double t) {
      return std::vector<double>{assembler.energy(moved(state, t, along)).energy};
    };
    EXPECT_TRUE(tests::is_derivative(energy, {dot(gradient, along)}, 1e-3)) << box.dimension << "D";
  }
}

TEST(Assembler, ProductIsDerivativeOfGradient) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(1);
    const std::vector<double> along = tests::Random(2).vector(body.dofs(), body.points.spacing);
    std::vector<double> product(body.dofs());
    assembler.product(state, along, product);
    const auto gradient = [&](double t) {
      std::vector<double> result(body.dofs());
      EXPECT_FALSE(assembler.gradient(moved(state, t, along), result).degenerate);
      return result;
    };
    ASSERT_GT(norm(gradient(0.0)), 0.0);
    EXPECT_TRUE(tests::is_derivative(gradient, product, 1e-3)) << box.dimension << "D";
  }
}

TEST(Assembler, TangentIsDerivativeOfGradientInEveryColumn) {
  for (tests::BoxSetting box : uneven_boxes()) {
    const int dimension = box.dimension;
    box.extent = {4, 3, 3};
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 1);
    const std::vector<double> state = body.random_state(3);
    Tangent tangent(assembler);
    assembler.tangent(state, tangent);
    for (std::size_t dof = 0; dof < body.dofs(); ++dof) {
      std::vector<double> unit(body.dofs(), 0.0), column(body.dofs());
      unit[dof] = body.points.spacing;
      tangent.multiply(unit, column);
      const auto gradient = [&](double t) {
        std::vector<double> result(body.dofs());
        (void)assembler.gradient(moved(state, t, unit), result);
        return result;
      };
      // Nearly flat tetrahedra bend on a smaller scale than bonds.
      EXPECT_TRUE(tests::is_derivative(gradient, column, 5e-4)) << dimension << "D, column " << dof;
    }
  }
}

TEST(Assembler, StoredTangentAndMatrixFreeProductAgree) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(4);
    Tangent tangent(BlockPattern(body.model.bonds()), box.dimension);
    tangent.diagonal.assign(tangent.diagonal.size(), 1e300);  // every entry is overwritten
    tangent.off_diagonal.assign(tangent.off_diagonal.size(), 1e300);
    assembler.tangent(state, tangent);
    const std::vector<double> v = tests::Random(5).vector(body.dofs());
    std::vector<double> stored(body.dofs()), free(body.dofs());
    tangent.multiply(v, stored);
    assembler.product(state, v, free);
    ASSERT_GT(norm(stored), 0.0);
    EXPECT_LE(distance(stored, free), 1e-13 * norm(stored)) << box.dimension << "D";
  }
}

TEST(Assembler, EnergyIsTheDoubleSumOverOrderedPairs) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.perturbation = 0.2;
    Points points = tests::box_points(box);
    tests::Random random(6);
    for (double& volume : points.volume) volume *= 1.0 + 0.5 * random.number();
    const BoxBody body(points, box);
    const std::vector<double> state = body.random_state(7);
    const double modulus = micromodulus(box.youngs_modulus, body.setting);
    // W_i = 1/2 sum_j (c s^2 L / 2) V_j, E = sum_i W_i V_i
    double energy = 0.0;
    std::vector<double> of_point(points.volume.size(), 0.0);
    double most = -1.0;
    for (Index i = 0; i < points.count(); ++i) {
      for (Index j = 0; j < points.count(); ++j) {
        const double reference = tests::reference_distance(points, i, j);
        if (i == j || reference > body.setting.horizon) continue;
        double squared = 0.0;
        for (int c = 0; c < dimension; ++c) {
          const auto at = [&](Index p) {
            return points.position(p)[c] + state[std::size_t(p) * dimension + c];
          };
          squared += (at(j) - at(i)) * (at(j) - at(i));
        }
        const double stretch = std::sqrt(squared) / reference - 1.0;
        most = std::max(most, stretch);
        of_point[i] +=
            0.25 * modulus * stretch * stretch * reference * points.volume[j] * points.volume[i];
      }
      energy += of_point[i];
    }
    Assembler assembler(body.points, body.model, 2);
    const Evaluation found = assembler.energy(state);
    ASSERT_GT(energy, 0.0);
    EXPECT_FALSE(found.degenerate);
    EXPECT_NEAR(found.energy / energy, 1.0, 1e-13);
    std::vector<double> energies(points.volume.size());
    assembler.point_energies(state, energies);
    std::vector<double> longest(points.volume.size());
    EXPECT_NEAR(point_stretches(points, body.model, state, longest, 2), most, 1e-14);
    EXPECT_NEAR(*std::max_element(longest.begin(), longest.end()), most, 1e-14);
    EXPECT_LE(distance(energies, of_point), 1e-13 * norm(of_point));
  }
}

// Eq. 14 of [CPD]: per point 1/3 of the sum over ordered pairs and 1/4 of that over ordered
// triplets, each times its flatness factor, in the counts too.
TEST(Assembler, EnergyIsTheSumOverOrderedPairsAndTriplets) {
  for (int dimension : {2, 3}) {
    tests::BoxSetting box = tests::small_box(dimension);
    box.extent = {5, 4, 3};
    box.perturbation = 0.2;
    box.triangles = 1.0;
    box.tetrahedra = dimension == 3 ? 2.0 : 0.0;
    const BoxBody body(box);
    BoxBody bonds_alone(body.points, [&] {
      tests::BoxSetting other = box;
      other.triangles = other.tetrahedra = 0.0;
      return other;
    }());
    const std::vector<double> state = body.random_state(7);
    const Points& points = body.points;
    const auto n = std::size_t(points.count());
    using Vector3 = std::array<double, 3>;
    const auto place = [&](std::size_t i, bool current) {
      Vector3 at = points.position(Index(i));
      for (int c = 0; c < dimension && current; ++c) at[c] += state[i * dimension + c];
      return at;
    };
    const auto arm = [&](std::size_t i, std::size_t j, bool current) {
      const Vector3 a = place(i, current), b = place(j, current);
      return Vector3{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    };
    const auto near = [&](std::size_t i, std::size_t j) {
      return i != j &&
             tests::reference_distance(points, Index(i), Index(j)) <= body.setting.horizon;
    };
    const auto dot = [](const Vector3& a, const Vector3& b) { return peristat::dot<3>(a, b); };
    const auto area = [&](const Vector3& b, const Vector3& c) {
      const Vector3 vector = cross(b, c);
      return dimension == 2 ? vector[2] : std::sqrt(dot(vector, vector));
    };
    const auto volume = [&](const Vector3& b, const Vector3& c, const Vector3& d) {
      return dot(cross(b, c), d);
    };
    const double neighbourhood_in_bulk =
        bulk_neighbourhood(dimension, box.spacing, body.setting.horizon, box.cross_section).volume;
    const auto neighbours_in_bulk =
        double(bulk_neighbourhood(dimension, box.spacing, body.setting.horizon, box.cross_section)
                   .neighbours);
    double expected = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double neighbours = 0.0, pairs = 0.0, triplets = 0.0, psi2 = 0.0, psi3 = 0.0;
      for (std::size_t j = 0; j < n; ++j) {
        if (!near(i, j)) continue;
        ++neighbours;
        for (std::size_t k = 0; k < n; ++k) {
          if (!near(i, k) || !near(j, k)) continue;
          const double reference = area(arm(i, j, false), arm(i, k, false));
          const double factor = flatness_factor(std::abs(reference) / std::pow(box.spacing, 2));
          if (factor > 0.0) {
            const double change = area(arm(i, j, true), arm(i, k, true)) / reference - 1.0;
            pairs += factor;
            psi2 += 0.5 * factor * std::abs(reference) * change * change;
          }
          for (std::size_t l = 0; l < n && dimension == 3; ++l) {
            if (!near(i, l) || !near(j, l) || !near(k, l)) continue;
            const double of_reference =
                volume(arm(i, j, false), arm(i, k, false), arm(i, l, false));
            const double of_volume =
                flatness_factor(std::abs(of_reference) / std::pow(box.spacing, 3));
            if (of_volume == 0.0) continue;
            const double relative =
                volume(arm(i, j, true), arm(i, k, true), arm(i, l, true)) / of_reference - 1.0;
            triplets += of_volume;
            psi3 += 0.5 * of_volume * std::abs(of_reference) * relative * relative;
          }
        }
      }
      const double v_h = neighbourhood_in_bulk * neighbours / neighbours_in_bulk;
      const auto modulus = [](const auto& term) {
        return std::get<Harmonic>(term->potential).modulus;
      };
      ASSERT_FALSE(pairs > 0.0 && pairs < 2.0) << "no full triangle";
      ASSERT_FALSE(triplets > 0.0 && triplets < 6.0) << "no full tetrahedron";
      if (pairs > 0.0) {
        expected += points.volume[i] * v_h * v_h / pairs / 3.0 *
                    modulus(body.simplex_term()->triangles()) * psi2;
      }
      if (triplets > 0.0) {
        expected += points.volume[i] * std::pow(v_h, 3) / triplets / 4.0 *
                    modulus(body.simplex_term()->tetrahedra()) * psi3;
      }
    }
    Assembler assembler(points, body.model, 2), of_bonds(points, bonds_alone.model, 2);
    const double energy = assembler.energy(state).energy - of_bonds.energy(state).energy;
    ASSERT_GT(expected, 1e-3 * of_bonds.energy(state).energy);
    // Flat tetrahedra of the perturbed lattice have large relative changes of tiny volumes.
    EXPECT_NEAR(energy / expected, 1.0, 1e-11) << dimension << "D";
  }
}

/// Everything that an assembler gives, one after another.
std::vector<double> everything(const BoxBody& body, int threads) {
  Assembler assembler(body.points, body.model, threads);
  EXPECT_EQ(assembler.threads(), threads);
  const std::vector<double> state = body.random_state(8);
  const std::vector<double> v = tests::Random(9).vector(body.dofs());
  std::vector<double> gradient(body.dofs()), product(body.dofs()),
      energies(body.points.volume.size());
  Tangent tangent(BlockPattern(body.model.bonds()), body.points.dimension);
  std::vector<double> all{assembler.gradient(state, gradient).energy};
  assembler.product(state, v, product);
  assembler.tangent(state, tangent);
  assembler.point_energies(state, energies);
  for (const auto* part :
       {&gradient, &product, &energies, &tangent.diagonal, &tangent.off_diagonal}) {
    all.insert(all.end(), part->begin(), part->end());
  }
  return all;
}

TEST(Assembler, GivesTheSameBitsOnAsManyThreadsAsItHasPartsAndElseTheSameUpToRoundOff) {
  int of_same_parts = 0, of_others = 0;
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    const std::vector<double> one = everything(body, 1);
    ASSERT_GT(norm(one), 0.0);
    const double scale = tests::largest(one);
    const int parts = int(Assembler(body.points, body.model, 1).parts().size());
    for (int threads : {2, 3, 5, 49}) {
      const std::vector<double> several = everything(body, threads);
      ASSERT_EQ(several.size(), one.size());
      EXPECT_EQ(int(Assembler(body.points, body.model, threads).parts().size()),
                std::max(parts, threads));
      if (threads <= parts) {
        EXPECT_EQ(several, one) << threads << " threads";
        ++of_same_parts;
        continue;
      }
      ++of_others;
      for (std::size_t k = 0; k < one.size(); ++k) {
        // Sums of some ten terms in another order.
        ASSERT_NEAR(several[k], one[k], 32 * epsilon * scale) << threads << " threads, " << k;
      }
    }
  }
  EXPECT_GT(of_same_parts, 3);
  EXPECT_GT(of_others, 0);
}

TEST(Assembler, IsReproducibleToTheLastBitForAGivenNumberOfThreads) {
  for (const auto& box : uneven_boxes()) {
    const BoxBody body(box);
    for (int threads : {1, 2, 3, 5}) {
      const std::vector<double> first = everything(body, threads);
      for (int repeat = 0; repeat < 3; ++repeat) EXPECT_EQ(everything(body, threads), first);
    }
  }
}

TEST(Assembler, TakesMoreThreadsThanRows) {
  tests::BoxSetting box = tests::small_box(2);
  box.extent = {2, 1, 0};
  const BoxBody body(box);
  const std::vector<double> one = everything(body, 1);
  ASSERT_EQ(body.model.bonds().count(), 1);
  EXPECT_EQ(everything(body, 7), one);
}

TEST(Assembler, EnergyAndGradientTellTheSameEnergy) {
  const BoxBody body(tests::small_box(3));
  Assembler assembler(body.points, body.model, 2);
  std::vector<double> gradient(body.dofs(), 1e300);
  const Evaluation both = assembler.gradient(body.random_state(1), gradient);
  EXPECT_EQ(assembler.energy(body.random_state(1)).energy, both.energy);
  EXPECT_LT(tests::largest(gradient), 1e300);  // overwritten, not added to
}

TEST(Assembler, ReportsDegenerateStates) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const BoxBody body(tests::small_box(dimension));
    for (int threads : {1, 3}) {
      Assembler assembler(body.points, body.model, threads);
      std::vector<double> gradient(body.dofs()), state(body.dofs(), 0.0);
      EXPECT_FALSE(assembler.gradient(state, gradient).degenerate);
      // One point driven onto a neighbour: the current vector is the difference of equal numbers.
      const Index i = body.points.count() / 2;
      const Index j = body.model.bonds().of(i)[0];
      for (int c = 0; c < dimension; ++c) {
        state[std::size_t(i) * dimension + c] =
            body.points.position(j)[c] - body.points.position(i)[c];
      }
      EXPECT_TRUE(assembler.gradient(state, gradient).degenerate);
      EXPECT_TRUE(assembler.energy(state).degenerate);
      for (double wrong : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e200}) {
        std::vector<double> broken(body.dofs(), 0.0);
        broken[body.dofs() / 2] = wrong;
        EXPECT_TRUE(assembler.gradient(broken, gradient).degenerate) << wrong;
      }
    }
  }
}

TEST(Assembler, ReportsCollapsedTrianglesButNotCollapsedTetrahedra) {
  // All points of a block driven into one plane: areas that had been across it keep gradients,
  // those of triangles along the direction of the collapse have none.
  for (bool tetrahedra : {false, true}) {
    tests::BoxSetting box = tests::small_box(3);
    (tetrahedra ? box.tetrahedra : box.triangles) = 1.0;
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    std::vector<double> state(body.dofs(), 0.0), gradient(body.dofs());
    // Shear z onto x, and flatten z: no length is zero, but x-z triangles become lines.
    for (Index i = 0; i < body.points.count(); ++i) {
      const double z = body.points.position(i)[2];
      state[std::size_t(i) * 3] = 0.3 * z;
      state[std::size_t(i) * 3 + 2] = -z;
    }
    EXPECT_EQ(assembler.gradient(state, gradient).degenerate, !tetrahedra);
  }
}

TEST(Assembler, ProjectedTangentIsPositiveSemidefiniteAndExactWhereThatIs) {
  for (tests::BoxSetting box : uneven_boxes()) {
    if (box.dimension == 1) continue;  // bonds in a line have no negative eigenvalue
    box.extent = {4, 3, 3};
    const BoxBody body(box);
    Assembler assembler(body.points, body.model, 2);
    const auto matrix = [&](const std::vector<double>& state, double projection) {
      Tangent tangent(BlockPattern(body.model.bonds()), box.dimension);
      assembler.tangent(state, tangent, projection);
      Eigen::MatrixXd result(body.dofs(), body.dofs());
      std::vector<double> unit(body.dofs(), 0.0), column(body.dofs());
      for (std::size_t k = 0; k < body.dofs(); ++k) {
        unit[k] = 1.0;
        tangent.multiply(unit, column);
        unit[k] = 0.0;
        result.col(Eigen::Index(k)) =
            Eigen::Map<const Eigen::VectorXd>(column.data(), Eigen::Index(column.size()));
      }
      return result;
    };
    const auto least_over_largest = [](const Eigen::MatrixXd& k) {
      const Eigen::VectorXd eigenvalues =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
      return eigenvalues.minCoeff() / eigenvalues.maxCoeff();
    };
    // Squeezed to half its width, so that interactions buckle.
    std::vector<double> squeezed = body.random_state(1);
    for (std::size_t k = 0; k < squeezed.size(); ++k) {
      squeezed[k] += -0.5 * body.points.reference[k];
    }
    const Eigen::MatrixXd exact = matrix(squeezed, 0.0), half = matrix(squeezed, 0.5),
                          full = matrix(squeezed, 1.0);
    EXPECT_LT(least_over_largest(exact), -1e-3);
    EXPECT_GT(least_over_largest(full), -1e-13);
    EXPECT_LE((half - 0.5 * (exact + full)).norm(), 1e-13 * full.norm());

    // At rest every interaction is at its minimum.
    const std::vector<double> rest(body.dofs(), 0.0);
    const Eigen::MatrixXd at_rest = matrix(rest, 0.0);
    EXPECT_LE((matrix(rest, 1.0) - at_rest).norm(), 1e-13 * at_rest.norm());
  }
}

}  // namespace
}  // namespace peristat
