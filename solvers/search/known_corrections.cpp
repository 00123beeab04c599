#include "solvers/search/known_corrections.hpp"

#include <utility>

#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Largest number of corrections: a search takes some five.
constexpr std::size_t most = 16;

/// A change of which less than this is new tells nothing.
constexpr double least_news = 0.1;

}  // namespace

std::vector<double> KnownCorrections::take_off(std::span<double> residual) const {
  std::vector<double> correction(residual.size());
  for (const Known& one : known_) {
    const double share = dot(residual, one.change);
    add_scaled(residual, -share, one.change);
    add_scaled(correction, -share, one.correction);
  }
  return correction;
}

void KnownCorrections::add(std::vector<double> correction, std::vector<double> change) {
  if (known_.size() == most) return;
  const double whole = norm(change);
  add_scaled(correction, 1.0, take_off(change));
  const double size = norm(change);
  if (!(size > least_news * whole)) return;
  for (double& entry : correction) entry /= size;
  for (double& entry : change) entry /= size;
  known_.push_back({std::move(correction), std::move(change)});
}

}  // namespace peristat
