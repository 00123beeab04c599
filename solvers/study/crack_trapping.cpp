#include "solvers/study/crack_trapping.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "solvers/formulations/formulations.hpp"

namespace peristat {
namespace {

/// Measured values of docs/trustworthy-peaks.md: bonds with the kernel 1/r in plane stress, 0 to 45
/// degrees at ratio 3, along the lattice at ratio 4.
struct Measured {
  int dimension;
  double horizon_ratio, low, high;
};
constexpr std::array<Measured, 2> measured{{{2, 3.015, 1.14, 1.19}, {2, 4.015, 1.15, 1.15}}};

/// Ratios nearer than this have nearly the same neighbours.
constexpr double same_ratio = 0.1;

bool is_brittle(const MaterialSpecification& material) {
  return material.damage.law == DamageLaw::critical_stretch &&
         formulation_of(material).has_measured_trapping;
}

}  // namespace

std::optional<CrackTrapping> crack_trapping(const BodySpecification& of, int dimension,
                                            double spacing) {
  const bool is_any_brittle =
      is_brittle(of.material) || std::ranges::any_of(of.regions, [](const RegionSpecification& r) {
        return is_brittle(r.material);
      });
  if (!is_any_brittle || !(spacing > 0.0) || dimension == 1) return std::nullopt;
  CrackTrapping found{of.horizon / spacing, dimension, std::nullopt};
  if (of.material.influence != ConstantInfluence::name) return found;
  for (const Measured& known : measured) {
    if (known.dimension == dimension &&
        std::abs(known.horizon_ratio - found.horizon_ratio) < same_ratio) {
      found.needed = {known.low, known.high};
    }
  }
  return found;
}

std::string description(const CrackTrapping& trapping) {
  const auto range = [](double low, double high) {
    return low == high ? fmt::format("{}", high) : fmt::format("{} to {}", low, high);
  };
  const std::string needed =
      trapping.needed ? "it runs at " + range(trapping.needed->first, trapping.needed->second)
                      : fmt::format(
                            "not measured in {}D at this ratio and influence function; with the "
                            "constant one in 2D, at ratios 3 and 4, it runs at 1.14 to 1.19",
                            trapping.dimension);
  return fmt::format(
      "brittle bonds at horizon ratio {:.2g} trap a crack: {} of K_Ic; with law = \"linear\" "
      "within 0.02 of it (docs/trustworthy-peaks.md)",
      trapping.horizon_ratio, needed);
}

}  // namespace peristat
