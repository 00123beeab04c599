#pragma once

#include <functional>

#include "src/neighbourhood/bonds.hpp"
#include "src/neighbourhood/kernel.hpp"

namespace peristat {

/// Share of the bonds that are as long as the horizon, to a thousandth of it, where a kernel ends
/// there with a jump: those are neighbours by the last digits of the places. It is three
/// thousandths of points without order, and a whole shell of a lattice whose horizon ratio is a
/// distance of it.
/// @param norm of a bond in the kernel's shape [m]; empty: its length
[[nodiscard]] double share_on_horizon(const Bonds& bonds, const Kernel& kernel,
                                      const std::function<double(Index i, Index j)>& norm = {});

}  // namespace peristat
