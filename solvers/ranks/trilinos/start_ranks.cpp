#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include <mpi.h>

#include "solvers/ranks/trilinos/module.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat::ranks {
namespace {

/// Largest message [bytes]; MPI counts in int.
constexpr std::size_t most_bytes = std::size_t(1) << 30;
constexpr int gather_tag = 1;

/// All ranks that mpirun has started. MPI's default error handler ends all of them, so that return
/// values need no checks.
class MpiRanks : public Communicator {
 public:
  MpiRanks() {
    int started = 0, ended = 0;
    MPI_Initialized(&started);
    MPI_Finalized(&ended);
    if (started || ended) throw std::logic_error("MPI was started before");
    int provided = MPI_THREAD_SINGLE;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    if (provided < MPI_THREAD_FUNNELED) {
      throw std::runtime_error("this MPI does not allow a rank to have threads");
    }
    MPI_Comm_dup(MPI_COMM_WORLD, &world_);
    MPI_Comm_rank(world_, &rank_);
    MPI_Comm_size(world_, &count_);
  }

  ~MpiRanks() override {
    MPI_Comm_free(&world_);
    MPI_Finalize();
  }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int count() const override { return count_; }
  [[nodiscard]] const void* handle() const override { return &world_; }

  [[nodiscard]] std::vector<double> all_of(const std::vector<double>& mine) const override {
    if (mine.size() > most_bytes / sizeof(double)) {
      throw std::logic_error("Communicator::all_of is for short vectors");
    }
    std::vector<double> all(mine.size() * std::size_t(count_));
    MPI_Allgather(mine.data(), int(mine.size()), MPI_DOUBLE, all.data(), int(mine.size()),
                  MPI_DOUBLE, world_);
    return all;
  }

  void gather(const std::string& mine, const Visit& visit) const override {
    unsigned long long size = mine.size();
    if (rank_ != 0) {
      MPI_Send(&size, 1, MPI_UNSIGNED_LONG_LONG, 0, gather_tag, world_);
      for_each_piece(mine.size(), [&](std::size_t first, int bytes) {
        MPI_Send(&mine[first], bytes, MPI_BYTE, 0, gather_tag, world_);
      });
      return;
    }
    visit(0, mine);
    for (int other = 1; other < count_; ++other) {
      MPI_Recv(&size, 1, MPI_UNSIGNED_LONG_LONG, other, gather_tag, world_, MPI_STATUS_IGNORE);
      std::string bytes_of_other(size, '\0');
      for_each_piece(size, [&](std::size_t first, int bytes) {
        MPI_Recv(&bytes_of_other[first], bytes, MPI_BYTE, other, gather_tag, world_,
                 MPI_STATUS_IGNORE);
      });
      visit(other, bytes_of_other);
    }
  }

  void broadcast(std::string& bytes) const override {
    unsigned long long size = bytes.size();
    MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG_LONG, 0, world_);
    bytes.resize(size);
    for_each_piece(size, [&](std::size_t first, int count) {
      MPI_Bcast(&bytes[first], count, MPI_BYTE, 0, world_);
    });
  }

  [[noreturn]] void abort(int exit_code) const override {
    MPI_Abort(world_, exit_code);
    std::_Exit(exit_code);
  }

 private:
  template <class Visit>
  static void for_each_piece(std::size_t size, const Visit& visit) {
    for (std::size_t first = 0; first < size; first += most_bytes) {
      visit(first, int(std::min(most_bytes, size - first)));
    }
  }

  MPI_Comm world_ = MPI_COMM_NULL;  // a duplicate: its messages meet no others
  int rank_ = 0, count_ = 1;
};

}  // namespace

std::unique_ptr<Communicator> start_ranks() { return std::make_unique<MpiRanks>(); }

}  // namespace peristat::ranks
