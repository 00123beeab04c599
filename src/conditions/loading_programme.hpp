#pragma once

#include <array>
#include <string>
#include <vector>

namespace peristat {

/// A load parameter over time: pairs of a time [s] and the value then, linear in between.
using TimeTable = std::vector<std::array<double, 2>>;

/// The load parameters `load`, `load2`, … along a path. Each has a table of values. The *stage*
/// runs from 0 over 1, 2, … and counts the tables' entries; between two entries a parameter varies
/// linearly. Without tables there is one parameter, the load factor, which equals the stage and
/// goes from 0 to 1. In a programme of time the stage is the time `t`, the first parameter, and
/// load parameters are given over time.
class LoadingProgramme {
 public:
  static constexpr std::size_t most_parameters = 4;
  /// A remainder of the stage below this is round-off of the sum of steps.
  static constexpr double tolerance = 1e-9;

  LoadingProgramme() : LoadingProgramme({{0.0, 1.0}}) {}
  /// @param tables of `load`, `load2`, …
  /// @throws InputError ("programme[k]", k from 0) if there is none or too many, or if one does not
  ///         begin with 0, has fewer than two entries, another number of them than the first, or
  ///         one that is not finite
  explicit LoadingProgramme(std::vector<std::vector<double>> tables);

  /// Programme with the parameter `t`, the time, which is also the stage [s].
  /// @param loads tables of `load`, `load2`, …
  /// @throws InputError ("end_time") unless the end is positive and finite; ("programme[k]") for
  ///         too many tables, and one whose times do not ascend from 0 to the end
  [[nodiscard]] static LoadingProgramme of_time(double end, std::vector<TimeTable> loads = {});

  /// Names of so many parameters: "load", "load2", …
  [[nodiscard]] static std::vector<std::string> names(std::size_t parameters);
  /// Names of this programme's parameters.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool is_of_time() const { return end_time_ > 0.0; }

  [[nodiscard]] std::size_t parameters() const { return tables_.size(); }
  [[nodiscard]] const std::vector<std::vector<double>>& tables() const { return tables_; }
  [[nodiscard]] const std::vector<TimeTable>& loads_over_time() const { return over_time_; }

  /// Values of the parameters.
  [[nodiscard]] std::vector<double> at(double stage) const;

  /// The stage of the last entry.
  [[nodiscard]] double end() const {
    return is_of_time() ? end_time_ : static_cast<double>(tables_.front().size() - 1);
  }
  [[nodiscard]] bool has_rest(double stage) const {
    return is_of_time() ? stage < end_time_ : end() - stage > tolerance;
  }
  /// True if a parameter is larger in size than at any stage before, or in a programme of time.
  [[nodiscard]] bool is_at_new_load(double stage) const;
  /// Stage of the first entry after a stage.
  [[nodiscard]] static double next_entry(double stage);

 private:
  std::vector<std::vector<double>> tables_;
  double end_time_ = 0.0;             // of a programme of time [s]
  std::vector<TimeTable> over_time_;  // likewise
};

}  // namespace peristat
