#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <string>

#include "cases/runner/process/time_left.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// Prints the progress of a run: one line per accepted step and decision. A terminal also gets a
/// line that follows the iterations, with the time left; lines are folded to its width. Everything
/// also goes to the log file. If standard output or the log can't be written any more (nobody reads
/// the pipe, the disk is full), that is reported once on standard error, and the run goes on.
class Progress {
 public:
  static constexpr const char* log_heading = "# log of peristat";

  /// Takes a line in the place of the terminal, and whether it tells a problem.
  using Sink = std::function<void(const std::string& line, bool is_problem)>;

  /// @param quiet prints nothing on the terminal, except in `problem`
  /// @param log_file empty for none; a new file, or an earlier log, which is replaced: it begins
  ///                 with the line `log_heading`
  /// @param tells    false: prints nothing at all, neither problems nor the log; true on one rank
  ///                 only
  /// @param sink     takes the lines that a person would see; empty: the terminal does
  /// @throws InputError (key "--log") if the log file can't be written, or holds something else
  Progress(bool quiet, const std::string& log_file, bool tells = true, Sink sink = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Sets how long a search may go on without a line if there is no live line (default: 30 s).
  void show_life_after(std::chrono::milliseconds silence) { longest_silence_ = silence; }

  /// Sets the stage of the loading programme at which the run ends (default: 1).
  void follow_to(double last_stage) { last_stage_ = last_stage; }

  void say(const std::string& line);
  /// Prints to standard error, quiet or not.
  void problem(const std::string& line);
  void iteration(const IterationRecord& record);
  void decision(const DecisionRecord& record);
  void accepted(const StepRecord& record, double relative_residual);

 private:
  void write_to_person(const std::string& text);
  void write_to_log(const std::string& line);
  void erase_live_line();
  void moved(const StepRecord& record);
  void show_life(const IterationRecord& record);
  [[nodiscard]] std::string time_left() const;

  Sink sink_;
  bool tells_, quiet_, live_;
  bool live_line_shown_ = false;
  double load_factor_ = 0.0;  // accepted
  double last_stage_ = 1.0;
  TimeLeft time_left_;
  std::chrono::milliseconds longest_silence_{30'000};
  std::chrono::steady_clock::time_point start_, last_said_;
  std::FILE* log_ = nullptr;
};

}  // namespace peristat
