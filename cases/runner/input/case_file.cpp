#include "cases/runner/input/case_file.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <vector>

#include "cases/runner/input/toml_table.hpp"
#include "src/core/input_error.hpp"
#include "src/core/nearest_name.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_size = 16u << 20;  // bytes; a megabyte is a huge case file
constexpr std::size_t most_candidates = 10'000;

template <class Iterator>
void collect_case_files(const fs::path& folder, std::vector<std::string>& files) {
  std::error_code error;
  for (Iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
       !error && entry != end && files.size() < most_candidates; entry.increment(error)) {
    if (entry->path().extension() == ".toml")
      files.push_back(entry->path().lexically_normal().string());
  }
}

/// A case file that the person may have meant, or nothing.
std::string similar_case_file(const fs::path& file) {
  std::vector<std::string> files;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  collect_case_files<fs::directory_iterator>(folder, files);
  collect_case_files<fs::recursive_directory_iterator>("cases", files);

  // a missing ending, then a slip in the path, then the right name in the wrong folder
  const std::string path = file.lexically_normal().string();
  for (const auto& candidate : files)
    if (candidate == path + ".toml") return candidate;
  const std::string near_path = nearest_name(path, files);
  if (!near_path.empty()) return near_path;
  std::vector<std::string> names;
  for (const auto& candidate : files) names.push_back(fs::path(candidate).stem().string());
  const std::string near_name = nearest_name(file.stem().string(), names);
  for (std::size_t k = 0; k < files.size(); ++k)
    if (!near_name.empty() && names[k] == near_name) return files[k];
  return {};
}

/// The case files of a folder, for a person who named the folder.
std::string case_files_in(const fs::path& folder) {
  std::vector<std::string> files;
  collect_case_files<fs::directory_iterator>(folder, files);
  return files.empty() ? "" : "; it holds " + listed(files);
}

}  // namespace

std::string read_case_text(const fs::path& file) {
  const auto refuse = [&](const std::string& why) { throw InputError("", file.string(), why); };
  if (file.empty()) refuse("the name of the case file is empty");

  std::error_code error;
  const auto status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) {
    const std::string similar = similar_case_file(file);
    refuse("no such case file" + (similar.empty() ? "" : "; did you mean " + similar + "?"));
  }
  if (error) refuse("the case file can't be read: " + error.message());
  if (fs::is_directory(status)) refuse("is a folder, not a case file" + case_files_in(file));
  // a device or a pipe might never end
  if (!fs::is_regular_file(status)) refuse("is not a regular file");
  if (fs::file_size(file, error) > largest_size || error)
    refuse("is larger than 16 MiB, so it is not a case file");

  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.is_open() || in.bad())
    refuse("the case file can't be read: " + std::generic_category().message(errno));
  return text;
}

}  // namespace peristat
