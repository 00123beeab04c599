#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {

inline void require(bool holds, const std::string& key, const std::string& value,
                    const std::string& allowed) {
  if (!holds) throw InputError(key, value, allowed);
}

inline void require_positive(const std::optional<double>& value, const std::string& key) {
  if (!value || (std::isfinite(*value) && *value > 0.0)) return;
  throw InputError(key, number_text(*value), "must be positive and finite");
}

inline void require_absent(bool is_given, const std::string& key, const std::string& why) {
  require(!is_given, key, "", why);
}

inline void require_within(double value, double least, double most, const std::string& key) {
  require(value >= least && value <= most, key, number_text(value),
          "must be from " + number_text(least) + " to " + number_text(most));
}

}  // namespace peristat
