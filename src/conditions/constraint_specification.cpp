#include "src/conditions/constraint_specification.hpp"

namespace peristat {

const SymmetryPlane* opposite(const std::vector<SymmetryPlane>& planes, std::size_t of) {
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (k != of && planes[k].axis == planes[of].axis) return &planes[k];
  }
  return nullptr;
}

std::string name_of_plane(const std::vector<SymmetryPlane>& planes, std::size_t of) {
  const std::string name = std::string("symmetry_") + "xyz"[planes[of].axis];
  const SymmetryPlane* const other = opposite(planes, of);
  if (!other) return name;
  return name + (planes[of].at < other->at ? "-" : "+");
}

std::string name_of_period(const Period& period) {
  return std::string("period_") + "xyz"[period.axis];
}

}  // namespace peristat
