#include "src/neighbourhood/partners.hpp"

#include <utility>

namespace peristat {
namespace {

std::uint32_t hash_of(std::span<const Index> ahead) {
  std::uint32_t hash = 0, factor = 2654435769U;  // 2^32 over the golden ratio
  for (const Index step : ahead) {
    hash += std::uint32_t(step) * factor;
    factor += 2U * 2654435769U;
  }
  return hash ^ hash >> 16;
}

}  // namespace

Partners::Partners(std::span<const Offset> offset, std::span<const Index> upper) {
  PartnersBuilder builder;
  for (std::size_t i = 0; i + 1 < offset.size(); ++i) {
    builder.add(upper.subspan(std::size_t(offset[i]), std::size_t(offset[i + 1] - offset[i])));
  }
  *this = builder.take();
}

void PartnersBuilder::reserve(std::size_t points, std::size_t steps) {
  made_.shift_.reserve(points);
  made_.ahead_.reserve(steps);
}

std::size_t PartnersBuilder::place_of(std::span<const Index> ahead) {
  std::vector<Index>& known = made_.ahead_;
  Row& recent = recent_[hash_of(ahead) % recent_.size()];
  const auto first = known.begin() + std::ptrdiff_t(recent.first);
  const bool is_alike =
      recent.count == ahead.size() && std::equal(ahead.begin(), ahead.end(), first);
  if (!is_alike) {
    recent = {known.size(), ahead.size()};
    known.insert(known.end(), ahead.begin(), ahead.end());
  }
  return recent.first;
}

void PartnersBuilder::add_steps() {
  made_.shift_.push_back(Offset(place_of(row_)) - made_.bonds_);
  made_.bonds_ += Offset(row_.size());
  ++next_;
}

void PartnersBuilder::append(const Partners& others, std::span<const Offset> offset) {
  constexpr Offset unknown = -1;
  std::vector<Offset> place(others.ahead_.size(), unknown);  // here, by the place there
  const std::span<const Index> all = others.ahead_;
  for (std::size_t i = 0; i + 1 < offset.size(); ++i, ++next_) {
    const Offset count = offset[i + 1] - offset[i];
    const auto there = std::size_t(offset[i] - offset[0] + others.shift_[i]);
    // Rows that start at the same place there are alike, but for those without partners.
    const bool is_known = count > 0 && place[there] != unknown;
    const Offset here =
        is_known ? place[there] : Offset(place_of(all.subspan(there, std::size_t(count))));
    if (count > 0) place[there] = here;
    made_.shift_.push_back(here - made_.bonds_);
    made_.bonds_ += count;
  }
}

Partners PartnersBuilder::take() {
  made_.ahead_.shrink_to_fit();
  return std::exchange(made_, {});
}

}  // namespace peristat
