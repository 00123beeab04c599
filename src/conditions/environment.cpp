#include "src/conditions/environment.hpp"

namespace peristat {

SharedEnvironment between(const SharedEnvironment& from, const SharedEnvironment& to,
                          double share) {
  if (from == to || share == 0.0) return from;
  if (share == 1.0) return to;
  auto there = std::make_shared<Environment>(*from);
  for (const auto member :
       {&Environment::eigenstretch, &Environment::pressure, &Environment::ground,
        &Environment::obstacles, &Environment::traction}) {
    std::vector<double>& values = (*there).*member;
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] += share * (((*to).*member)[k] - values[k]);
    }
  }
  return there;
}

}  // namespace peristat
