#include "cases/runner/process/ranks_environment.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cases/runner/process/exit.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

/// mpirun passes only the standard streams on to its ranks. They reach a descriptor of this process
/// through /proc.
void keep_note_reachable() {
  const std::string descriptors = "/dev/fd/";
  const char* const note = std::getenv("PERISTAT_NOTE");
  if (!note || std::string(note).rfind(descriptors, 0) != 0) return;
  const std::string here = "/proc/" + std::to_string(getpid()) + "/fd/";
  setenv("PERISTAT_NOTE", (here + (note + descriptors.size())).c_str(), 1);
}

constexpr const char* last_words = "PERISTAT_LAST_WORDS";

/// A pipe from the ranks to this process. The ranks open it through /proc.
class LastWords {
 public:
  LastWords() {
    if (pipe2(ends_, O_CLOEXEC | O_NONBLOCK) != 0) {
      throw MachineError(std::string("a pipe can't be made: ") + std::strerror(errno));
    }
    setenv(last_words, fmt::format("/proc/{}/fd/{}", getpid(), ends_[1]).c_str(), 1);
  }
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;
  ~LastWords() {
    for (const int end : ends_) close(end);
  }

  void print() const {
    char text[4096];
    ssize_t bytes = 0;
    while ((bytes = read(ends_[0], text, sizeof text)) > 0) {
      std::fwrite(text, 1, std::size_t(bytes), stderr);
    }
  }

 private:
  int ends_[2] = {-1, -1};
};

/// Returns the number of bytes that reach the process that has started the ranks.
std::size_t pass_to_launcher(const std::string& text) {
  const char* const pipe = std::getenv(last_words);
  const int end = pipe ? open(pipe, O_WRONLY | O_NONBLOCK | O_CLOEXEC) : -1;
  if (end < 0) return 0;
  const ssize_t bytes = write(end, text.data(), text.size());
  close(end);
  return std::size_t(std::max<ssize_t>(bytes, 0));
}

volatile pid_t mpirun = 0;

/// mpirun kills its ranks when it is interrupted, but forwards SIGUSR1, on which they stop as a run
/// of one rank does. A second interruption ends them at once.
void pass_on(int signal) {
  kill(mpirun, SIGUSR1);
  std::signal(signal, [](int) { kill(mpirun, SIGTERM); });
}

void pass_on_interruptions() {
  std::signal(SIGINT, pass_on);
  std::signal(SIGTERM, pass_on);
  if (std::signal(SIGHUP, pass_on) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

[[noreturn]] void become_mpirun(const std::vector<char*>& words) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);  // mpirun ends with the process that has started it
  setpgid(0, 0);                     // the terminal interrupts the parent process only
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);  // reading the terminal would stop mpirun
  execvp(words.front(), words.data());
  std::fprintf(stderr, "peristat: mpirun can't be started: %s; it is in Debian's openmpi-bin\n",
               std::strerror(errno));
  _exit(static_cast<int>(Exit::machine_failed));
}

}  // namespace

bool is_started_as_rank() {
  return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr || std::getenv("PMIX_RANK") != nullptr;
}

int ranks_on_machine() {
  const char* const count = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  return count ? std::max(1, std::atoi(count)) : 1;
}

int run_as_ranks(int ranks, const std::vector<std::string>& arguments) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  // Ranks may have several threads, so they are not bound to cores.
  std::vector<std::string> words{"mpirun", "--quiet", "--oversubscribe",     "--bind-to",
                                 "none",   "-np",     std::to_string(ranks), program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  keep_note_reachable();
  const LastWords said;
  mpirun = fork();
  if (mpirun < 0) throw MachineError(std::string("mpirun can't be started: ") + strerror(errno));
  if (mpirun == 0) become_mpirun(pointers);
  pass_on_interruptions();
  int status = 0;
  while (waitpid(mpirun, &status, 0) < 0 && errno == EINTR) {
  }
  said.print();
  constexpr int of_signals = 128;  // as in shells
  return WIFEXITED(status) ? WEXITSTATUS(status) : of_signals + WTERMSIG(status);
}

void say_last_words(const std::string& text) {
  std::fflush(stdout);
  std::fputs(text.c_str() + pass_to_launcher(text), stderr);
  constexpr std::chrono::milliseconds until_mpirun_has_read{300};
  std::this_thread::sleep_for(until_mpirun_has_read);
}

}  // namespace peristat
