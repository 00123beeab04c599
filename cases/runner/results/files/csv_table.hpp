#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cases/runner/results/files/table.hpp"

namespace peristat {

/// A CSV file that grows by whole rows: UTF-8, comma, newline, numbers as the shortest text that
/// reads back as the same number, text in double quotes where it holds a comma, quote or newline.
///
/// A row is appended by a single write, which a kill can't tear inside a page of the file (the
/// kernel looks for a kill only between pages). A row that would reach into the next page is
/// written by copying the file and renaming the copy instead.
class CsvTable {
 public:
  /// Creates the file with its header and first rows, in place of an existing one.
  /// @throws OutputError
  CsvTable(std::filesystem::path file, const std::vector<Column>& columns,
           const std::vector<Row>& rows = {});
  ~CsvTable();
  CsvTable(const CsvTable&) = delete;
  CsvTable& operator=(const CsvTable&) = delete;

  /// @throws OutputError; the file then ends with the last whole row
  void append(const Row& row);

 private:
  void open();

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// A row as a line of a CSV file, with the newline.
[[nodiscard]] std::string csv_line(const Row& row);

}  // namespace peristat
