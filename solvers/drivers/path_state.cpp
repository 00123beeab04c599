#include "solvers/drivers/path_state.hpp"

#include <algorithm>
#include <cstddef>

#include "assembly/terms/damage.hpp"

namespace peristat {
namespace {

template <class Array>
bool is_empty_or(const Array& array, std::size_t size) {
  return array.empty() || array.size() == size;
}

bool are_sizes_of(const History& history, const Assembler& body) {
  const History at_rest = body.initial_history();
  const std::size_t terms = body.model().terms().size();
  const auto is_as_long = [&](const History& other, std::size_t term) {
    return history.of(term).size() == other.of(term).size();
  };
  for (std::size_t term = 0; term < terms; ++term) {
    if (!at_rest.of(term).empty() && !is_as_long(at_rest, term)) return false;
  }
  // Terms that follow others have no history before the others have changed.
  const History followed = body.history_of(bond_stretches(body.model(), history), history);
  for (std::size_t term = 0; term < terms; ++term) {
    const bool is_told = !history.of(term).empty();
    if (at_rest.of(term).empty() && is_told && !is_as_long(followed, term)) return false;
  }
  return history.terms() <= terms;
}

}  // namespace

History own_history(const History& history, const Assembler& body) {
  if (history.terms() < 2) return history;
  const History at_rest = body.initial_history();
  const auto follows = [&](std::size_t term) {
    return at_rest.of(term).empty() && !history.of(term).empty();
  };
  bool any_follows = false;
  for (std::size_t term = 0; term < history.terms(); ++term) any_follows |= follows(term);
  if (!any_follows) return history;
  History own;
  for (std::size_t term = 0; term < history.terms(); ++term) {
    if (at_rest.of(term).empty()) continue;
    own.replace(term, {history.of(term).begin(), history.of(term).end()});
  }
  return own;
}

History with_followers(History history, const Assembler& body) {
  for (const auto& term : body.model().terms()) term->follow(body.model(), history);
  return history;
}

bool is_of_body(const PathState& state, const Assembler& body,
                const std::vector<char>& prescribed) {
  const std::size_t points = body.points().volume.size(), dofs = prescribed.size();
  const Fragments& found = state.pins.found;
  if (!is_empty_or(found.piece, points) || !is_empty_or(found.pinned, dofs) ||
      !is_empty_or(state.pins.pinned, dofs)) {
    return false;
  }
  const bool are_points = std::all_of(found.loose.begin(), found.loose.end(), [&](Index point) {
    return point >= 0 && std::size_t(point) < points;
  });
  const FreeDofs free = state.pins.free_dofs(prescribed, body.points().dimension);
  const auto bonds = std::size_t(body.model().bonds().count());
  const RemainingLives& lives = state.fatigue.lives;
  return are_points && is_empty_or(lives.life, bonds) &&
         lives.near_crack.size() == lives.life.size() &&
         state.accepted.displacement.size() == dofs && state.ledger.force.size() == dofs &&
         are_sizes_of(state.accepted.history, body) && is_empty_or(state.arc.direction, dofs) &&
         is_empty_or(state.dynamics.velocity, dofs) &&
         is_empty_or(state.dynamics.acceleration, dofs) &&
         is_empty_or(state.relaxed.motion.velocity, std::size_t(free.count()));
}

}  // namespace peristat
