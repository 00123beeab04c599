#include "cases/runner/results/folder/results_marker.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cases/runner/process/output_file.hpp"
#include "src/core/json_object.hpp"

namespace peristat {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_marker = 1 << 16;  // bytes; ours are a hundredth of that
// The marker is read as it is written: one member per line. Whatever looks different is not ours.
constexpr const char* first_lines = "{\n  \"format\": 1,\n";

[[noreturn]] void fail(const fs::path& file, int error) {
  throw fs::filesystem_error("peristat.json", file,
                             std::error_code(error, std::generic_category()));
}

std::string read_all(int descriptor, const fs::path& file) {
  std::string text(largest_marker, '\0');
  const ssize_t size = ::pread(descriptor, text.data(), text.size(), 0);
  if (size < 0) fail(file, errno);
  text.resize(static_cast<std::size_t>(size));
  return text;
}

/// JSON text of a member that stands on a line of its own; empty if there is none.
std::string member(const std::string& text, const std::string& key) {
  const std::string start = "  \"" + key + "\": ";
  std::istringstream rows(text);
  for (std::string row; std::getline(rows, row);) {
    if (row.starts_with(start) && row.ends_with(',')) {
      return row.substr(start.size(), row.size() - start.size() - 1);
    }
  }
  return "";
}

std::string marker_text(const RunIdentity& run) {
  std::string text = first_lines;
  const auto add = [&](const std::string& key, const std::string& json) {
    text += "  \"" + key + "\": " + json + ",\n";
  };
  add("program", json_string("peristat " + run.program));
  add("title", json_string(run.title));
  add("case", json_string(run.case_file.string()));
  add("process", std::to_string(::getpid()));
  text += "  \"files\": [";
  const char* separator = "\n";
  for (const std::string& file : run.files) {
    text += separator + ("    " + json_string(file));
    separator = ",\n";
  }
  return text + "\n  ]\n}\n";
}

}  // namespace

ResultsMarker::ResultsMarker(fs::path file, int flags) : file_(std::move(file)) {
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | flags, 0666);
}

ResultsMarker::ResultsMarker(ResultsMarker&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      text_(std::move(other.text_)) {}

ResultsMarker::~ResultsMarker() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::optional<ResultsMarker> ResultsMarker::find(const fs::path& folder) {
  const fs::path file = folder / name;
  const fs::file_status status = fs::symlink_status(file);
  if (!fs::exists(status)) return std::nullopt;
  const auto foreign = [] {
    return RefusedFolder(std::string("holds a ") + name +
                         " that this program has not written; name a new or an empty folder");
  };
  if (!fs::is_regular_file(status)) throw foreign();
  ResultsMarker marker(file, 0);
  if (marker.descriptor_ < 0) fail(file, errno);
  marker.text_ = read_all(marker.descriptor_, file);
  if (::flock(marker.descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    const std::string process = member(marker.text_, "process");
    throw RefusedFolder("another run is writing to it" +
                        (process.empty() ? "" : " (process " + process + ")") +
                        "; wait for its end or name another folder");
  }  // Without locks in the file system, another run can't be detected.
  marker.text_ = read_all(marker.descriptor_, file);
  if (!marker.is_blank() && !marker.text_.starts_with(first_lines)) throw foreign();
  return marker;
}

ResultsMarker ResultsMarker::create(const fs::path& folder) {
  ResultsMarker marker(folder / name, O_CREAT | O_EXCL);
  const int error = marker.descriptor_ < 0 ? errno : 0;
  if (error == EEXIST) throw RefusedFolder("another run has just begun in it");
  if (error != 0) fail(marker.file_, error);
  if (::flock(marker.descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw RefusedFolder("another run has just begun in it");
  }
  return marker;
}

bool ResultsMarker::is_of(const fs::path& case_file) const {
  return member(text_, "case") == json_string(case_file.string());
}

std::string ResultsMarker::case_file() const {
  const std::string json = member(text_, "case");
  return json.size() > 2 ? json.substr(1, json.size() - 2) : "unknown";
}

std::vector<std::string> ResultsMarker::files() const {
  std::vector<std::string> names;
  std::istringstream rows(text_);
  for (std::string row; std::getline(rows, row);) {
    if (row.ends_with(',')) row.pop_back();
    if (!row.starts_with("    \"") || !row.ends_with('"') || row.size() < 7) continue;
    const std::string file = row.substr(5, row.size() - 6);
    const bool is_plain = file.find_first_of("/\\") == std::string::npos && file != "..";
    if (is_plain && file != "." && file != name) names.push_back(file);
  }
  return names;
}

void ResultsMarker::write(const RunIdentity& run) {
  std::string text = marker_text(run);
  const std::size_t size = text.size();
  // One write that leaves nothing of the old text: a kill finds the one or the other.
  text.resize(std::max(size, text_.size()), ' ');
  const ssize_t written = ::pwrite(descriptor_, text.data(), text.size(), 0);
  const int error = written < 0 ? errno : ENOSPC;
  if (written != static_cast<ssize_t>(text.size())) {
    throw OutputError(file_.string() + ": can't be written: " + std::strerror(error), error);
  }
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) {
    throw OutputError(file_.string() + ": can't be written: " + std::strerror(errno), errno);
  }
}

}  // namespace peristat
