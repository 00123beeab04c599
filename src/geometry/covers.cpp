#include "src/geometry/covers.hpp"

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/expression_at_points.hpp"
#include "src/geometry/outermost_face.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

std::string key_of(std::size_t layer, const char* key) {
  return "layers[" + std::to_string(layer) + "]." + key;
}

/// An expression stores the place that it is evaluated at: one thread at a time.
struct LockedExpression {
  Expression expression;
  std::mutex mutex{};
};

std::function<bool(const Coordinates&)> where_of(const Lattice& lattice, std::size_t number) {
  const std::string& text = lattice.layers[number].where;
  if (text.empty()) return {};
  try {
    auto locked = std::make_shared<LockedExpression>(expression_of(text, lattice));
    return [locked](const Coordinates& place) {
      const std::lock_guard<std::mutex> lock(locked->mutex);
      return locked->expression(place) != 0.0;
    };
  } catch (const InputError& error) {
    throw InputError(key_of(number, "where"), error.value(), error.allowed());
  }
}

}  // namespace

std::vector<Cover> covers_of(const Lattice& lattice, const std::vector<Coordinates>& places,
                             const Communicator& ranks) {
  const Solid solid(lattice.dimension, lattice.shapes);
  std::vector<Cover> covers;
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    const Layer& layer = lattice.layers[k];
    const auto face = outermost_face(solid, layer.side, places, lattice.spacing, ranks);
    if (!face) {
      throw InputError(key_of(k, "side"), name(layer.side),
                       "the body has no flat outermost side there for the layer to cover");
    }
    const double spacing =
        lattice.angle == 0.0 ? lattice.spacing.along(layer.side.axis) : double(lattice.spacing);
    covers.push_back({layer.side, *face, layer.thickness * spacing, where_of(lattice, k)});
  }
  return covers;
}

}  // namespace peristat
