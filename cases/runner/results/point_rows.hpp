#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "cases/runner/results/hdf5_file.hpp"
#include "solvers/ranks/part_of_body.hpp"

namespace peristat {

/// Brings what ranks have of their points to rank 0, in the order of the whole body and in parts:
/// nobody ever holds a value of all points.
class RowGathering {
 public:
  /// @param most_rows of a part
  explicit RowGathering(const PartOfBody& part, std::int64_t most_rows = std::int64_t(1) << 20)
      : part_(part), most_rows_(most_rows) {}

  [[nodiscard]] const PartOfBody& part() const { return part_; }
  [[nodiscard]] std::uint64_t rows() const { return std::uint64_t(part_.whole()); }

  /// A call that all ranks make.
  /// @param mine as many values per owned point on all ranks
  /// @param put called with rows that follow one another, at rank 0 only
  template <class Value>
  void gather(const std::vector<Value>& mine, std::size_t values_per_row,
              const Hdf5File::PutRows<Value>& put) const {
    const std::vector<GlobalIndex>& number = part_.number();
    auto next = number.begin();
    for (std::int64_t first = 0; first < part_.whole(); first += most_rows_) {
      const std::int64_t count = std::min(most_rows_, std::int64_t(part_.whole()) - first);
      const auto end = std::lower_bound(next, number.end(), first + count);
      const Packed<Value> packed{first, values_per_row};
      const std::string bytes = packed.pack(number.data(), std::size_t(next - number.begin()),
                                            std::size_t(end - number.begin()), mine.data());
      next = end;
      std::vector<Value> rows(part_.ranks().rank() == 0 ? std::size_t(count) * values_per_row : 0);
      part_.ranks().gather(
          bytes, [&](int, const std::string& received) { packed.unpack(received, rows); });
      if (part_.ranks().rank() == 0) put(std::uint64_t(first), rows);
    }
  }

 private:
  /// Rows with their places behind `first`.
  template <class Value>
  struct Packed {
    std::int64_t first;
    std::size_t values;

    [[nodiscard]] std::size_t bytes() const {
      return sizeof(std::int64_t) + values * sizeof(Value);
    }
    [[nodiscard]] std::string pack(const GlobalIndex* number, std::size_t from, std::size_t to,
                                   const Value* mine) const {
      std::string packed((to - from) * bytes(), '\0');
      char* at = packed.data();
      for (std::size_t i = from; i < to; ++i, at += bytes()) {
        const std::int64_t place = number[i] - first;
        std::memcpy(at, &place, sizeof place);
        std::memcpy(at + sizeof place, mine + i * values, values * sizeof(Value));
      }
      return packed;
    }
    void unpack(const std::string& packed, std::vector<Value>& rows) const {
      for (std::size_t k = 0; k < packed.size(); k += bytes()) {
        std::int64_t place = 0;
        std::memcpy(&place, &packed[k], sizeof place);
        std::memcpy(&rows[std::size_t(place) * values], &packed[k + sizeof place],
                    values * sizeof(Value));
      }
    }
  };

  const PartOfBody& part_;
  std::int64_t most_rows_;
};

/// Where values per point go: into a file, of a body that is whole here, or gathered from ranks.
class RowSink {
 public:
  /// @param rows points of the body
  RowSink(Hdf5File& file, std::uint64_t rows) : file_(&file), rows_(rows) {}
  /// @param file null on ranks that send only
  RowSink(Hdf5File* file, const RowGathering& gathering)
      : file_(file), rows_(gathering.rows()), gathering_(&gathering) {}

  /// @param row extents of a point's values; none: one value
  template <class Value>
  void write(const std::string& path, const std::vector<Value>& values, const Hdf5File::Shape& row,
             const DatasetLabel& label) const {
    Hdf5File::Shape shape{rows_};
    shape.insert(shape.end(), row.begin(), row.end());
    std::size_t values_per_row = 1;
    for (const std::uint64_t extent : row) values_per_row *= extent;
    if (!gathering_ || values_per_row == 0) {
      if (file_) file_->write(path, values, shape, label);
    } else if (!file_) {
      gathering_->gather<Value>(values, values_per_row, {});
    } else {
      file_->write_rows<Value>(path, shape, label, [&](const Hdf5File::PutRows<Value>& put) {
        gathering_->gather<Value>(values, values_per_row, put);
      });
    }
  }

 private:
  Hdf5File* file_;
  std::uint64_t rows_;
  const RowGathering* gathering_ = nullptr;
};

}  // namespace peristat
