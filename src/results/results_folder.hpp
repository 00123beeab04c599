#pragma once

#include <filesystem>

namespace peristat {

/// Paths of a results folder's files (docs/results.md).
struct ResultsFolder {
  std::filesystem::path directory;  ///< absolute

  [[nodiscard]] std::filesystem::path results() const { return directory / "results.h5"; }
  [[nodiscard]] std::filesystem::path xdmf() const { return directory / "results.xdmf"; }
  [[nodiscard]] std::filesystem::path history() const { return directory / "history.csv"; }
  [[nodiscard]] std::filesystem::path iterations() const { return directory / "iterations.csv"; }
  [[nodiscard]] std::filesystem::path decisions() const { return directory / "decisions.csv"; }
  [[nodiscard]] std::filesystem::path broken_bonds() const {
    return directory / "broken_bonds.csv";
  }
  [[nodiscard]] std::filesystem::path convergence() const { return directory / "convergence.csv"; }
  [[nodiscard]] std::filesystem::path dossier() const { return directory / "dossier.txt"; }
  [[nodiscard]] std::filesystem::path summary() const { return directory / "summary.json"; }
  [[nodiscard]] std::filesystem::path parts() const { return directory / "parts"; }
};

/// Makes the folder ready for a new run: creates it, or removes the files of an earlier run from it
/// (nothing else), and creates parts/.
/// @throws InputError (key "output.directory") if the folder can't be written, or holds files but
/// none
///         of an earlier run: it may be somebody's home folder
[[nodiscard]] ResultsFolder prepare_results_folder(const std::filesystem::path& directory);

/// Removes the files of parts/, and parts/ itself if nothing else is in it.
void remove_parts(const ResultsFolder& folder);

}  // namespace peristat
