#include "cases/runner/process/interruption.hpp"

#include <atomic>
#include <csignal>

namespace peristat {
namespace {

std::atomic<bool> requested{false};

void request(int signal) {
  requested = true;
  std::signal(signal, SIG_DFL);  // a second one ends the program at once
}

}  // namespace

void make_write_faults_errors() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void heed_interruptions() {
  requested = false;
  std::signal(SIGINT, request);
  std::signal(SIGTERM, request);
  std::signal(SIGUSR1, request);  // mpirun and Slurm can send it
  if (std::signal(SIGHUP, request) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

bool interruption_requested() { return requested; }

}  // namespace peristat
