#include "solvers/search/known_corrections.hpp"

#include <cmath>
#include <type_traits>

namespace peristat {
namespace {

/// A change of which less than this is new tells nothing.
constexpr double least_news = 0.1;

template <class One, class Other>
double dot_of(const One& one, const Other& other) {
  double sum = 0.0;
#pragma omp simd reduction(+ : sum)
  for (std::size_t k = 0; k < one.size(); ++k) sum += double(one[k]) * double(other[k]);
  return sum;
}

template <class To>
void add_share(To& to, double share, const std::vector<float>& of) {
  using Number = std::remove_reference_t<decltype(to[0])>;
#pragma omp simd
  for (std::size_t k = 0; k < of.size(); ++k) to[k] += Number(share) * Number(of[k]);
}

template <class Numbers>
std::vector<float> scaled(const Numbers& values, double factor) {
  std::vector<float> result(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) result[k] = float(factor * double(values[k]));
  return result;
}

}  // namespace

void KnownCorrections::take_off(std::span<double> residual, std::span<double> correction) const {
  for (const Known& one : latest_first_) {
    const double share = dot_of(residual, one.change);
    add_share(residual, -share, one.change);
    add_share(correction, -share, one.correction);
  }
}

void KnownCorrections::add(std::span<const double> correction, std::span<const double> change) {
  put_first(correction, change);
}

template <class Numbers>
void KnownCorrections::put_first(const Numbers& correction, const Numbers& change) {
  const double size = std::sqrt(dot_of(change, change));
  if (!(size > 0.0) || !std::isfinite(size)) return;
  const Known latest{scaled(correction, 1.0 / size), scaled(change, 1.0 / size)};
  std::vector<Known> all{latest};
  for (Known& one : latest_first_) {
    const double share = dot_of(one.change, latest.change);
    add_share(one.change, -share, latest.change);
    const double rest = std::sqrt(dot_of(one.change, one.change));
    if (!(rest > least_news) || all.size() == most) continue;
    add_share(one.correction, -share, latest.correction);
    for (float& entry : one.change) entry = float(entry / rest);
    for (float& entry : one.correction) entry = float(entry / rest);
    all.push_back(std::move(one));
  }
  latest_first_ = std::move(all);
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

void KnownCorrections::settle() {
  std::vector<Known> all;
  all.swap(latest_first_);
  for (auto one = all.rbegin(); one != all.rend(); ++one) put_first(one->correction, one->change);
}

}  // namespace peristat
