#include "src/conditions/displacement_control.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "src/conditions/points_of_set.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

void check_weights(const ControlTerm& term, int dimension, const std::string& key) {
  double largest = 0.0;
  for (int c = 0; c < dimension; ++c) {
    const double weight = term.weights[std::size_t(c)];
    if (!std::isfinite(weight)) throw InputError(key, number_text(weight), "must be finite");
    largest = std::max(largest, std::abs(weight));
  }
  if (largest == 0.0) throw InputError(key, "", "are all zero, so no displacement is controlled");
}

}  // namespace

DisplacementControl::DisplacementControl(const Points& points,
                                         const std::vector<ControlTerm>& terms,
                                         const std::vector<char>& prescribed)
    : weights_(points.reference.size(), 0.0) {
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const std::string table = indexed("controls", k);
    const std::vector<Index>& members = points_of_set(points, terms[k].set, table + ".set");
    check_weights(terms[k], points.dimension, table + ".weights");
    for (const Index point : members) {
      for (int c = 0; c < points.dimension; ++c) {
        weights_[std::size_t(point) * points.dimension + c] +=
            terms[k].weights[std::size_t(c)] / double(members.size());
      }
    }
  }
  for (std::size_t dof = 0; dof < weights_.size(); ++dof) {
    if (weights_[dof] != 0.0 && !prescribed[dof]) return;
  }
  throw InputError("controls", "",
                   "every displacement in the sum is prescribed by a support, or the terms cancel: "
                   "the sum contains no free degree of freedom that could be controlled");
}

double DisplacementControl::value(std::span<const double> displacement) const {
  return std::inner_product(weights_.begin(), weights_.end(), displacement.begin(), 0.0);
}

}  // namespace peristat
