#include "assembly/terms/failure/shared_bonds.hpp"

#include <algorithm>
#include <unordered_map>

#include "src/parallel/collectives.hpp"

namespace peristat {

std::vector<SharedBond> in_order(const Communicator& ranks, std::vector<SharedBond> mine) {
  constexpr std::size_t width = 5;
  std::vector<double> numbers;
  for (const auto& [utilisation, ends, rank, number] : mine) {
    const auto [low, high] = std::minmax(ends[0], ends[1]);
    numbers.insert(numbers.end(),
                   {utilisation, double(low), double(high), double(rank), double(number)});
  }
  numbers = concatenated(ranks, numbers);
  std::vector<SharedBond> all;
  for (std::size_t k = 0; k < numbers.size(); k += width) {
    all.push_back({numbers[k],
                   {GlobalIndex(numbers[k + 1]), GlobalIndex(numbers[k + 2])},
                   int(numbers[k + 3]),
                   std::size_t(numbers[k + 4])});
  }
  std::ranges::sort(all, [](const SharedBond& a, const SharedBond& b) {
    return a.utilisation != b.utilisation ? a.utilisation > b.utilisation : a.ends < b.ends;
  });
  return all;
}

std::vector<std::vector<std::size_t>> rounds_of(std::span<const SharedBond> bonds,
                                                LossReaches reaches) {
  std::unordered_map<GlobalIndex, std::size_t> rounds_before;  // per point
  std::vector<std::vector<std::size_t>> rounds;
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    std::size_t& one = rounds_before[bonds[k].ends[0]];
    std::size_t& other = rounds_before[bonds[k].ends[1]];
    const std::size_t round =
        reaches == LossReaches::any_bond ? rounds.size() : std::max(one, other);
    if (round == rounds.size()) rounds.emplace_back();
    rounds[round].push_back(k);
    one = other = round + 1;
  }
  return rounds;
}

}  // namespace peristat
