#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "cases/runner/input/case_location.hpp"
#include "cases/runner/input/givens.hpp"
#include "cases/runner/input/settings.hpp"
#include "solvers/drivers/load_stepping.hpp"
#include "solvers/formulations/specification/body_specification.hpp"
#include "solvers/fracture/crack_tip.hpp"
#include "solvers/linear/make_linear_solver.hpp"
#include "solvers/observe/probe_specification.hpp"
#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/lattice.hpp"
#include "src/geometry/mesh_points.hpp"
#include "src/geometry/point_set.hpp"

namespace peristat {

/// Table [units]: units of the plain numbers and expressions of a case file. Empty: the unit
/// follows from the others, see unit_system.
struct UnitNames {
  std::string length{}, time{}, force{}, stress{}, energy{}, mass{};
};

/// Horizon of points from a file: one length for all, or a multiple of each point's size.
struct PointHorizon {
  double length = 0.0;  ///< [m]
  double ratio = 0.0;   ///< horizon / size; 0: the length
};

/// Points that come from a file, or are given by a program, instead of a lattice (table [points]).
struct PointSource {
  /// Absolute; in the case file relative to the case file's folder. Empty: the points are given.
  std::filesystem::path file;
  std::filesystem::path neighbours{};  ///< absolute; empty: the points within the horizon
  double cross_section = 1.0;          ///< 1D: area [m2]; 2D: thickness [m]
  PointHorizon horizon{};
  /// Unit of the coordinates in the file, whose cube is the unit of its volumes [m].
  double length_unit = 1.0;
  PointsAt at = PointsAt::elements;  ///< of a mesh
  bool cut_bonds = true;             ///< of a mesh: bonds must not leave it

  /// True if the file is a mesh, by the end of its name: .msh, .inp, .vtu, .vtk, .exo, .e, .ex2,
  /// .med.
  [[nodiscard]] bool is_mesh() const;
};

/// Values of a load parameter: given one by one, as an expression of the step, or over time.
struct LoadTable {
  std::vector<double> entries;
  std::string expression;
  TimeTable over_time;  ///< of a motion
};

struct LoadingSpecification {
  std::vector<LoadTable> tables;  ///< of load, load2, …; none: load from 0 to 1
  int steps = 1;                  ///< from one entry to the next, or of the expressions
  bool adaptive = true;           ///< cut and grow; otherwise a failed step ends the run
  double smallest_step = 1e-6;    ///< of the stage
  double largest_step = 0.0;      ///< of the stage; 0: the first step (the reader writes it out)
  int max_broken_bonds = 0;       ///< in one implicit step; 0: no limit
  double stop_below = 0.0;  ///< fraction of the largest reaction to end at; 0: load's end only
  EventOptions events{};    ///< of mode path
  int teeth = 10;           ///< of mode path, see BodySpecification

  /// Number of equal steps from one entry to the next; 1 for an expression, which has an entry for
  /// each step.
  [[nodiscard]] int steps_to_entry() const;
  /// Load parameters that expressions may use in a quasi-static mode.
  [[nodiscard]] std::vector<std::string> parameters() const;
};

struct SolverSpecification {
  Mode mode = Mode::newton;
  LinearMethod linear = LinearMethod::automatic;
  PreconditionerKind preconditioner = PreconditionerKind::automatic;
  TangentStorage tangent = TangentStorage::automatic;
  Precision precision = Precision::single;              ///< see StudyOptions
  ForceOperator force_operator = ForceOperator::bonds;  ///< see BodySpecification
  Projection projection = Projection::automatic;
  Predictor predictor = Predictor::consistent;
  double relative_tolerance = 1e-10;
  int max_iterations = 25;         ///< of Newton's method in a step
  double linear_tolerance = 1e-3;  ///< largest relative residual of its linear systems
  ArcLengthOptions arc_length{};   ///< table [arc_length]
  FragmentRemedy fragments = FragmentRemedy::hold;
  /// Horizon / spacing of the elastic stand-in that the adaptive mode uses until damage begins; 0:
  /// none.
  double elastic_horizon_ratio = 0.0;
};

/// Table [dynamics]: the motion in time.
struct DynamicsSpecification {
  bool is_asked_for = false;  ///< set by solver.mode
  double end_time = 0.0;      ///< [s]
  double time_step = 0.0;     ///< [s]; 0: step_share of the stable step
  double step_share = 0.9;
  int history_every = 0;  ///< time steps from one row of the history to the next; 0: output.every
  MotionScheme scheme = MotionScheme::verlet;
  double spectral_radius = 1.0;  ///< of implicit steps at the highest frequencies
  MotionStart start = MotionStart::rest;

  /// True if each step solves for equilibrium, with the settings of the solver.
  [[nodiscard]] bool is_implicit() const { return is_asked_for && scheme == MotionScheme::newmark; }
  /// True if the start or each step is an equilibrium that is solved for.
  [[nodiscard]] bool searches() const {
    return is_implicit() || (is_asked_for && start == MotionStart::equilibrium);
  }
};

/// Table [relaxation]: steps of the load factor, and how each is relaxed.
struct RelaxationSpecification {
  int steps = 1;
  bool moving = false;  ///< the load changes in every iteration, as in [ADAPT], and is never held
  int iterations = 10'000;      ///< for the whole load, if it moves
  double peak_tolerance = 0.0;  ///< of the stage; 0: the peak is not searched
  RelaxationOptions options;
};

struct OutputSpecification {
  std::filesystem::path directory;  ///< default results/FOLDER_STEM of the case file
  int every = 1;              ///< fields of every n-th accepted step, or time step; the last always
  bool count_cracks = false;  ///< bonds that a pre-crack has cut count as damage
  bool stress = false;        ///< strain and stress are among the fields
};

/// Table [sensitivity]: derivatives of the history.
struct SensitivitySpecification {
  std::vector<std::string> over{};  ///< keys of numbers of the case file; empty: none
};

/// A case, read and checked once and constant from then on: the specification of the body, which
/// knows no file, and all the rest.
struct Case : BodySpecification {
  UnitNames units;  ///< of the file; all members here are in SI units
  std::string title;
  int dimension = 2;
  std::variant<Lattice, PointSource> body;
  double horizon_ratio = 3.015;  ///< horizon / spacing, for a lattice
  /// Names of further data of points from a file, which expressions may use; without values.
  Columns columns;
  std::vector<SetRule> sets;
  LoadingSpecification loading;
  SolverSpecification solver;
  RelaxationSpecification relaxation;
  DynamicsSpecification dynamics;
  FatigueOptions fatigue;  ///< table [fatigue], of mode fatigue
  OutputSpecification output;
  std::vector<ProbeSpecification> probes;
  std::vector<CrackTipSpecification> crack_tips;
  SensitivitySpecification sensitivity;

  /// What a program gives beside the text; never null.
  std::shared_ptr<const Givens> givens = std::make_shared<const Givens>();

  /// Parameters that expressions of supports and loads may use: those of the loading, and the time
  /// of a motion.
  [[nodiscard]] std::vector<std::string> parameters() const;

  /// Files of the tables in expressions, absolute; grows while the keys are read.
  std::shared_ptr<std::set<std::filesystem::path>> tables =
      std::make_shared<std::set<std::filesystem::path>>();

  std::string file;         ///< as given by the person
  std::string as_read;      ///< text of the file
  std::string as_resolved;  ///< TOML with overrides and defaults in place
  Settings settings;        ///< the overrides
  /// Places of every key, table and array element by dotted key, e.g. "support[1].displacement[0]".
  std::map<std::string, CaseLocation> locations;
  /// Values that were converted to SI units, as they are typed, likewise.
  std::map<std::string, std::string> typed;
};

/// True if the results or a probe of the case contain strain or stress.
[[nodiscard]] bool tells_stress(const Case& from);

/// The key that gives every point a horizon of its own; empty: there is one horizon.
[[nodiscard]] std::string key_of_own_horizons(const Case& from);

/// Reads and checks a case file.
/// @param overrides a value that is no TOML is taken as a string
/// @throws InputError whose place is "FILE:LINE:COLUMN", "--set KEY=VALUE" or, if the file can't be
///         read at all, empty
[[nodiscard]] Case read_case(const std::filesystem::path& file, const Settings& overrides = {});

/// Reads and checks a case from the text that its file has, or had.
/// @param givens what a program gives beside it
[[nodiscard]] Case read_case(
    const std::filesystem::path& file, const std::string& text, const Settings& overrides,
    std::shared_ptr<const Givens> givens = std::make_shared<const Givens>());

/// Functions that expressions of the case may call; lives as long as they do.
[[nodiscard]] std::shared_ptr<const GivenFunctions> given_functions(const Case& from);

/// Puts file, line and column of a key in front of a message: those of the longest part of the key
/// that the case file has, or the file alone.
[[nodiscard]] std::string located(const Case& from, const std::string& key,
                                  const std::string& message);

/// Returns the error with the case file's key, if a lower layer has used a name of its own, and
/// with the key's place. An error that has a place already is returned as it is.
[[nodiscard]] InputError located(const Case& from, const InputError& error);

/// Runs `make`; adds the place of the key in the case file to input errors.
template <class Make>
auto located_errors(const Case& from, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw located(from, error);
  }
}

}  // namespace peristat
