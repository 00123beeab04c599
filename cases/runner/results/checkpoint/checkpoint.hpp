#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cases/runner/results/checkpoint/state_numbering.hpp"
#include "cases/runner/results/tables/run_costs.hpp"
#include "solvers/drivers/path_state.hpp"

namespace peristat {

/// Version of the layout of checkpoints, which other programs can't read. It grows with every
/// change of their contents or format.
inline constexpr std::int64_t checkpoint_layout = 14;

/// Numbers of rows of the tables of results.h5.
struct TableRows {
  int history = 0, iterations = 0, decisions = 0, broken_bonds = 0;
};

/// State that a run is resumed from.
struct Checkpoint {
  PathState path;
  TableRows rows;
  static constexpr int none = -1;
  int last_with_fields = none;  ///< number of the last step that has fields
  /// Data for the fields of the last step, if they are not written yet.
  struct Unwritten {
    std::vector<double> told_stretches;  ///< histories of bonds as last written with fields
    std::vector<double> force;           ///< internal force [N]
  } unwritten;
  RunCosts costs;  ///< so far
};

/// Thrown for a checkpoint that can't be used. The message is part of a sentence: "is damaged: …".
class BadCheckpoint : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Takes the bytes of a checkpoint, part after part.
using PutBytes = std::function<void(std::string_view)>;

/// Writes a checkpoint as bytes, with a checksum: HDF5 would take longer for it than a small body
/// for a step. Arrays of nearly only zeros, or nearly only ones, store the values that differ. The
/// bytes are those of the whole body whatever the number of ranks, and no rank ever has all of
/// them.
/// @param program   version that writes
/// @param numbering null for a whole body; otherwise collective
/// @param put       called at rank 0
void write_checkpoint(Checkpoint checkpoint, const std::string& program, StateNumbering* numbering,
                      const PutBytes& put);

/// Access to the bytes of a checkpoint.
struct CheckpointBytes {
  std::uint64_t size = 0;
  std::function<std::string(std::uint64_t first, std::uint64_t count)> read;
};

/// Parts of a checkpoint to read.
struct WantedState {
  bool has_arrays = true;               ///< false: arrays of the state stay empty
  StateNumbering* numbering = nullptr;  ///< null: arrays of the whole body
};

/// Reads the checkpoint that some bytes begin with. For a part of a body, arrays whose size is that
/// of another body are left empty.
/// @param program version that reads
/// @throws BadCheckpoint if it has another layout (named with both programs), or is damaged as far
///         as that shows without its checksum
[[nodiscard]] Checkpoint read_checkpoint(const CheckpointBytes& bytes, const std::string& program,
                                         const WantedState& wanted);

/// @throws BadCheckpoint if the bytes are not a checkpoint to the last bit
void require_whole(const CheckpointBytes& bytes, const std::string& program);

/// Write and read a checkpoint in memory.
[[nodiscard]] std::string encode(Checkpoint checkpoint, const std::string& program);
[[nodiscard]] Checkpoint decode(std::string_view bytes, const std::string& program);

}  // namespace peristat
