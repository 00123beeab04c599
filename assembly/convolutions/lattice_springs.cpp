#include "assembly/convolutions/lattice_springs.hpp"

#include "src/geometry/lattice_frame.hpp"

namespace peristat {
namespace {

/// Calls visit(step, direction, length, factor) for the neighbours of a point, one per opposite
/// pair.
template <class Visit>
void for_each_half(const Kernel& kernel, const Spacing& spacing, double angle, const Visit& visit) {
  const LatticeKernel lattice(kernel, spacing);
  const LatticeFrame frame(kernel.dimension, {}, 0.0, spacing, kernel.dimension > 1 ? angle : 0.0);
  lattice.for_each_neighbour([&](const LatticeStep& step, double factor) {
    if (step < LatticeStep{}) return;  // its opposite is visited
    const double length = lattice.distance(step);
    Coordinates along{};
    for (int c = 0; c < kernel.dimension; ++c) {
      along[c] = step[std::size_t(c)] * spacing.along(c) / length;
    }
    visit(step, frame.turned(along), length, factor);
  });
}

Coordinates scaled(double length, Coordinates direction) {
  for (double& component : direction) component *= length;
  return direction;
}

}  // namespace

std::vector<LatticeSpring> lattice_springs(const Kernel& kernel, const Spacing& spacing,
                                           double angle, double micromodulus, double volume) {
  std::vector<LatticeSpring> springs;
  for_each_half(kernel, spacing, angle,
                [&](const LatticeStep& step, const Coordinates& n, double length, double factor) {
                  const double stiffness = micromodulus * volume * volume * factor / length;
                  springs.push_back({step, n, scaled(length, n), stiffness});
                });
  return springs;
}

std::vector<LatticeArm> lattice_arms(const Kernel& kernel, const Spacing& spacing, double angle,
                                     double volume) {
  std::vector<LatticeArm> arms;
  for_each_half(kernel, spacing, angle,
                [&](const LatticeStep& step, const Coordinates& n, double length, double factor) {
                  arms.push_back({step, scaled(length, n), volume * volume * factor});
                });
  return arms;
}

}  // namespace peristat
