#include "solvers/search/foreseen_contacts.hpp"

#include <utility>

namespace peristat {

LinearOutcome predict_with_contacts(
    const EquilibriumProblem& problem, std::vector<double>& foreseen,
    const std::function<StateView()>& start,
    const std::function<LinearOutcome(std::vector<double>& next)>& solve) {
  constexpr int most_rounds = 6;
  Assembler& assembler = problem.assembler;
  if (!assembler.has_contacts()) {
    std::vector<double> next;
    return solve(next);
  }
  std::vector<Index> closed = assembler.closed_contacts(start());
  for (int round = 1;; ++round) {
    std::vector<double> next;
    const LinearOutcome linear = solve(next);
    if (linear != LinearOutcome::solved || round == most_rounds) return linear;
    foreseen.swap(next);
    move_followers(problem, foreseen);
    std::vector<Index> now = assembler.closed_contacts(start());
    const bool stays = problem.sums().largest_of_all(now == closed ? 0.0 : 1.0) == 0.0;
    if (stays) {
      foreseen.swap(next);  // the one of the tangent
      return linear;
    }
    closed = std::move(now);
  }
}

}  // namespace peristat
