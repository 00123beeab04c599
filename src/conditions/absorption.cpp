#include "src/conditions/absorption.hpp"

#include "src/conditions/field_of_place.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {

std::vector<double> absorption_rates(const Points& points,
                                     const std::vector<AbsorbingSpecification>& absorbing) {
  std::vector<double> rates;
  for (std::size_t k = 0; k < absorbing.size(); ++k) {
    std::vector<double> of_layer(std::size_t(points.count()), 0.0);
    const std::string key = indexed("absorbing", k);
    add_field_of_place(points, absorbing[k].set, absorbing[k].rate, key, "rate", 1, 0, of_layer);
    rates.resize(of_layer.size(), 0.0);
    for (std::size_t i = 0; i < of_layer.size(); ++i) {
      if (of_layer[i] < 0.0) {
        throw InputError(key + ".rate", number_text(of_layer[i]),
                         "must not be negative; it is at " +
                             place_text(points.position(Index(i)), points.dimension) + " m");
      }
      rates[i] += of_layer[i];
    }
  }
  return rates;
}

}  // namespace peristat
