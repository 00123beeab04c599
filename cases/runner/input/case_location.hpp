#pragma once

#include <string>

namespace peristat {

/// Place of a key in the case file, or on the command line.
struct CaseLocation {
  int line = 0, column = 0;   ///< from 1; 0 for a key that only an override has
  std::string override_text;  ///< "KEY=VALUE" of the --set that the key comes from, or empty

  /// "FILE:LINE:COLUMN", "--set KEY=VALUE", or "FILE" if the place is not known.
  [[nodiscard]] std::string text(const std::string& file) const {
    if (!override_text.empty()) return "--set " + override_text;
    if (line == 0) return file;
    return file + ":" + std::to_string(line) + ":" + std::to_string(column);
  }
};

}  // namespace peristat
