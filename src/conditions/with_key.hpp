#pragma once

#include <string>

#include "src/core/input_error.hpp"

namespace peristat {

/// Runs `make` and gives its input errors the key that they concern.
template <class Make>
auto with_key(const std::string& key, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(key, error.value(), error.allowed());
  }
}

/// Gives input errors that have no key that of the table.
template <class Make>
auto with_table(const std::string& table, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(error.key().empty() ? table : error.key(), error.value(), error.allowed());
  }
}

}  // namespace peristat
