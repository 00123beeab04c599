#pragma once

namespace peristat {

/// From here on a write into a pipe that nobody reads, or beyond the shell's limit of file sizes,
/// is an error instead of a signal that ends the program.
void make_write_faults_errors();

/// From here on SIGINT, SIGTERM, SIGUSR1 and SIGHUP (unless it was ignored, as under nohup) ask the
/// run to stop; a second one ends the program at once.
void heed_interruptions();

/// True if the run has been asked to stop.
[[nodiscard]] bool interruption_requested();

}  // namespace peristat
