#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solvers/ranks/records.hpp"
#include "src/core/communicator.hpp"

namespace peristat {

/// Starts MPI, once in a process, and ends it with the result, which outlives all that uses it. A
/// process that mpirun has not started is a sole rank of MPI.
/// @throws std::runtime_error where MPI can't be started
[[nodiscard]] std::unique_ptr<Communicator> start_ranks();

/// Sends each record to a rank, perhaps its own, by Tpetra::Distributor; a call that all make.
/// @param to rank of each record
/// @return those that come here, in an order that is the same again
[[nodiscard]] Records exchange(const Communicator& ranks, const std::vector<int>& to,
                               const Records& records);

/// Parts of a cloud of points of about equal weight by planes across the axes, the multi-jagged
/// method of Zoltan2.
/// @param positions of this rank's points, times the dimension, row major [m]
/// @param numbers   of them in the whole cloud
/// @return rank of each
[[nodiscard]] std::vector<int> partition(const Communicator& ranks, int dimension,
                                         const std::vector<double>& positions,
                                         const std::vector<std::int64_t>& numbers,
                                         const std::vector<double>& weights);

}  // namespace peristat
