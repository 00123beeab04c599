#include "cases/runner/case_keys.hpp"

namespace peristat {

const std::map<std::string, std::vector<std::string>>& shape_keys() {
  static const std::map<std::string, std::vector<std::string>> keys{
      {"box", {"min", "max"}},
      {"disk", {"centre", "radius"}},
      {"cylinder", {"centre", "radius", "axis", "length"}},
      {"sphere", {"centre", "radius"}},
      {"polygon", {"vertices"}}};
  return keys;
}

const std::map<std::string, std::vector<std::string>>& case_keys() {
  static const auto keys = [] {
    std::map<std::string, std::vector<std::string>> tables{
        {"",
         {"title", "dimension", "lattice", "points", "set", "crack", "quadrature", "material",
          "support", "load", "loading", "solver", "relaxation", "output", "probe"}},
        {"lattice",
         {"spacing", "horizon_ratio", "thickness", "area", "origin", "perturbation", "seed",
          "shape", "layer"}},
        {"lattice.shape",
         {"add", "subtract", "min", "max", "centre", "radius", "axis", "length", "vertices"}},
        {"lattice.layer", {"name", "side", "thickness", "where"}},
        {"points", {"file", "horizon", "thickness", "area"}},
        {"set", {"name", "where", "shape"}},
        {"set.shape", {"box", "disk", "cylinder", "sphere", "polygon"}},
        {"crack", {"from", "to", "vertices"}},
        {"quadrature", {"volume_correction", "surface_correction", "weights"}},
        {"material",
         {"model", "plane", "youngs_modulus", "micromodulus", "poisson_ratio", "c1", "c2", "c3",
          "calibration", "density", "damage"}},
        {"material.damage", {"law", "onset", "critical", "rate", "no_fail"}},
        {"support", {"set", "displacement"}},
        {"load", {"set", "body_force", "total_force"}},
        {"loading", {"steps", "adaptive", "smallest_step", "largest_step", "max_broken_bonds"}},
        {"solver",
         {"mode", "linear", "preconditioner", "tangent", "relative_tolerance", "linear_tolerance",
          "max_iterations", "projection", "predictor", "fragments", "elastic_horizon_ratio"}},
        {"relaxation",
         {"steps", "load", "iterations", "ramp", "breaking", "damping", "mass_factor",
          "max_iterations", "quiet_iterations", "displacement_tolerance"}},
        {"output", {"directory", "every", "count_cracks"}},
        {"probe", {"name", "set", "other", "field", "axis"}}};
    for (const auto& [kind, own] : shape_keys()) tables["set.shape." + kind] = own;
    return tables;
  }();
  return keys;
}

}  // namespace peristat
