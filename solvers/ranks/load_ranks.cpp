#include <cstddef>

#include "solvers/linear/load_module.hpp"
#include "solvers/ranks/ranks.hpp"
#include "solvers/ranks/trilinos/module.hpp"
#include "src/parallel/communicator.hpp"
#include "src/parallel/ghost_exchange.hpp"

namespace peristat {
namespace {

/// Address space that Trilinos and MPI need.
constexpr std::size_t room_for_ranks = std::size_t(384) << 20;

const ranks::Module& ranks_module() {
  static const ranks::Module* const loaded = [] {
    void* const symbol =
        load_module("MPI", ranks::module_file, ranks::module_symbol, room_for_ranks);
    return reinterpret_cast<const ranks::Module* (*)()>(symbol)();
  }();
  return *loaded;
}

/// Exchange of a sole rank, which has all points itself.
class NoGhosts : public GhostExchange {
 public:
  void update(double*) override { ++exchanges_; }
  [[nodiscard]] Traffic traffic() const override { return {exchanges_, 0, 0}; }

 private:
  std::int64_t exchanges_ = 0;
};

}  // namespace

std::unique_ptr<Communicator> start_ranks() { return ranks_module().start_ranks(); }

Records exchange(const Communicator& ranks, const std::vector<int>& to, const Records& records) {
  return ranks.count() == 1 ? records : ranks_module().exchange(ranks, to, records);
}

std::vector<int> partition(const Communicator& ranks, int dimension,
                           const std::vector<double>& positions,
                           const std::vector<std::int64_t>& numbers,
                           const std::vector<double>& weights) {
  if (ranks.count() == 1) return std::vector<int>(numbers.size(), 0);
  return ranks_module().partition(ranks, dimension, positions, numbers, weights);
}

std::unique_ptr<GhostExchange> make_ghost_exchange(const Communicator& ranks,
                                                   const std::vector<std::int64_t>& owned,
                                                   const std::vector<std::int64_t>& ghosts,
                                                   int width) {
  if (ranks.count() == 1 && ghosts.empty()) return std::make_unique<NoGhosts>();
  return ranks_module().make_ghost_exchange(ranks, owned, ghosts, width);
}

}  // namespace peristat
