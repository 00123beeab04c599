#pragma once

#include <string>
#include <vector>

#include "tests/problems.hpp"

namespace peristat::tests {

inline constexpr double onset = 0.01, critical = 0.03;

[[nodiscard]] inline BondPotential softening(double micromodulus) {
  return Degraded<TanhDegradation>{micromodulus, TanhDegradation::continuous(onset, critical, 3.0)};
}

/// A strip with a notch from below in its middle, or whose bonds across the middle alone may fail.
struct Strip {
  enum class Middle { notched, weak };
  BoxSetting box;
  BoxBody body;
  Conditions conditions;
  FreeDofs free;
  Assembler assembler;
  Tangent tangent;

  Strip(Middle middle, const std::vector<SupportSpecification>& supports, int threads = 1,
        double triangles = 0.0)
      : box(setting(triangles)),
        body(points_with_ends(box), box),
        conditions((change(middle), body.points), supports, {}),
        free(conditions.prescribed(), 2),
        assembler(body.points, body.model, threads),
        tangent(BlockPattern(body.model.bonds()), 2) {}
  Strip(const Strip&) = delete;
  Strip& operator=(const Strip&) = delete;

  LinearOutcome analyze(LinearSolver& solver) const {
    return solver.analyze(tangent.pattern, free);
  }

  static BoxSetting setting(double triangles) {
    BoxSetting strip = small_box(2);
    strip.triangles = triangles;
    strip.extent = {15, 7, 0};
    strip.potential = softening;
    return strip;
  }

 private:
  void change(Middle middle) {
    const Bonds& bonds = body.model.bonds();
    const auto crosses = [&](Index i, Offset bond) {
      const double a = body.points.position(i)[0] - 0.7,
                   b = body.points.position(bonds.partner[bond])[0] - 0.7;
      return a * b < 0.0;
    };
    if (middle == Middle::notched) {
      body.remove_bonds([&](Index i, Offset bond) {
        return crosses(i, bond) && body.points.position(i)[1] < 0.3 &&
               body.points.position(bonds.partner[bond])[1] < 0.3;
      });
      return;
    }
    std::vector<char> never_fails(std::size_t(bonds.count()), 1);
    for_each_bond(bonds, [&](Index i, Index, Offset bond) {
      if (crosses(i, bond)) never_fails[std::size_t(bond)] = 0;
    });
    body.replace_bonds(bonds, std::move(never_fails));
  }
};

/// Held on the left, drawn along x on the right.
[[nodiscard]] inline std::vector<SupportSpecification> drawn(const std::string& displacement) {
  return {support("left", "0", "0"), support("right", displacement, "0")};
}

}  // namespace peristat::tests
