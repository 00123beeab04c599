#include "cases/runner/memory.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <sys/resource.h>

namespace peristat {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Program, libraries and files; Trilinos, which is loaded where it is used [bytes].
constexpr double base_bytes = 27e6, trilinos_bytes = 45e6;

/// CHOLMOD's workspace beside the factor, as measured: 460 MB for the beam of
/// cases/cantilever, 1.56 GB for the plate with a hole at 120 000 points.
constexpr double factor_overhead = 1.2;

/// Value in bytes behind `key` in a file of lines "key: value kB", or unlimited.
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

/// Room left in the control group of this process (version 2, or the memory controller of version
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

/// Vectors and preconditioner of conjugate gradients with rigid pieces.
double iterative_bytes(int dimension, double points, double horizon_ratio) {
  const double d = dimension;
  const double motions = 0.5 * d * (d + 1.0);
  // Krylov vectors, block Jacobi's inverse and the basis of the pieces' motions.
  const double fine = 8.0 * points * d * (9.0 + d + motions);
  const double pieces = points / std::pow(4.0 / 3.0 * horizon_ratio, d), coarse = motions * pieces;
  // Each piece has blocks with its 26 (3D), 8 or 2 neighbours, half of them stored, and itself;
  // while they are gathered each entry takes 48 bytes.
  const double gathered = 48.0 * motions * motions * pieces * 0.5 * (std::pow(3.0, d) + 1.0);
  const double factor = dimension == 3 ? 11.0 * std::pow(coarse, 4.0 / 3.0)
                                       : 3.2 * coarse * std::log2(std::max(coarse, 2.0));
  return fine + gathered + 8.0 * factor_overhead * factor;
}

}  // namespace

double bonds_per_point(int dimension, double horizon_ratio) {
  const double m = horizon_ratio;
  switch (dimension) {
    case 1:
      return m;
    case 2:
      return 0.5 * std::numbers::pi * m * m;
    default:
      return 2.0 / 3.0 * std::numbers::pi * m * m * m;
  }
}

MemoryEstimate estimate_memory(int dimension, const BodySize& size, double horizon_ratio,
                               double bonds, double free_dofs) {
  MemoryEstimate estimate;
  estimate.points = size.points;
  estimate.bonds = bonds;
  estimate.free_dofs = free_dofs;
  const double d = dimension;
  const double n = std::max(free_dofs, 2.0);

  // A row of the natural order couples to the points of about 1.15 horizons along the body.
  const double section = size.points / std::max(size.longest, 1.0);
  const double band = std::min(n, d * section * (1.15 * horizon_ratio));
  const double natural_entries = n * band;
  const double natural_flops = 0.75 * n * band * band;
  // Separators of nested dissection are one horizon thick.
  const double thick = horizon_ratio / 3.015 * (horizon_ratio / 3.015);
  const double dissection_entries =
      dimension == 3 ? 98.0 * thick * std::pow(n, 4.0 / 3.0) : 29.0 * thick * n * std::log2(n);
  const double dissection_flops =
      dimension == 3 ? 297.0 * thick * thick * n * n : 1010.0 * thick * thick * std::pow(n, 1.5);
  estimate.factor_entries = std::min(natural_entries, dissection_entries);
  estimate.factor_flops = std::min(natural_flops, dissection_flops);

  const double blocks = (bonds + size.points) * d * d;
  estimate.body_bytes = base_bytes + 20.0 * bonds + 8.0 * size.points * (20.0 * d + 58.0);
  estimate.tangent_bytes = 8.0 * blocks;
  estimate.matrix_bytes = 16.0 * blocks;
  estimate.iterative_bytes =
      trilinos_bytes + iterative_bytes(dimension, size.points, horizon_ratio);
  // Conjugate gradients with an old factor are worth their while from here: see Cholesky.
  if (estimate.factor_flops > 96.0 * estimate.factor_entries) {
    estimate.matrix_bytes += trilinos_bytes;
  }
  return estimate;
}

double MemoryEstimate::direct_bytes() const {
  return matrix_bytes + 8.0 * factor_overhead * factor_entries;
}

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
                    " are available: use a larger lattice.spacing, a smaller "
                    "lattice.horizon_ratio or a machine with more memory");
}

}  // namespace peristat
