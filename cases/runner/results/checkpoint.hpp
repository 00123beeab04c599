#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cases/runner/results/run_costs.hpp"
#include "solvers/drivers/path_state.hpp"

namespace peristat {

/// Layout of checkpoints, which other programs can't read: a number that grows with every change of
/// what they are made of, or of how they are written.
inline constexpr std::int64_t checkpoint_layout = 6;

/// How many rows the tables of results.h5 have.
struct TableRows {
  int history = 0, iterations = 0, decisions = 0, broken_bonds = 0;
};

/// What a run goes on from.
struct Checkpoint {
  PathState path;
  TableRows rows;
  int last_with_fields = 0;  ///< number of the last step that has fields; 0: none
  /// What the fields of the last step will need, if it has none so far.
  struct Unwritten {
    std::vector<double> told_stretches;  ///< histories of bonds as the step with fields told them
    std::vector<double> force;           ///< internal force [N]
  } unwritten;
  RunCosts costs;  ///< so far
};

/// A path's state that can't be gone on from; says why, as part of a sentence: "is damaged: …".
class BadCheckpoint : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Takes bytes that follow one another, a piece at a time.
using VisitBytes = std::function<void(std::string_view)>;

/// A checkpoint as bytes, with a checksum: HDF5 would take longer for it than a small body for a
/// step. Of arrays that hold nearly only zeros, or nearly only ones, what differs is kept. Pieces
/// are the checkpoint's own arrays: of a large body their bytes in a row would be as much again.
/// @param program version that writes
void encode(Checkpoint checkpoint, const std::string& program, const VisitBytes& visit);

/// The checkpoint that some bytes begin with.
/// @param program version that reads
/// @throws BadCheckpoint: it has another layout (named with both programs), or is damaged
[[nodiscard]] Checkpoint decode(std::string_view bytes, const std::string& program);

}  // namespace peristat
