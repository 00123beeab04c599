// Compressed datasets: what is written in chunks, by several threads, is what HDF5 reads.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "cases/runner/results/files/hdf5_file.hpp"

namespace peristat {
namespace {

template <class Value>
std::vector<Value> values_of(std::uint64_t count) {
  std::vector<Value> values;
  for (std::uint64_t k = 0; k < count; ++k) values.push_back(Value(k * k % 251));
  return values;
}

template <class Value>
void expect_read_as_written(std::uint64_t rows, std::uint64_t width, std::uint64_t at_once) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("rows_" + std::to_string(getpid()) + ".h5");
  const std::vector<Value> all = values_of<Value>(rows * width);
  {
    Hdf5File to = Hdf5File::create(file, 1 << 23);
    const auto fill = [&](const Hdf5File::PutRows<Value>& put) {
      for (std::uint64_t first = 0; first < rows; first += at_once) {
        const std::uint64_t last = std::min(first + at_once, rows);
        put(first, {all.begin() + std::ptrdiff_t(first * width),
                    all.begin() + std::ptrdiff_t(last * width)});
      }
    };
    to.write_rows<Value>("/rows", {rows, width}, {"1", "numbers"}, fill,
                         Hdf5File::Storage::compressed);
  }
  const Hdf5File from = Hdf5File::open_for_reading(file);
  EXPECT_EQ(from.numbers("/rows"), (std::vector<double>(all.begin(), all.end())))
      << rows << " rows, " << at_once << " at once";
  std::filesystem::remove(file);
}

TEST(CompressedRows, AreReadAsWritten) {
  for (const std::uint64_t rows : {1u, 1000u, 32768u, 100000u}) {
    // A chunk has 32768 rows. Parts of 50000 are written by HDF5's own filters.
    for (const std::uint64_t at_once : {65536u, 50000u}) {
      expect_read_as_written<double>(rows, 3, at_once);
      expect_read_as_written<std::int32_t>(rows, 1, at_once);
      expect_read_as_written<std::uint8_t>(rows, 2, at_once);
    }
  }
}

}  // namespace
}  // namespace peristat
