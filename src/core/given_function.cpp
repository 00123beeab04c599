#include "src/core/given_function.hpp"

#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"

namespace peristat {

void check_functions(const GivenFunctions& functions) {
  for (const auto& [name, function] : functions) {
    const auto refuse = [&name = name](const std::string& why) {
      throw InputError("functions", '"' + name + '"', why);
    };
    const std::string why_not = why_no_column(name);
    if (!why_not.empty()) refuse("as the name of a function " + why_not);
    if (function.arguments < 1) refuse("a function needs at least one argument");
    if (!function.fill) refuse("there is no function of this name to call");
  }
}

}  // namespace peristat
