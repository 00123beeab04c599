#pragma once

#include <filesystem>
#include <string>

#include "cases/runner/results/folder/results_marker.hpp"

namespace peristat {

/// Paths of a results folder's files (docs/results.md).
struct ResultsFolder {
  std::filesystem::path directory;  ///< absolute

  [[nodiscard]] std::filesystem::path results() const { return directory / "results.h5"; }
  [[nodiscard]] std::filesystem::path xdmf() const { return directory / "results.xdmf"; }
  [[nodiscard]] std::filesystem::path vtk_hdf() const { return directory / "results.vtkhdf"; }
  [[nodiscard]] std::filesystem::path history() const { return directory / "history.csv"; }
  [[nodiscard]] std::filesystem::path load_displacement() const {
    return directory / "load_displacement.csv";
  }
  [[nodiscard]] std::filesystem::path iterations() const { return directory / "iterations.csv"; }
  [[nodiscard]] std::filesystem::path decisions() const { return directory / "decisions.csv"; }
  [[nodiscard]] std::filesystem::path broken_bonds() const {
    return directory / "broken_bonds.csv";
  }
  [[nodiscard]] std::filesystem::path convergence() const { return directory / "convergence.csv"; }
  [[nodiscard]] std::filesystem::path dossier() const { return directory / "dossier.txt"; }
  [[nodiscard]] std::filesystem::path summary() const { return directory / "summary.json"; }
  [[nodiscard]] std::filesystem::path parts() const { return directory / "parts"; }
  [[nodiscard]] std::filesystem::path points() const { return parts() / "points.h5"; }
  /// results.h5 of an earlier session of the run.
  [[nodiscard]] std::filesystem::path earlier() const { return parts() / "earlier.h5"; }
  /// results.h5 and checkpoint as they last were known to be on the disk.
  [[nodiscard]] std::filesystem::path safe_results() const { return parts() / "safe_results.h5"; }
  [[nodiscard]] std::filesystem::path safe_checkpoint() const {
    return parts() / "safe_checkpoint";
  }
  [[nodiscard]] std::filesystem::path plots() const { return directory / "plots"; }

  /// In plots/: names of the pictures that the plot command has drawn there, one per line.
  static constexpr const char* picture_list = ".pictures";

  /// What the report command writes, with a sign in its second line.
  [[nodiscard]] std::filesystem::path page() const { return directory / "report.html"; }
  static constexpr const char* sign_of_page = "<!-- made by peristat report -->";
};

/// Table of the values along a line, in the results folder.
[[nodiscard]] inline std::string file_of_line(const std::string& name) {
  return "line_" + name + ".csv";
}

/// True if a path is the folder or leads into it; both resolved.
[[nodiscard]] bool is_below(const std::filesystem::path& path, const std::filesystem::path& folder);

/// True if a run that writes the folder may put a file of its own in the place of this one; both
/// resolved.
[[nodiscard]] bool is_name_of_results(const std::filesystem::path& file,
                                      const std::filesystem::path& folder);

/// A results folder that this run alone writes, as long as the marker lives.
struct ClaimedFolder {
  ResultsFolder paths;
  ResultsMarker marker;
};

/// Makes the folder ready for a new run: creates it, or removes the files of an earlier run of the
/// same case from it, and creates parts/. The marker lists the files of the earlier run,
/// plots/.pictures its pictures, a page has its sign; nothing else is removed, and no link is
/// followed below the folder.
/// @param run   its list of files holds additional ones, and is completed
/// @param overwrite also removes an earlier run of another case, or of version 1, which left no
///        marker
/// @throws InputError ("directory") before anything is changed: the folder can't be
///         written, holds files but no earlier run (it may be somebody's home folder), an earlier
///         run of another case, or links in place of our folders, or another run is writing it
/// @throws OutputError if the disk is full, or the like
[[nodiscard]] ClaimedFolder claim_results_folder(const std::filesystem::path& directory,
                                                 RunIdentity run, bool overwrite);

/// Prepares the folder of an earlier run for resuming: its tables, fields and pictures stay; files
/// on how it ended, and a page, are removed.
/// @param marker of the folder
/// @throws OutputError
void go_on_in_results_folder(const ResultsFolder& folder, ResultsMarker& marker, RunIdentity run);

/// Removes the files of parts/, and parts/ itself if nothing else is in it.
void remove_parts(const ResultsFolder& folder);

}  // namespace peristat
