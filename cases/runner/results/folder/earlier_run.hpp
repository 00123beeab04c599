#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/settings.hpp"
#include "cases/runner/results/checkpoint/checkpoint.hpp"
#include "cases/runner/results/files/table.hpp"
#include "cases/runner/results/folder/results_folder.hpp"
#include "cases/runner/results/parts/step_part.hpp"
#include "cases/runner/results/tables/line_table.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "src/core/input_error.hpp"
#include "src/geometry/points.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// Contents of a run's results.h5 up to its checkpoint.
struct EarlierResults {
  std::vector<Row> history, iterations, decisions, broken_bonds;
  ObjectInFile points;
  std::vector<WrittenStep> steps;
  std::map<std::string, std::vector<Row>> lines{};  ///< by name
};

/// An earlier run with results and a checkpoint in a folder. Nobody else writes the folder as long
/// as this object lives.
class EarlierRun {
 public:
  /// @param program version of this program
  /// @param ranks   that resume it. Collective
  /// @throws InputError if the folder holds no run, or none that can be resumed, with the reason.
  ///         HDF5 may crash on a damaged file, so all is tried in a separate process. Only rank 0
  ///         throws
  EarlierRun(const std::filesystem::path& directory, const std::string& program,
             const Communicator& ranks);

  [[nodiscard]] const std::filesystem::path& directory() const { return folder_.directory; }
  [[nodiscard]] const std::filesystem::path& case_file() const { return case_file_; }
  [[nodiscard]] const std::string& case_text() const { return case_text_; }
  [[nodiscard]] const Settings& settings() const { return settings_; }
  /// CaseText::files; empty if there are none.
  [[nodiscard]] const std::string& files() const { return files_; }
  /// The checkpoint; its arrays are empty before load().
  [[nodiscard]] const Checkpoint& checkpoint() const { return checkpoint_; }
  /// Reads the arrays of the checkpoint's state. Collective.
  /// @param numbering of this rank's part; null for a whole body
  void load(StateNumbering* numbering);
  /// Completes the state by the parts of histories that follow from the rest, for this body.
  void find_followers(const Assembler& body);
  /// Forgets how far solvers have fallen back: changed solvers begin at the top of their chains.
  void forget_solvers() { checkpoint_.path.rungs = {}; }
  /// True if the run has gathered its results and reported how it ended.
  [[nodiscard]] bool is_concluded() const;
  /// A sentence if the newest checkpoint was lost and an older one is taken.
  [[nodiscard]] const std::string& remark() const { return remark_; }

  /// @throws InputError if a part of them is damaged
  [[nodiscard]] EarlierResults results(const std::vector<std::string>& support_sets,
                                       const std::vector<ProbeColumns>& probes,
                                       const std::vector<LineTable>& lines = {}) const;
  /// True if the run had these points, on this rank.
  /// @param gathering with several ranks: collective, each with the points that it owns
  [[nodiscard]] bool has_points(const Points& points, const RowGathering& gathering) const;

  /// Prepares the folder for results that link to the existing ones.
  /// @param earlier names of files that move are updated
  /// @throws OutputError
  [[nodiscard]] ClaimedFolder take_over(const RunIdentity& run, EarlierResults& earlier);

 private:
  /// The state that was written last, or the one that is sure to have reached the disk.
  enum class Generation { newest, safe };

  void choose();
  /// Reads everything but arrays.
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
  std::optional<ResultsMarker> marker_;  // on rank 0 only
  Generation generation_ = Generation::newest;
  std::filesystem::path checkpoint_file_;  // of a run that has parts
  std::filesystem::path results_;          // the file to resume from
  bool is_gathered_ = false;               // it has no parts
  std::filesystem::path case_file_;
  std::string case_text_, files_, remark_;
  Settings settings_;
  Checkpoint checkpoint_;
};

}  // namespace peristat
