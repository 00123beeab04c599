#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solvers/ranks/records.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/ghost_exchange.hpp"

namespace peristat {

/// Starts MPI, once per process; the result ends it and must outlive all of its users. A process
/// that mpirun has not started is a sole rank of MPI.
/// @throws std::runtime_error where MPI can't be started
[[nodiscard]] std::unique_ptr<Communicator> start_ranks();

/// Sends each record to a rank, perhaps its own, by Tpetra::Distributor. Collective.
/// @param to rank of each record
/// @return the records received here, in a reproducible order
[[nodiscard]] Records exchange(const Communicator& ranks, const std::vector<int>& to,
                               const Records& records);

/// Partitions a cloud of points into parts of about equal weight by planes across the axes, with
/// the multi-jagged method of Zoltan2. Collective.
/// @param positions of this rank's points, points x dimension, row major [m]
/// @param numbers   of these points in the whole cloud
/// @return rank of each point
[[nodiscard]] std::vector<int> partition(const Communicator& ranks, int dimension,
                                         const std::vector<double>& positions,
                                         const std::vector<std::int64_t>& numbers,
                                         const std::vector<double>& weights);

/// Exchange of ghosts between ranks.
/// @param owned, ghosts numbers in the whole body of the points that this rank owns, and of those
///        whose values it needs; each is owned by one rank
/// @param width values per point
/// @throws std::logic_error for a ghost that no other rank owns
[[nodiscard]] std::unique_ptr<GhostExchange> make_ghost_exchange(
    const Communicator& ranks, const std::vector<std::int64_t>& owned,
    const std::vector<std::int64_t>& ghosts, int width);

}  // namespace peristat
