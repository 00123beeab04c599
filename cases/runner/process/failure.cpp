#include "cases/runner/process/failure.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
#include <system_error>
#include <thread>

#include <sys/resource.h>
#include <unistd.h>

#include "solvers/linear/available_memory.hpp"
#include "solvers/linear/memory_estimate.hpp"
#include "src/core/input_error.hpp"
#include "src/core/machine_error.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Text about the shell's limit of the address space; empty if there is none.
std::string shell_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  return " (the shell allows " + bytes_text(double(limit.rlim_cur)) +
         " of address space, see \"ulimit -v\")";
}

}  // namespace

Failure current_failure() {
  try {
    throw;
  } catch (const InputError& error) {
    return {Exit::wrong_input, error.what()};
  } catch (const MemoryError& error) {
    return {Exit::out_of_memory, error.what()};
  } catch (const std::bad_alloc&) {
    return {Exit::out_of_memory, "out of memory" + shell_limit()};
  } catch (const MachineError& error) {
    return {Exit::machine_failed, error.what()};
  } catch (const std::system_error& error) {
    return {Exit::machine_failed, error.what()};
  } catch (const std::exception& error) {
    return {Exit::bug, error.what()};
  }
}

void give_way_to_first(const Communicator& ranks) {
  using namespace std::chrono_literals;
  constexpr int most_in_turn = 40;  // ranks beyond these wait equally long: several may report
  if (ranks.rank() == 0) return;
  std::this_thread::sleep_for(2s + std::min(ranks.rank() - 1, most_in_turn) * 250ms);
}

}  // namespace peristat
