#include "solvers/ranks/sum_on_machine.hpp"

#include <cstddef>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// A number that all processes of a machine share, also in containers, and other machines hardly.
double number_of_machine() {
  std::string text;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> text;
  constexpr std::size_t exact_in_double = std::size_t(1) << 53;
  return double(std::hash<std::string>{}(text) % exact_in_double);
}

}  // namespace

double sum_on_machine(const Communicator& ranks, double mine) {
  const double machine = number_of_machine();
  const std::vector<double> all = ranks.all_of({machine, mine});
  double sum = 0.0;
  for (std::size_t k = 0; k < all.size(); k += 2) {
    if (all[k] == machine) sum += all[k + 1];
  }
  return sum;
}

}  // namespace peristat
