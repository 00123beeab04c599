#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/settings.hpp"
#include "cases/runner/results/earlier_run.hpp"
#include "cases/runner/results/points_part.hpp"
#include "cases/runner/results/probe_columns.hpp"
#include "cases/runner/results/summary.hpp"
#include "solvers/problem/records.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Text that describes the run: the case under /case, title and versions as attributes of the file.
struct CaseText {
  std::string as_read, as_resolved;
  std::string title{};
  std::map<std::string, std::string> versions{};  ///< "peristat", "hdf5", ... -> "1.0.0"
  std::filesystem::path file{};  ///< absolute; a later run of the same file may replace this one
  Settings settings{};           ///< what `--set` has given
};

/// What a run writes beside what every run does.
struct FurtherOutput {
  bool has_stress = false;  ///< tensors are among the fields
  std::vector<LineTable> lines{};
};

/// Writer of a results folder (docs/results.md): results.h5, results.xdmf, history.csv,
/// iterations.csv, decisions.csv, broken_bonds.csv, summary.json, dossier.txt, and peristat.json,
/// which it holds locked: a folder has one writer.
///
/// A kill at any moment leaves every accepted step readable: each step's fields go to a file of
/// their own, `parts/NNNNNN.h5`, and results.h5, which links to them, is published by renaming a
/// complete new file over the old one. `close` gathers the parts into one self-contained
/// results.h5. The destructor alone leaves what is published.
///
/// Every number handed in is finite: anything else is a bug of the caller and throws
/// std::logic_error that names it, before anything is written. What can't be written later (disk
/// full, folder gone) throws OutputError, a std::runtime_error that names the file and the reason;
/// what was published before stays readable.
///
/// Of a body that ranks have parts of, all make the same calls with what is theirs: rank 0 writes,
/// the others send (RowGathering). Records are the same on all ranks.
class Results {
 public:
  /// Creates the folder and its files; an earlier run of the same case file is replaced, other
  /// files are left alone.
  /// @param points and counts of all points, or with `gathering` of those that the rank owns
  /// @param gathering null: the body is whole
  /// @param overwrite also an earlier run of another case is replaced
  /// @throws InputError ("directory") if the folder can't be written or must be left
  ///         alone, see claim_results_folder; (key "probe") if a probe's name is the name of
  ///         another column
  /// @throws OutputError if the disk is full, or the like
  Results(const std::filesystem::path& directory, const Points& points, const CaseText& text,
          const std::vector<std::string>& support_sets, const std::vector<ProbeColumns>& probes,
          const std::vector<PointCounts>& counts = {}, bool overwrite = false,
          const FurtherOutput& further = {}, const RowGathering* gathering = nullptr);
  /// Goes on with the results of an earlier run from its checkpoint. What it holds beyond that, and
  /// what tells how it ended, is dropped.
  /// @param earlier what it holds up to there; its files are named anew where they move
  /// @param numbering null: the body is whole
  /// @throws OutputError
  Results(EarlierRun& run, EarlierResults& earlier, const Points& points, const CaseText& text,
          const std::vector<std::string>& support_sets, const std::vector<ProbeColumns>& probes,
          const FurtherOutput& further = {}, StateNumbering* numbering = nullptr);
  ~Results();
  Results(const Results&) = delete;
  Results& operator=(const Results&) = delete;

  void add(const IterationRecord& record);
  void add(const DecisionRecord& record);
  /// Bonds that the step added next has broken; of ranks those that are told here.
  void add(const std::vector<BrokenBondRecord>& records);
  /// Rows of a line of the step added next.
  void add_line(const std::string& name, const std::vector<Row>& rows);
  /// Adds an accepted step and publishes it, together with the iterations and decisions so far.
  /// `fields` is empty for steps that only enter the history. Step numbers ascend; the record holds
  /// a reaction of every support set and every probe.
  void add(const StepRecord& record, const std::optional<StepFields>& fields);

  /// Publishes what a run can go on from, once it has added the path's last step; its rows are
  /// counted here. Now and then it sees to it that all this has reached the disk, as seldom as that
  /// takes a hundredth of the time.
  /// @param numbering null: the body is whole
  void add_checkpoint(Checkpoint checkpoint, StateNumbering* numbering = nullptr);

  /// Publishes the fields of the step added last, unless they were added with it: for the end of a
  /// run whose last step was one that only enters the history.
  void add_fields(const StepRecord& record, const StepFields& fields);

  /// Adds what is known of a search that failed: dossier.txt, and in results.h5 its residual [N]
  /// and the displacement [m] of the state it ended in (points x dimension, on ranks of those that
  /// are owned).
  void add_dossier(const std::string& text, const std::vector<double>& residual,
                   const std::vector<double>& displacement);

  /// Writes summary.json (counts and energies are taken from the last step record, sums of
  /// iterations from all) and gathers the parts. Nothing can be added afterwards. If the parts
  /// can't be gathered, summary.json tells it (status "failed") and everything stays readable where
  /// it is.
  /// @throws OutputError
  void close(Summary summary);

  /// Ends a run that failed: writes summary.json, if it can be, with status "failed" and the
  /// reason, into room that was set aside at the start. What was published stays where it is.
  void fail(Summary summary, const std::string& reason) noexcept;

  /// What a person finds of the run, in a sentence.
  [[nodiscard]] std::string what_is_left() const;

  [[nodiscard]] double seconds_spent() const;  ///< wall time inside this class [s]

 private:
  struct Files;
  struct Sender;
  std::unique_ptr<Files> files_;
  std::unique_ptr<Sender> sender_;  ///< in the place of files, on ranks after the first one
};

}  // namespace peristat
