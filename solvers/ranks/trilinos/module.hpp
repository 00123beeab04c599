#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solvers/ranks/records.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/ghost_exchange.hpp"

// Code that needs MPI is a separate module (load_ranks.cpp), so that runs of a sole rank never
// start it; this header is the whole interface between the two.

namespace peristat::ranks {

using StartRanks = std::unique_ptr<Communicator>();
StartRanks start_ranks;

using Exchange = Records(const Communicator& ranks, const std::vector<int>& to,
                         const Records& records);
Exchange exchange;

using Partition = std::vector<int>(const Communicator& ranks, int dimension,
                                   const std::vector<double>& positions,
                                   const std::vector<std::int64_t>& numbers,
                                   const std::vector<double>& weights);
Partition partition;

using MakeGhostExchange = std::unique_ptr<GhostExchange>(const Communicator& ranks,
                                                         const std::vector<std::int64_t>& owned,
                                                         const std::vector<std::int64_t>& ghosts,
                                                         int width);
MakeGhostExchange make_ghost_exchange;

struct Module {
  StartRanks* start_ranks;
  Exchange* exchange;
  Partition* partition;
  MakeGhostExchange* make_ghost_exchange;
};

/// The module's one symbol, of type `const Module*()`.
inline constexpr const char* module_symbol = "peristat_ranks_module";
/// Its file, beside the program.
inline constexpr const char* module_file = "peristat_ranks.so";

}  // namespace peristat::ranks
