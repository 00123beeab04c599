#include "solvers/drivers/fragment_pins.hpp"

#include <algorithm>
#include <cstdint>

#include "assembly/terms/damage.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Takes floating pieces out of the equations. A piece that a support still moves is kept: only its
/// free motions are pinned.
void remove_pieces(Fragments& found, const std::vector<char>& prescribed, int dimension,
                   const IndexMap& index_map) {
  const auto d = std::size_t(dimension);
  std::vector<double> removed(std::size_t(found.count) + 1, 1.0);
  removed[0] = 0.0;  // pieces that are held
  const std::size_t dofs = found.piece.size() * d;
  for (std::size_t dof = 0; dof < dofs; ++dof) {
    if (prescribed[dof]) removed[std::size_t(found.piece[dof / d])] = 0.0;
  }
  removed = index_map.ranks().min(removed);
  for (std::size_t dof = 0; dof < dofs; ++dof) {
    if (removed[std::size_t(found.piece[dof / d])] != 0.0) found.pinned[dof] = 1;
  }
}

}  // namespace

void FragmentPins::find(const Assembler& assembler, const State& state,
                        const Conditions& conditions, FragmentRemedy remedy) {
  const std::vector<char>& prescribed = conditions.prescribed();
  const DamagedNetwork network = damaged_network(assembler.model(), state.history);
  // Linear forces use the directions of the reference configuration.
  const bool is_linear = assembler.model().balances().linear;
  const std::vector<double> rest(is_linear ? state.displacement.size() : 0, 0.0);
  const std::vector<double>& moved = is_linear ? rest : state.displacement;
  found = find_fragments(assembler.points(), *network.bonds, network.broken, prescribed, moved,
                         conditions.holding(moved), assembler.index_map());
  if (remedy == FragmentRemedy::remove) {
    remove_pieces(found, prescribed, assembler.points().dimension, assembler.index_map());
  }
}

bool FragmentPins::are_outdated(const Sums& sums) const {
  const bool mine = pinned.empty() ? std::any_of(found.pinned.begin(), found.pinned.end(),
                                                 [](char pin) { return pin != 0; })
                                   : !found.pinned.empty() && found.pinned != pinned;
  return sums.largest_of_all(double(mine)) > 0.0;
}

FreeDofs FragmentPins::free_dofs(const std::vector<char>& prescribed, int dimension) const {
  std::vector<char> without_equation = prescribed;
  for (std::size_t dof = 0; dof < pinned.size(); ++dof) without_equation[dof] |= pinned[dof];
  return {without_equation, dimension};
}

double FragmentPins::force(const Sums& sums, const Trial& state,
                           std::span<const double> external_force) const {
  return sums.norm_of_entries(pinned.size(), [&](std::size_t dof) {
    return pinned[dof] ? state.gradient[dof] - external_force[dof] : 0.0;
  });
}

std::string FragmentPins::described(const Sums& sums) const {
  const double loose = sums.of_all(double(found.loose.size()));
  return std::to_string(found.count) + " floating pieces, " + std::to_string(std::int64_t(loose)) +
         " loose points";
}

}  // namespace peristat
