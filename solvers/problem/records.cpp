#include "solvers/problem/records.hpp"

#include <map>
#include <stdexcept>

namespace peristat {
namespace {

const std::map<Decision, std::string>& decision_names() {
  static const std::map<Decision, std::string> names{
      {Decision::accept, "accept"},
      {Decision::accept_and_grow, "accept and grow"},
      {Decision::accept_at_round_off, "accept at round-off"},
      {Decision::cut, "cut"},
      {Decision::stop, "stop"},
      {Decision::hand_over, "hand over to relaxation"},
      {Decision::hand_back, "hand back to newton"},
      {Decision::hold_fragments, "hold fragments"},
      {Decision::remove_fragments, "remove fragments"},
      {Decision::change_linear_solver, "change linear solver"},
      {Decision::locate, "locate critical point"},
      {Decision::change_time_step, "change time step"},
      {Decision::preload, "preload"},
      {Decision::branch_off, "branch off"}};
  return names;
}

}  // namespace

std::string name(Decision decision) { return decision_names().at(decision); }

Decision decision_named(const std::string& name) {
  for (const auto& [decision, spelt] : decision_names()) {
    if (spelt == name) return decision;
  }
  throw std::out_of_range("no decision is named \"" + name + "\"");
}

}  // namespace peristat
