#include "src/neighbourhood/influence.hpp"

namespace peristat {

std::vector<std::string> influence_names() {
  std::vector<std::string> names;
  Influences::for_each([&](const auto& influence) { names.emplace_back(influence.name); });
  return names;
}

std::function<double(double)> influence_named(const std::string& name) {
  std::function<double(double)> named;
  Influences::for_each([&]<class I>(const I& influence) {
    if (I::name == name && !std::same_as<I, ConstantInfluence>) named = influence;
  });
  return named;
}

}  // namespace peristat
