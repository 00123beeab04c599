#include "solvers/linear/trilinos/gathered_factor.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <unordered_map>

#include <Teuchos_LAPACK.hpp>

#include "src/parallel/communicator.hpp"

namespace peristat::trilinos {
namespace {

template <class T>
std::string packed(const T* values, std::size_t count) {
  return {reinterpret_cast<const char*>(values), count * sizeof(T)};
}

template <class T>
std::vector<T> unpacked(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

/// Concatenates the values of all ranks, at rank 0.
template <class T>
std::vector<T> gathered(const Communicator& ranks, const T* mine, std::size_t count) {
  std::vector<T> all;
  ranks.gather(packed(mine, count), [&](int, const std::string& bytes) {
    const std::vector<T> values = unpacked<T>(bytes);
    all.insert(all.end(), values.begin(), values.end());
  });
  return all;
}

}  // namespace

bool GatheredFactor::factorize(const GatheredRows& rows) {
  own_ = rows.number.size();
  const Communicator::Counts count = ranks_.count_all(std::int64_t(own_));
  first_ = std::size_t(count.before);
  if (count.all > most_rows) return false;
  all_ = int(count.all);
  std::vector<long long> row;  // of each entry
  for (std::size_t i = 0; i < own_; ++i) {
    row.insert(row.end(), rows.begin[i + 1] - rows.begin[i], rows.number[i]);
  }
  const auto number = gathered(ranks_, rows.number.data(), own_);
  const auto row_of = gathered(ranks_, row.data(), row.size());
  const auto column_of = gathered(ranks_, rows.column.data(), rows.column.size());
  const auto value_of = gathered(ranks_, rows.value.data(), rows.value.size());
  int status = 0;
  if (ranks_.rank() == 0 && all_ > 0) {
    std::unordered_map<long long, std::size_t> place;
    for (std::size_t k = 0; k < number.size(); ++k) place[number[k]] = k;
    const auto size = std::size_t(all_);
    factor_.assign(size * size, 0.0);
    for (std::size_t k = 0; k < value_of.size(); ++k) {
      factor_[place.at(column_of[k]) * size + place.at(row_of[k])] += value_of[k];
    }
    Teuchos::LAPACK<int, double>().POTRF('L', all_, factor_.data(), all_, &status);
  }
  return ranks_.max(status == 0 ? 0.0 : 1.0) == 0.0;
}

void GatheredFactor::solve(const double* b, double* x) const {
  std::vector<double> all = gathered(ranks_, b, own_);
  std::string bytes;
  if (ranks_.rank() == 0 && all_ > 0) {
    int status = 0;
    Teuchos::LAPACK<int, double>().POTRS('L', all_, 1, factor_.data(), all_, all.data(), all_,
                                         &status);
    bytes = packed(all.data(), all.size());
  }
  ranks_.broadcast(bytes);
  all = unpacked<double>(bytes);
  std::copy_n(all.begin() + std::ptrdiff_t(first_), own_, x);
}

}  // namespace peristat::trilinos
