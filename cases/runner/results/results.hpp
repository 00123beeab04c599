#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solvers/problem/records.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

/// Everything of summary.json that the step records do not hold.
struct Summary {
  std::string status;  ///< "completed", "not_converged", "inconsistent", "interrupted", "failed"
  std::string reason;  ///< sentence for a person when the status is not "completed"
  Index points = 0;
  std::int64_t free_dofs = 0;
  /// How many interactions of each kind there are; readers find these three in every run.
  std::vector<std::pair<std::string, std::int64_t>> interactions{
      {"bonds", 0}, {"triangles", 0}, {"tetrahedra", 0}};
  std::int64_t factorisations = 0, linear_iterations = 0;
  double max_displacement = 0.0;
  struct Seconds {
    double total = 0, neighbourhood = 0, assembly = 0, linear = 0, relaxation = 0, output = 0;
  } seconds;
  int threads = 1, ranks = 1;

  void count(const std::string& kind, std::int64_t interactions_of_kind);
};

/// Text that describes the run: the case under /case, title and versions as attributes of the file.
struct CaseText {
  std::string as_read, as_resolved;
  std::string title{};
  std::map<std::string, std::string> versions{};  ///< "peristat", "hdf5", ... -> "1.0.0"
  std::filesystem::path file{};  ///< absolute; a later run of the same file may replace this one
};

/// Numbers of every point that do not change, e.g. counts of neighbours.
struct PointCounts {
  std::string name;  ///< of the dataset in /points
  std::string description;
  std::vector<std::int32_t> values;
};

/// Columns that a probe adds to the history: NAME for one component, NAME_x, NAME_y, NAME_z for
/// more.
struct ProbeColumns {
  std::string name;
  int components = 1;
  std::string unit = "1";  ///< of the probed field
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
class Results {
 public:
  /// Creates the folder and its files; an earlier run of the same case file is replaced, other
  /// files are left alone.
  /// @param overwrite also an earlier run of another case is replaced
  /// @throws InputError ("directory") if the folder can't be written or must be left
  ///         alone, see claim_results_folder; (key "probe") if a probe's name is the name of
  ///         another column
  /// @throws OutputError if the disk is full, or the like
  Results(const std::filesystem::path& directory, const Points& points, const CaseText& text,
          const std::vector<std::string>& support_sets, const std::vector<ProbeColumns>& probes,
          const std::vector<PointCounts>& counts = {}, bool overwrite = false);
  ~Results();
  Results(const Results&) = delete;
  Results& operator=(const Results&) = delete;

  void add(const IterationRecord& record);
  void add(const DecisionRecord& record);
  /// Bonds that the step added next has broken.
  void add(const std::vector<BrokenBondRecord>& records);
  /// Adds an accepted step and publishes it, together with the iterations and decisions so far.
  /// `fields` is empty for steps that only enter the history. Step numbers ascend; the record holds
  /// a reaction of every support set and every probe.
  void add(const StepRecord& record, const std::optional<StepFields>& fields);

  /// Publishes the fields of the step added last, unless they were added with it: for the end of a
  /// run whose last step was one that only enters the history.
  void add_fields(const StepRecord& record, const StepFields& fields);

  /// Adds what is known of a search that failed: dossier.txt, and in results.h5 its residual [N]
  /// and the displacement [m] of the state it ended in (points x dimension).
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
  std::unique_ptr<Files> files_;
};

}  // namespace peristat
