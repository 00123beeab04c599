#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "src/potentials/make_saw_tooth.hpp"
#include "tests/problems.hpp"

namespace peristat::tests {

inline constexpr double onset = 0.01, critical = 0.03;

[[nodiscard]] inline BondPotential softening(double micromodulus) {
  return Degraded<TanhDegradation>{micromodulus, TanhDegradation::continuous(onset, critical, 3.0)};
}
[[nodiscard]] inline BondPotential toothed(double micromodulus) {
  return with_teeth(softening(micromodulus), 5);
}

/// Controlled sum of displacements, and the programme of its values.
struct Control {
  std::vector<ControlTerm> terms{};
  LoadingProgramme programme{};
};

/// A strip with a notch from below in its middle (notched), without a notch and with bonds that may
/// fail across the middle only (weak), or with bonds that never fail (elastic).
/// The sets "left_lip" and "right_lip" are the points beside the mouth of the notch.
struct Strip {
  enum class Middle { notched, weak, elastic };
  BoxSetting box;
  BoxBody body;
  Conditions conditions;
  FreeDofs free;
  Assembler assembler;
  Tangent tangent;

  Strip(Middle middle, const std::vector<SupportSpecification>& supports, int threads = 1,
        double triangles = 0.0, const Control& control = {}, bool has_teeth = false)
      : box(setting(triangles, has_teeth)),
        body(points_with_ends(box), box),
        conditions((change(middle), body.points), supports, {}, control.programme, control.terms),
        free(conditions.prescribed(), 2),
        assembler(body.points, body.model, threads),
        tangent(BlockPattern(body.model.bonds()), 2) {}
  Strip(const Strip&) = delete;
  Strip& operator=(const Strip&) = delete;

  LinearOutcome analyze(LinearSolver& solver) const {
    return solver.analyze(tangent.pattern, free);
  }

  static BoxSetting setting(double triangles, bool has_teeth = false) {
    BoxSetting strip = small_box(2);
    strip.triangles = triangles;
    strip.extent = {15, 7, 0};
    strip.potential = has_teeth ? toothed : softening;
    return strip;
  }

 private:
  void change(Middle middle) {
    for (Index i = 0; i < body.points.count(); ++i) {
      const Coordinates at = body.points.position(i);
      if (at[1] > 0.06) continue;
      if (std::abs(at[0] - 0.6) < 0.06) body.points.sets["left_lip"].push_back(i);
      if (std::abs(at[0] - 0.8) < 0.06) body.points.sets["right_lip"].push_back(i);
    }
    const Bonds& bonds = body.model.bonds();
    const auto crosses = [&](Index i, Offset bond) {
      const double a = body.points.position(i)[0] - 0.7,
                   b = body.points.position(bonds.partner(i, bond))[0] - 0.7;
      return a * b < 0.0;
    };
    if (middle == Middle::notched) {
      body.remove_bonds([&](Index i, Offset bond) {
        return crosses(i, bond) && body.points.position(i)[1] < 0.3 &&
               body.points.position(bonds.partner(i, bond))[1] < 0.3;
      });
      return;
    }
    std::vector<char> never_fails(std::size_t(bonds.count()), 1);
    for_each_bond(bonds, [&](Index i, Index, Offset bond) {
      if (middle == Middle::weak && crosses(i, bond)) never_fails[std::size_t(bond)] = 0;
    });
    body.replace_bonds(bonds, std::move(never_fails));
  }
};

/// Controls the opening of the notch's mouth, which goes to `value` [m].
[[nodiscard]] inline Control mouth_opening(double value) {
  return {{{"right_lip", {1.0, 0.0, 0.0}}, {"left_lip", {-1.0, 0.0, 0.0}}},
          LoadingProgramme({{0.0, value}})};
}

/// Supports: fixed on the left, displaced along x on the right.
[[nodiscard]] inline std::vector<SupportSpecification> drawn(const std::string& displacement) {
  return {support("left", "0", "0"), support("right", displacement, "0")};
}

}  // namespace peristat::tests
