#include "cases/runner/process/ranks_environment.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

/// mpirun gives its ranks no other streams than the standard ones: they reach a descriptor of this
/// process through /proc.
void keep_note_reachable() {
  const std::string descriptors = "/dev/fd/";
  const char* const note = std::getenv("PERISTAT_NOTE");
  if (!note || std::string(note).rfind(descriptors, 0) != 0) return;
  const std::string here = "/proc/" + std::to_string(getpid()) + "/fd/";
  setenv("PERISTAT_NOTE", (here + (note + descriptors.size())).c_str(), 1);
}

}  // namespace

bool is_started_as_rank() {
  return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr || std::getenv("PMIX_RANK") != nullptr;
}

int ranks_on_machine() {
  const char* const count = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  return count ? std::max(1, std::atoi(count)) : 1;
}

void start_as_ranks(int ranks, const std::vector<std::string>& arguments) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  // Ranks may have threads, so that they are bound to no core.
  std::vector<std::string> words{"mpirun", "--quiet", "--oversubscribe",     "--bind-to",
                                 "none",   "-np",     std::to_string(ranks), program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  keep_note_reachable();
  execvp(pointers.front(), pointers.data());
  throw MachineError(std::string("mpirun can't be started: ") + std::strerror(errno) +
                     "; it is in Debian's package openmpi-bin");
}

}  // namespace peristat
