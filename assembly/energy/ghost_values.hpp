#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "assembly/energy/sharing.hpp"

namespace peristat {

/// Gives ghosts the one value per point that their owners have; a call that all ranks make.
inline void update_ghost_values(const Sharing& sharing, int dimension, std::span<double> values) {
  const auto d = std::size_t(dimension);
  std::vector<double> vectors(values.size() * d);
  for (std::size_t i = 0; i < values.size(); ++i) vectors[i * d] = values[i];
  sharing.update_ghosts(vectors);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = vectors[i * d];
}

}  // namespace peristat
