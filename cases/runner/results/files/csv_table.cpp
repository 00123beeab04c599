#include "cases/runner/results/files/csv_table.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>

#include "cases/runner/process/output_file.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

std::string cell_text(const TableCell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return std::to_string(*integer);
  if (const auto* number = std::get_if<double>(&cell)) return number_text(*number);
  const auto& text = std::get<std::string>(cell);
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char character : text) quoted += character == '"' ? "\"\"" : std::string(1, character);
  return quoted + "\"";
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream rows(file, std::ios::binary);
  if (!rows) throw OutputError(file.string() + ": can't be read: " + std::strerror(errno), errno);
  std::ostringstream text;
  text << rows.rdbuf();
  return text.str();
}

}  // namespace

std::string csv_line(const Row& row) {
  std::string line;
  for (const TableCell& cell : row) line += cell_text(cell) + ",";
  line.back() = '\n';
  return line;
}

CsvTable::CsvTable(std::filesystem::path file, const std::vector<Column>& columns,
                   const std::vector<Row>& rows)
    : file_(std::move(file)) {
  Row names;
  for (const Column& column : columns) names.emplace_back(column.name);
  std::string text = csv_line(names);
  for (const Row& row : rows) text += csv_line(row);
  publish_file(file_, text);
  size_ = text.size();
  open();
}

CsvTable::~CsvTable() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void CsvTable::open() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor_ < 0) {
    throw OutputError(file_.string() + ": can't be opened: " + std::strerror(errno), errno);
  }
}

void CsvTable::append(const Row& row) {
  static const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  const std::string line = csv_line(row);
  if (size_ / page != (size_ + line.size() - 1) / page) {
    const std::string rows = contents(file_);
    if (rows.size() != size_) throw OutputError(file_.string() + ": was changed during the run");
    publish_file(file_, rows + line);
    open();
  } else {
    ssize_t written = 0;
    do {
      written = ::write(descriptor_, line.data(), line.size());
    } while (written < 0 && errno == EINTR);
    if (written != static_cast<ssize_t>(line.size())) {
      const int error = written < 0 ? errno : ENOSPC;
      // A failure to cut off the torn row is not reported: it would add nothing to the error below.
      [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(size_));
      throw OutputError(file_.string() + ": can't be written: " + std::strerror(error), error);
    }
  }
  size_ += line.size();
}

}  // namespace peristat
