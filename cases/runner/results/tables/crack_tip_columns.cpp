#include "cases/runner/results/tables/crack_tip_columns.hpp"

#include <array>

namespace peristat {
namespace {

constexpr std::array<const char*, 3> stress_intensities{"_K1", "_K2", "_K3"};

std::size_t modes(const Case& from) { return from.dimension == 3 ? 3 : 2; }

}  // namespace

std::vector<ProbeColumns> crack_tip_columns(const Case& from) {
  std::vector<ProbeColumns> columns;
  for (const CrackTipSpecification& tip : from.crack_tips) {
    columns.push_back({tip.name + "_J", 1, "J/m2"});
    columns.push_back({tip.name + "_J_spread", 1, "1"});
    for (std::size_t mode = 0; mode < modes(from) && has_isotropic_materials(from); ++mode) {
      columns.push_back({tip.name + stress_intensities[mode], 1, "Pa m^0.5"});
    }
    if (has_isotropic_materials(from)) {
      columns.push_back({tip.name + "_T", 1, "Pa"});
      columns.push_back({tip.name + "_T_star", 1, "1"});
    }
    if (tip.cut == 0.0) continue;
    columns.push_back({tip.name + "_G_displacement", 1, "J/m2"});
    columns.push_back({tip.name + "_G_load", 1, "J/m2"});
  }
  return columns;
}

std::string add_crack_tip_values(const Case& from, const std::vector<CrackTip>& tips,
                                 Assembler& assembler, const Trial& state, double stage,
                                 std::map<std::string, std::vector<double>>& values) {
  std::string without_release;
  for (std::size_t k = 0; k < tips.size(); ++k) {
    const std::string& name = from.crack_tips[k].name;
    const CrackTipValues found = tips[k].integrals.values(assembler, state.at());
    values[name + "_J"] = {found.j};
    values[name + "_J_spread"] = {found.spread};
    for (std::size_t mode = 0; mode < modes(from) && has_isotropic_materials(from); ++mode) {
      values[name + stress_intensities[mode]] = {found.k[mode]};
    }
    if (has_isotropic_materials(from)) {
      values[name + "_T"] = {found.t_stress};
      values[name + "_T_star"] = {found.t_star};
    }
    if (!tips[k].release) continue;
    const std::optional<ReleaseRates> rates = tips[k].release->rates(state, stage);
    if (!rates) {
      without_release += (without_release.empty() ? "" : ", ") + name;
    }
    values[name + "_G_displacement"] = {rates.value_or(ReleaseRates{}).at_displacement};
    values[name + "_G_load"] = {rates.value_or(ReleaseRates{}).at_load};
  }
  return without_release;
}

}  // namespace peristat
