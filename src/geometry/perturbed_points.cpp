#include "src/geometry/perturbed_points.hpp"

#include <cstddef>
#include <random>

#include "src/geometry/lattice_sites.hpp"

namespace peristat {

// The generator's integers are mapped here, because the standard leaves the mapping of its
// distributions to each library.
void perturb(const Lattice& lattice, const std::vector<bool>& is_body, GlobalIndex before,
             Points& points) {
  if (lattice.perturbation == 0.0) return;
  std::mt19937_64 generator(lattice.seed);
  generator.discard(static_cast<unsigned long long>(before * lattice.dimension));
  const LatticeFrame frame = frame_of(lattice);
  for (Index point = 0; point < points.count(); ++point) {
    if (!is_body[point]) continue;
    Coordinates shift{};
    for (int c = 0; c < lattice.dimension; ++c) {
      const double from_zero_to_one = double(generator() >> 11) * 0x1p-53;
      shift[c] = lattice.perturbation * lattice.spacing.along(c) * (2.0 * from_zero_to_one - 1.0);
    }
    shift = frame.turned(shift);
    for (int c = 0; c < lattice.dimension; ++c)
      points.reference[std::size_t(point) * lattice.dimension + c] += shift[c];
  }
}

}  // namespace peristat
