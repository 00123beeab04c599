#include "solvers/linear/lu_factor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <omp.h>
#include <suitesparse/umfpack.h>

namespace peristat {
namespace {

static_assert(std::is_same_v<Offset, SuiteSparse_long>);
using Long = SuiteSparse_long;

/// Rows from which METIS has a smaller factor than AMD, by a fifth of the flops and more.
constexpr Index smallest_for_metis = 5'000;

/// Condition number that leaves no digit of a solution.
constexpr double singular_condition = 1.0 / std::numeric_limits<double>::epsilon();

/// Memory of UMFPACK, measured within a factor of 1.5: factor and working arrays over the factor
/// (1.2 to 1.6 in 2D and 3D), and bytes per entry of the matrix.
constexpr double working_memory = 1.5, bytes_per_matrix_entry = 10.0;

/// Bytes per matrix entry of the copy that is kept here to recognise an unchanged matrix.
constexpr double bytes_of_copy = sizeof(Long) + sizeof(double);

/// Restricts OpenBLAS, which follows OpenMP, to one thread.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

LinearOutcome outcome_of(Long status) {
  switch (status) {
    case UMFPACK_OK:
      return LinearOutcome::solved;
    case UMFPACK_ERROR_out_of_memory:
    case UMFPACK_ERROR_n_nonpositive:
      return LinearOutcome::out_of_memory;
    default:
      return LinearOutcome::singular;
  }
}

}  // namespace

struct LuFactor::Umfpack {
  double most_bytes;
  // UMFPACK takes columns: given these rows, it factorises the transpose.
  std::vector<Long> begin, column;
  std::vector<double> value;
  void *symbolic = nullptr, *numeric = nullptr;
  std::array<double, UMFPACK_CONTROL> control{};
  std::array<double, UMFPACK_INFO> info{};
  double entries = 0.0, flops = 0.0;
  int orders = 0, factorisations = 0;

  explicit Umfpack(double bytes) : most_bytes(bytes) {
    umfpack_dl_defaults(control.data());
    control[UMFPACK_PRL] = 0;
    // Interactions couple both ways, so that the pattern is symmetric except at cracks. By default
    // UMFPACK would need the values to detect this, and its order would depend on them.
    control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    control[UMFPACK_IRSTEP] = 0;
  }
  Umfpack(const Umfpack&) = delete;
  Umfpack& operator=(const Umfpack&) = delete;
  ~Umfpack() { release(); }

  void release_numbers() { umfpack_dl_free_numeric(&numeric); }
  void release() {
    release_numbers();
    umfpack_dl_free_symbolic(&symbolic);
  }

  [[nodiscard]] Long size() const { return Long(begin.size()) - 1; }

  [[nodiscard]] bool has_pattern_of(const SparseRows& matrix) const {
    return symbolic && matrix.offset == begin &&
           std::equal(column.begin(), column.end(), matrix.column.begin(), matrix.column.end());
  }

  [[nodiscard]] bool fits(double factor_entries) const {
    const double need = 8.0 * working_memory * factor_entries +
                        (bytes_per_matrix_entry + bytes_of_copy) * double(column.size());
    return need <= most_bytes;
  }

  LinearOutcome find_order(const SparseRows& matrix) {
    release();
    begin = matrix.offset;
    column.assign(matrix.column.begin(), matrix.column.end());
    control[UMFPACK_ORDERING] =
        size() < smallest_for_metis ? UMFPACK_ORDERING_AMD : UMFPACK_ORDERING_METIS;
    ++orders;
    const Long status = umfpack_dl_symbolic(size(), size(), begin.data(), column.data(), nullptr,
                                            &symbolic, control.data(), info.data());
    if (status != UMFPACK_OK) return outcome_of(status);
    // If rows and columns of a single entry leave no square rest, UMFPACK falls back on an order
    // for unsymmetric patterns, and gives only bounds.
    const bool is_symmetric = info[UMFPACK_SYMMETRIC_LUNZ] > 0.0;
    entries = is_symmetric ? info[UMFPACK_SYMMETRIC_LUNZ]
                           : info[UMFPACK_LNZ_ESTIMATE] + info[UMFPACK_UNZ_ESTIMATE];
    flops = is_symmetric ? info[UMFPACK_SYMMETRIC_FLOPS] : info[UMFPACK_FLOPS_ESTIMATE];
    if (fits(entries)) return LinearOutcome::solved;
    release();
    return LinearOutcome::out_of_memory;
  }

  void apply_inverse(const std::vector<double>& b, double* x) const {
    // Solves with the transpose of the factorised transpose. Without refinement the matrix is not
    // read.
    umfpack_dl_solve(UMFPACK_Aat, nullptr, nullptr, nullptr, x, b.data(), numeric, control.data(),
                     nullptr);
  }

  [[nodiscard]] std::vector<double> row_sums() const {
    std::vector<double> sums(std::size_t(size()), 0.0);
    for (std::size_t r = 0; r < sums.size(); ++r) {
      for (auto k = std::size_t(begin[r]); k < std::size_t(begin[r + 1]); ++k) {
        sums[r] += std::abs(value[k]);
      }
    }
    return sums;
  }

  /// Lower bound of the condition number of the matrix A with its rows scaled to sums of one, so
  /// that units and materials don't matter: growth under A^-1 D, D the row sums, of a vector to
  /// which it has been applied once.
  [[nodiscard]] double condition() const {
    const auto largest = [](const std::vector<double>& v) {
      double most = 0.0;
      for (const double entry : v) most = std::max(most, std::abs(entry));
      return most;
    };
    const std::vector<double> sums = row_sums();
    std::vector<double> v(sums.size()), image(sums.size());
    std::mt19937_64 bits(1);
    for (double& entry : v) entry = 2.0 * double(bits() >> 11) * 0x1p-53 - 1.0;
    double growth = 0.0;
    for (int k = 0; k < 2; ++k) {
      const double before = largest(v);
      for (std::size_t r = 0; r < v.size(); ++r) v[r] *= sums[r] / before;
      apply_inverse(v, image.data());
      v.swap(image);
      growth = largest(v);
      if (!(growth < singular_condition)) break;
    }
    return growth;
  }

  LinearOutcome find_numbers() {
    release_numbers();
    ++factorisations;
    const Long status = umfpack_dl_numeric(begin.data(), column.data(), value.data(), symbolic,
                                           &numeric, control.data(), info.data());
    LinearOutcome outcome = outcome_of(status);
    if (outcome == LinearOutcome::solved) {
      entries = info[UMFPACK_LNZ] + info[UMFPACK_UNZ];
      flops = info[UMFPACK_FLOPS];
      if (!(condition() < singular_condition)) outcome = LinearOutcome::singular;
    }
    if (outcome != LinearOutcome::solved) release_numbers();
    return outcome;
  }
};

LuFactor::LuFactor(double most_bytes) : umfpack_(std::make_unique<Umfpack>(most_bytes)) {}
LuFactor::~LuFactor() = default;

void LuFactor::reset() { umfpack_->release(); }

LinearOutcome LuFactor::factorize(SparseRows matrix) {
  Umfpack& own = *umfpack_;
  const bool is_known = own.has_pattern_of(matrix);
  if (is_known && own.numeric && own.value == matrix.value) return LinearOutcome::solved;
  own.release_numbers();
  const auto is_finite = [](double entry) { return std::isfinite(entry); };
  if (!std::all_of(matrix.value.begin(), matrix.value.end(), is_finite)) {
    return LinearOutcome::singular;
  }
  const OneThread one;
  if (!is_known) {
    const LinearOutcome outcome = own.find_order(matrix);
    if (outcome != LinearOutcome::solved) return outcome;
  }
  own.value = std::move(matrix.value);
  matrix = {};  // frees its memory before the factor is made
  return own.find_numbers();
}

bool LuFactor::is_ready() const { return umfpack_->numeric != nullptr; }

void LuFactor::solve(std::span<double> v) const {
  umfpack_->apply_inverse({v.begin(), v.end()}, v.data());
}

double LuFactor::largest_row_sum() const {
  const std::vector<double> sums = umfpack_->row_sums();
  return sums.empty() ? 0.0 : *std::max_element(sums.begin(), sums.end());
}

int LuFactor::orders() const { return umfpack_->orders; }
int LuFactor::factorisations() const { return umfpack_->factorisations; }
double LuFactor::entries() const { return umfpack_->entries; }
double LuFactor::flops() const { return umfpack_->flops; }

std::string LuFactor::describe() const {
  if (!umfpack_->symbolic) return "not factorised yet";
  return fmt::format("{} order, factor {:.3g} entries ({:.0f} MB), {:.3g} flops",
                     umfpack_->size() < smallest_for_metis ? "AMD" : "METIS", entries(),
                     8e-6 * entries(), flops());
}

std::string LuFactor::library_version() {
  return fmt::format("{}.{}.{}", UMFPACK_MAIN_VERSION, UMFPACK_SUB_VERSION, UMFPACK_SUBSUB_VERSION);
}

}  // namespace peristat
