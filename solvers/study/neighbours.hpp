#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "solvers/body/body.hpp"
#include "solvers/drivers/path.hpp"

namespace peristat {

/// What a load that is found does to a state: the rate of displacements with it, by the tangent.
struct LoadAnswer {
  std::vector<double> rate;  ///< per degree of freedom [m]
  double control = 0.0;      ///< rate of the controlled displacement [m]
};

/// @throws InputError if loads have no rate there
/// @return nothing if the linear solver fails
[[nodiscard]] std::optional<LoadAnswer> load_answer(const SolvedBody& solved,
                                                    const Conditions& conditions,
                                                    const UncommittedState& at);

/// Equilibria of two bodies that differ from one that is solved by a little less and a little more
/// of a parameter. Half the difference of anything in them, over the change of the parameter, is
/// its derivative.
///
/// Both follow the equilibria of the solved body, those between the commits of a step too. From one
/// to the next the change w of the displacement, with the bodies at u - w and u + w, is found by
///
///   K dw = (R+ - R-) / 2,   R = f_ext - dE/dx after each body's own history,
///
/// with the factor K that the search for u has left: its error slows the iterations, but not the
/// result. Each body then commits its own damage, so that the derivatives of histories take part.
/// Under a control the change of the load is an unknown, too.
class Neighbours {
 public:
  struct Neighbour {
    Neighbour(const Body& of, int threads);

    const Body& body;
    Assembler assembler;
    LoadPoint at = 0.0;
    Trial state;
    std::vector<double> external_force;
    double external_work = 0.0;  ///< up to the accepted state, by the trapezoidal rule [J]
  };

  /// The bodies must outlive it.
  /// @param relative_change of the parameter from the solved body to each of them
  /// @throws InputError without a key if their points, bonds or supports differ from those of the
  ///         solved body
  Neighbours(const Body& less, const Body& more, const Assembler& solved,
             const Conditions& conditions, double relative_change, int threads);

  /// Returns to the last accepted state, for a step or another attempt of it.
  void begin();
  /// Follows the solved body to an equilibrium.
  /// @param answer null: the load is given
  /// @return why that fails; empty if it does not
  [[nodiscard]] std::string follow(const SolvedBody& solved, const UncommittedState& to,
                                   const LoadAnswer* answer);
  /// Commits the damage of the equilibrium.
  void commit();
  /// Accepts the present state.
  /// @param history of the solved body after its commits
  /// @return why derivatives do not exist there; empty if they do
  [[nodiscard]] std::string accept(const History& history, bool is_preload);

  [[nodiscard]] Neighbour& less() { return of_[0]; }
  [[nodiscard]] Neighbour& more() { return of_[1]; }

 private:
  /// A state that work is done from or to.
  struct Worked {
    Trial state;
    std::vector<double> force;
  };

  /// Moves both to u -+ w, and evaluates them there.
  void place(const FreeDofs& free, const UncommittedState& to);
  /// Finds the change of the displacement, and of a load that is found; false if there is none.
  [[nodiscard]] bool equilibrate(const SolvedBody& solved, const UncommittedState& to,
                                 const LoadAnswer* answer);
  /// Half the difference of their residuals [N].
  void find_half_residual(std::span<double> force);
  /// Half the difference of the controlled displacements that they have and that they should have.
  [[nodiscard]] double control_gap(double stage) const;
  [[nodiscard]] Worked worked(const Neighbour& of) const;
  [[nodiscard]] double work_between(Neighbour& of, const Worked& from, const Worked& to) const;

  double relative_change_;
  std::array<Neighbour, 2> of_;
  std::array<Worked, 2> accepted_;
  std::array<std::optional<Worked>, 2> intact_;  // before the first commit of a step
  struct Change {
    std::vector<double> displacement;
    double load = 0.0;  // of a load that is found
  } change_, accepted_change_;
  double held_ = 0.0;  // change of the controlled displacement at load 0
};

}  // namespace peristat
