#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "cases/runner/results/files/point_rows.hpp"
#include "solvers/ranks/distribute.hpp"
#include "solvers/ranks/make_index_map.hpp"
#include "src/geometry/slab.hpp"
#include "src/parallel/index_map.hpp"
#include "tests/ranks/bodies_on_ranks.hpp"
#include "tests/ranks/on_ranks.hpp"

namespace peristat::tests {
namespace {

TEST(RowGathering, brings_the_values_of_all_points_in_their_order_and_in_parts) {
  const Communicator& ranks = all_ranks();
  for (const RanksBody& body : all_bodies()) {
    SCOPED_TRACE(body.name);
    const double horizon = body.setting().horizon;
    const IndexMap part = make_index_map(
        distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1), ranks);
    for (const std::int64_t most_rows : {std::int64_t(1), std::int64_t(5), std::int64_t(1) << 20}) {
      const RowGathering gathering(part, most_rows);
      std::vector<std::int32_t> mine;
      for (const GlobalIndex number : part.numbered().owned) {
        mine.insert(mine.end(), {std::int32_t(2 * number), std::int32_t(2 * number + 1)});
      }
      std::vector<std::int32_t> all;
      gathering.gather<std::int32_t>(
          mine, 2, [&](std::uint64_t first, const std::vector<std::int32_t>& rows) {
            EXPECT_EQ(2 * first, all.size());
            EXPECT_LE(rows.size(), 2 * std::size_t(most_rows));
            all.insert(all.end(), rows.begin(), rows.end());
          });
      EXPECT_EQ(all.size(), ranks.rank() == 0 ? 2 * std::size_t(part.whole()) : 0);
      for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k], std::int32_t(k));
    }
  }
}

TEST(RowGathering, gives_back_the_values_of_owned_points_and_counts_before_them) {
  const Communicator& ranks = all_ranks();
  for (const RanksBody& body : all_bodies()) {
    SCOPED_TRACE(body.name);
    const double horizon = body.setting().horizon;
    const IndexMap part = make_index_map(
        distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1), ranks);
    for (const std::int64_t most_rows : {std::int64_t(1), std::int64_t(5), std::int64_t(1) << 20}) {
      const RowGathering gathering(part, most_rows);
      const std::vector<double> mine =
          gathering.scatter<double>(2, [&](std::uint64_t first, std::uint64_t count) {
            std::vector<double> rows;
            for (std::uint64_t k = first; k < first + count; ++k) {
              rows.insert(rows.end(), {0.5 * double(k), -double(k)});
            }
            return rows;
          });
      ASSERT_EQ(mine.size(), 2 * part.numbered().owned.size());
      std::vector<std::int64_t> counts;
      for (std::size_t i = 0; i < part.numbered().owned.size(); ++i) {
        EXPECT_EQ(mine[2 * i], 0.5 * double(part.numbered().owned[i]));
        EXPECT_EQ(mine[2 * i + 1], -double(part.numbered().owned[i]));
        counts.push_back(part.numbered().owned[i] % 3);
      }
      const auto [before, all] = gathering.counted_before(counts);
      const auto sum_to = [](GlobalIndex end) {  // of k % 3 for k < end
        return end / 3 * 3 + (end % 3 == 2 ? 1 : 0);
      };
      EXPECT_EQ(all, sum_to(part.whole()));
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(before[i], sum_to(part.numbered().owned[i]));
      }
    }
  }
}

TEST(RowGathering, brings_what_is_told_of_bonds_in_their_order_and_in_parts) {
  struct Item {
    Index first_point, second_point, second_image;
    double value;
  };
  const Communicator& ranks = all_ranks();
  const RanksBody body = plate_with_hole();
  const double horizon = body.setting().horizon;
  const IndexMap part =
      make_index_map(distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1), ranks);
  for (const std::int64_t most_rows : {std::int64_t(7), std::int64_t(1) << 20}) {
    std::vector<Item> mine;  // up to three of each point, the largest one first
    for (const GlobalIndex number : part.numbered().owned) {
      for (Index k = Index(number % 4); k-- > 0;) {
        mine.push_back({Index(number), Index(number) + k, 0, double(number) + 0.25 * k});
      }
    }
    const std::int64_t all = ranks.count_all(std::int64_t(mine.size())).all;
    std::vector<Item> items;
    RowGathering(part, most_rows).gather_of_bonds(mine, [&](const std::vector<Item>& some) {
      EXPECT_LE(some.size(), std::size_t(most_rows));
      items.insert(items.end(), some.begin(), some.end());
    });
    ASSERT_EQ(std::int64_t(items.size()), ranks.rank() == 0 ? all : 0);
    for (std::size_t k = 0; k < items.size(); ++k) {
      EXPECT_EQ(items[k].value,
                items[k].first_point + 0.25 * (items[k].second_point - items[k].first_point));
      if (k > 0) {
        EXPECT_LT(items[k - 1].value, items[k].value);
      }
    }
  }
}

TEST(RowSink, writes_parts_of_rows_one_after_the_other) {
  const Communicator& ranks = all_ranks();
  const RanksBody body = plate_with_hole();
  const double horizon = body.setting().horizon;
  const IndexMap part =
      make_index_map(distribute(make_slab(body.lattice, ranks), horizon, horizon, ranks, 1), ranks);
  const RowGathering gathering(part, 100);
  std::optional<Hdf5File> file;
  if (ranks.rank() == 0) file.emplace(Hdf5File::in_memory("rows (in memory)", 1 << 16));
  const RowSink sink(file ? &*file : nullptr, gathering, std::uint64_t(part.whole()));
  std::vector<double> vectors;
  std::vector<std::uint8_t> flags;
  for (const GlobalIndex number : part.numbered().owned) {
    vectors.insert(vectors.end(), {0.5 * double(number), -double(number)});
    flags.push_back(number % 3 == 0);
  }
  sink.write("/vectors", vectors, {2}, {"m", "two of each point"});
  sink.write("/flags", flags, {}, {"1", "one of each point"});
  if (!file) return;
  const std::vector<double> all_vectors = file->numbers("/vectors");
  const std::vector<std::uint8_t> all_flags = file->bytes("/flags");
  EXPECT_EQ(all_flags.size(), std::size_t(part.whole()));
  EXPECT_EQ(all_vectors.size(), 2 * std::size_t(part.whole()));
  for (std::size_t i = 0; 2 * i + 1 < all_vectors.size() && i < all_flags.size(); ++i) {
    EXPECT_EQ(all_vectors[2 * i], 0.5 * double(i));
    EXPECT_EQ(all_vectors[2 * i + 1], -double(i));
    EXPECT_EQ(all_flags[i], i % 3 == 0);
  }
}

}  // namespace
}  // namespace peristat::tests
