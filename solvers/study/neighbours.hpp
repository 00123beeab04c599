#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "solvers/body/body.hpp"
#include "solvers/drivers/observer.hpp"
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
                                                    const StepRecord& record,
                                                    const AcceptedState& accepted);

/// Equilibria of two bodies that differ from one that is solved by a little less and a little more
/// of a parameter. Half the difference of anything in them, over the change of the parameter, is
/// its derivative.
///
/// Both follow the accepted states of the solved body. From one state to the next the change w of
/// the displacement, with the bodies at u - w and u + w, is found by
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
    Trial state;  ///< with its damage committed
    std::vector<double> external_force, working_force;
    double external_work = 0.0;  ///< since the start, by the trapezoidal rule [J]
  };

  /// The bodies must outlive it.
  /// @param relative_change of the parameter from the solved body to each of them
  /// @throws InputError without a key if their points, bonds or supports differ from those of the
  ///         solved body
  Neighbours(const Body& less, const Body& more, const Assembler& solved,
             const Conditions& conditions, double relative_change, int threads);

  /// Follows the solved body to an accepted state.
  /// @param answer null: the load is given
  /// @return why that fails; empty if it does not
  [[nodiscard]] std::string follow(const SolvedBody& solved, const StepRecord& record,
                                   const AcceptedState& accepted, const LoadAnswer* answer);

  [[nodiscard]] Neighbour& less() { return of_[0]; }
  [[nodiscard]] Neighbour& more() { return of_[1]; }
  [[nodiscard]] int corrections() const { return corrections_; }  ///< so far

 private:
  /// Moves both to u -+ w, and evaluates them there.
  void place(const FreeDofs& free, const StepRecord& record, std::span<const double> displacement);
  /// Finds the change of the displacement, and of a load that is found; false if there is none.
  [[nodiscard]] bool equilibrate(const SolvedBody& solved, const StepRecord& record,
                                 const AcceptedState& accepted, const LoadAnswer* answer);
  /// Half the difference of their residuals [N].
  void find_half_residual(std::span<double> force);
  void add_work(Neighbour& of, const StepRecord& record, const Trial& before) const;
  /// Half the difference of the controlled displacements that they have and that they should have.
  [[nodiscard]] double control_gap(const StepRecord& record) const;

  double relative_change_;
  std::array<Neighbour, 2> of_;
  std::vector<double> change_;  // of the displacement
  double load_change_ = 0.0;    // of a load that is found
  double held_ = 0.0;           // change of the controlled displacement at load 0
  int corrections_ = 0;
};

}  // namespace peristat
