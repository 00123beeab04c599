#include "cases/runner/process/fault_aside.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

constexpr const char* done = "done";

/// Processor time [s] after which a library is taken to be in an endless loop: files have no more
/// than some hundred gigabytes.
constexpr rlim_t most_seconds = 600;

/// Runs the work. Returns `done`, or the message of its exception.
std::string told(const std::function<void()>& work) {
  try {
    work();
    return done;
  } catch (const std::bad_alloc&) {
    return "it needs more memory than there is";
  } catch (const std::exception& error) {
    return error.what();
  }
}

[[noreturn]] void fail(const char* what) {
  throw MachineError(std::string(what) + ": " + std::strerror(errno));
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> some;
  for (ssize_t size = 0; (size = ::read(descriptor, some.data(), some.size())) != 0;) {
    if (size > 0) {
      text.append(some.data(), static_cast<std::size_t>(size));
    } else if (errno != EINTR) {
      break;
    }
  }
  return text;
}

}  // namespace

std::optional<std::string> fault_aside(const std::function<void()>& work) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) fail("a pipe can't be opened");
  const pid_t child = ::fork();
  if (child < 0) fail("a process can't be started");
  if (child == 0) {
    const rlimit limit{most_seconds, most_seconds};
    static_cast<void>(::setrlimit(RLIMIT_CPU, &limit));
    const std::string text = told(work);
    const ssize_t written = ::write(pipe[1], text.data(), text.size());
    ::_exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
  }
  ::close(pipe[1]);
  const std::string text = read_all(pipe[0]);
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (text == done) return std::nullopt;
  return text.empty() ? "the library that reads it crashes" : text;
}

}  // namespace peristat
