#include "solvers/linear/mumps/symmetric_factor.hpp"

#include <cstring>
#include <stdexcept>

#include <dmumps_c.h>

#include "solvers/linear/mumps/module.hpp"

namespace peristat::mumps {
namespace {

/// MUMPS numbers its control and result arrays from 1.
template <class Array>
auto& at(Array& array, int number) {
  return array[number - 1];
}

/// Jobs of a call of MUMPS.
enum Job { start = -1, end = -2, analysis = 1, factorisation = 2, solution = 3 };

class Factor final : public SymmetricFactor {
 public:
  Factor() {
    std::memset(&data_, 0, sizeof data_);
    constexpr int all_processes = -987654;  // MUMPS' code for all; there is one
    data_.comm_fortran = all_processes;
    data_.par = 1;
    constexpr int symmetric_indefinite = 2;
    data_.sym = symmetric_indefinite;
    static_cast<void>(call(start));
    for (const int stream : {1, 2, 3}) at(data_.icntl, stream) = -1;  // prints nothing
    at(data_.icntl, 4) = 0;
  }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;
  ~Factor() override {
    data_.job = end;
    dmumps_c(&data_);
  }

  FactorOutcome analyze(const LowerEntries& entries) override {
    data_.n = entries.rows;
    data_.nnz = static_cast<MUMPS_INT8>(entries.row.size());
    data_.irn = const_cast<int*>(entries.row.data());
    data_.jcn = const_cast<int*>(entries.column.data());
    return call(analysis);
  }

  double expected_entries() const override {
    const int entries = at(data_.infog, 3);  // in millions where it is negative
    return entries < 0 ? -1e6 * entries : entries;
  }
  double expected_flops() const override { return at(data_.rinfog, 1); }

  FactorOutcome factorize(std::vector<double>& values) override {
    data_.a = values.data();
    // Workspace beyond the estimate, in per cent: pivoting may delay rows.
    for (const int room : {30, 100, 400}) {
      at(data_.icntl, 14) = room;
      const FactorOutcome outcome = call(factorisation);
      if (!lacks_room()) return outcome;
    }
    return FactorOutcome::put_off;
  }

  std::int64_t negative_pivots() const override { return at(data_.infog, 12); }

  void solve(double* right_hand_side) override {
    data_.rhs = right_hand_side;
    if (call(solution) != FactorOutcome::done) throw std::runtime_error("MUMPS: no solution");
  }

 private:
  bool lacks_room() const {
    const int code = at(data_.infog, 1);
    return code == -8 || code == -9;
  }

  FactorOutcome call(Job job) {
    data_.job = job;
    dmumps_c(&data_);
    const int code = at(data_.infog, 1);
    if (code >= 0) return FactorOutcome::done;
    constexpr int zero_pivot = -10, structurally_singular = -6;
    if (code == zero_pivot || code == structurally_singular) return FactorOutcome::singular;
    constexpr int no_memory = -13, no_memory_for_pattern = -7, limit_of_memory = -19;
    if (lacks_room() || code == no_memory || code == no_memory_for_pattern ||
        code == limit_of_memory) {
      return FactorOutcome::out_of_memory;
    }
    throw std::runtime_error("MUMPS ended with error " + std::to_string(code) + ", " +
                             std::to_string(at(data_.infog, 2)));
  }

  DMUMPS_STRUC_C data_;
};

}  // namespace

std::unique_ptr<SymmetricFactor> make_symmetric_factor() { return std::make_unique<Factor>(); }

std::string version() { return MUMPS_VERSION; }

}  // namespace peristat::mumps
