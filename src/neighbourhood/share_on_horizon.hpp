#pragma once

#include <functional>

#include "src/neighbourhood/bonds.hpp"
#include "src/neighbourhood/kernel.hpp"

namespace peristat {

/// Fraction of the bonds that are as long as the horizon, to a thousandth of it, if the kernel ends
/// there with a jump: whether these are bonds depends on the last digits of positions. It is three
/// thousandths for points without order, and a whole shell on a lattice whose horizon is a distance
/// between its points.
/// @param norm of a bond in the kernel's shape [m]; empty: its length
[[nodiscard]] double share_on_horizon(const Bonds& bonds, const Kernel& kernel,
                                      const std::function<double(Index i, Index j)>& norm = {});

}  // namespace peristat
