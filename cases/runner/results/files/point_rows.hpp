#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/results/files/hdf5_file.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

/// Gathers values of points on rank 0, in the order of the whole body and in parts: no rank ever
/// holds the values of all points of a partitioned body.
class RowGathering {
 public:
  /// @param most_rows largest number of rows of a part
  explicit RowGathering(const IndexMap& part, std::int64_t most_rows = std::int64_t(1) << 20)
      : part_(part), most_rows_(most_rows) {}

  [[nodiscard]] const IndexMap& part() const { return part_; }
  [[nodiscard]] const Communicator& ranks() const { return part_.ranks(); }
  /// True if nothing has to be gathered.
  [[nodiscard]] bool is_whole() const { return part_.is_whole(); }
  /// Number of rows of an array of the body, of which so many are here.
  [[nodiscard]] std::uint64_t rows(std::size_t here) const {
    return is_whole() ? here : std::uint64_t(part_.whole());
  }

  /// Gathers values of the owned points on rank 0. Collective.
  /// @param mine as many values per owned point on all ranks
  /// @param put called with consecutive rows, at rank 0 only
  template <class Value>
  void gather(const std::vector<Value>& mine, std::size_t values_per_row,
              const Hdf5File::PutRows<Value>& put) const {
    const std::span<const GlobalIndex> number = numbers();
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

  /// Gives each rank the values of the points that it owns. Collective.
  /// @param take called for consecutive rows, at rank 0 only
  template <class Value, class Take>
  [[nodiscard]] std::vector<Value> scatter(std::size_t values_per_row, const Take& take) const {
    std::vector<Value> mine;
    const std::span<const GlobalIndex> number = numbers();
    auto next = number.begin();
    for (std::int64_t first = 0; first < part_.whole(); first += most_rows_) {
      const std::int64_t count = std::min(most_rows_, std::int64_t(part_.whole()) - first);
      std::vector<Value> rows;
      if (part_.ranks().rank() == 0) rows = take(std::uint64_t(first), std::uint64_t(count));
      std::string bytes(reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(Value));
      part_.ranks().broadcast(bytes);
      rows.resize(bytes.size() / sizeof(Value));
      std::memcpy(rows.data(), bytes.data(), bytes.size());
      for (; next != number.end() && *next < first + count; ++next) {
        const auto row = rows.begin() + std::ptrdiff_t(std::size_t(*next - first) * values_per_row);
        mine.insert(mine.end(), row, row + std::ptrdiff_t(values_per_row));
      }
    }
    return mine;
  }

  /// Gathers items on rank 0 in their order and in parts. Collective.
  /// @tparam Item of plain bytes
  /// @param order_of returns two whole numbers for an item, the first from 0 to `most_order`
  /// @param put called with consecutive items, at rank 0 only
  template <class Item, class OrderOf, class Put>
  void gather_in_order(std::vector<Item> mine, std::int64_t most_order, const OrderOf& order_of,
                       const Put& put) const {
    const Communicator& ranks = part_.ranks();
    const std::int64_t all = ranks.count_all(std::int64_t(mine.size())).all;
    if (all == 0) return;
    std::ranges::sort(mine, {}, order_of);
    auto next = mine.begin();
    std::int64_t part = all <= most_rows_ ? most_order + 1 : most_order / (all / most_rows_) + 1;
    for (std::int64_t first = 0; first <= most_order; first += part, part *= 2) {
      const auto end_of = [&] {
        return std::partition_point(next, mine.end(), [&](const Item& item) {
          return std::int64_t(order_of(item).first) < first + part;
        });
      };
      while (part > 1 && ranks.count_all(end_of() - next).all > most_rows_) part /= 2;
      std::vector<Item> items = gathered(std::vector<Item>(next, end_of()));
      next = end_of();
      std::ranges::sort(items, {}, order_of);
      if (ranks.rank() == 0) put(items);
    }
  }

  /// Gathers items of bonds in the order of a single rank: ascending by `first_point`, then bonds
  /// to points before those to each kind of images (`second_image`), then by `second_point`.
  template <class Item, class Put>
  void gather_of_bonds(std::vector<Item> mine, const Put& put) const {
    gather_in_order(
        std::move(mine), std::int64_t(part_.whole()),
        [&](const Item& item) {
          return std::pair(item.first_point,
                           item.second_image * std::int64_t(part_.whole()) + item.second_point);
        },
        put);
  }

  /// Adds up a count per owned point over the points of the whole body in their order. Collective.
  /// @return the sum before each owned point, and the total
  [[nodiscard]] std::pair<std::vector<std::int64_t>, std::int64_t> counted_before(
      const std::vector<std::int64_t>& counts) const {
    const std::span<const GlobalIndex> number = numbers();
    std::vector<std::int64_t> before(counts.size());
    std::int64_t sum = 0;
    auto next = number.begin();
    for (std::int64_t first = 0; first < part_.whole(); first += most_rows_) {
      const auto end = std::lower_bound(next, number.end(), first + most_rows_);
      std::vector<std::int64_t> sums = sums_before(counts, first, next, end, sum);
      for (; next != end; ++next) {
        before[std::size_t(next - number.begin())] = sums[std::size_t(*next - first)];
      }
      sum = sums.back();
    }
    return {std::move(before), sum};
  }

 private:
  using Number = std::span<const GlobalIndex>::iterator;

  /// Numbers in the whole body of the points that this rank owns.
  [[nodiscard]] std::span<const GlobalIndex> numbers() const { return part_.numbered().owned; }

  /// Sums before each point of a part, and behind the last one; on all ranks.
  [[nodiscard]] std::vector<std::int64_t> sums_before(const std::vector<std::int64_t>& counts,
                                                      std::int64_t first, Number next, Number end,
                                                      std::int64_t sum) const {
    const auto rows = std::size_t(std::min(most_rows_, std::int64_t(part_.whole()) - first));
    const Number begin = numbers().begin();
    const Packed<std::int64_t> packed{first, 1};
    const std::string mine = packed.pack(numbers().data(), std::size_t(next - begin),
                                         std::size_t(end - begin), counts.data());
    std::vector<std::int64_t> sums(rows + 1, 0);
    part_.ranks().gather(mine,
                         [&](int, const std::string& received) { packed.unpack(received, sums); });
    for (std::int64_t& entry : sums) entry = std::exchange(sum, sum + entry);
    std::string bytes(reinterpret_cast<const char*>(sums.data()), sums.size() * sizeof sum);
    part_.ranks().broadcast(bytes);
    std::memcpy(sums.data(), bytes.data(), bytes.size());
    return sums;
  }

  /// Items of all ranks, at rank 0.
  template <class Item>
  [[nodiscard]] std::vector<Item> gathered(const std::vector<Item>& mine) const {
    std::vector<Item> items;
    const std::string bytes(reinterpret_cast<const char*>(mine.data()), mine.size() * sizeof(Item));
    part_.ranks().gather(bytes, [&](int, const std::string& received) {
      const std::size_t known = items.size();
      items.resize(known + received.size() / sizeof(Item));
      if (!received.empty()) std::memcpy(&items[known], received.data(), received.size());
    });
    return items;
  }

  /// Packs rows with their positions relative to `first`.
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

  const IndexMap& part_;
  std::int64_t most_rows_;
};

/// Gathering of a body that is not partitioned.
[[nodiscard]] inline const RowGathering& no_gathering() {
  static const RowGathering whole(whole_body());
  return whole;
}

/// Source of values per point: a file, or for a partitioned body rank 0, which sends them out in
/// parts. All calls are collective.
class RowSource {
 public:
  /// @param file null on all ranks but 0
  RowSource(const Hdf5File* file, const RowGathering& gathering)
      : file_(file), gathering_(gathering) {}

  /// Result of `find` on rank 0, on all ranks.
  template <class Find>
  [[nodiscard]] bool all_agree(const Find& find) const {
    return any_of_all(gathering_.ranks(), file_ && find());
  }

  /// Reads the values of the points that this rank owns.
  template <class Value>
  [[nodiscard]] std::vector<Value> read(const std::string& path, std::size_t values_per_row) const {
    if (gathering_.is_whole()) return file_->some_rows<Value>(path, 0, file_->count_of_rows(path));
    return gathering_.scatter<Value>(values_per_row, [&](std::uint64_t first, std::uint64_t count) {
      return file_->some_rows<Value>(path, first, count);
    });
  }

 private:
  const Hdf5File* file_;
  const RowGathering& gathering_;
};

/// Destination of values per point: a file, directly for a whole body or gathered from ranks.
class RowSink {
 public:
  /// @param file null on ranks that send only
  /// @param rows points of the body
  RowSink(Hdf5File* file, const RowGathering& gathering, std::uint64_t rows)
      : file_(file), rows_(rows), gathering_(gathering) {}

  /// @param row extents of a point's values; none: one value
  template <class Value>
  void write(const std::string& path, const std::vector<Value>& values, const Hdf5File::Shape& row,
             const DatasetLabel& label) const {
    Hdf5File::Shape shape{rows_};
    shape.insert(shape.end(), row.begin(), row.end());
    std::size_t values_per_row = 1;
    for (const std::uint64_t extent : row) values_per_row *= extent;
    if (gathering_.is_whole() || values_per_row == 0) {
      if (file_) file_->write(path, values, shape, label);
    } else if (!file_) {
      gathering_.gather<Value>(values, values_per_row, {});
    } else {
      file_->write_rows<Value>(path, shape, label, [&](const Hdf5File::PutRows<Value>& put) {
        gathering_.gather<Value>(values, values_per_row, put);
      });
    }
  }

  /// Values of bonds, see RowGathering::gather_of_bonds.
  /// @param first_point, second_point, second_image, values of the bonds that this rank reports; a
  ///        body without images has no `second_image`
  /// @param count of bonds on all ranks
  template <class Value>
  void write_of_bonds(const std::string& path, const std::vector<Index>& first_point,
                      const std::vector<Index>& second_point,
                      const std::vector<Index>& second_image, const std::vector<Value>& values,
                      std::uint64_t count, const DatasetLabel& label) const {
    if (gathering_.is_whole() || count == 0) {
      if (file_) file_->write(path, values, {count}, label);
      return;
    }
    struct Item {
      Index first_point, second_point, second_image;
      Value value;
    };
    std::vector<Item> mine;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Index image = second_image.empty() ? 0 : second_image[k];
      mine.push_back({first_point[k], second_point[k], image, values[k]});
    }
    if (!file_) return gathering_.gather_of_bonds(std::move(mine), [](const auto&) {});
    file_->write_rows<Value>(path, {count}, label, [&](const Hdf5File::PutRows<Value>& put) {
      std::uint64_t first = 0;
      gathering_.gather_of_bonds(std::move(mine), [&](const std::vector<Item>& items) {
        std::vector<Value> rows;
        for (const Item& item : items) rows.push_back(item.value);
        put(first, rows);
        first += rows.size();
      });
    });
  }

 private:
  Hdf5File* file_;
  std::uint64_t rows_;
  const RowGathering& gathering_;
};

}  // namespace peristat
