#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/settings.hpp"
#include "cases/runner/results/folder/earlier_run.hpp"
#include "cases/runner/results/parts/points_part.hpp"
#include "cases/runner/results/tables/probe_columns.hpp"
#include "cases/runner/results/tables/step_fields.hpp"
#include "cases/runner/results/tables/summary.hpp"
#include "solvers/problem/records.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Text that describes the run: the case under /case, title and versions as attributes of the file.
struct CaseText {
  std::string as_read, as_resolved;
  std::string title{};
  std::map<std::string, std::string> versions{};  ///< "peristat", "hdf5", ... -> "1.0.0"
  std::filesystem::path file{};  ///< absolute; a later run of the same file may replace this one
  Settings settings{};           ///< values given by `--set`
  std::string files{};  ///< that the case reads, and what a program gives, see checksums_of_files
  std::string preflight{};  ///< what `check` says of the body, the loads and the law
};

/// Optional output of a run.
struct FurtherOutput {
  bool has_stress = false;  ///< tensors are among the fields
  std::vector<LineTable> lines{};
  bool has_control = false;        ///< the load is found for a controlled displacement
  bool has_sensitivities = false;  ///< a file of Sensitivities belongs to the run
};

/// Writer of a results folder (docs/results.md): results.h5, results.xdmf, results.vtkhdf,
/// history.csv, load_displacement.csv, iterations.csv, decisions.csv, broken_bonds.csv,
/// summary.json, dossier.txt, and peristat.json, which it holds locked: a folder has one writer.
///
/// A kill at any moment leaves every accepted step readable: each step's fields go to a file of
/// their own, `parts/NNNNNN.h5`, and results.h5, which links to them, is published by renaming a
/// complete new file over the old one. `close` gathers the parts into one self-contained
/// results.h5. The destructor alone leaves what is published.
///
/// Every number handed in must be finite: anything else is a bug of the caller and throws
/// std::logic_error that names it, before anything is written. If later data can't be written (disk
/// full, folder gone), OutputError is thrown, a std::runtime_error that names the file and the
/// reason; what was published before stays readable.
///
/// For a distributed body all calls are collective, each rank with its own values: rank 0 writes,
/// the others send (RowGathering). Records are the same on all ranks.
class Results {
 public:
  /// Creates the folder and its files; an earlier run of the same case file is replaced, other
  /// files are left alone.
  /// @param points and counts of the points that this rank owns
  /// @param overwrite also replaces an earlier run of another case
  /// @throws InputError ("directory") if the folder can't be written or must be left
  ///         alone, see claim_results_folder; (key "probe") if a probe's name is the name of
  ///         another column
  /// @throws OutputError if the disk is full, or the like
  Results(const std::filesystem::path& directory, const Points& points, const CaseText& text,
          const std::vector<std::string>& support_sets, const std::vector<ProbeColumns>& probes,
          const std::vector<PointCounts>& counts = {}, bool overwrite = false,
          const FurtherOutput& further = {}, const RowGathering& gathering = no_gathering());
  /// Continues the results of an earlier run from its checkpoint. Later results, and files on how
  /// it ended, are dropped.
  /// @param earlier its results up to the checkpoint; names of files that move are updated
  /// @param numbering null for a whole body
  /// @throws OutputError
  Results(EarlierRun& run, EarlierResults& earlier, const Points& points, const CaseText& text,
          const std::vector<std::string>& support_sets, const std::vector<ProbeColumns>& probes,
          const FurtherOutput& further = {}, StateNumbering* numbering = nullptr);
  ~Results();
  Results(const Results&) = delete;
  Results& operator=(const Results&) = delete;

  void add(const IterationRecord& record);
  void add(const DecisionRecord& record);
  /// Adds the bonds that the step added next has broken; with several ranks, those that this rank
  /// reports.
  void add(const std::vector<BrokenBondRecord>& records);
  /// Adds rows of a line for the step added next.
  void add_line(const std::string& name, const std::vector<Row>& rows);
  /// Adds an accepted step and publishes it, together with the iterations and decisions so far.
  /// `fields` has no values for steps that only enter the history. Step numbers ascend; the record
  /// holds a reaction of every support set and every probe.
  void add(const StepRecord& record, const StepFields& fields = {});

  /// Publishes a checkpoint after the path's last step has been added; fills in its counts of rows.
  /// Now and then makes sure that all files have reached the disk, so seldom that it takes a
  /// hundredth of the time.
  /// @param numbering null for a whole body
  void add_checkpoint(Checkpoint checkpoint, StateNumbering* numbering = nullptr);

  /// Publishes the fields of the step added last, unless they were added with it: for the end of a
  /// run whose last step was one that only enters the history.
  void add_fields(const StepRecord& record, const StepFields& fields);

  /// Adds the report on a search that failed: dossier.txt, and in results.h5 its residual [N] and
  /// the displacement [m] of the state it ended in (points x dimension; with several ranks, owned
  /// points).
  void add_dossier(const std::string& text, const std::vector<double>& residual,
                   const std::vector<double>& displacement);

  /// Writes summary.json (counts and energies are taken from the last step record, sums of
  /// iterations from all) and gathers the parts. Nothing can be added afterwards. If the parts
  /// can't be gathered, summary.json says so (status "failed") and everything stays readable where
  /// it is.
  /// @throws OutputError
  void close(Summary summary);

  /// Ends a run that failed: writes summary.json, if it can be, with status "failed" and the
  /// reason, into room that was set aside at the start. Published files stay where they are.
  void fail(Summary summary, const std::string& reason) noexcept;

  /// Leaves its files open until the process ends: after a failed allocation HDF5 can't close its
  /// objects, and would end the process.
  void abandon() noexcept;

  /// Sentence on what is left of the run.
  [[nodiscard]] std::string what_is_left() const;

  [[nodiscard]] double seconds_spent() const;  ///< wall time inside this class [s]

 private:
  struct Files;
  struct Sender;
  std::unique_ptr<Files> files_;
  std::unique_ptr<Sender> sender_;  ///< in the place of files_, on all ranks but 0
};

}  // namespace peristat
