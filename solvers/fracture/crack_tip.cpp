#include "solvers/fracture/crack_tip.hpp"

#include "src/measures/small_algebra.hpp"

namespace peristat {

Coordinates CrackTipFrame::components(const Coordinates& place) const {
  const Coordinates arm = minus<3>(place, origin);
  return {dot<3>(arm, e1), dot<3>(arm, e2), dot<3>(arm, e3)};
}

Coordinates CrackTipFrame::vector(const Coordinates& components) const {
  return plus<3>(plus<3>(scaled<3>(components[0], e1), scaled<3>(components[1], e2)),
                 scaled<3>(components[2], e3));
}

}  // namespace peristat
