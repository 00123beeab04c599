#include "cases/runner/process/progress.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cases/runner/process/folded_text.hpp"
#include "cases/runner/process/output_file.hpp"
#include "solvers/drivers/mode.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// @return the system's error, 0 for none
int write_now(std::FILE* file, const std::string& text) {
  errno = 0;
  const bool is_written =
      std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
  return is_written ? 0 : (errno != 0 ? errno : EIO);
}

/// Ignores errors: there is no other place to report them.
void write_to_standard_error(const std::string& line) {
  write_now(stderr, "peristat: " + line + "\n");
}

/// Width of a terminal; 80 if unknown.
std::size_t columns(int descriptor) {
  winsize size{};
  const bool told = ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 20;
  return told ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(bool quiet, const std::string& log_file, bool tells, Sink sink)
    : sink_(std::move(sink)),
      tells_(tells),
      quiet_(quiet || !tells),
      live_(!quiet_ && !sink_ && isatty(STDOUT_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      last_said_(start_) {
  if (log_file.empty() || !tells) return;
  try {
    log_ = open_own_file(log_file, log_heading);
  } catch (const ForeignFile& error) {
    throw InputError("--log", log_file,
                     std::string(error.what()) +
                         ": name a new file, or the log of an earlier run, which is replaced");
  } catch (const OutputError& error) {
    if (is_about_means(error.cause())) throw;
    throw InputError("--log", log_file,
                     std::string("can't be written: ") + std::strerror(error.cause()));
  }
}

Progress::~Progress() {
  erase_live_line();
  if (log_) std::fclose(log_);
}

void Progress::write_to_person(const std::string& text) {
  if (quiet_) return;
  const int error = write_now(stdout, text);
  if (error == 0) return;
  quiet_ = true;
  live_ = false;
  write_to_standard_error(std::string("standard output can't be written (") + std::strerror(error) +
                          "): the run continues without output");
}

void Progress::write_to_log(const std::string& line) {
  if (!log_) return;
  const int error = write_now(log_, line + "\n");
  if (error == 0) return;
  std::fclose(std::exchange(log_, nullptr));
  write_to_standard_error(std::string("the log can't be written (") + std::strerror(error) +
                          "): the run continues without it");
}

void Progress::erase_live_line() {
  if (!live_line_shown_) return;
  write_to_person("\r\033[K");
  live_line_shown_ = false;
}

void Progress::say(const std::string& line) {
  last_said_ = std::chrono::steady_clock::now();
  erase_live_line();
  if (sink_) {
    if (!quiet_) sink_(line, false);
  } else {
    write_to_person((live_ ? folded(line, columns(STDOUT_FILENO)) : line) + "\n");
  }
  write_to_log(line);
}

void Progress::problem(const std::string& line) {
  if (!tells_) return;
  erase_live_line();
  if (sink_) {
    sink_(line, true);
  } else {
    write_to_standard_error(line);
  }
  write_to_log(line);
}

std::string Progress::time_left() const {
  const double left = time_left_.seconds().value_or(0.0);
  if (left < 1.0) return "";
  if (left < 120.0) return fmt::format("  about {:.0f} s left", left);
  if (left < 7200.0) return fmt::format("  about {:.0f} min left", left / 60.0);
  return fmt::format("  about {:.1f} h left", left / 3600.0);
}

void Progress::iteration(const IterationRecord& record) {
  if (log_) {
    write_to_log(fmt::format(
        "  step {} iteration {}: residual {:.3e} N, relative {:.3e}, step length {:g}", record.step,
        record.iteration, record.residual, record.relative_residual, record.step_length));
  }
  if (!live_) return show_life(record);
  erase_live_line();
  const std::string line =
      fmt::format("step {}  load {:.4g}  iteration {}  residual {:.1e}{}", record.step,
                  load_factor_, record.iteration, record.relative_residual, time_left());
  write_to_person(cut_to(line, columns(STDOUT_FILENO) - 1));
  live_line_shown_ = true;
}

/// Prints a line now and then in a long search where no live line is shown.
void Progress::show_life(const IterationRecord& record) {
  if (std::chrono::steady_clock::now() - last_said_ < longest_silence_) return;
  say(fmt::format("  step {}: still searching, iteration {}, residual {:.1e}", record.step,
                  record.iteration, record.relative_residual));
}

void Progress::decision(const DecisionRecord& record) {
  if (record.action == Decision::accept) return;
  if (record.action == Decision::preload) return say("  " + record.reason);
  if (record.action == Decision::accept_and_grow) {
    say(fmt::format("  next step grows to {:.4g}", record.next_increment));
    return;
  }
  const std::string what = record.action == Decision::cut
                               ? fmt::format("step cut to {:.4g}", record.next_increment)
                               : name(record.action);
  // After a converged search, the reason is printed without the outcome.
  const std::string why = record.outcome == "converged"
                              ? record.reason
                              : fmt::format("{} ({})", record.outcome, record.reason);
  say(fmt::format("  load {:.6g}: {}; {}", record.load_factor, why, what));
}

void Progress::moved(const StepRecord& record) {
  const MotionRecord& motion = *record.motion;
  const std::string broken = record.broken_bonds > 0
                                 ? fmt::format(", {} bonds broken", record.broken_bonds)
                                 : std::string();
  say(
      fmt::format("step {:6}  time {:<10.5g} s  kinetic {:<9.3e} J  stored {:<9.3e} J  damage "
                  "{:.3g}{}{}",
                  record.step, motion.time, motion.kinetic_energy, record.stored_energy,
                  record.max_damage, broken, time_left()));
}

void Progress::accepted(const StepRecord& record, double relative_residual) {
  load_factor_ = record.load_factor;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const bool relaxed_or_damaged =
      !record.motion && (record.relaxation_iterations > 0 || record.max_damage > 0.0);
  // The length of these paths is not known in advance.
  if (record.mode != Mode::arc_length.name && record.mode != Mode::path.name &&
      record.mode != Mode::fatigue.name)
    time_left_.accepted(elapsed.count(), record.stage / last_stage_, relaxed_or_damaged);
  if (record.motion) return moved(record);
  const std::string relaxed =
      record.relaxation_iterations > 0
          ? fmt::format("  after {} of relaxation", record.relaxation_iterations)
          : std::string();
  const std::string broken = record.broken_bonds > 0
                                 ? fmt::format(", {} bonds broken", record.broken_bonds)
                                 : std::string();
  const std::string cycles =
      record.mode == Mode::fatigue.name ? fmt::format("  cycles {:<9.6g}", record.cycles) : "";
  const std::string unstable =
      record.negative_pivots > 0 ? fmt::format(", {} negative pivots", record.negative_pivots) : "";
  say(fmt::format(
      "step {:4}  load {:<8.6g}{}  {:2} iterations{}  residual {:.1e}  damage {:.3g}{}{}{}",
      record.step, record.load_factor, cycles, record.newton_iterations, relaxed, relative_residual,
      record.max_damage, broken, unstable, time_left()));
}

}  // namespace peristat
