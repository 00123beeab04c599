#include "cases/runner/commands/resume.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cases/runner/commands/run_facts.hpp"
#include "cases/runner/input/case.hpp"
#include "cases/runner/input/case_difference.hpp"
#include "cases/runner/input/case_file.hpp"
#include "cases/runner/input/case_inputs.hpp"
#include "cases/runner/input/case_keys.hpp"
#include "cases/runner/input/toml_text.hpp"
#include "cases/runner/process/progress.hpp"
#include "cases/runner/results/folder/earlier_run.hpp"
#include "cases/runner/setup/part_body.hpp"
#include "src/conditions/loading_programme.hpp"
#include "src/core/input_error.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

void require_extending(const Settings& settings) {
  const std::vector<std::string>& allowed = extending_keys();
  for (const auto& [key, value] : settings) {
    if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    throw InputError(
        "--set", key + "=" + value,
        fmt::format("would change the case; when a run is resumed, --set may change only {}",
                    fmt::join(allowed, ", ")));
  }
}

/// Settings that the run began with, and the folder that it is in now.
Settings settings_in(const EarlierRun& earlier) {
  Settings settings = earlier.settings();
  std::erase_if(settings, [](const auto& setting) { return setting.first == "output.directory"; });
  settings.emplace_back("output.directory", toml_string(earlier.directory().string()));
  return settings;
}

/// Text of the case: from its file, or from the run if the file is gone.
/// @throws InputError if the file has changed
std::string case_text(const EarlierRun& earlier, const Settings& settings,
                      const std::shared_ptr<const Givens>& givens) {
  if (!std::filesystem::exists(earlier.case_file())) return earlier.case_text();
  const Case then = read_case(earlier.case_file(), earlier.case_text(), settings, givens);
  const Case now =
      read_case(earlier.case_file(), read_case_text(earlier.case_file()), settings, givens);
  const std::vector<std::string> changes = case_differences(then.as_resolved, now.as_resolved);
  if (changes.empty()) return now.as_read;
  throw InputError(
      "", "",
      fmt::format("has changed since the run began: {}. Undo these changes to resume, or start "
                  "again with `run`; give keys that only extend a run with --set",
                  fmt::join(changes, "; ")),
      earlier.case_file().string());
}

/// Refuses files that have changed since the run began.
void require_same_files(const EarlierRun& earlier, const Case& from) {
  if (earlier.files().empty()) return;
  std::istringstream lines(checksums_of_files(from));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(mark_of_given)) continue;  // require_givens has seen to these
    if (("\n" + earlier.files()).find("\n" + line + "\n") != std::string::npos) continue;
    throw InputError("", "",
                     "has changed since the run began. The run reads this file: restore it to "
                     "resume, or start again with `run`",
                     line.substr(line.find(' ') + 1));
  }
}

LoadingProgramme programme_of(const Case& from) {
  if (from.end_time) return LoadingProgramme::of_time(*from.end_time, from.loads_over_time);
  return from.programme.empty() ? LoadingProgramme() : LoadingProgramme(from.programme);
}

/// Refuses load tables over time that differ from the run's up to the time that it has reached.
void require_same_loads(const LoadingProgramme& then, const LoadingProgramme& now, double time) {
  std::vector<double> times{0.0, time};
  for (const LoadingProgramme* const programme : {&then, &now}) {
    for (const TimeTable& table : programme->loads_over_time()) {
      for (const auto& pair : table) times.push_back(std::min(pair[0], time));
    }
  }
  for (const double at : times) {
    if (then.at(at) == now.at(at)) continue;
    throw InputError("--set", "loading.table",
                     fmt::format("the loads at {:.6g} s have changed, but the run has used them to "
                                 "reach {:.6g} s; the tables may change only after this time",
                                 at, time));
  }
}

/// Refuses load tables that differ from the run's up to the stage that it has reached.
void require_same_beginning(const LoadingProgramme& then, const LoadingProgramme& now,
                            const PathState& path) {
  const double stage = path.accepted.stage, reached = std::ceil(stage);
  if (then.is_of_time()) {
    if (now.is_of_time() && stage <= now.end()) {
      require_same_loads(then, now, stage);
      return;
    }
    throw InputError("--set", "dynamics.end_time",
                     fmt::format("the run has already reached {:.6g} s, beyond this time", stage));
  }
  const bool is_long_enough = reached <= now.end() && then.parameters() == now.parameters();
  for (double entry = 0.0; is_long_enough && entry <= reached; ++entry) {
    if (then.at(entry) == now.at(entry)) continue;
    throw InputError("--set", "loading.table",
                     fmt::format("entry {} has changed, but the run has used it to reach stage "
                                 "{:.6g}; only later entries may change",
                                 entry, stage));
  }
  if (is_long_enough) return;
  throw InputError(
      "--set", "loading.table",
      fmt::format(
          "the run has reached stage {:.6g} of {} load parameters, but these tables don't reach it",
          stage, then.parameters()));
}

/// Refuses other modes than adaptive, which alone replaces the stand-in by the body.
void require_stand_in(const PathState& path, const Case& from) {
  if (!path.stands_in || from.solver.mode == Mode::adaptive) return;
  throw InputError(
      "--set", "solver.mode=" + std::string(from.solver.mode.name),
      "the run still uses its elastic stand-in (solver.elastic_horizon_ratio), which only mode "
      "adaptive replaces by the body; resume in that mode until damage has begun");
}

/// True if the run has made all cycles or blocks that are asked for. Whether another bond breaks
/// only the run itself finds out.
bool has_made_cycles(const PathState::Fatigue& reached, const FatigueOptions& asked) {
  return (asked.cycles > 0.0 && reached.cycles >= asked.cycles) ||
         (asked.blocks > 0 && reached.blocks >= asked.blocks);
}

bool is_finished(const EarlierRun& earlier, const Case& from) {
  const PathState& path = earlier.checkpoint().path;
  if (from.solver.mode == Mode::fatigue && !has_made_cycles(path.fatigue, from.fatigue)) {
    return false;
  }
  return earlier.is_concluded() && !programme_of(from).has_rest(path.accepted.stage);
}

}  // namespace

Exit resume(const std::filesystem::path& directory, const Settings& settings,
            const RunOptions& options, const Communicator& ranks,
            const std::shared_ptr<const Givens>& givens) {
  require_extending(settings);
  EarlierRun earlier(directory, PERISTAT_VERSION, ranks);
  try {
    require_givens(earlier.files(), *givens);
  } catch (const InputError& error) {
    throw InputError("", "", error.allowed(), directory.string());
  }
  Settings all = settings_in(earlier);
  const std::string text = case_text(earlier, all, givens);
  const Case then = read_case(earlier.case_file(), text, all, givens);
  all.insert(all.end(), settings.begin(), settings.end());
  const Case from = read_case(earlier.case_file(), text, all, givens);
  if (ranks.count() > 1) refuse_keys_without_ranks(from);
  require_same_files(earlier, then);
  require_same_beginning(programme_of(then), programme_of(from), earlier.checkpoint().path);
  require_stand_in(earlier.checkpoint().path, from);
  if (std::any_of(settings.begin(), settings.end(),
                  [](const auto& setting) { return setting.first.starts_with("solver."); })) {
    earlier.forget_solvers();
  }
  if (is_finished(earlier, from)) {
    keep_inputs_and_log_apart(from, options.log_file);
    Progress(options.quiet, options.log_file, ranks.rank() == 0)
        .say(fmt::format("the run in {} has reached its end: {} steps, load factor {:.6g}",
                         directory.string(), earlier.checkpoint().path.steps,
                         programme_of(from).at(earlier.checkpoint().path.accepted.stage)[0]));
    return Exit::done;
  }
  return run(from, options, ranks, &earlier);
}

}  // namespace peristat
