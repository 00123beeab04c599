#include "solvers/fragment_pins.hpp"

#include "assembly/terms/damage.hpp"
#include "solvers/vector_verbs.hpp"

namespace peristat {

FragmentPins::FragmentPins(const std::vector<char>& prescribed, const FreeDofs& free,
                           FragmentRemedy remedy)
    : prescribed_(prescribed), free_(free), remedy_(remedy), pinned_(prescribed.size(), 0) {}

void FragmentPins::find(const Assembler& assembler, const State& state) {
  found_ = find_fragments(assembler.points(), assembler.model().bonds(),
                          broken_bonds(assembler.model(), state.history), prescribed_,
                          state.displacement);
  if (removes_pieces()) remove_pieces();
}

/// Takes floating pieces out of the equations. One that a support still moves goes with it: only
/// what is missing is pinned there.
void FragmentPins::remove_pieces() {
  const auto d = std::size_t(free_.dimension);
  std::vector<char> removed(std::size_t(found_.count) + 1, 1);
  removed[0] = 0;  // the pieces that are held
  for (std::size_t dof = 0; dof < prescribed_.size(); ++dof) {
    if (prescribed_[dof]) removed[std::size_t(found_.piece[dof / d])] = 0;
  }
  for (std::size_t dof = 0; dof < prescribed_.size(); ++dof) {
    found_.pinned[dof] |= removed[std::size_t(found_.piece[dof / d])];
  }
}

void FragmentPins::pin() {
  pinned_ = found_.pinned;
  std::vector<char> without_equation = prescribed_;
  for (std::size_t dof = 0; dof < pinned_.size(); ++dof) without_equation[dof] |= pinned_[dof];
  own_free_ = std::make_unique<FreeDofs>(without_equation, free_.dimension);
}

double FragmentPins::force(const Trial& state, std::span<const double> external_force) const {
  return norm_of(pinned_.size(), [&](std::size_t dof) {
    return pinned_[dof] ? state.gradient[dof] - external_force[dof] : 0.0;
  });
}

std::string FragmentPins::described() const {
  return std::to_string(found_.count) + " floating pieces, " + std::to_string(found_.loose.size()) +
         " loose points";
}

}  // namespace peristat
