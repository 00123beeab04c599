#pragma once

#include <functional>

namespace peristat {

/// int_from^to of a smooth function, to round-off, by adaptive Gauss-Kronrod quadrature.
[[nodiscard]] double integral(const std::function<double(double)>& of, double from, double to);

}  // namespace peristat
