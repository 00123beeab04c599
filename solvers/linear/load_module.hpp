#pragma once

#include <cstddef>

namespace peristat {

/// Loads a module: a shared library beside the program that brings a large third-party library and
/// is loaded on first use. It stays loaded until the process ends. Symbols of the program take
/// precedence, for example BLAS; other modules do not see the symbols of this one. A missing module
/// is built by the launcher that started the program, which PERISTAT_LAUNCHER names.
/// @param library name of the third-party library, for messages
/// @param file found by the run path of the program
/// @param room address space that it needs [bytes], checked first: the process would end if loading
///        ran out of it
/// @return address of `symbol`
/// @throws MachineError, std::bad_alloc if the machine is the reason; std::runtime_error otherwise
[[nodiscard]] void* load_module(const char* library, const char* file, const char* symbol,
                                std::size_t room);

}  // namespace peristat
