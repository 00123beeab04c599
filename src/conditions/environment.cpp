#include "src/conditions/environment.hpp"

namespace peristat {

SharedEnvironment between(const SharedEnvironment& from, const SharedEnvironment& to,
                          double share) {
  if (from == to || share == 0.0) return from;
  if (share == 1.0) return to;
  auto there = std::make_shared<Environment>(*from);
  for (std::size_t k = 0; k < there->eigenstretch.size(); ++k) {
    double& value = there->eigenstretch[k];
    value += share * (to->eigenstretch[k] - value);
  }
  return there;
}

}  // namespace peristat
