#include "assembly/convolutions/correspondence.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>

#include "assembly/convolutions/linear_bonds.hpp"
#include "src/core/dual.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

using Parity = LatticeFields::Parity;
using Product = LatticeFields::Product;

template <int D>
using Tensors = Eigen::Map<Eigen::Matrix<double, D, D, Eigen::RowMajor>>;
template <int D>
using ConstTensors = Eigen::Map<const Eigen::Matrix<double, D, D, Eigen::RowMajor>>;
template <int D>
using ConstVectors = Eigen::Map<const Eigen::Matrix<double, D, 1>>;

double length_of(const Coordinates& xi) { return std::hypot(xi[0], xi[1], xi[2]); }

/// E = (H + H^T + H^T H) / 2: no digits are lost at small strains.
template <int D, class Real>
Matrix<D, Real> green_strain(const Matrix<D, Real>& H) {
  Matrix<D, Real> strain;
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) {
      Real sum = H[i][j] + H[j][i];
      for (int k = 0; k < D; ++k) sum += H[k][i] * H[k][j];
      strain[i][j] = Real(0.5) * sum;
    }
  }
  return strain;
}

/// S = lambda tr(E) 1 + 2 mu E
template <int D, class Real>
Matrix<D, Real> second_stress(const Matrix<D, Real>& strain, const LamePair& constants) {
  Real trace = 0.0;
  for (int i = 0; i < D; ++i) trace += strain[i][i];
  Matrix<D, Real> stress;
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) stress[i][j] = Real(2.0 * constants.mu) * strain[i][j];
    stress[i][i] += Real(constants.lambda) * trace;
  }
  return stress;
}

/// P = F S
template <int D, class Real>
Matrix<D, Real> first_stress(const Matrix<D, Real>& H, const LamePair& constants) {
  const Matrix<D, Real> second = second_stress<D, Real>(green_strain<D, Real>(H), constants);
  Matrix<D, Real> stress = second;
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) {
      for (int k = 0; k < D; ++k) stress[i][j] += H[i][k] * second[k][j];
    }
  }
  return stress;
}

template <int D>
Matrix<D, double> matrix_at(const std::vector<double>& field, std::size_t point) {
  Matrix<D, double> at;
  for (std::size_t k = 0; k < D * D; ++k) at[k / D][k % D] = field[point * D * D + k];
  return at;
}

/// S : E / 2
template <int D>
double energy_density(const Matrix<D, double>& H, const LamePair& constants) {
  const Matrix<D, double> strain = green_strain<D, double>(H);
  const Matrix<D, double> stress = second_stress<D, double>(strain, constants);
  double sum = 0.0;
  for (int i = 0; i < D; ++i) sum += 0.5 * dot<D>(stress[i], strain[i]);
  return sum;
}

}  // namespace

Correspondence::Correspondence(const CutLattice& box, const std::array<bool, 3>& is_periodic,
                               std::vector<LatticeArm> arms, const Setting& setting, int threads)
    : arms_(std::move(arms)),
      setting_(setting),
      fields_(box, is_periodic, steps_of(arms_), threads) {
  const int d = box.dimension;
  if (d < 2) throw std::logic_error("a correspondence material is of dimension 2 or 3");
  const auto spectrum = [&](Parity parity, const auto& value) {
    return fields_.spectrum(parity, [&](std::size_t s) { return value(arms_[s]); });
  };
  size_ = spectrum(Parity::even, [](const LatticeArm& arm) { return arm.share; });
  for (int i = 0; i < d; ++i) {
    arm_.push_back(
        spectrum(Parity::odd, [i](const LatticeArm& arm) { return arm.share * arm.xi[i]; }));
    for (int j = i; j < d; ++j) {
      shape_.push_back(spectrum(Parity::even, [i, j](const LatticeArm& arm) {
        return arm.share * arm.xi[i] * arm.xi[j];
      }));
    }
  }
  for (const LatticeArm& arm : arms_) {
    const double length = length_of(arm.xi);
    whole_size_ += 2.0 * arm.share;
    whole_shape_ += 2.0 * arm.share * length * length / d;
  }
  set_integrity(std::vector<double>(box.place.size(), 1.0));
}

void Correspondence::set_integrity(std::span<const double> integrity) {
  fields_.set_integrity(integrity);
  state_.clear();
  if (fields_.dimension() == 2) renew_shapes<2>();
  if (fields_.dimension() == 3) renew_shapes<3>();
}

template <int D>
void Correspondence::renew_shapes() {
  const std::size_t points = fields_.points();
  sizes_.resize(points);
  arms_left_.resize(points * D);
  shapes_.resize(points * D * D);
  inverse_shapes_.resize(points * D * D);
  fields_.fill(0, [](std::size_t) { return 1.0; });
  fields_.find_sums(size_, 0, [&](std::size_t i, double sum) { sizes_[i] = sum; });
  for (std::size_t c = 0; c < D; ++c) {
    fields_.find_sums(arm_[c], 0, [&](std::size_t i, double sum) { arms_left_[i * D + c] = sum; });
    for (std::size_t e = c; e < D; ++e) {
      fields_.find_sums(shape_[pair_of(int(c), int(e), D)], 0, [&](std::size_t i, double sum) {
        shapes_[(i * D + c) * D + e] = shapes_[(i * D + e) * D + c] = sum;
      });
    }
  }
  fields_.leave_out_lonely(whole_size_, [&](std::size_t i) { return sizes_[i]; });
  fields_.for_points([&](std::size_t i) {
    const ConstTensors<D> shape(&shapes_[i * D * D]);
    Tensors<D> inverse(&inverse_shapes_[i * D * D]);
    const bool has_one = symmetric_eigenvalues<D>(shape.data())[0] > least_shape * whole_shape_;
    inverse.setZero();
    if (has_one && share(i) > 0.0) inverse = shape.inverse();
  });
  if (!has_images()) return;
  shared_sizes_.resize(points);
  fields_.fill(0, [&](std::size_t i) { return share(i); });
  fields_.find_sums(
      size_, 0, [&](std::size_t i, double sum) { shared_sizes_[i] = share(i) * sizes_[i] + sum; });
}

/// Finds sum q' kappa eta xi, or its rate for a rate u, and leaves u in fields 0 ... D - 1.
template <int D>
void Correspondence::find_moments(const std::vector<double>& u, std::vector<double>& moments) {
  moments.resize(fields_.points() * D * D);
  for (std::size_t i = 0; i < D; ++i) {
    fields_.fill(i, [&](std::size_t x) { return u[x * D + i]; });
    for (std::size_t j = 0; j < D; ++j) {
      fields_.find_sums(arm_[j], i, [&](std::size_t x, double sum) {
        moments[(x * D + i) * D + j] = sum - u[x * D + i] * arms_left_[x * D + j];
      });
    }
  }
}

/// Finds H, or its rate for a rate u, and leaves u in fields 0 ... D - 1.
template <int D>
void Correspondence::find_gradients(const std::vector<double>& u, std::vector<double>& gradients) {
  find_moments<D>(u, gradients);
  fields_.for_points([&](std::size_t x) {
    Tensors<D> gradient(&gradients[x * D * D]);
    gradient *= ConstTensors<D>(&inverse_shapes_[x * D * D]);
  });
}

void Correspondence::take_up(std::span<const double> displacement) {
  state_.assign(displacement.begin(), displacement.end());
  fields_.take_off_mean(displacement, displacement_);
  if (fields_.dimension() == 2) find_gradients<2>(displacement_, gradients_);
  if (fields_.dimension() == 3) find_gradients<3>(displacement_, gradients_);
}

template <int D>
void Correspondence::find_stresses() {
  stresses_.resize(gradients_.size());
  fields_.for_points([&](std::size_t i) {
    const Matrix<D, double> first =
        first_stress<D, double>(matrix_at<D>(gradients_, i), setting_.constants);
    Tensors<D> stress(&stresses_[i * D * D]);
    stress = setting_.volume * ConstTensors<D>(first[0].data()) *
             ConstTensors<D>(&inverse_shapes_[i * D * D]);
    stress -= setting_.stabilisation * ConstTensors<D>(&gradients_[i * D * D]);
  });
}

template <int D>
void Correspondence::find_stress_rates() {
  stresses_.resize(gradients_.size());
  fields_.for_points([&](std::size_t i) {
    Matrix<D, Dual> at;
    for (std::size_t k = 0; k < D * D; ++k) {
      at[k / D][k % D] = {gradients_[i * D * D + k], gradient_rates_[i * D * D + k]};
    }
    const Matrix<D, Dual> first = first_stress<D, Dual>(at, setting_.constants);
    Eigen::Matrix<double, D, D> rate;
    for (int r = 0; r < D; ++r) {
      for (int c = 0; c < D; ++c) rate(r, c) = first[std::size_t(r)][std::size_t(c)].rate;
    }
    Tensors<D> stress(&stresses_[i * D * D]);
    stress = setting_.volume * rate * ConstTensors<D>(&inverse_shapes_[i * D * D]);
    stress -= setting_.stabilisation * ConstTensors<D>(&gradient_rates_[i * D * D]);
  });
}

/// Finds sign f, or its rate, from R, u and fields 0 ... D - 1 of u, or from their rates.
template <int D>
void Correspondence::find_pulls(const std::vector<double>& u, double sign,
                                std::span<double> force) {
  const double beta = setting_.stabilisation;
  for (std::size_t i = 0; i < D; ++i) {
    std::array<Product, D + 1> products;
    for (std::size_t j = 0; j < D; ++j) {
      fields_.fill(D + j, [&](std::size_t x) { return stresses_[(x * D + i) * D + j]; });
      products[j] = {&arm_[j], D + j};
    }
    products[D] = {&size_, i, 2.0 * beta};
    if (has_images()) {
      fields_.fill(2 * D, [&](std::size_t x) { return share(x) * u[x * D + i]; });
      products[D] = {&size_, 2 * D, beta};
    }
    fields_.find_sums(products, [&](std::size_t x, double sum) {
      sum -= beta * sizes_of_ends(x) * u[x * D + i];
      for (std::size_t j = 0; j < D; ++j) {
        sum += stresses_[(x * D + i) * D + j] * arms_left_[x * D + j];
      }
      force[x * D + i] = sign * fields_.integrity(x) * sum;
    });
    if (!has_images()) continue;
    fields_.find_sums(size_, i, [&](std::size_t x, double sum) {
      force[x * D + i] += sign * fields_.integrity(x) * share(x) * beta * sum;
    });
  }
}

void Correspondence::find_forces(std::span<const double> displacement, std::span<double> force) {
  take_up(displacement);
  with_dimension(fields_.dimension(), [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    if constexpr (D > 1) {
      find_stresses<D>();
      find_pulls<D>(displacement_, 1.0, force);
    }
  });
}

void Correspondence::find_forces_and_energies(std::span<const double> displacement,
                                              std::span<double> force, std::span<double> energy) {
  find_forces(displacement, force);
  if (fields_.dimension() == 2) find_energies<2>(energy);
  if (fields_.dimension() == 3) find_energies<3>(energy);
}

/// sum q' kappa z^2 = sum q' kappa eta^2 - H K : H, since H minimises it. Uses the fields that the
/// forces of the same displacements have left.
template <int D>
void Correspondence::find_energies(std::span<double> energy) {
  const std::vector<double>& u = displacement_;
  const auto squared = [&](std::size_t x) {
    double sum = 0.0;
    for (std::size_t c = 0; c < D; ++c) sum += u[x * D + c] * u[x * D + c];
    return sum;
  };
  fields_.fill(D, squared);
  fields_.find_sums(size_, D,
                    [&](std::size_t x, double sum) { energy[x] = sum + squared(x) * sizes_[x]; });
  for (std::size_t c = 0; c < D; ++c) {
    fields_.find_sums(size_, c,
                      [&](std::size_t x, double sum) { energy[x] -= 2.0 * u[x * D + c] * sum; });
  }
  fields_.for_points([&](std::size_t x) {
    const ConstTensors<D> gradient(&gradients_[x * D * D]), shape(&shapes_[x * D * D]);
    const double rest = energy[x] - (gradient * shape).cwiseProduct(gradient).sum();
    const double density = energy_density<D>(matrix_at<D>(gradients_, x), setting_.constants);
    energy[x] = share(x) * fields_.integrity(x) *
                (setting_.volume * density + 0.5 * setting_.stabilisation * rest);
  });
}

void Correspondence::multiply(std::span<const double> displacement, std::span<const double> v,
                              std::span<double> product) {
  if (!std::ranges::equal(displacement, state_)) take_up(displacement);
  fields_.take_off_mean(v, direction_);
  with_dimension(fields_.dimension(), [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    if constexpr (D > 1) {
      find_gradients<D>(direction_, gradient_rates_);
      find_stress_rates<D>();
      find_pulls<D>(direction_, -1.0, product);
    }
  });
}

void Correspondence::outline_tangent(std::span<const double> displacement,
                                     std::span<double> diagonal, std::span<double> row_sums) {
  if (!std::ranges::equal(displacement, state_)) take_up(displacement);
  with_dimension(fields_.dimension(), [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    if constexpr (D > 1) {
      outline_blocks<D>(diagonal);
      add_neighbours_blocks<D>(diagonal);
      std::vector<double> bounds(row_sums.size());
      bound_rows<D>(bounds);
      add_rounded_up(bounds, row_sums);
    }
  });
}

/// A displacement u of a point changes its H by u g, with g = -K^-1 sum q' kappa xi: at rest the
/// energy of that is V ((lambda + mu) (u . g)^2 + mu u^2 g^2) / 2. The stabilisation adds
/// sum q' kappa u^2 at the point and its neighbours, less the part that H represents.
template <int D>
void Correspondence::outline_blocks(std::span<double> diagonal) {
  const auto& [lambda, mu] = setting_.constants;
  const double V = setting_.volume, beta = setting_.stabilisation;
  fields_.for_points([&](std::size_t i) {
    const ConstVectors<D> arms(&arms_left_[i * D]);
    const Eigen::Matrix<double, D, 1> g = -(ConstTensors<D>(&inverse_shapes_[i * D * D]) * arms);
    Eigen::Matrix<double, D, D> block = V * (lambda + mu) * g * g.transpose();
    block.diagonal().array() += V * mu * g.squaredNorm() + beta * (sizes_of_ends(i) + g.dot(arms));
    Tensors<D>(&diagonal[i * D * D]) += fields_.integrity(i) * block;
  });
}

/// Adds the same for the neighbours' H, which change by u g' with g' = q kappa K'^-1 xi: sums of
/// kappa^2 xi xi with the neighbours' K'^-1 on both sides.
template <int D>
void Correspondence::add_neighbours_blocks(std::span<double> diagonal) {
  const auto& [lambda, mu] = setting_.constants;
  const double V = setting_.volume, beta = setting_.stabilisation;
  std::vector<LatticeSpectrum> kernels;
  std::vector<Product> products;
  for (int k = 0; k < D; ++k) {
    for (int l = k; l < D; ++l) {
      kernels.push_back(fields_.spectrum(Parity::even, [&](std::size_t s) {
        const LatticeArm& arm = arms_[s];
        return arm.share * arm.share * arm.xi[k] * arm.xi[l];
      }));
    }
  }
  for (std::size_t p = 0; p < kernels.size(); ++p) products.push_back({&kernels[p], p});
  // Calls add(point, sum) with the sum of q' kappa^2 xi . weights(neighbour) xi.
  const auto find = [&](const auto& weight, const auto& add) {
    for (int k = 0; k < D; ++k) {
      for (int l = k; l < D; ++l) {
        const double times = k == l ? 1.0 : 2.0;
        fields_.fill(pair_of(k, l, D), [&](std::size_t x) {
          return times * weight(ConstTensors<D>(&inverse_shapes_[x * D * D]), k, l);
        });
      }
    }
    fields_.find_sums(products, [&](std::size_t x, double sum) {
      const double q = fields_.integrity(x);
      add(Tensors<D>(&diagonal[x * D * D]), q * q * sum);
    });
  };
  for (int a = 0; a < D; ++a) {
    for (int b = a; b < D; ++b) {
      find(
          [a, b](const auto& inverse, int k, int l) {
            return 0.5 * (inverse(a, k) * inverse(b, l) + inverse(a, l) * inverse(b, k));
          },
          [&](Tensors<D> block, double sum) {
            block(a, b) += V * (lambda + mu) * sum;
            if (a != b) block(b, a) += V * (lambda + mu) * sum;
            if (a == b) block.diagonal().array() += V * mu * sum;
          });
    }
  }
  find([](const auto& inverse, int k, int l) { return inverse(k, l); },
       [&](Tensors<D> block, double sum) { block.diagonal().array() -= beta * sum; });
}

/// With P = F S, dP = dH S + F (lambda tr(dE) + 2 mu dE) and dE = (F^T dH + dH^T F) / 2, every H
/// adds to a row at most V (|S| + |F|^2 sqrt(d) (|lambda| + 2 mu)) |g| times the sum of all its
/// |g|. The stabilisation adds terms like beta |K^-1 g| for H, and 4 beta q q' kappa for eta.
template <int D>
void Correspondence::bound_rows(std::span<double> row_sums) {
  const auto& [lambda, mu] = setting_.constants;
  const double V = setting_.volume, beta = setting_.stabilisation;
  const double modulus = std::sqrt(double(D)) * (std::abs(lambda) + 2.0 * mu);
  const LatticeSpectrum lengths = fields_.spectrum(
      Parity::even, [&](std::size_t s) { return arms_[s].share * length_of(arms_[s].xi); });
  std::vector<double> weight(fields_.points());
  fields_.fill(0, [](std::size_t) { return 1.0; });
  fields_.find_sums(lengths, 0, [&](std::size_t i, double sum) {
    const double norm = symmetric_eigenvalues<D>(&inverse_shapes_[i * D * D])[D - 1];
    const double arms = ConstVectors<D>(&arms_left_[i * D]).norm();
    const Matrix<D, double> H = matrix_at<D>(gradients_, i);
    const Matrix<D, double> S =
        second_stress<D, double>(green_strain<D, double>(H), setting_.constants);
    const double F = 1.0 + ConstTensors<D>(H[0].data()).norm();
    const double stiffness = V * (ConstTensors<D>(S[0].data()).norm() + F * F * modulus);
    weight[i] = (stiffness * norm + beta) * norm * (sum + arms);
  });
  fields_.fill(1, [&](std::size_t i) { return weight[i]; });
  fields_.find_sums(lengths, 1, [&](std::size_t i, double sum) {
    const double arms = ConstVectors<D>(&arms_left_[i * D]).norm();
    const double row =
        fields_.integrity(i) * (sum + weight[i] * arms + 2.0 * beta * sizes_of_ends(i));
    for (std::size_t c = 0; c < D; ++c) row_sums[i * D + c] = row;
  });
}

void Correspondence::add_virials(std::span<const double> displacement, std::span<double> virials) {
  std::vector<double> u;  // displacement_ stays at the state that is known
  fields_.take_off_mean(displacement, u);
  if (fields_.dimension() == 2) add_virials<2>(u, virials);
  if (fields_.dimension() == 3) add_virials<3>(u, virials);
}

/// q (V F S + beta sum q' kappa z xi) per point: where there is an H, H K equals sum q' kappa eta
/// xi, and the sum of z vanishes.
template <int D>
void Correspondence::add_virials(const std::vector<double>& u, std::span<double> virials) {
  std::vector<double> moments;
  find_moments<D>(u, moments);
  fields_.for_points([&](std::size_t i) {
    const ConstTensors<D> moment(&moments[i * D * D]), inverse(&inverse_shapes_[i * D * D]);
    Eigen::Matrix<double, D, D> virial = setting_.stabilisation * moment;
    if (!inverse.isZero(0.0)) {
      Matrix<D, double> H;
      Tensors<D>(H[0].data()) = moment * inverse;
      const Matrix<D, double> stress = first_stress<D, double>(H, setting_.constants);
      virial = setting_.volume * ConstTensors<D>(stress[0].data());
    }
    Tensors<D>(&virials[i * D * D]) += share(i) * fields_.integrity(i) * virial;
  });
}

std::size_t Correspondence::points_without_gradient() const {
  const auto d = std::size_t(fields_.dimension());
  std::size_t count = 0;
  const std::size_t own = std::min(setting_.own, fields_.points());
  for (std::size_t i = 0; i < own; ++i) count += inverse_shapes_[i * d * d] == 0.0;
  return count;
}

double Correspondence::expected_bytes(const LatticeBox& box,
                                      std::span<const LatticeSpring> springs) {
  const double d = box.dimension, pairs = d * (d + 1.0) / 2.0;
  // Per site: fields of u and of stresses, their sum, kernels on half of the modes. Per point: site
  // and integrity, size, arms, three displacements, five matrices.
  return 8.0 * lattice_places(box, steps_of(springs)) * (2.0 * d + 1.0 + 0.5 * (pairs + d + 1.0)) +
         8.0 * double(box.place.size()) * (3.0 + 4.0 * d + 5.0 * d * d);
}

double Correspondence::bytes() const {
  double numbers = 0.0;
  for (const std::vector<double>* kept :
       {&sizes_, &shared_sizes_, &arms_left_, &shapes_, &inverse_shapes_, &state_, &displacement_,
        &direction_, &gradients_, &gradient_rates_, &stresses_}) {
    numbers += double(kept->size());
  }
  const auto spectra = double(1 + arm_.size() + shape_.size());
  return 8.0 * numbers + fields_.bytes() + spectra * fields_.spectrum_bytes();
}

}  // namespace peristat
