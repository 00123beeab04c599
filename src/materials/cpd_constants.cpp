#include "src/materials/cpd_constants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/materials/poisson_ratio_limits.hpp"
#include "src/neighbourhood/bulk_neighbourhood.hpp"
#include "src/neighbourhood/lattice_ball.hpp"
#include "src/neighbourhood/side_influence.hpp"

namespace peristat {
namespace {

constexpr double pi = std::numbers::pi;
const double sqrt3 = std::sqrt(3.0);

/// Mean areas over the contributing pairs of a ball of horizon 1. Each of a triangle's sides is the
/// longest for a third of the triangles; the third corner is then in the lens of two balls about
/// its ends. With y the distance from that side t (area t y), and P the fraction of pairs that
/// contribute:
///   2D: P = 1 - 3 sqrt3/(4 pi), mean over all pairs 12/(6 pi) int y = 5/(12 pi);
///   3D: P = 15/32, mean over all pairs 27/16 int y^2 = 27/16 (pi/12 - 3 sqrt3/32).
const double mean_area_in_plane = 5.0 / (3.0 * (4.0 * pi - 3.0 * sqrt3));
const double mean_area_in_space = 18.0 / 5.0 * (pi / 12.0 - 3.0 * sqrt3 / 32.0);

/// Mean volume over the contributing triplets, in the same way from the longest of six edges: the
/// two other corners are in the lens of two balls and within 1 of each other. The fraction of
/// triplets that contribute is the complete star of four hard spheres, known from their fourth
/// virial coefficient; the integral of the volume is by Gauss's rule, to ten digits.
double mean_volume() {
  constexpr double lens_volume_integral = 0.183000569676;
  const double virial = 2707.0 / 4480.0 + 219.0 * std::numbers::sqrt2 / (2240.0 * pi) -
                        4131.0 * std::acos(1.0 / 3.0) / (4480.0 * pi);
  const double fraction = 1995.0 / 4480.0 - virial;
  return 2.0 * pi * lens_volume_integral / (std::pow(4.0 * pi / 3.0, 3) * fraction);
}

/// lambda and mu as the elasticity of an isotropic body.
CubicElasticity isotropic_elasticity(double lambda, double mu) {
  return {lambda + 2.0 * mu, lambda, mu};
}

void add_scaled(CubicElasticity& to, double factor, const CubicElasticity& what) {
  to.c11 += factor * what.c11;
  to.c12 += factor * what.c12;
  to.c44 += factor * what.c44;
}

}  // namespace

double youngs_modulus_of(const LameModuli& moduli, int dimension) {
  const auto [lambda, mu] = moduli;
  return dimension == 2 ? 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu)
                        : mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
}

double poisson_ratio_of(const LameModuli& moduli, int dimension) {
  const auto [lambda, mu] = moduli;
  return dimension == 2 ? lambda / (lambda + 2.0 * mu) : 0.5 * lambda / (lambda + mu);
}

LameModuli lame_moduli(double youngs_modulus, double poisson_ratio, int dimension) {
  const double most = dimension == 2 ? 1.0 : 0.5;
  if (!(youngs_modulus > 0.0)) {
    throw InputError("youngs_modulus", number_text(youngs_modulus), "must be positive");
  }
  if (!(poisson_ratio > -1.0 && poisson_ratio < most)) {
    throw InputError("poisson_ratio", number_text(poisson_ratio),
                     dimension == 2
                         ? "must be above -1 and below 1, the incompressible limit in 2D"
                         : "must be above -1 and below 0.5, the incompressible limit in 3D");
  }
  const double digits = least_distance_of_poisson_ratio;
  if (1.0 + poisson_ratio < digits || 1.0 - poisson_ratio / most < digits) {
    throw InputError(
        "poisson_ratio", number_text(poisson_ratio),
        "is so near its limit that too few digits of double precision are left: take at most " +
            number_text(most * (1.0 - digits)) + ", and at least " + number_text(digits - 1.0));
  }
  const double mu = 0.5 * youngs_modulus / (1.0 + poisson_ratio);
  const double lambda =
      2.0 * mu * poisson_ratio / (dimension == 2 ? 1.0 - poisson_ratio : 1.0 - 2.0 * poisson_ratio);
  return {lambda, mu};
}

void require_stable(const LameModuli& moduli, int dimension) {
  if (!(moduli.mu > 0.0)) {
    throw InputError("mu", number_text(moduli.mu), "must be positive in a stable body");
  }
  if (!(moduli.lambda + 2.0 / dimension * moduli.mu > 0.0)) {
    throw InputError("lambda", number_text(moduli.lambda),
                     dimension == 2 ? "lambda + mu must be positive in a stable body"
                                    : "lambda + 2/3 mu must be positive in a stable body");
  }
}

LameModuli CubicElasticity::isotropic(int dimension) const {
  return dimension == 2
             ? LameModuli{(c11 + 3.0 * c12 - 2.0 * c44) / 4.0, (c11 - c12 + 2.0 * c44) / 4.0}
             : LameModuli{(c11 + 4.0 * c12 - 2.0 * c44) / 5.0, (c11 - c12 + 3.0 * c44) / 5.0};
}

CubicElasticity CpdStiffness::elasticity(const CpdConstants& constants) const {
  CubicElasticity sum;
  add_scaled(sum, constants.c1, of_c1);
  add_scaled(sum, constants.c2, of_c2);
  add_scaled(sum, constants.c3, of_c3);
  return sum;
}

CpdConstants CpdStiffness::constants(const LameModuli& moduli, double c2) const {
  const LameModuli one = of_c1.isotropic(dimension), two = of_c2.isotropic(dimension),
                   three = of_c3.isotropic(dimension);
  CpdConstants result;
  // Constant for the part of lambda that the others leave, zero where that part is their round-off:
  // Poisson's ratio of central forces, 1/3 or 1/4, must not make a constant negative by its last
  // digits.
  const auto of_rest = [&](double others, double largest, double per_constant) {
    constexpr double round_off = 1e-10;
    const double left = moduli.lambda - others;
    if (std::abs(left) <= round_off * largest) return 0.0;
    if (per_constant == 0.0) {
      throw InputError("poisson_ratio", number_text(poisson_ratio_of(moduli, dimension)),
                       "can't be reached: with this horizon no neighbours of a point are "
                       "neighbours of each other, and bonds alone have " +
                           number_text(poisson_ratio_of({one.lambda, one.mu}, dimension)));
    }
    return left / per_constant;
  };
  if (dimension == 2) {
    result.c1 = moduli.mu / one.mu;  // triangles resist no shear in 2D
    result.c2 = of_rest(one.lambda * result.c1, moduli.mu, two.lambda);
  } else {
    result.c2 = c2;
    result.c1 = (moduli.mu - two.mu * c2) / one.mu;
    const double of_bonds = one.lambda * result.c1, of_triangles = two.lambda * c2;
    const double largest = std::max(moduli.mu, std::abs(of_triangles));
    result.c3 = of_rest(of_bonds + of_triangles, largest, three.lambda);
  }
  if (!(result.c1 > 0.0)) {
    throw InputError("c2", number_text(c2),
                     "leaves no positive c1 for a shear modulus of " + number_text(moduli.mu) +
                         " Pa; must be below " + number_text(moduli.mu / two.mu));
  }
  return result;
}

CpdStiffness continuum_stiffness(int dimension, double horizon, double cross_section) {
  CpdStiffness stiffness;
  stiffness.dimension = dimension;
  if (dimension == 2) {
    const double disk = pi * horizon * horizon * cross_section;
    const double of_c1 = pi * std::pow(horizon, 3) * cross_section / 24.0;
    const double of_c2 = disk * disk * mean_area_in_plane * horizon * horizon / 3.0;
    stiffness.of_c1 = isotropic_elasticity(of_c1, of_c1);
    stiffness.of_c2 = isotropic_elasticity(of_c2, 0.0);
  } else {
    const double ball = 4.0 / 3.0 * pi * std::pow(horizon, 3);
    const double of_c1 = pi * std::pow(horizon, 4) / 30.0;
    // Isotropic mean <P P> of projections onto planes: mu = 1/15, lambda = 6/15.
    const double of_c2 = ball * ball * mean_area_in_space * horizon * horizon / 3.0;
    const double of_c3 = std::pow(ball, 3) * mean_volume() * std::pow(horizon, 3) / 4.0;
    stiffness.of_c1 = isotropic_elasticity(of_c1, of_c1);
    stiffness.of_c2 = isotropic_elasticity(6.0 / 15.0 * of_c2, 1.0 / 15.0 * of_c2);
    stiffness.of_c3 = isotropic_elasticity(of_c3, 0.0);
  }
  return stiffness;
}

CpdStiffness lattice_stiffness(int dimension, double spacing, double horizon,
                               double cross_section) {
  return lattice_stiffness({dimension, horizon, cross_section}, spacing);
}

CpdStiffness lattice_stiffness(const Kernel& kernel, double spacing) {
  const int dimension = kernel.dimension;
  const BulkNeighbourhood bulk =
      bulk_neighbourhood(dimension, spacing, kernel.horizon, kernel.cross_section);
  const LatticeBall ball(dimension, spacing, kernel.horizon);
  constexpr Coordinates here{};
  CpdStiffness stiffness;
  stiffness.dimension = dimension;

  // 1/2 V1 C1 sum L n n n n
  const double v1 = bulk.volume / double(bulk.neighbours);
  for (const Coordinates& arm : ball.arms()) {
    const double length = std::hypot(arm[0], arm[1], arm[2]);
    const double nx = arm[0] / length, ny = arm[1] / length, mixed = nx * nx * ny * ny;
    add_scaled(stiffness.of_c1, 0.5 * v1 * length * kernel.influence_at(length),
               {std::pow(nx, 4), mixed, mixed});
  }

  // 2/3 V2 C2 sum A P P over unordered pairs, P = I in 2D and I - m m^T in 3D
  if (bulk.pairs > 0) {
    const double v2 = bulk.volume * bulk.volume / double(bulk.pairs);
    ball.for_each_pair([&](const Coordinates& b, const Coordinates& c, double area) {
      double mx = 0.0, my = 0.0;
      if (dimension == 3) {
        mx = (b[1] * c[2] - b[2] * c[1]) / area;
        my = (b[2] * c[0] - b[0] * c[2]) / area;
      }
      const double pxx = 1.0 - mx * mx, pyy = 1.0 - my * my, pxy = -mx * my;
      const double influence = influence_of_sides(kernel, std::array{here, b, c});
      add_scaled(stiffness.of_c2, 2.0 / 3.0 * v2 * area * influence,
                 {pxx * pxx, pxx * pyy, pxy * pxy});
    });
  }

  // 6/4 V3 C3 sum V I I over unordered triplets
  if (bulk.triplets > 0) {
    const double v3 = std::pow(bulk.volume, 3) / double(bulk.triplets);
    ball.for_each_triplet(
        [&](const Coordinates& b, const Coordinates& c, const Coordinates& d, double volume) {
          const double influence = influence_of_sides(kernel, std::array{here, b, c, d});
          add_scaled(stiffness.of_c3, 1.5 * v3 * volume * influence, {1.0, 1.0, 0.0});
        });
  }
  return stiffness;
}

}  // namespace peristat
