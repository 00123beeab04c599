#include "src/results/results_folder.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "src/input_error.hpp"
#include "src/results/output_file.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

/// The history stands last, so that a folder whose removal was interrupted is still recognised.
std::vector<fs::path> own_files(const ResultsFolder& folder) {
  return {folder.results(),   folder.xdmf(),         folder.iterations(),
          folder.decisions(), folder.broken_bonds(), folder.convergence(),
          folder.dossier(),   folder.summary(),      folder.history()};
}

bool is_part(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t digits = name.find_first_not_of("0123456789");
  const std::string rest = name.substr(std::min(digits, name.size()));
  if (name == "points.h5" || name == "points.h5.tmp") return true;
  return digits >= 6 && (rest == ".h5" || rest == ".h5.tmp");
}

}  // namespace

void remove_parts(const ResultsFolder& folder) {
  if (!fs::is_directory(folder.parts())) return;
  std::vector<fs::path> parts;
  for (const auto& entry : fs::directory_iterator(folder.parts())) {
    if (is_part(entry.path())) parts.push_back(entry.path());
  }
  for (const fs::path& part : parts) fs::remove(part);
  if (fs::is_empty(folder.parts())) fs::remove(folder.parts());
}

ResultsFolder prepare_results_folder(const fs::path& directory) {
  const auto refuse = [&](const std::string& reason) -> InputError {
    return {"output.directory", directory.string(), reason};
  };
  if (directory.empty()) throw refuse("must name a folder");
  try {
    const ResultsFolder folder{fs::absolute(directory).lexically_normal()};
    if (fs::exists(folder.directory) && !fs::is_directory(folder.directory)) {
      throw refuse("is a file; it must be a folder, or a path where one can be created");
    }
    fs::create_directories(folder.directory);

    const std::vector<fs::path> own = own_files(folder);
    const auto exists = [](const fs::path& file) {
      return fs::exists(file) || fs::exists(temporary(file));
    };
    if (!fs::is_empty(folder.directory) && std::none_of(own.begin(), own.end(), exists)) {
      throw refuse("holds files but no results of an earlier run; name a new or an empty folder");
    }
    for (const fs::path& file : own) {
      // An empty history holds the folder's place until the new one is written.
      if (file != folder.history()) fs::remove(file);
      fs::remove(temporary(file));
    }
    write_file(folder.history(), "");
    remove_parts(folder);
    const fs::path plots = folder.directory / "plots";
    if (fs::is_directory(plots)) {
      std::vector<fs::path> pictures;
      for (const auto& entry : fs::directory_iterator(plots)) {
        if (entry.path().extension() == ".png" || entry.path().extension() == ".gif")
          pictures.push_back(entry.path());
      }
      for (const fs::path& picture : pictures) fs::remove(picture);
    }
    fs::create_directory(folder.parts());
    return folder;
  } catch (const fs::filesystem_error& error) {
    throw refuse("the folder can't be written: " + error.code().message());
  } catch (const OutputError& error) {
    throw refuse(std::string("the folder can't be written: ") + error.what());
  }
}

}  // namespace peristat
