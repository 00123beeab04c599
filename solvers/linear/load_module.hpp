#pragma once

#include <cstddef>

namespace peristat {

/// Loads a module: a shared library beside the program that brings a large third-party library and
/// is loaded at the first use. It stays until the process ends. Symbols that the program already
/// has come first, BLAS for one; other modules do not see those of this one. A module that is not
/// there is built by the launcher that started the program, which PERISTAT_LAUNCHER names.
/// @param library third-party library that it brings, for messages
/// @param file    found by the run path of the program
/// @param room    address space that it needs [bytes]: where it finds none while it is loaded, the
///                process ends
/// @return its symbol
/// @throws MachineError, std::bad_alloc where the machine is the reason, std::runtime_error
[[nodiscard]] void* load_module(const char* library, const char* file, const char* symbol,
                                std::size_t room);

}  // namespace peristat
