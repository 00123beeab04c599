#include "solvers/linear/available_memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <sys/resource.h>

namespace peristat {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Value in bytes after `key` in a file of lines "key: value kB", or unlimited.
double kilobytes_in(const char* file, const std::string& key) {
  std::ifstream lines(file);
  std::string word;
  while (lines >> word) {
    double value;
    if (word == key && lines >> value) return 1024.0 * value;
  }
  return unlimited;
}

double number_in(const std::string& file) {
  std::ifstream stream(file);
  double value;
  return stream >> value ? value : unlimited;
}

/// Memory left in the control group of this process (version 2, or the memory controller of version
/// 1).
double control_group_room() {
  std::ifstream groups("/proc/self/cgroup");
  double room = unlimited;
  for (std::string line; std::getline(groups, line);) {
    const auto path_at = line.find('/');
    if (path_at == std::string::npos) continue;
    const bool version2 = line.rfind("0::", 0) == 0;
    if (!version2 && line.find(":memory:") == std::string::npos) continue;
    const std::string folder =
        (version2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory") + line.substr(path_at);
    const double limit = number_in(folder + (version2 ? "/memory.max" : "/memory.limit_in_bytes"));
    const double used =
        number_in(folder + (version2 ? "/memory.current" : "/memory.usage_in_bytes"));
    if (limit < unlimited && used < unlimited) room = std::min(room, limit - used);
  }
  return room;
}

}  // namespace

double available_memory() {
  double available = std::min(kilobytes_in("/proc/meminfo", "MemAvailable:"), control_group_room());
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    const double used = kilobytes_in("/proc/self/status", "VmSize:");
    available = std::min(available, double(limit.rlim_cur) - (used < unlimited ? used : 0.0));
  }
  return available;
}

std::string bytes_text(double bytes) {
  if (bytes < 1e9) return fmt::format("{:.0f} MB", bytes / 1e6);
  if (bytes < 1e14) return fmt::format("{:.2f} GB", bytes / 1e9);
  return fmt::format("{:.1e} GB", bytes / 1e9);
}

void require_memory(double bytes, const std::string& for_what) {
  const double available = available_memory();
  if (bytes <= available) return;
  throw MemoryError(for_what + " needs about " + bytes_text(bytes) + ", and " +
                    bytes_text(available) +
                    " are available: use a larger spacing, a smaller horizon "
                    "or a machine with more memory");
}

}  // namespace peristat
