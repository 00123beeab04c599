#include "solvers/body/without_equation.hpp"

#include "solvers/ranks/part_tangent.hpp"

namespace peristat {

std::vector<char> without_equation(const Body& body) {
  const std::vector<char>& prescribed = body.conditions->prescribed();
  return without_ghosts(*body.index_map, prescribed, body.points.dimension);
}

}  // namespace peristat
