#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cases/runner/results/files/hdf5_file.hpp"
#include "cases/runner/results/files/point_rows.hpp"
#include "cases/runner/results/files/xdmf_series.hpp"
#include "cases/runner/results/tables/step_fields.hpp"

namespace peristat {

/// Shape of the fields of all steps.
struct StepShape {
  Index points = 0;
  int dimension = 0;
  bool has_tensors = false;

  /// True if vectors need views of three components (see XdmfSeries), or tensors of nine.
  [[nodiscard]] bool has_views() const { return dimension < 3 || has_tensors; }
};

/// A step whose fields are written, and where.
struct WrittenStep {
  int step = 0;
  double load_factor = 0.0;
  std::string mode;
  std::string file;                 ///< relative to the results folder
  std::string group, views;         ///< in it; `views` may be empty in 3D
  std::vector<std::string> fields;  ///< names

  /// "000001"
  [[nodiscard]] std::string name() const;
};

/// Fields of a step that are ready to be written.
class StepPart {
 public:
  /// @param fields outlive it
  /// Collective: rank 0 writes, all others send the fields of the points that they own.
  /// @throws std::logic_error that names a field of the wrong size, or with values that are not
  ///         finite
  StepPart(StepShape shape, const StepFields& fields,
           const RowGathering& gathering = no_gathering());

  [[nodiscard]] bool is_empty() const { return names_.empty(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Number of bytes of the values that are written.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Writes the groups `step.group` and, where there are views, `step.views`.
  void write(Hdf5File& file, const WrittenStep& step) const;
  void send() const;

 private:
  void write_rows(const RowSink& sink, const std::string& group) const;

  StepShape shape_;
  const StepFields& fields_;
  const RowGathering& gathering_;
  std::vector<std::string> names_;
  std::uint64_t changed_bonds_ = 0;  // whose histories are written, on all ranks
  bool have_images_ = false;         // any rank has values of `second_image`
};

/// Names of the fields that a step's group holds.
[[nodiscard]] std::vector<std::string> field_names(const Hdf5File& file, const std::string& group);

/// Writes views of the vectors and tensors of the step in `group` as the group `views`.
void write_views(Hdf5File& file, const std::string& views, const std::string& group,
                 const std::vector<std::string>& fields, StepShape shape);

/// Fields of a step in results.xdmf.
[[nodiscard]] std::vector<XdmfSeries::Field> shown_fields(const WrittenStep& step, StepShape shape);

}  // namespace peristat
