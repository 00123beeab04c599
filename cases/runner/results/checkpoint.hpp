#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cases/runner/results/run_costs.hpp"
#include "cases/runner/results/state_numbering.hpp"
#include "solvers/drivers/path_state.hpp"

namespace peristat {

/// Layout of checkpoints, which other programs can't read: a number that grows with every change of
/// what they are made of, or of how they are written.
inline constexpr std::int64_t checkpoint_layout = 8;

/// How many rows the tables of results.h5 have.
struct TableRows {
  int history = 0, iterations = 0, decisions = 0, broken_bonds = 0;
};

/// What a run goes on from.
struct Checkpoint {
  PathState path;
  TableRows rows;
  static constexpr int none = -1;
  int last_with_fields = none;  ///< number of the last step that has fields
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

/// Takes the bytes of a checkpoint, part after part.
using PutBytes = std::function<void(std::string_view)>;

/// Writes a checkpoint as bytes, with a checksum: HDF5 would take longer for it than a small body
/// for a step. Of arrays that hold nearly only zeros, or nearly only ones, what differs is kept.
/// The bytes are those of the whole body whatever the number of ranks, and no rank ever has all of
/// them.
/// @param program   version that writes
/// @param numbering null: the body is whole; otherwise a call that all ranks make
/// @param put       called at rank 0
void write_checkpoint(Checkpoint checkpoint, const std::string& program, StateNumbering* numbering,
                      const PutBytes& put);

/// Where the bytes of a checkpoint are.
struct CheckpointBytes {
  std::uint64_t size = 0;
  std::function<std::string(std::uint64_t first, std::uint64_t count)> read;
};

/// What of a checkpoint is wanted.
struct WantedState {
  bool has_arrays = true;               ///< without them a path's state has numbers alone
  StateNumbering* numbering = nullptr;  ///< null: arrays are of the whole body
};

/// The checkpoint that some bytes begin with. Of a part of a body an array is left empty that is of
/// another body.
/// @param program version that reads
/// @throws BadCheckpoint: it has another layout (named with both programs), or is damaged as far as
///         that shows without its checksum
[[nodiscard]] Checkpoint read_checkpoint(const CheckpointBytes& bytes, const std::string& program,
                                         const WantedState& wanted);

/// @throws BadCheckpoint if the bytes are no checkpoint to the last bit
void require_whole(const CheckpointBytes& bytes, const std::string& program);

/// Both for bytes in memory.
[[nodiscard]] std::string encode(Checkpoint checkpoint, const std::string& program);
[[nodiscard]] Checkpoint decode(std::string_view bytes, const std::string& program);

}  // namespace peristat
