#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/settings.hpp"
#include "cases/runner/results/checkpoint.hpp"
#include "cases/runner/results/line_table.hpp"
#include "cases/runner/results/probe_columns.hpp"
#include "cases/runner/results/results_folder.hpp"
#include "cases/runner/results/step_part.hpp"
#include "cases/runner/results/table.hpp"
#include "src/core/communicator.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// What results.h5 of a run holds up to its checkpoint.
struct EarlierResults {
  std::vector<Row> history, iterations, decisions, broken_bonds;
  ObjectInFile points;
  std::vector<WrittenStep> steps;
  std::map<std::string, std::vector<Row>> lines{};  ///< by name
};

/// A run that has left its results and a checkpoint in a folder, which nobody else writes as long
/// as this lives.
class EarlierRun {
 public:
  /// @param program version of this program
  /// @param ranks   that go on with it, all by this call
  /// @throws InputError if the folder holds no run, or none that can be gone on from:
  ///         says why. HDF5 may crash on a damaged file, so all is tried in a process of its own.
  ///         Of ranks the first one alone throws
  EarlierRun(const std::filesystem::path& directory, const std::string& program,
             const Communicator& ranks);

  [[nodiscard]] const std::filesystem::path& directory() const { return folder_.directory; }
  [[nodiscard]] const std::filesystem::path& case_file() const { return case_file_; }
  [[nodiscard]] const std::string& case_text() const { return case_text_; }
  [[nodiscard]] const Settings& settings() const { return settings_; }
  /// Without arrays before they are loaded.
  [[nodiscard]] const Checkpoint& checkpoint() const { return checkpoint_; }
  /// Reads the arrays of the checkpoint's state; a call that all ranks make.
  /// @param numbering of this rank's part; null: the body is whole
  void load(StateNumbering* numbering);
  /// Completes a state that is of this body with what terms remember that follow others.
  void find_followers(const Assembler& body);
  /// Other solvers than before begin at the top of their ladders.
  void forget_solvers() { checkpoint_.path.rungs = {}; }
  /// Whether the run has gathered its results and said how it ended.
  [[nodiscard]] bool is_concluded() const;
  /// A sentence if the newest checkpoint was lost and an older one is taken.
  [[nodiscard]] const std::string& remark() const { return remark_; }

  /// @throws InputError if something of it is damaged
  [[nodiscard]] EarlierResults results(const std::vector<std::string>& support_sets,
                                       const std::vector<ProbeColumns>& probes,
                                       const std::vector<LineTable>& lines = {}) const;
  /// Whether the run was one of these points, on this rank.
  /// @param gathering of ranks, which all make this call with the points that they own
  [[nodiscard]] bool has_points(const Points& points, const RowGathering* gathering) const;

  /// Makes the folder ready for results that link to those there are.
  /// @param earlier their files are named anew where they move
  /// @throws OutputError
  [[nodiscard]] ClaimedFolder take_over(const RunIdentity& run, EarlierResults& earlier);

 private:
  /// The state that was written last, or the one that is sure to have reached the disk.
  enum class Generation { newest, safe };

  void choose();
  /// Everything but arrays.
  void read(Generation which);
  void require_whole_checkpoint() const;
  [[nodiscard]] CheckpointBytes bytes_of_checkpoint() const;
  [[nodiscard]] EarlierResults read_results(const std::vector<std::string>& support_sets,
                                            const std::vector<ProbeColumns>& probes,
                                            const std::vector<LineTable>& lines) const;
  [[nodiscard]] InputError refusal(const std::string& reason) const;

  ResultsFolder folder_;
  std::string program_;
  const Communicator& ranks_;
  std::optional<ResultsMarker> marker_;  // of the first rank
  Generation generation_ = Generation::newest;
  std::filesystem::path checkpoint_file_;  // of a run that has parts
  std::filesystem::path results_;          // the file that is gone on from
  bool is_gathered_ = false;               // it has no parts
  std::filesystem::path case_file_;
  std::string case_text_, remark_;
  Settings settings_;
  Checkpoint checkpoint_;
};

}  // namespace peristat
