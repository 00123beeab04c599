#include "solvers/linear/load_module.hpp"

#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include <dlfcn.h>

#include "src/core/address_space.hpp"
#include "src/core/machine_error.hpp"

namespace peristat {
namespace {

/// The loader tells why in words alone: "cannot open shared object file: Error 24", "failed to map
/// segment from shared object", "cannot allocate memory in static TLS block", ...
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

}  // namespace

void* load_module(const char* library, const char* file, const char* symbol, std::size_t room) {
  if (!has_address_space(room)) throw std::bad_alloc();
  void* const loaded = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
  if (!loaded) throw_why_not(library, dlerror());
  void* const found = dlsym(loaded, symbol);
  if (!found) throw_why_not(library, dlerror());
  return found;
}

}  // namespace peristat
