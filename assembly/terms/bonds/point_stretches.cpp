#include "assembly/terms/bonds/point_stretches.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <type_traits>

#include "assembly/terms/damage.hpp"
#include "src/measures/length.hpp"

namespace peristat {
namespace {

constexpr double none = -std::numeric_limits<double>::infinity();

/// Lets a number that several threads raise be at least `value`.
void raise(double& number, double value) {
  const std::atomic_ref<double> shared(number);
  double before = shared.load(std::memory_order_relaxed);
  while (before < value &&
         !shared.compare_exchange_weak(before, value, std::memory_order_relaxed)) {
  }
}

template <int D>
void find_largest(const Points& points, const Model& model, const StateView& at,
                  std::span<double> stretches, int threads) {
  const std::vector<char> broken = broken_bonds(model, at.history);
  const Bonds& bonds = model.bonds();
  const std::span<const double> eigenstretch = at.eigenstretch();
  const auto difference = [](std::span<const double> field, Index i, Index j) {
    Vector<D, double> result;
    for (int c = 0; c < D; ++c) {
      result[c] = field[std::size_t(j) * D + c] - field[std::size_t(i) * D + c];
    }
    return result;
  };
#pragma omp parallel for num_threads(threads) schedule(static)
  for (Index i = 0; i < bonds.points(); ++i) {
    double largest = none;
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!broken.empty() && broken[bond]) continue;
      const Index j = bonds.partner(i, bond);
      const double free = eigenstretch.empty() ? 0.0 : 0.5 * (eigenstretch[i] + eigenstretch[j]);
      const double stretch =
          Length::at<D, double>(bonds.inverse_length(bond), {difference(points.reference, i, j)},
                                {difference(at.displacement, i, j)})
              .relative_change -
          free;
      largest = std::max(largest, stretch);
      raise(stretches[j], stretch);
    }
    raise(stretches[i], largest);
  }
}

}  // namespace

double point_stretches(const Points& points, const Model& model, const StateView& at,
                       std::span<double> stretches, int threads) {
  std::fill(stretches.begin(), stretches.end(), none);
  switch (points.dimension) {
    case 1:
      find_largest<1>(points, model, at, stretches, threads);
      break;
    case 2:
      find_largest<2>(points, model, at, stretches, threads);
      break;
    default:
      find_largest<3>(points, model, at, stretches, threads);
  }
  const double largest = stretches.empty() ? none : std::ranges::max(stretches);
  std::replace(stretches.begin(), stretches.end(), none, 0.0);
  return largest;
}

std::vector<double> largest_driving(const Points& points, const Bonds& bonds,
                                    std::span<const BondDrive> drives,
                                    std::span<const char> broken) {
  std::vector<double> largest(std::size_t(points.own()), 0.0);
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!broken.empty() && broken[std::size_t(bond)]) continue;
      const double driving = drives[std::size_t(bond)].driving();
      for (const Index point : {i, bonds.partner(i, bond)}) {
        double& of_point = largest[std::size_t(points.source(point))];
        of_point = std::max(of_point, driving);
      }
    }
  }
  return largest;
}

}  // namespace peristat
