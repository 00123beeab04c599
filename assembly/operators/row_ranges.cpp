#include "assembly/operators/row_ranges.hpp"

namespace peristat {
namespace {

RowRange range_of(const BlockPattern& pattern, Index first, Index last, Index own) {
  const Index far = std::max(own, last);
  RowRange range{first, last, last, pattern.points(), last};
  for (Index row = first; row < last; ++row) {
    const PartnersOfPoint partners = pattern.of(row);
    if (partners.empty()) continue;
    range.touched_end = std::max(range.touched_end, partners.back() + 1);
    auto end = partners.end();
    if (partners.back() >= far) {
      end = std::lower_bound(partners.begin(), end, far);
      range.far_first = std::min(range.far_first, *end);
    }
    if (end != partners.begin()) range.near_end = std::max(range.near_end, end[-1] + 1);
  }
  range.far_first = std::min(range.far_first, range.touched_end);
  return range;
}

}  // namespace

std::vector<RowRange> partition_rows(const BlockPattern& pattern, int parts, Index own) {
  std::vector<RowRange> ranges(parts);
  const Index rows = pattern.points();
  Index first = 0;
  for (int part = 0; part < parts; ++part) {
    // Each row counts one block beside its own, so that rows without any are shared out, too.
    const double share = double(part + 1) / parts * double(pattern.blocks() + rows);
    Index last = first;
    while (last < rows && double(pattern.offset[last + 1] + last + 1) <= share) ++last;
    if (part + 1 == parts) last = rows;
    ranges[part] = range_of(pattern, first, last, own);
    first = last;
  }
  return ranges;
}

int parts_of_rows(const BlockPattern& pattern, int threads, Index own) {
  // A row beyond is gathered, cleared and added up, which takes as long as a few blocks: some per
  // cent of a pass. In small bodies it may take more, for their passes are short.
  constexpr double blocks_per_row_beyond = 70.0, of_small_bodies = 20.0, small = 2000.0;
  constexpr double large = 500000.0;    // rows beyond take memory that matters if they are more
  constexpr double most_between = 4.0;  // in all rows: untouched memory may be used, by huge pages
  const double rows = pattern.points(), blocks = double(pattern.blocks());
  const double quick =
      std::max(blocks / blocks_per_row_beyond, std::min(blocks / of_small_bodies, small));
  const double most = std::min(quick, std::max(rows, large));
  for (const int parts : {48, 24, 16, 12, 8, 6, 4, 3, 2}) {
    double beyond = 0.0, between = 0.0;  // between: addresses of rows that are not touched
    for (const RowRange& range : partition_rows(pattern, parts, own)) {
      beyond += double(range.rows_beyond());
      between += double(range.far_first - range.near_end);
    }
    if (beyond <= most && between <= most_between * rows) return std::max(parts, threads);
  }
  return threads;
}

}  // namespace peristat
