#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cases/runner/commands/calibrate.hpp"
#include "cases/runner/commands/case_schema.hpp"
#include "cases/runner/commands/check.hpp"
#include "cases/runner/commands/check_tangent.hpp"
#include "cases/runner/commands/key_reference.hpp"
#include "cases/runner/commands/points.hpp"
#include "cases/runner/commands/resume.hpp"
#include "cases/runner/commands/run.hpp"
#include "cases/runner/commands/unknown_option.hpp"
#include "cases/runner/input/case.hpp"
#include "cases/runner/input/toml_text.hpp"
#include "cases/runner/process/blas_memory.hpp"
#include "cases/runner/process/failure.hpp"
#include "cases/runner/process/ranks_environment.hpp"
#include "cases/runner/process/runtime_environment.hpp"
#include "cases/runner/setup/part_body.hpp"
#include "solvers/formulations/formulations.hpp"
#include "solvers/ranks/ranks.hpp"
#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"
#include "src/core/threads.hpp"
#include "src/parallel/communicator.hpp"

namespace {

using namespace peristat;

struct CommandLine {
  std::string case_file, results, output, log_file, deformation, table;
  bool lists_keys_on_ranks = false;
  std::vector<std::string> settings;
  int threads = 0, steps = 0, ranks = 0;
  bool quiet = false, overwrite = false;
  bool no_plots = false;  // accepted here, used by the launcher, which draws
  CalibrationQuestion calibration;
  MaterialModel calibrated_model = MaterialModel::cpd;
  std::optional<std::string> influence;  // default: the model's
  BondCalibrationQuestion bond_calibration;
  PointsQuestion points;
  std::vector<const CLI::Option*> of_bonds;  // options of calibrate that cpd does not take
};

/// Splits each "key=value" of --set, and adds --output.
Settings overrides(const CommandLine& line) {
  Settings result;
  for (const std::string& setting : line.settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("--set", setting, "needs the form key=value, e.g. loading.steps=50");
    }
    result.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }
  if (!line.output.empty()) result.emplace_back("output.directory", toml_string(line.output));
  return result;
}

void add_settings(CLI::App& command, CommandLine& line) {
  command
      .add_option(
          "--set", line.settings,
          "override a key of the case file, such as --set loading.steps=50; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
}

/// Range of positive whole numbers. CLI11's own PositiveNumber prints the largest double as the
/// limit.
CLI::Range at_least_one() { return {1, std::numeric_limits<int>::max()}; }

void add_threads(CLI::App& command, CommandLine& line) {
  command.add_option("--threads", line.threads, "number of threads (default: all processors)")
      ->check(at_least_one());
}

void add_case_options(CLI::App& command, CommandLine& line) {
  command.add_option("case", line.case_file, "case file (docs/case-file.md)")->required();
  add_settings(command, line);
  add_threads(command, line);
}

/// Adds the options of run and resume.
void add_run_options(CLI::App& command, CommandLine& line) {
  command
      .add_option("--stop-after", line.steps,
                  "stop after this number of accepted steps (in mode dynamics: rows of the "
                  "history), as if interrupted; `peristat resume` continues")
      ->type_name("STEPS")
      ->check(at_least_one());
  command
      .add_option("--ranks", line.ranks,
                  "run on this many ranks, which mpirun starts (docs/cluster.md)")
      ->check(at_least_one());
  command.add_flag("--no-plots", line.no_plots,
                   "draw no pictures at the end (./peristat draws them)");
  command.add_flag("--quiet", line.quiet, "print only problems");
  command.add_option("--log", line.log_file,
                     "write everything that is printed, and every iteration, to this file");
}

void add_calibration(CLI::App& command, CommandLine& line) {
  CLI::Option* file =
      command.add_option("case", line.case_file, "case file; its lattice and material are used");
  add_settings(command, line);
  CalibrationQuestion& asked = line.calibration;
  command.add_flag("--strengths", asked.with_strengths,
                   "also print the strengths under tension, biaxial tension, shear and "
                   "compression; needs a law of damage");
  command.add_option("--dimension", asked.dimension, "2 or 3; for bonds also 1")->excludes(file);
  command.add_option("--spacing", asked.spacing, "spacing of the lattice [m]")->excludes(file);
  command.add_option("--horizon-ratio", asked.horizon_ratio, "horizon / spacing")->excludes(file);
  command.add_option("--thickness", asked.thickness, "thickness in 2D [m] (default: 1)")
      ->excludes(file);
  const auto add = [&](const char* name, std::optional<double>& value, const char* text) {
    command.add_option(name, value, text)->excludes(file);
  };
  add("--youngs-modulus", asked.youngs_modulus, "E [Pa], with --poisson-ratio");
  add("--poisson-ratio", asked.poisson_ratio, "nu");
  add("--lambda", asked.lambda, "[Pa], with --mu");
  add("--mu", asked.mu, "[Pa]");
  add("--c1", asked.c1, "[N/m6], one-neighbour constant");
  add("--c2", asked.c2,
      "[N/m10], two-neighbour constant; in 3D it can be given together with moduli");
  add("--c3", asked.c3, "[N/m14], three-neighbour constant, 3D");
}

/// Transformer from the names of an option's values to the values, as numbers.
template <class Value>
CLI::Validator names(const std::vector<std::pair<std::string, Value>>& values) {
  std::string all;
  for (const auto& [name, value] : values) all += (all.empty() ? "" : "|") + name;
  const auto to_number = [values, all](std::string& text) -> std::string {
    for (const auto& [name, value] : values) {
      if (text != name) continue;
      text = std::to_string(static_cast<int>(value));
      return {};
    }
    return "must be " + all + ", not \"" + text + '"';
  };
  return CLI::Validator(to_number, all);
}

void add_bond_calibration(CLI::App& command, CommandLine& line) {
  CLI::Option* file = command.get_option("case");
  BondCalibrationQuestion& asked = line.bond_calibration;
  MaterialSpecification& material = asked.material;
  DamageSpecification& damage = material.damage;
  const auto add = [&](const char* name, auto& value, const char* text) {
    return command.add_option(name, value, text)->excludes(file);
  };
  const auto add_of_bonds = [&](const char* name, auto& value, const char* text) {
    CLI::Option* option = add(name, value, text);
    line.of_bonds.push_back(option);
    return option;
  };
  using Volume = VolumeCorrection;
  using Surface = SurfaceCorrection;
  using Law = DamageLaw;
  add("--model", line.calibrated_model, "cpd (default), bond or state")
      ->transform(names<MaterialModel>({{"cpd", MaterialModel::cpd},
                                        {"bond", MaterialModel::bond},
                                        {"state", MaterialModel::state}}));
  add_of_bonds("--area", asked.area, "bond: area in 1D [m2] (default: 1)");
  add_of_bonds("--angle", asked.angle, "bond: angle of the lattice [degrees]");
  add_of_bonds("--volume-correction", asked.volume_correction,
               "bond: none (default), linear, exact or exact_centroids")
      ->transform(names<Volume>({{"none", Volume::none},
                                 {"linear", Volume::linear},
                                 {"exact", Volume::exact},
                                 {"exact_centroids", Volume::exact_centroids}}));
  using Shape = HorizonShape;
  add_of_bonds("--horizon-shape", asked.horizon_shape, "bond: ball (default), box or diamond")
      ->transform(
          names<Shape>({{"ball", Shape::ball}, {"box", Shape::box}, {"diamond", Shape::diamond}}));
  add_of_bonds("--surface-correction", asked.surface_correction,
               "bond: none (default), volume or energy")
      ->transform(names<Surface>(
          {{"none", Surface::none}, {"volume", Surface::volume}, {"energy", Surface::energy}}));
  add_of_bonds("--plane", material.plane, "bond, 2D: stress (default) or strain")
      ->transform(
          names<PlaneState>({{"stress", PlaneState::stress}, {"strain", PlaneState::strain}}));
  add_of_bonds("--calibration", material.calibration, "bond: continuum (default) or lattice")
      ->transform(names<Calibration>(
          {{"continuum", Calibration::continuum}, {"lattice", Calibration::lattice}}));
  add("--influence", line.influence, "influence function, as in case files");
  add_of_bonds("--micromodulus", material.micromodulus, "bond: c [N/m6]");
  add("--drive", damage.drive, "cpd: release (default with --fracture-energy) or stretch")
      ->transform(names<DamageDrive>(
          {{"release", DamageDrive::release}, {"stretch", DamageDrive::stretch}}));
  add("--law", damage.law, "law of damage, as in case files")
      ->transform(names<Law>({{"critical_stretch", Law::critical_stretch},
                              {"tanh", Law::tanh},
                              {"tanh_continuous", Law::tanh_continuous},
                              {"linear", Law::linear},
                              {"exponential", Law::exponential},
                              {"blended", Law::blended},
                              {"bilinear", Law::bilinear},
                              {"cornelissen", Law::cornelissen}}));
  add("--fracture-energy", damage.fracture_energy, "[J/m2]");
  add("--fracture-toughness", damage.fracture_toughness, "[Pa sqrt(m)]");
  add("--strength", damage.strength, "[Pa]");
  add("--strength-surface", damage.strength_surface,
      "rankine, drucker_prager or mohr_coulomb, through --strength")
      ->transform(names<StrengthCriterion>({{"rankine", StrengthCriterion::rankine},
                                            {"drucker_prager", StrengthCriterion::drucker_prager},
                                            {"mohr_coulomb", StrengthCriterion::mohr_coulomb}}));
  add("--compressive-strength", damage.compressive_strength, "with --strength-surface [Pa]");
  add("--biaxial-strength", damage.biaxial_strength, "with drucker_prager [Pa]");
  add("--critical", damage.critical, "stretch");
  add("--onset", damage.onset, "stretch");
  add("--peak", damage.peak, "blended: stretch");
  add("--hardening", damage.hardening, "blended");
  add("--rate", damage.rate, "tanh laws and exponential");
}

/// Refuses options that the constants of cpd do not depend on: they would seem to have been used.
void refuse_options_of_bonds(const CommandLine& line) {
  for (const CLI::Option* option : line.of_bonds) {
    if (option->count() > 0) throw InputError(option->get_name(), "", "is not for --model cpd");
  }
}

/// Throws if an option is missing that calibrate needs without a case file.
void require_lattice(const CLI::App& command) {
  for (const char* name : {"--dimension", "--spacing", "--horizon-ratio"}) {
    if (command.get_option(name)->count() > 0) continue;
    throw InputError(name, "", "is missing; give this option or a case file");
  }
}

Exit calibrate(const CommandLine& line) {
  BondCalibrationQuestion of_bonds = line.bond_calibration;
  of_bonds.material.model = line.calibrated_model;
  const std::string influence =
      line.influence.value_or(formulation_of(of_bonds.material).default_influence);
  if (line.calibrated_model != MaterialModel::cpd) {
    of_bonds.material.influence = influence;
    return calibrate(line.calibration, std::move(of_bonds));
  }
  refuse_options_of_bonds(line);
  CalibrationQuestion asked = line.calibration;
  asked.influence = influence;
  return calibrate(asked, of_bonds.material.damage);
}

void add_points(CLI::App& command, CommandLine& line) {
  PointsQuestion& asked = line.points;
  command.add_option("mesh", asked.mesh, "mesh: .msh, .inp, .vtu, .vtk, .exo, .e, .ex2 or .med")
      ->required();
  command.add_option("--dimension", asked.dimension, "2 or 3 (default: 3 if the mesh has solids)")
      ->check(CLI::Range(2, 3));
  command.add_option("--length-unit", asked.length_unit,
                     "unit of the coordinates in the file, such as mm (default: m)");
  command.add_option("--thickness", asked.thickness, "thickness in 2D [m] (default: 1)");
  command.add_option("--at", asked.at, "elements (default) or nodes")
      ->transform(names<PointsAt>({{"elements", PointsAt::elements}, {"nodes", PointsAt::nodes}}));
  command.add_option("--output", asked.output, "write the points to this file, for points.file");
}

RunOptions run_options(const CommandLine& line, int threads) {
  return {threads, line.quiet, line.log_file, line.overwrite, line.steps};
}

/// True if the exception being handled was thrown on all ranks. Each rank then ends by itself, and
/// rank 0 prints the reason.
bool& all_have_failed() {
  static bool have_failed = false;
  return have_failed;
}

/// Runs `act`, which needs no communication, and records if it fails on all ranks. Collective.
template <class Act>
auto on_each_rank(const Communicator& ranks, const Act& act) {
  std::exception_ptr failure;
  std::optional<decltype(act())> result;
  try {
    result.emplace(act());
  } catch (...) {
    failure = std::current_exception();
  }
  all_have_failed() = ranks.min(failure ? 1.0 : 0.0) > 0.0;
  if (failure) std::rethrow_exception(failure);
  return *std::move(result);
}

Exit execute(const CLI::App& program, const CommandLine& line, int threads,
             const Communicator& ranks) {
  if (program.got_subcommand("keys")) {
    return line.lists_keys_on_ranks ? print_keys_on_ranks() : print_keys(line.table);
  }
  if (program.got_subcommand("schema")) return print_schema();
  if (program.got_subcommand("resume")) {
    return resume(line.results, overrides(line), run_options(line, threads), ranks);
  }
  if (program.got_subcommand("points")) return print_points(line.points);
  const bool is_calibration = program.got_subcommand("calibrate");
  if (is_calibration && line.case_file.empty()) {
    require_lattice(*program.get_subcommand("calibrate"));
    return calibrate(line);
  }
  const Case from = on_each_rank(ranks, [&] {
    Case read = read_case(line.case_file, overrides(line));
    if (ranks.count() > 1) refuse_keys_without_ranks(read);
    return read;
  });
  if (is_calibration) return calibrate(from, line.calibration.with_strengths);
  if (program.got_subcommand("check")) return check(from, threads);
  if (program.got_subcommand("check-tangent")) {
    return check_tangent(from, line.deformation, threads);
  }
  return run(from, run_options(line, threads), ranks);
}

/// Returns a sentence about unexpected words on the command line.
std::string unexpected_words(const CLI::App& program) {
  for (const CLI::App* command : program.get_subcommands()) {
    std::vector<std::string> options;
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    }
    const bool takes_set = command->get_option_no_throw("--set") != nullptr;
    const std::vector<std::string> words = program.remaining(true);
    return command->get_name() + ": " + describe_unknown(words, options, takes_set);
  }
  return describe_unknown(program.remaining(true), {}, false);
}

/// Throws if standard output can't be written: these commands have no other output.
void require_told() {
  errno = 0;
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return;
  throw MachineError(
      fmt::format("standard output can't be written: {}", std::strerror(errno != 0 ? errno : EIO)));
}

/// Communicator of this run; null unless the process was started as a rank. It outlives all its
/// users.
std::unique_ptr<Communicator>& all_ranks() {
  static std::unique_ptr<Communicator> ranks;
  return ranks;
}

const Communicator& start_ranks_of(const CLI::App& program, int asked_for) {
  if (!is_started_as_rank()) return sole_rank();
  all_ranks() = start_ranks();
  all_have_failed() = true;  // the refusals below occur on all ranks
  if (asked_for > 0 && asked_for != all_ranks()->count()) {
    throw InputError(
        "--ranks", std::to_string(asked_for),
        fmt::format("does not match the number of ranks started, {}", all_ranks()->count()));
  }
  if (all_ranks()->count() == 1) {
    all_have_failed() = false;
    return sole_rank();
  }
  if (!program.got_subcommand("run") && !program.got_subcommand("resume")) {
    throw InputError("", "", "only the commands run and resume are for more than one rank");
  }
  all_have_failed() = false;
  return *all_ranks();
}

/// Returns the arguments without --ranks.
std::vector<std::string> arguments_of_ranks(int count, char** arguments) {
  std::vector<std::string> kept;
  for (int k = 1; k < count; ++k) {
    const std::string argument = arguments[k];
    if (argument == "--ranks") {
      ++k;
    } else if (argument.rfind("--ranks=", 0) != 0) {
      kept.push_back(argument);
    }
  }
  return kept;
}

/// Aborts all ranks, since others may be waiting for this one.
int end_all_ranks(const Failure& failure) {
  give_way_to_first(*all_ranks());
  say_last_words(fmt::format("peristat: {}\n", failure.message));
  all_ranks()->abort(static_cast<int>(failure.code));
  return static_cast<int>(failure.code);
}

/// Prints the exception being handled, and returns the exit code.
int report_failure() {
  const Failure failure = current_failure();
  if (all_ranks() && all_ranks()->count() > 1) {
    if (!all_have_failed()) return end_all_ranks(failure);
    // Before MPI ends: mpirun kills the other ranks when the first returns this exit code.
    if (all_ranks()->rank() == 0) say_last_words(fmt::format("peristat: {}\n", failure.message));
    all_ranks().reset();
    return static_cast<int>(failure.code);
  }
  std::fflush(stdout);
  std::fputs(fmt::format("peristat: {}\n", failure.message).c_str(), stderr);
  return static_cast<int>(failure.code);
}

}  // namespace

int main(int count, char** arguments) try {
  open_standard_streams();
  CLI::App program("Implicit quasi-static peridynamics", "peristat");
  program.set_version_flag("--version", "peristat " PERISTAT_VERSION);
  program.require_subcommand(1);
  CommandLine line;
  CLI::App* run_command = program.add_subcommand("run", "run a case");
  add_case_options(*run_command, line);
  run_command->add_option("--output", line.output, "results folder (default: the case's)");
  run_command->add_flag("--overwrite", line.overwrite,
                        "replace results of another case, or of version 1, in the folder");
  add_run_options(*run_command, line);
  CLI::App* resume_command =
      program.add_subcommand("resume", "continue a run that has not reached its end");
  resume_command->add_option("results", line.results, "results folder of the run")->required();
  add_settings(*resume_command, line);
  add_threads(*resume_command, line);
  add_run_options(*resume_command, line);
  add_case_options(
      *program.add_subcommand("check", "read a case and build its body, without solving"), line);
  CLI::App* tangent_command = program.add_subcommand(
      "check-tangent", "check residual and tangent by finite differences; prints JSON");
  add_case_options(*tangent_command, line);
  tangent_command->add_option("--deformation", line.deformation,
                              "current coordinates as expressions of x, y, z: 'EXPR; EXPR; …'");
  CLI::App* const keys =
      program.add_subcommand("keys", "print the keys of case files, as tables in markdown");
  CLI::Option* const table = keys->add_option(
      "table", line.table, "print one table, such as solver or lattice.shape (default: all)");
  keys->add_flag("--ranks", line.lists_keys_on_ranks,
                 "print the keys that are supported on several ranks")
      ->excludes(table);
  program.add_subcommand("schema", "print a JSON schema, with which editors check case files");
  add_points(*program.add_subcommand(
                 "points", "print counts and sizes of a mesh, or write its points as text"),
             line);
  CLI::App* const calibration = program.add_subcommand(
      "calibrate",
      "compute constants from moduli and fracture data, or moduli from constants; prints JSON");
  add_calibration(*calibration, line);
  add_bond_calibration(*calibration, line);
  try {
    program.parse(count, arguments);
  } catch (const CLI::ExtrasError&) {
    throw InputError("", "", unexpected_words(program));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      // CLI11 takes the word after an unknown option for a case file, which then excludes other
      // options.
      if (!program.remaining(true).empty()) throw InputError("", "", unexpected_words(program));
      throw InputError("", "", std::string(error.what()) + "; --help lists the options");
    }
    program.exit(error);
    require_told();
    return static_cast<int>(Exit::done);
  }

  if (line.ranks > 1 && !is_started_as_rank()) {
    require_room_for_ranks(line.ranks);
    return run_as_ranks(line.ranks, arguments_of_ranks(count, arguments));
  }
  int threads = choose_threads(line.threads);
  if (line.threads == 0) threads = std::max(1, threads / ranks_on_machine());
  restart_with_environment(threads, arguments);
  require_threads(threads);
  claim_blas_memory(threads);
  const Exit exit = execute(program, line, threads, start_ranks_of(program, line.ranks));
  if (exit == Exit::done && !program.got_subcommand("run") && !program.got_subcommand("resume"))
    require_told();
  all_ranks().reset();
  return static_cast<int>(exit);
} catch (...) {
  return report_failure();
}
