#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace peristat {

/// Thrown for a results folder that a run must leave alone; the message says why and what to do.
class RefusedFolder : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Identity of a run, as written in its folder.
struct RunIdentity {
  std::string program;              ///< version
  std::string title;                ///< of the case
  std::filesystem::path case_file;  ///< absolute; runs of the same file replace each other
  std::vector<std::string> files;   ///< names in the folder that are the run's own
};

/// peristat.json, the file that makes a folder a results folder: whose run it holds, and which
/// files are that run's. The run that writes the folder holds the file locked; the kernel unlocks
/// it when the process ends, however it does. It is never replaced, so that all see the same lock.
class ResultsMarker {
 public:
  static constexpr const char* name = "peristat.json";

  /// The marker of a folder, locked; none if there is none.
  /// @throws RefusedFolder if another run holds it, or if it is no file of this program
  /// @throws std::filesystem::filesystem_error
  [[nodiscard]] static std::optional<ResultsMarker> find(const std::filesystem::path& folder);
  /// A new, blank marker, locked.
  /// @throws as `find`
  [[nodiscard]] static ResultsMarker create(const std::filesystem::path& folder);

  ResultsMarker(ResultsMarker&& other) noexcept;
  ResultsMarker& operator=(ResultsMarker&&) = delete;
  ~ResultsMarker();

  /// True if it is empty: its run was killed before it had touched anything.
  [[nodiscard]] bool is_blank() const { return text_.empty(); }
  /// True if the earlier run is one of this case file.
  [[nodiscard]] bool is_of(const std::filesystem::path& case_file) const;
  /// Case file of the earlier run, for a person.
  [[nodiscard]] std::string case_file() const;
  /// Names of the earlier run's files; never a path that leads elsewhere.
  [[nodiscard]] std::vector<std::string> files() const;

  /// Writes the run that owns the folder from now on.
  /// @throws OutputError
  void write(const RunIdentity& run);

 private:
  ResultsMarker(std::filesystem::path file, int flags);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::string text_;  // as it was read
};

}  // namespace peristat
