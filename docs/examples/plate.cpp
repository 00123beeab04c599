#include <cstdio>

#include <peristat/peristat.hpp>

using namespace peristat;

int main() try {
  // 0.15 m x 0.05 m with a hole, and three rows of points at either end that are held and pulled.
  Lattice lattice{.dimension = 2, .spacing = 1e-3, .cross_section = 1e-3};
  lattice.shapes = {{ShapeStep::Action::add, Box{{-0.075, -0.025}, {0.075, 0.025}}},
                    {ShapeStep::Action::subtract, Disk{{0.0, 0.0}, 5e-3}}};
  lattice.layers = {{.name = "left", .side = {0, -1}}, {.name = "right", .side = {0, +1}}};

  BodySpecification plate{.horizon = 3.015e-3};
  plate.material.youngs_modulus = 192e9;
  plate.supports = {{"left", {"0", "0"}}};
  plate.loads = {{LoadSpecification::Kind::total_force, "right", {"12.8e3*load", "0"}}};

  const auto body = make_body(make_points(lattice), plate);
  const StudyResult result = solve(*body, {.loading = {.steps = 2}});
  if (result.outcome != Outcome::converged) return 3;
  std::printf("end displacement %.17g m\n",
              mean_displacement(body->points, result.state, "right")[0]);
  std::printf("reaction %.17g N\n", result.steps.back().reactions.at("left")[0]);

  Observation observed(*body, result.state);
  const ProbeSpecification above_hole{
      .at = Coordinates{0.0, 5.5e-3}, .field = "stress", .component = "xx"};
  std::printf("stress above the hole %.17g Pa\n", probe_values(above_hole, observed)[0]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
