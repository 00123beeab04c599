#include "cases/runner/input/givens.hpp"

#include <sstream>

#include "src/core/input_error.hpp"

namespace peristat {
std::string lines_of(const Givens& givens) {
  std::string lines;
  for (const auto& [name, function] : givens.functions)
    lines += std::string(mark_of_given) + "function " + name + "\n";
  if (givens.points) lines += std::string(mark_of_given) + "points\n";
  return lines;
}

void require_givens(const std::string& lines, const Givens& givens) {
  const std::string here = "\n" + lines_of(givens);
  std::istringstream then(lines);
  std::string missing;
  for (std::string line; std::getline(then, line);) {
    if (!line.starts_with(mark_of_given) || here.find("\n" + line + "\n") != std::string::npos)
      continue;
    missing += (missing.empty() ? "" : ", ") + line.substr(mark_of_given.size());
  }
  if (missing.empty()) return;
  throw InputError("", "",
                   "this run used functions or points of a program: " + missing +
                       ". Resume it in a program that gives them");
}

}  // namespace peristat
