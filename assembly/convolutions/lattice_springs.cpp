#include "assembly/convolutions/lattice_springs.hpp"

#include "src/geometry/lattice_frame.hpp"

namespace peristat {

std::vector<LatticeSpring> lattice_springs(const Kernel& kernel, const Spacing& spacing,
                                           double angle, double micromodulus, double volume) {
  const LatticeKernel lattice(kernel, spacing);
  const LatticeFrame frame(kernel.dimension, {}, 0.0, spacing, kernel.dimension > 1 ? angle : 0.0);
  std::vector<LatticeSpring> springs;
  lattice.for_each_neighbour([&](const LatticeStep& step, double factor) {
    if (step < LatticeStep{}) return;  // its opposite is there
    const double length = lattice.distance(step);
    Coordinates along{};
    for (int c = 0; c < kernel.dimension; ++c) {
      along[c] = step[std::size_t(c)] * spacing.along(c) / length;
    }
    LatticeSpring spring{step, frame.turned(along), {}, 0.0};
    for (std::size_t c = 0; c < 3; ++c) spring.arm[c] = length * spring.direction[c];
    spring.stiffness = micromodulus * volume * volume * factor / length;
    springs.push_back(spring);
  });
  return springs;
}

}  // namespace peristat
