#pragma once

#include <concepts>

namespace peristat {

/// A law that loses stiffness in drops alone: between two of them a bond is elastic.
template <class Law>
concept StepwiseLaw = requires(const Law law, double strength) {
  { law.borne_after(strength) } -> std::same_as<double>;
};

}  // namespace peristat
