#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/points/points.hpp"
#include "src/results/history.hpp"

namespace peristat {

/// Everything of summary.json that the step records do not hold.
struct Summary {
  std::string status;  ///< "completed", "not_converged", "interrupted"
  std::string reason;  ///< sentence for a person when the status is not "completed"
  Index points = 0;
  std::int64_t free_dofs = 0, bonds = 0, triangles = 0, tetrahedra = 0;
  std::int64_t factorisations = 0, linear_iterations = 0;
  double max_displacement = 0.0;
  struct Seconds {
    double total = 0, neighbourhood = 0, assembly = 0, linear = 0, relaxation = 0, output = 0;
  } seconds;
  int threads = 1, ranks = 1;
};

/// Text that describes the run, stored under /case.
struct CaseText {
  std::string as_read, as_resolved;
};

/// Writer of a results folder (docs/results.md): results.h5, results.xdmf, history.csv,
/// iterations.csv, decisions.csv, summary.json.
///
/// A kill at any moment leaves every accepted step readable: each step's fields go to a file of their
/// own, `parts/NNNNNN.h5`, and results.h5, which links to them, is published by renaming a complete
/// new file over the old one. `close` gathers the parts into one self-contained results.h5.
class Results {
 public:
  /// Creates the folder and its files; a results folder of an earlier run is replaced, other files
  /// are left alone.
  /// @throws InputError (key "output.directory") if the folder can't be written
  Results(const std::filesystem::path& directory, const Points& points, const CaseText& text,
          const std::vector<std::string>& support_sets,
          const std::vector<std::pair<std::string, int>>& probes);  // name, number of components
  ~Results();
  Results(const Results&) = delete;
  Results& operator=(const Results&) = delete;

  void add(const IterationRecord& record);
  void add(const DecisionRecord& record);
  /// Adds an accepted step and publishes it, together with the iterations and decisions so far.
  /// `fields` is empty for steps that only enter the history.
  void add(const StepRecord& record, const std::optional<StepFields>& fields);

  /// Writes summary.json (counts and energies are taken from the last step record, sums of
  /// iterations from all) and gathers the parts. Nothing can be added afterwards.
  void close(Summary summary);

  [[nodiscard]] double seconds_spent() const;  ///< wall time inside this class [s]

 private:
  struct Files;
  std::unique_ptr<Files> files_;
};

}  // namespace peristat
