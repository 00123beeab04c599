#include "src/materials/bulk_bonds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "src/core/coordinates.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/dense/symmetric_system.hpp"
#include "src/materials/lattice_directions.hpp"
#include "src/neighbourhood/lattice_kernel.hpp"

namespace peristat {
namespace {

using SymmetricTensor = std::vector<double>;  // symmetric, in Kelvin's notation

/// n n^T
SymmetricTensor dyad(const Coordinates& n, int dimension) {
  SymmetricTensor result;
  for (int a = 0; a < dimension; ++a) result.push_back(n[a] * n[a]);
  for (int a = 0; a < dimension; ++a) {
    for (int b = 0; b < a; ++b) result.push_back(std::numbers::sqrt2 * n[a] * n[b]);
  }
  return result;
}

double contract(const SymmetricTensor& a, const SymmetricTensor& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// Normals of the lattice's planes of small indices, in its axes.
std::vector<Coordinates> lattice_normals(const Spacing& spacing, int dimension) {
  constexpr int most = 4;
  std::vector<Coordinates> normals;
  for (int h = -most; h <= most; ++h) {
    for (int k = dimension > 1 ? -most : 0; k <= (dimension > 1 ? most : 0); ++k) {
      for (int l = dimension > 2 ? -most : 0; l <= (dimension > 2 ? most : 0); ++l) {
        if (std::array{h, k, l} <= std::array{0, 0, 0}) continue;  // one of two opposite ones
        normals.push_back({h / spacing.along(0), k / spacing.along(1), l / spacing.along(2)});
      }
    }
  }
  return normals;
}

}  // namespace

BulkBonds::BulkBonds(const BondSetting& setting) : setting_(setting) {
  const Spacing& spacing = setting.lattice.value().spacing;
  const LatticeKernel lattice(setting, spacing);
  const double cell = std::pow(spacing, setting.dimension) * setting.cross_section;
  lattice.for_each_neighbour([&](const LatticeStep& step, double factor) {
    if (step <= LatticeStep{}) return;  // one of two opposite ones
    Coordinates along{};
    for (int c = 0; c < 3; ++c) along[std::size_t(c)] = step[std::size_t(c)] * spacing.along(c);
    bonds_.push_back({unit(turned(along)), lattice.distance(step), 2.0 * cell * factor});
  });
  if (setting.lattice->surface_correction == SurfaceCorrection::energy) correct_energy();
  find_compliance();
}

Coordinates BulkBonds::turned(const Coordinates& v) const {
  const double angle = setting_.lattice->angle * std::numbers::pi / 180.0;
  const double c = std::cos(angle), s = std::sin(angle);
  if (setting_.dimension == 1) return v;
  return {c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]};
}

/// Same as in make_bonds; inside a lattice all points have the same factors.
void BulkBonds::correct_energy() {
  const double full = 0.25 * micromodulus(1.0, setting_) / confined_energy_per_modulus(setting_);
  Coordinates ratio{};  // discrete over classical energy, per axis
  for (const Bond& bond : bonds_) {
    for (int a = 0; a < setting_.dimension; ++a) {
      ratio[a] += full * bond.weight * bond.length * std::pow(bond.direction[a], 4);
    }
  }
  for (Bond& bond : bonds_) {
    double sum = 0.0;
    for (int a = 0; a < setting_.dimension; ++a) {
      const double axis = ratio[a] > 0.0 ? ratio[a] : 1.0;
      sum += std::pow(bond.direction[a] * axis, 2);
    }
    bond.weight /= std::sqrt(sum);
  }
}

void BulkBonds::find_compliance() {
  const std::size_t size = dyad({}, setting_.dimension).size();
  std::vector<double> stiffness(size * size, 0.0);
  for (const Bond& bond : bonds_) {
    const SymmetricTensor n = dyad(bond.direction, setting_.dimension);
    for (std::size_t c = 0; c < size; ++c) {
      for (std::size_t r = 0; r < size; ++r) {
        stiffness[c * size + r] += 0.5 * bond.weight * bond.length * n[r] * n[c];
      }
    }
  }
  const SymmetricModes modes = symmetric_modes(stiffness, int(size));
  // Bonds along the axes alone resist no shear.
  if (!(modes.values.front() > 1e-12 * modes.values.back())) return;
  compliance_.assign(size * size, 0.0);
  for (std::size_t k = 0; k < size; ++k) {
    const double* mode = &modes.vectors[k * size];
    for (std::size_t e = 0; e < size * size; ++e) {
      compliance_[e] += mode[e / size] * mode[e % size] / modes.values[k];
    }
  }
}

std::vector<double> BulkBonds::strain_of_pull(const Coordinates& direction) const {
  const SymmetricTensor stress = dyad(unit(direction), setting_.dimension);
  SymmetricTensor strain(stress.size(), 0.0);
  for (std::size_t a = 0; a < stress.size(); ++a) {
    for (std::size_t b = 0; b < stress.size(); ++b) {
      strain[a] += compliance_[a * stress.size() + b] * stress[b];
    }
  }
  // For a body free to contract out of the plane: E is (1 - nu^2) of the plane-strain modulus.
  const bool is_confined = setting_.dimension == 2 && setting_.plane == PlaneState::strain;
  const double nu = poisson_ratio(setting_);
  for (double& part : strain) part *= is_confined ? 1.0 / (1.0 - nu * nu) : 1.0;
  return strain;
}

double BulkBonds::moment(int k) const {
  double sum = 0.0;
  for (const Bond& bond : bonds_) sum += bond.weight * std::pow(bond.length, k);
  return sum;
}

double BulkBonds::crossing(const Coordinates& normal) const {
  const Coordinates n = unit(normal);
  double sum = 0.0;
  for (const Bond& bond : bonds_) {
    sum += bond.weight * bond.length * bond.length * std::abs(dot(bond.direction, n));
  }
  return 0.5 * sum;
}

DirectionalSpread BulkBonds::crossing() const {
  DirectionalSpread result = over_directions([&](const auto& n) { return crossing(n); });
  result.mean = 0.5 * mean_of_magnitude(setting_.dimension) * moment(2);
  return result;
}

double BulkBonds::youngs_modulus(const Coordinates& direction) const {
  if (compliance_.empty()) return 0.0;
  return 1.0 / contract(strain_of_pull(direction), dyad(unit(direction), setting_.dimension));
}

template <class Quantity>
DirectionalSpread BulkBonds::over_directions(const Quantity& of) const {
  // Long horizons are nearly the same in all directions, so that fewer are enough.
  const int count = std::clamp(int(2e7 / double(bonds_.size())), 60, 2000);
  const std::vector<Coordinates> even = even_directions(setting_.dimension, count);
  std::vector<Coordinates> all = lattice_normals(setting_.lattice->spacing, setting_.dimension);
  if (int(all.size()) > count) all.resize(std::size_t(count));
  all.insert(all.end(), even.begin(), even.end());
  DirectionalSpread result{0.0, of(turned(all.front())), 0.0};
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double value = of(turned(all[k]));
    result.least = std::min(result.least, value);
    result.most = std::max(result.most, value);
    const bool counts = even.empty() || k >= all.size() - even.size();
    if (counts) result.mean += value / double(even.empty() ? all.size() : even.size());
  }
  return result;
}

double bulk_micromodulus(double youngs_modulus, const BondSetting& setting) {
  return micromodulus(youngs_modulus, setting, BulkBonds(setting).moment(1));
}

namespace {

/// Second moment of the corrected bonds of a cloud, the mean over points [m5].
double second_moment(const BondSetting& setting, const BulkCloud& cloud) {
  const double second = setting.cloud_moment(2, cloud.size);
  switch (cloud.surface_correction) {
    case SurfaceCorrection::energy:
      return second * setting.moment(1) / setting.cloud_moment(1, cloud.size);
    case SurfaceCorrection::volume: {
      // A point is none of its own neighbours.
      const double own = std::pow(cloud.size, setting.dimension) * setting.cross_section;
      const double seen = setting.cloud_moment(0, cloud.size) - own;
      return second * setting.lattice_moment(0, cloud.size) / seen;
    }
    case SurfaceCorrection::none:
      break;
  }
  return second;
}

}  // namespace

double mean_crossing(const BondSetting& setting) {
  const double second = setting.lattice ? BulkBonds(setting).moment(2)
                        : setting.cloud ? second_moment(setting, *setting.cloud)
                                        : setting.moment(2);
  return 0.5 * mean_of_magnitude(setting.dimension) * second;
}

}  // namespace peristat
