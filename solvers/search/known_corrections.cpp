#include "solvers/search/known_corrections.hpp"

#include <array>
#include <cmath>

#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// A change of which less than this is not in later ones tells nothing.
constexpr double least_news = 0.1;

template <class One, class Other>
double dot_of(const One& one, const Other& other) {
  return sum_of(one.size(), [&](std::size_t k) { return double(one[k]) * double(other[k]); });
}

void add_share(std::span<double> to, double share, const std::vector<float>& of) {
#pragma omp simd
  for (std::size_t k = 0; k < of.size(); ++k) to[k] += share * double(of[k]);
}

std::vector<float> scaled(std::span<const double> values, double factor) {
  std::vector<float> result(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) result[k] = float(factor * values[k]);
  return result;
}

}  // namespace

void KnownCorrections::take_off(std::span<double> residual, std::span<double> correction) const {
  const std::vector<double> shares = shares_of(residual);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    add_share(residual, -shares[k], latest_first_[k].change);
    add_share(correction, -shares[k], latest_first_[k].correction);
  }
}

void KnownCorrections::add(std::span<const double> correction, std::span<const double> change) {
  const double size = std::sqrt(dot_of(change, change));
  if (!(size > 0.0) || !std::isfinite(size)) return;
  if (latest_first_.size() == most) latest_first_.pop_back();
  latest_first_.insert(latest_first_.begin(),
                       {scaled(correction, 1.0 / size), scaled(change, 1.0 / size)});
}

std::vector<double> KnownCorrections::shares_of(std::span<const double> residual) const {
  const std::size_t size = latest_first_.size();
  std::array<std::array<double, most>, most> factor{};  // of the changes' products, row by row
  std::vector<double> shares(size);
  for (std::size_t i = 0; i < size; ++i) {
    const std::vector<float>& change = latest_first_[i].change;
    double share = dot_of(residual, change), rest = dot_of(change, change);
    const double whole = rest;
    for (std::size_t j = 0; j < i; ++j) {
      if (factor[j][j] == 0.0) continue;
      double product = dot_of(change, latest_first_[j].change);
      for (std::size_t k = 0; k < j; ++k) product -= factor[i][k] * factor[j][k];
      factor[i][j] = product / factor[j][j];
      share -= factor[i][j] * shares[j];
      rest -= factor[i][j] * factor[i][j];
    }
    if (!(rest > least_news * least_news * whole)) continue;
    factor[i][i] = std::sqrt(rest);
    shares[i] = share / factor[i][i];
  }
  for (std::size_t i = size; i-- > 0;) {
    if (factor[i][i] == 0.0) continue;
    for (std::size_t j = i + 1; j < size; ++j) shares[i] -= factor[j][i] * shares[j];
    shares[i] /= factor[i][i];
  }
  return shares;
}

void KnownCorrections::lose(double stiffness, std::span<const std::pair<Index, double>> g) {
  for (Known& one : latest_first_) {
    double along = 0.0;
    for (const auto& [equation, share] : g) along += share * one.correction[std::size_t(equation)];
    for (const auto& [equation, share] : g) {
      one.change[std::size_t(equation)] += float(stiffness * along * share);
    }
  }
}

}  // namespace peristat
