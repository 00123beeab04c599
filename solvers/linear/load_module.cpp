#include "solvers/linear/load_module.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include <dlfcn.h>

#include "src/core/address_space.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

/// Throws the exception that fits the loader's reason. The loader gives it as text alone: "cannot
/// open shared object file: Error 24", "failed to map segment from shared object", "cannot allocate
/// memory in static TLS block", ...
[[noreturn]] void throw_why_not(const char* library, const std::string& reason) {
  const std::string message = std::string(library) + " can't be loaded: " + reason;
  for (const int cause : {EMFILE, ENFILE}) {
    if (reason.ends_with("Error " + std::to_string(cause)) ||
        reason.ends_with(std::strerror(cause))) {
      throw MachineError(message);
    }
  }
  if (reason.find("map segment") != std::string::npos ||
      reason.find("allocate memory") != std::string::npos) {
    throw std::bad_alloc();
  }
  throw std::runtime_error(message);
}

bool is_missing(const std::string& file, const std::string& reason) {
  return reason.starts_with(file + ": ") && reason.ends_with(std::strerror(ENOENT));
}

/// Has the launcher that started the program build a module that is missing.
/// @return true if a launcher started the program
/// @throws MachineError if the build fails or is interrupted
bool build_by_launcher(const char* library, const std::string& file) {
  if (std::getenv("PERISTAT_LAUNCHER") == nullptr) return false;
  const std::string target = file.substr(0, file.rfind(".so"));
  const int status = std::system(("\"$PERISTAT_LAUNCHER\" build " + target + " >&2").c_str());
  if (status != 0) throw MachineError(std::string(library) + " could not be built: see above");
  return true;
}

}  // namespace

void* load_module(const char* library, const char* file, const char* symbol, std::size_t room) {
  if (!has_address_space(room)) throw std::bad_alloc();
  // By default Scotch 7, which MUMPS and the ranks use, orders on all cores, and differently in
  // each run: round-off of factors and partitions would not repeat.
  setenv("SCOTCH_PTHREAD_NUMBER", "1", 0);
  void* loaded = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
  std::string reason = loaded ? "" : dlerror();
  if (!loaded && is_missing(file, reason) && build_by_launcher(library, file)) {
    loaded = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
    if (!loaded) reason = dlerror();
  }
  if (!loaded) throw_why_not(library, reason);
  void* const found = dlsym(loaded, symbol);
  if (!found) throw_why_not(library, dlerror());
  return found;
}

}  // namespace peristat
