#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

// Also compiled as C++17 by the code that starts MPI: solvers/ranks/trilinos.

namespace peristat {

/// The ranks of a run: processes each of which holds a part of the body. Every call but rank,
/// count, handle and abort is collective: all ranks make it, in the same order.
///
/// Every rank adds sums up in the order of the ranks, so that all get the same bits and decide
/// alike, and the same number of ranks gives the same bits again.
class Communicator {
 public:
  Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  virtual ~Communicator() = default;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int count() const = 0;

  /// Concatenates the numbers of all ranks in their order; all give the same count.
  [[nodiscard]] virtual std::vector<double> all_of(const std::vector<double>& mine) const = 0;

  /// At rank 0 calls visit(rank, bytes) with the bytes of every rank, in their order and one at a
  /// time, so that rank 0 need not hold all of them. Elsewhere visits nothing.
  using Visit = std::function<void(int rank, const std::string& bytes)>;
  virtual void gather(const std::string& mine, const Visit& visit) const = 0;

  /// Gives all ranks the bytes of rank 0.
  virtual void broadcast(std::string& bytes) const = 0;

  /// Ends all ranks; not collective.
  [[noreturn]] virtual void abort(int exit_code) const = 0;

  /// The MPI_Comm, for code compiled with MPI; null: a sole rank without MPI.
  [[nodiscard]] virtual const void* handle() const = 0;

  [[nodiscard]] std::vector<double> sum(const std::vector<double>& mine) const {
    return reduced(mine, [](double a, double b) { return a + b; });
  }
  /// A NaN of any rank is the result, so that comparisons see it.
  [[nodiscard]] std::vector<double> min(const std::vector<double>& mine) const {
    return reduced(mine, [](double a, double b) { return a != a || a < b ? a : b; });
  }
  [[nodiscard]] std::vector<double> max(const std::vector<double>& mine) const {
    return reduced(mine, [](double a, double b) { return a != a || a > b ? a : b; });
  }
  // One rank makes no vectors: every iteration of a relaxation asks.
  [[nodiscard]] double sum(double mine) const { return count() == 1 ? mine : sum(one(mine))[0]; }
  [[nodiscard]] double min(double mine) const { return count() == 1 ? mine : min(one(mine))[0]; }
  [[nodiscard]] double max(double mine) const { return count() == 1 ? mine : max(one(mine))[0]; }

  /// Sum of the numbers of the ranks before this one, and of all ranks: exact below 2^53.
  struct Counts {
    std::int64_t before = 0, all = 0;
  };
  [[nodiscard]] Counts count_all(std::int64_t mine) const {
    const std::vector<double> of_ranks = all_of({double(mine)});
    Counts counts;
    for (std::size_t other = 0; other < of_ranks.size(); ++other) {
      if (other < std::size_t(rank())) counts.before += std::int64_t(of_ranks[other]);
      counts.all += std::int64_t(of_ranks[other]);
    }
    return counts;
  }

 private:
  [[nodiscard]] static std::vector<double> one(double number) { return {number}; }

  template <class Reduce>
  [[nodiscard]] std::vector<double> reduced(const std::vector<double>& mine,
                                            const Reduce& reduce) const {
    const std::vector<double> of_ranks = all_of(mine);
    std::vector<double> result(of_ranks.begin(), of_ranks.begin() + std::ptrdiff_t(mine.size()));
    for (std::size_t k = mine.size(); k < of_ranks.size(); ++k) {
      double& entry = result[k % mine.size()];
      entry = reduce(entry, of_ranks[k]);
    }
    return result;
  }
};

/// A run of one rank, without MPI.
class SoleRank : public Communicator {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int count() const override { return 1; }
  [[nodiscard]] std::vector<double> all_of(const std::vector<double>& mine) const override {
    return mine;
  }
  void gather(const std::string& mine, const Visit& visit) const override { visit(0, mine); }
  void broadcast(std::string&) const override {}
  [[noreturn]] void abort(int exit_code) const override { std::_Exit(exit_code); }
  [[nodiscard]] const void* handle() const override { return nullptr; }
};

/// The communicator of whatever one rank holds alone.
[[nodiscard]] inline const Communicator& sole_rank() {
  static const SoleRank sole;
  return sole;
}

}  // namespace peristat
