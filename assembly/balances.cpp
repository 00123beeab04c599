#include "assembly/balances.hpp"

#include <variant>

namespace peristat {

Balances balances_of(const Model& model) {
  const auto is_positive = [](const auto& potential) {
    return std::visit([](const auto& law) { return law.modulus >= 0.0; }, potential);
  };
  Balances balances;
  balances.positive_energy = is_positive(model.potential) &&
                             (!model.triangles || is_positive(model.triangles->potential)) &&
                             (!model.tetrahedra || is_positive(model.tetrahedra->potential));
  return balances;
}

}  // namespace peristat
