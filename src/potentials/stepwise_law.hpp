#pragma once

#include <concepts>
#include <stdexcept>

namespace peristat {

/// A law that loses stiffness in drops alone: between two of them a bond is elastic.
template <class Law>
concept StepwiseLaw = requires(const Law law, double strength) {
  { law.borne_after(strength) } -> std::same_as<double>;
};

/// True for such a law, and for one of several that is.
template <class Law>
[[nodiscard]] bool falls_by_steps(const Law& law) {
  if constexpr (requires { law.falls_by_steps(); }) {
    return law.falls_by_steps();
  } else {
    return StepwiseLaw<Law>;
  }
}

/// Stretch that such a law bears after a strength is exceeded.
template <class Law>
[[nodiscard]] double borne_after(const Law& law, double strength) {
  if constexpr (StepwiseLaw<Law>) {
    return law.borne_after(strength);
  } else {
    throw std::logic_error("a law whose force falls smoothly has no drops");
  }
}

}  // namespace peristat
