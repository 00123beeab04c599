#include "cases/runner/results/folder/results_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>
#include <vector>

#include "cases/runner/process/output_file.hpp"
#include "cases/runner/results/checkpoint/checkpoint_files.hpp"
#include "cases/runner/results/files/hdf5_file.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

/// Files of the folder itself, in all versions so far.
const std::vector<std::string> own_files{
    "results.h5",    "results.xdmf",          "history.csv",     "iterations.csv",
    "decisions.csv", "broken_bonds.csv",      "convergence.csv", "dossier.txt",
    "summary.json",  "load_displacement.csv", "results.vtkhdf"};

/// Pictures of version 1, which kept no list of them.
const std::vector<std::string> pictures_of_version_1{
    "deformed.png",     "fields.png",   "lateral.png", "middle_plane.png",      "damage.png",
    "broken_bonds.png", "sequence.png", "crack.gif",   "load_displacement.png", "energies.png",
    "convergence.png"};

bool is_real_folder(const fs::path& path) { return fs::is_directory(fs::symlink_status(path)); }

bool is_part(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t digits = name.find_first_not_of("0123456789");
  const std::string rest = name.substr(std::min(digits, name.size()));
  for (const char* part :
       {"points.h5", "dossier.h5", "earlier.h5", "safe_results.h5", "safe_checkpoint",
        CheckpointFiles::names[0], CheckpointFiles::names[1]}) {
    if (name == part || name == part + std::string(".tmp")) return true;
  }
  return digits >= 6 && (rest == ".h5" || rest == ".h5.tmp");
}

/// True if results.h5 was written by this program: the only sign that version 1 left.
bool has_own_results(const ResultsFolder& folder) {
  if (!fs::is_regular_file(fs::symlink_status(folder.results()))) return false;
  try {
    return Hdf5File::open_for_reading(folder.results()).has_attribute("/", "peristat_version");
  } catch (const std::runtime_error&) {
    return false;
  }
}

bool holds_files(const fs::path& directory) {
  return std::any_of(
      fs::directory_iterator(directory), fs::directory_iterator(),
      [](const auto& entry) { return entry.path().filename() != ResultsMarker::name; });
}

/// Names of what an earlier run has left.
struct Leftovers {
  std::vector<std::string> files, pictures;
};

Leftovers leftovers_without_marker(const ResultsFolder& folder, bool overwrite) {
  if (!holds_files(folder.directory)) return {};
  if (!has_own_results(folder)) {
    throw RefusedFolder(
        "holds files but no results of an earlier run; name a new or an empty folder");
  }
  if (!overwrite) {
    throw RefusedFolder(
        "holds results of version 1, which did not mark its files; replace them with --overwrite, "
        "or name a new or an empty folder");
  }
  return {own_files, pictures_of_version_1};
}

/// Names that plots/.pictures lists.
std::vector<std::string> listed_pictures(const ResultsFolder& folder) {
  std::vector<std::string> pictures;
  const fs::path list = folder.plots() / ResultsFolder::picture_list;
  if (!is_real_folder(folder.plots()) || !fs::is_regular_file(fs::symlink_status(list))) return {};
  std::ifstream rows(list);
  for (std::string row; std::getline(rows, row);) {
    if (!row.empty() && row != "." && row != ".." && row.find('/') == std::string::npos) {
      pictures.push_back(row);
    }
  }
  pictures.emplace_back(ResultsFolder::picture_list);
  return pictures;
}

Leftovers leftovers(const ResultsFolder& folder, const ResultsMarker* earlier,
                    const fs::path& case_file, bool overwrite) {
  if (!earlier || earlier->is_blank()) return leftovers_without_marker(folder, overwrite);
  if (!overwrite && !earlier->is_of(case_file)) {
    throw RefusedFolder("holds the results of another case (" + earlier->case_file() +
                        "); name another folder, or replace them with --overwrite");
  }
  return {earlier->files(), listed_pictures(folder)};
}

/// Refuses links out of the folder, and entries of the wrong type.
void require_plain(const ResultsFolder& folder, const Leftovers& old) {
  for (const fs::path& path : {folder.parts(), folder.plots()}) {
    if (fs::exists(fs::symlink_status(path)) && !is_real_folder(path)) {
      throw RefusedFolder(
          path.filename().string() +
          " in it is a link or a file instead of a folder; remove it or name another folder");
    }
  }
  for (const std::string& name : old.files) {
    if (is_real_folder(folder.directory / name)) {
      throw RefusedFolder(name + " in it is a folder; remove it or name another folder");
    }
  }
}

/// Refuses files that have the name of one of the run's own and are not of an earlier run.
void require_no_foreign(const ResultsFolder& folder, const Leftovers& old,
                        const std::vector<std::string>& own) {
  for (const std::string& name : own) {
    const bool is_left = std::find(old.files.begin(), old.files.end(), name) != old.files.end();
    if (!is_left && fs::exists(fs::symlink_status(folder.directory / name))) {
      throw RefusedFolder("holds a " + name +
                          " that no earlier run has written, but this run would write a file of "
                          "that name; move it or name another folder");
    }
  }
}

/// Removes the page of an earlier run, which would show other results than the folder holds.
void remove_page(const ResultsFolder& folder) {
  if (!fs::is_regular_file(fs::symlink_status(folder.page()))) return;
  std::string head(200, '\0');
  std::ifstream(folder.page()).read(head.data(), std::streamsize(head.size()));
  std::error_code ignored;
  if (head.find(ResultsFolder::sign_of_page) != std::string::npos) {
    fs::remove(folder.page(), ignored);
  }
}

void remove(const ResultsFolder& folder, const Leftovers& old) {
  remove_page(folder);
  for (const std::string& name : old.files) {
    const fs::path file = folder.directory / name;
    fs::remove(file);
    fs::remove(temporary(file));
  }
  remove_parts(folder);
  if (!is_real_folder(folder.plots())) return;
  for (const std::string& name : old.pictures) {
    const fs::path picture = folder.plots() / name;
    if (!is_real_folder(picture)) fs::remove(picture);
  }
}

ClaimedFolder claim(const fs::path& directory, RunIdentity run, bool overwrite) {
  const ResultsFolder folder{fs::absolute(directory).lexically_normal()};
  if (fs::exists(folder.directory) && !fs::is_directory(folder.directory)) {
    throw RefusedFolder("is a file; it must be a folder, or a path where one can be created");
  }
  fs::create_directories(folder.directory);
  std::optional<ResultsMarker> earlier = ResultsMarker::find(folder.directory);
  const Leftovers old = leftovers(folder, earlier ? &*earlier : nullptr, run.case_file, overwrite);
  require_plain(folder, old);
  run.files.insert(run.files.end(), own_files.begin(), own_files.end());
  require_no_foreign(folder, old, run.files);
  ResultsMarker marker = earlier ? std::move(*earlier) : ResultsMarker::create(folder.directory);
  remove(folder, old);
  marker.write(run);
  fs::create_directory(folder.parts());
  return {folder, std::move(marker)};
}

}  // namespace

bool is_below(const fs::path& path, const fs::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

bool is_name_of_results(const fs::path& file, const fs::path& folder) {
  if (is_below(file, folder / "parts") || is_below(file, folder / "plots")) return true;
  if (file.parent_path() != folder) return false;
  const std::string name = file.filename().string();
  return name == ResultsMarker::name || (name.starts_with("line_") && name.ends_with(".csv")) ||
         std::any_of(own_files.begin(), own_files.end(), [&](const std::string& own) {
           return name == own || name == temporary(own).string();
         });
}

void go_on_in_results_folder(const ResultsFolder& folder, ResultsMarker& marker, RunIdentity run) {
  run.files.insert(run.files.end(), own_files.begin(), own_files.end());
  marker.write(run);
  remove_page(folder);
  std::error_code ignored;  // files that can't be removed are overwritten at the end
  for (const fs::path& file : {folder.summary(), folder.dossier(), folder.convergence()}) {
    fs::remove(file, ignored);
  }
}

void remove_parts(const ResultsFolder& folder) {
  if (!is_real_folder(folder.parts())) return;
  std::vector<fs::path> parts;
  for (const auto& entry : fs::directory_iterator(folder.parts())) {
    if (is_part(entry.path())) parts.push_back(entry.path());
  }
  for (const fs::path& part : parts) fs::remove(part);
  if (fs::is_empty(folder.parts())) fs::remove(folder.parts());
}

ClaimedFolder claim_results_folder(const fs::path& directory, RunIdentity run, bool overwrite) {
  const auto refusal = [&](const std::string& reason) {
    return InputError("directory", directory.string(), reason);
  };
  const auto unwritable = [&](const std::string& what, int cause) {
    if (is_about_means(cause)) throw OutputError(what, cause);
    return refusal("the folder can't be written: " + what);
  };
  if (directory.empty()) throw refusal("must name a folder");
  try {
    return claim(directory, std::move(run), overwrite);
  } catch (const RefusedFolder& error) {
    throw refusal(error.what());
  } catch (const fs::filesystem_error& error) {
    const std::string path = error.path1().empty() ? directory.string() : error.path1().string();
    throw unwritable(path + ": " + error.code().message(), error.code().value());
  } catch (const OutputError& error) {
    throw unwritable(error.what(), error.cause());
  }
}

}  // namespace peristat
