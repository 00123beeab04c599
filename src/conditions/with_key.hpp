#pragma once

#include <string>

#include "src/core/input_error.hpp"

namespace peristat {

/// Runs `make` and sets the key of its input errors.
template <class Make>
auto with_key(const std::string& key, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(key, error.value(), error.allowed());
  }
}

/// Runs `make` and sets the table as the key of its input errors that have none.
template <class Make>
auto with_table(const std::string& table, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(error.key().empty() ? table : error.key(), error.value(), error.allowed());
  }
}

}  // namespace peristat
