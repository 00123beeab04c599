#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

// Read as C++17, too, by what starts MPI: solvers/ranks/trilinos.

namespace peristat {

/// The ranks of a run: processes each of which holds a part of the body. Every call but rank, count
/// and abort is one that all ranks make, in the same order.
///
/// Sums are added up in the order of the ranks, by every rank alike: all get the same bits, so that
/// they decide alike, and a number of ranks gives the same bits again.
class Communicator {
 public:
  Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  virtual ~Communicator() = default;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int count() const = 0;

  /// What the ranks give, rank by rank; all give as many numbers.
  [[nodiscard]] virtual std::vector<double> all_of(const std::vector<double>& mine) const = 0;

  /// At rank 0: visit(rank, bytes) with what every rank gives, in their order and one at a time, so
  /// that rank 0 need not hold all of it. Elsewhere nothing is visited.
  using Visit = std::function<void(int rank, const std::string& bytes)>;
  virtual void gather(const std::string& mine, const Visit& visit) const = 0;

  /// Gives all ranks the bytes of rank 0.
  virtual void broadcast(std::string& bytes) const = 0;

  /// Ends all ranks with a message on standard error; not a call that all make.
  [[noreturn]] virtual void abort(const std::string& message, int exit_code) const = 0;

  /// An MPI_Comm, for what is compiled with MPI; null: a sole rank without MPI.
  [[nodiscard]] virtual const void* handle() const = 0;

  [[nodiscard]] std::vector<double> sum(const std::vector<double>& mine) const {
    return reduced(mine, [](double a, double b) { return a + b; });
  }
  /// Numbers that are not finite stay: a comparison must not lose them.
  [[nodiscard]] std::vector<double> min(const std::vector<double>& mine) const {
    return reduced(mine, [](double a, double b) { return a != a || a < b ? a : b; });
  }
  [[nodiscard]] std::vector<double> max(const std::vector<double>& mine) const {
    return reduced(mine, [](double a, double b) { return a != a || a > b ? a : b; });
  }
  [[nodiscard]] double sum(double mine) const { return sum(std::vector<double>{mine})[0]; }
  [[nodiscard]] double min(double mine) const { return min(std::vector<double>{mine})[0]; }
  [[nodiscard]] double max(double mine) const { return max(std::vector<double>{mine})[0]; }

  /// Numbers of ranks before this one, added up, and those of all: exact below 2^53.
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
  [[noreturn]] void abort(const std::string& message, int exit_code) const override {
    std::cerr << message << std::endl;
    std::_Exit(exit_code);
  }
  [[nodiscard]] const void* handle() const override { return nullptr; }
};

}  // namespace peristat
