#include "solvers/linear/trilinos/matrix_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include <Ifpack2_Chebyshev.hpp>
#include <Ifpack2_RILUK.hpp>
#include <MueLu_Hierarchy.hpp>
#include <MueLu_ParameterListInterpreter.hpp>
#include <MueLu_SmootherBase.hpp>
#include <MueLu_TpetraOperator.hpp>
#include <MueLu_Utilities.hpp>
#include <Teuchos_Comm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Trilinos_version.h>
#include <Xpetra_Matrix.hpp>
#include <Xpetra_MultiVector.hpp>

#include "solvers/linear/trilinos/gathered_factor.hpp"
#include "solvers/linear/trilinos/module.hpp"
#include "solvers/linear/trilinos/teuchos_communicator.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat::trilinos {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;

// The only types that Debian's Tpetra is instantiated for.
using Map = Tpetra::Map<int, long long>;
using Vector = Tpetra::MultiVector<double, int, long long>;
using Operator = Tpetra::Operator<double, int, long long>;
using Matrix = Tpetra::CrsMatrix<double, int, long long>;
using RowMatrix = Tpetra::RowMatrix<double, int, long long>;
using Cycle = MueLu::TpetraOperator<double, int, long long>;

/// Hierarchy without descriptions: MueLu describes what it has built with a call of MPI, even if it
/// prints nothing. On one rank MPI is not running.
class Hierarchy : public MueLu::Hierarchy<double, int, long long> {
 public:
  using MueLu::Hierarchy<double, int, long long>::describe;
  void describe(Teuchos::FancyOStream&, MueLu::VerbLevel) const override {}
};

/// Rows of the equations in a matrix of whole points.
struct Embedding {
  int rows = 0;
  std::vector<int> row_of_equation;
};

/// Embeds the equations into whole points; points without any equation have no rows.
Embedding embed(int equations, const EquationBlocks& blocks) {
  Embedding embedding;
  embedding.row_of_equation.reserve(static_cast<std::size_t>(equations));
  int last_point = -1;
  for (int e = 0; e < equations; ++e) {
    const int dof = blocks.dof.empty() ? e : blocks.dof[e];
    const int point = dof / blocks.size;
    if (point != last_point) embedding.rows += blocks.size;
    last_point = point;
    embedding.row_of_equation.push_back(embedding.rows - blocks.size + dof % blocks.size);
  }
  return embedding;
}

double diagonal_entry(const CompressedRows& matrix, int row) {
  const auto first = matrix.column.begin() + std::ptrdiff_t(matrix.begin[row]);
  const auto last = matrix.column.begin() + std::ptrdiff_t(matrix.begin[row + 1]);
  const auto found = std::lower_bound(first, last, row);
  return found != last && *found == row ? matrix.value[found - matrix.column.begin()] : 0.0;
}

double sum(const CompressedRows& matrix, double mine) {
  return matrix.ranks ? matrix.ranks->sum(mine) : mine;
}

/// @throws NoPreconditioner on all ranks if the condition is met on any of them
void refuse(const CompressedRows& matrix, bool has_met, const char* what) {
  if (sum(matrix, has_met ? 1.0 : 0.0) > 0.0) throw NoPreconditioner(what);
}

/// Refuses a matrix that is not suitable, with which Trilinos would go on.
void check(const CompressedRows& matrix) {
  if (sum(matrix, matrix.rows) == 0.0) throw NoPreconditioner("no equations");
  refuse(matrix,
         std::any_of(matrix.value.begin(), matrix.value.end(),
                     [](double value) { return !std::isfinite(value); }),
         "an entry is not finite");
  bool is_positive = true;
  for (int row = 0; row < matrix.rows; ++row) {
    is_positive = is_positive && diagonal_entry(matrix, row) > 0.0;
  }
  refuse(matrix, !is_positive, "a diagonal entry is not positive");
}

RCP<const Teuchos::Comm<int>> communicator_of(const CompressedRows& matrix) {
  const SoleRank sole;
  return teuchos_communicator(matrix.ranks ? *matrix.ranks : sole);
}

/// Map with `rows` rows on this rank.
RCP<const Map> map_of_rows(const CompressedRows& matrix, int rows) {
  const auto any = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  return rcp(new Map(any, std::size_t(rows), 0, communicator_of(matrix)));
}

/// Exchange of the values of other ranks' rows that have columns here.
class GhostColumns {
 public:
  explicit GhostColumns(const CompressedRows& matrix) : own_(std::size_t(matrix.rows)) {
    if (!matrix.ranks) return;
    const auto any = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
    const RCP<const Map> rows = map_of_rows(matrix, matrix.rows);
    const RCP<const Map> ghosts = rcp(new Map(any, matrix.ghosts, 0, rows->getComm()));
    import_ = rcp(new Tpetra::Import<int, long long>(rows, ghosts));
    sent_ = rcp(new Vector(rows, 1));
    received_ = rcp(new Vector(ghosts, 1));
  }

  /// @param values of the rows here, then of the ghost columns
  void update(std::vector<double>& values) const {
    if (import_.is_null()) return;
    std::copy_n(values.begin(), own_, sent_->getDataNonConst(0).begin());
    received_->doImport(*sent_, *import_, Tpetra::INSERT);
    const Teuchos::ArrayRCP<const double> received = received_->getData(0);
    values.resize(own_);
    values.insert(values.end(), received.begin(), received.end());
  }

 private:
  std::size_t own_;
  RCP<Tpetra::Import<int, long long>> import_;  // null: all rows are here
  RCP<Vector> sent_, received_;
};

/// Column map of Tpetra's copy: its own rows, then the ghosts by their numbers in the whole copy.
RCP<const Map> map_of_columns(const CompressedRows& from, const Embedding& to,
                              const GhostColumns& ghosts, const RCP<const Map>& rows) {
  if (!from.ranks) return rows;
  const std::int64_t first = from.ranks->count_all(to.rows).before;
  std::vector<double> place;
  for (const int row : to.row_of_equation) place.push_back(double(first + row));
  ghosts.update(place);
  std::vector<long long> columns;
  for (int row = 0; row < to.rows; ++row) columns.push_back(first + row);
  for (std::size_t k = std::size_t(from.rows); k < place.size(); ++k) {
    columns.push_back(static_cast<long long>(place[k]));
  }
  const auto any = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  return rcp(new Map(any, columns, 0, rows->getComm()));
}

/// Returns Tpetra's copy of a matrix. Prescribed degrees of freedom get rows if their point has
/// free ones; such a row has only a diagonal entry, so that it couples with nothing.
RCP<Matrix> tpetra_matrix(const CompressedRows& from, const Embedding& to,
                          const GhostColumns& ghosts) {
  const auto rows = static_cast<std::size_t>(to.rows);
  const std::size_t added = rows - to.row_of_equation.size();
  double trace = 0.0;
  for (int row = 0; row < from.rows; ++row) trace += diagonal_entry(from, row);

  using Local = Matrix::local_matrix_device_type;
  // Comes before the arrays, because it starts Kokkos.
  const RCP<const Map> map = map_of_rows(from, to.rows);
  const RCP<const Map> columns = map_of_columns(from, to, ghosts, map);
  const Local::row_map_type::non_const_type begin("begin", rows + 1);
  const Local::index_type::non_const_type column("column", from.column.size() + added);
  const Local::values_type::non_const_type value("value", from.value.size() + added);
  std::size_t filled = 0;
  int equation = 0;
  for (int row = 0; row < to.rows; ++row) {
    begin(row) = filled;
    if (equation < from.rows && to.row_of_equation[equation] == row) {
      for (std::size_t k = from.begin[equation]; k < from.begin[equation + 1]; ++k, ++filled) {
        const int of = from.column[k];
        column(filled) = of < from.rows ? to.row_of_equation[of] : to.rows + (of - from.rows);
        value(filled) = from.value[k];
      }
      ++equation;
    } else {
      column(filled) = row;
      value(filled++) = trace / from.rows;
    }
  }
  begin(rows) = filled;

  const RCP<Matrix> matrix = rcp(new Matrix(map, columns, begin, column, value));
  matrix->expertStaticFillComplete(map, map);
  return matrix;
}

/// Largest eigenvalue of the symmetric tridiagonal matrix with the given diagonal and squared
/// off-diagonal entries, by bisection on the number of eigenvalues above a value (Sturm).
double largest_eigenvalue(const std::vector<double>& diagonal, const std::vector<double>& squares) {
  const std::size_t size = diagonal.size();
  double below = diagonal[0], above = diagonal[0];
  for (std::size_t k = 0; k < size; ++k) {
    const double radius =
        (k > 0 ? std::sqrt(squares[k - 1]) : 0.0) + (k + 1 < size ? std::sqrt(squares[k]) : 0.0);
    below = std::max(below, diagonal[k]);
    above = std::max(above, diagonal[k] + radius);
  }
  const auto all_are_below = [&](double value) {
    double pivot = 0.0;
    for (std::size_t k = 0; k < size; ++k) {
      pivot = diagonal[k] - value - (k > 0 ? squares[k - 1] / pivot : 0.0);
      if (!(pivot < 0.0)) return false;
    }
    return true;
  };
  while (above - below > 1e-6 * above) {
    const double middle = 0.5 * (below + above);
    (all_are_below(middle) ? above : below) = middle;
  }
  return above;
}

/// Largest eigenvalue of D^-1 A, D the diagonal of A, by Lanczos' method on D^-1/2 A D^-1/2. A few
/// dozen steps reach what takes hundreds of the power method. The start is always the same:
/// Ifpack2's is random, and no two preconditioners would agree.
double largest_eigenvalue(const CompressedRows& matrix, const GhostColumns& ghosts, int steps) {
  const auto rows = static_cast<std::size_t>(matrix.rows);
  const auto count =
      matrix.ranks ? matrix.ranks->count_all(matrix.rows) : Communicator::Counts{0, matrix.rows};
  std::vector<double> scale(rows), last(rows, 0.0), current(rows), next(rows);
  std::mt19937 random;
  random.discard(static_cast<unsigned long long>(count.before));
  double squared = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    scale[row] = 1.0 / std::sqrt(diagonal_entry(matrix, static_cast<int>(row)));
    current[row] = double(random()) * 0x1p-32 - 0.5;
    squared += current[row] * current[row];
  }
  squared = sum(matrix, squared);
  for (double& entry : current) entry /= std::sqrt(squared);
  ghosts.update(scale);

  std::vector<double> diagonal, squares;
  double beside = 0.0;
  for (int step = 0; step < steps && step < count.all; ++step) {
    ghosts.update(current);
    double projection = 0.0;
    for (std::size_t row = 0; row < rows; ++row) {
      double product = 0.0;
      for (std::size_t k = matrix.begin[row]; k < matrix.begin[row + 1]; ++k) {
        product += matrix.value[k] * scale[matrix.column[k]] * current[matrix.column[k]];
      }
      next[row] = scale[row] * product - beside * last[row];
      projection += next[row] * current[row];
    }
    projection = sum(matrix, projection);
    diagonal.push_back(projection);
    squared = 0.0;
    for (std::size_t row = 0; row < rows; ++row) {
      next[row] -= projection * current[row];
      squared += next[row] * next[row];
    }
    squared = sum(matrix, squared);
    beside = std::sqrt(squared);
    // The start spans an invariant space, in which there is nothing more to find.
    if (beside <= 1e-10 * projection) break;
    squares.push_back(squared);
    for (double& entry : next) entry /= beside;
    std::swap(last, current);
    std::swap(current, next);
    next.resize(rows);
  }
  return largest_eigenvalue(diagonal, squares);
}

RCP<Operator> make_riluk(const CompressedRows& from, const RCP<Matrix>& matrix,
                         const MatrixPreconditionerOptions& options) {
  const auto riluk = rcp(new Ifpack2::RILUK<RowMatrix>(RCP<const RowMatrix>(matrix)));
  Teuchos::ParameterList parameters;
  parameters.set("fact: iluk level-of-fill", options.level_of_fill);
  riluk->setParameters(parameters);
  riluk->initialize();
  riluk->compute();
  // Ifpack2 goes on after any pivot; it stores their inverses.
  const Teuchos::ArrayRCP<const double> pivots = riluk->getD().getData(0);
  refuse(from,
         std::any_of(pivots.begin(), pivots.end(),
                     [](double inverse) { return !(inverse > 0.0 && std::isfinite(inverse)); }),
         "a pivot of the incomplete factors is not positive");
  return riluk;
}

RCP<Operator> make_chebyshev(const RCP<Matrix>& matrix, double eigenvalue,
                             const MatrixPreconditionerOptions& options) {
  const auto chebyshev = rcp(new Ifpack2::Chebyshev<RowMatrix>(RCP<const RowMatrix>(matrix)));
  Teuchos::ParameterList parameters;
  parameters.set("chebyshev: degree", options.chebyshev_degree);
  // Ifpack2 adds 10 % of safety.
  parameters.set("chebyshev: max eigenvalue", eigenvalue);
  parameters.set("chebyshev: zero starting solution", true);
  chebyshev->setParameters(parameters);
  chebyshev->initialize();
  chebyshev->compute();
  return chebyshev;
}

/// Solves the coarsest level of multigrid on several ranks. KLU2 of Amesos2 13.2 gives wrong
/// solutions for matrices that are distributed over ranks.
class CoarsestLevel : public MueLu::SmootherBase<double, int, long long> {
 public:
  using Level = Xpetra::Matrix<double, int, long long>;
  using Vectors = Xpetra::MultiVector<double, int, long long>;

  CoarsestLevel(const CompressedRows& from, const Level& matrix) : factor_(*from.ranks) {
    GatheredRows rows;
    rows.begin.push_back(0);
    for (std::size_t row = 0; row < matrix.getNodeNumRows(); ++row) {
      Teuchos::ArrayView<const int> columns;
      Teuchos::ArrayView<const double> values;
      matrix.getLocalRowView(int(row), columns, values);
      rows.number.push_back(matrix.getRowMap()->getGlobalElement(int(row)));
      for (const int column : columns) {
        rows.column.push_back(matrix.getColMap()->getGlobalElement(column));
      }
      rows.value.insert(rows.value.end(), values.begin(), values.end());
      rows.begin.push_back(rows.value.size());
    }
    if (!factor_.factorize(rows)) {
      throw NoPreconditioner("the coarsest level of multigrid can't be factorised");
    }
  }

  void Apply(Vectors& x, const Vectors& b, bool /*x_is_zero*/) const override {
    factor_.solve(b.getData(0).getRawPtr(), x.getDataNonConst(0).getRawPtr());
  }
  [[nodiscard]] std::size_t getNodeSmootherComplexity() const override {
    return Teuchos::OrdinalTraits<std::size_t>::invalid();
  }

 private:
  GatheredFactor factor_;
};

RCP<Operator> make_multigrid(const CompressedRows& from, const RCP<Matrix>& matrix,
                             double eigenvalue, int block_size, const Embedding& embedding,
                             const NearNullSpace& near_null_space,
                             const MatrixPreconditionerOptions& options) {
  Teuchos::ParameterList parameters;
  parameters.set("verbosity", "none");
  parameters.set("number of equations", block_size);
  parameters.set("multigrid algorithm", "sa");
  // For the coarse levels; ten iterations, the default, estimate 1.35 instead of 1.60.
  parameters.set("sa: eigenvalue estimate num iterations", 80);
  parameters.set("coarse: max size", options.largest_coarse_system);
  parameters.set("coarse: type", from.ranks ? "none" : "KLU2");
  // The same smoother before and after the coarse correction, symmetric in itself: so is the cycle.
  Teuchos::ParameterList& smoother = parameters.sublist("smoother: params");
  if (from.ranks) {  // a polynomial does not depend on the number of ranks
    parameters.set("smoother: type", "CHEBYSHEV");
    smoother.set("chebyshev: degree", 5);
    smoother.set("chebyshev: ratio eigenvalue", 20.0);
    smoother.set("chebyshev: zero starting solution", true);
  } else {
    parameters.set("smoother: type", "RELAXATION");
    smoother.set("relaxation: type", "Symmetric Gauss-Seidel");
    smoother.set("relaxation: sweeps", 1);
  }

  MueLu::ParameterListInterpreter<double, int, long long> setup(parameters,
                                                                matrix->getRowMap()->getComm());
  const RCP<MueLu::Hierarchy<double, int, long long>> hierarchy = rcp(new Hierarchy);
  hierarchy->setlib(Xpetra::UseTpetra);
  const auto fine = MueLu::TpetraCrs_To_XpetraMatrix(matrix);
  fine->SetMaxEigenvalueEstimate(eigenvalue);
  hierarchy->GetLevel(0)->Set("A", fine);
  if (near_null_space.count > 0) {
    const RCP<Vector> motions =
        rcp(new Vector(matrix->getRowMap(), static_cast<std::size_t>(near_null_space.count)));
    const std::size_t equations = embedding.row_of_equation.size();
    for (int motion = 0; motion < near_null_space.count; ++motion) {
      const Teuchos::ArrayRCP<double> column = motions->getDataNonConst(std::size_t(motion));
      // MueLu refuses aggregates in which a motion vanishes, such as those of points that may only
      // move along one axis. Rows of prescribed components therefore get noise, too small to matter
      // beside a free one.
      for (int row = 0; row < embedding.rows; ++row) {
        column[row] = 1e-6 * std::cos(double(row) * double(2 * motion + 1) + double(motion));
      }
      for (std::size_t e = 0; e < equations; ++e) {
        column[embedding.row_of_equation[e]] =
            near_null_space.values[std::size_t(motion) * equations + e];
      }
    }
    hierarchy->GetLevel(0)->Set("Nullspace",
                                MueLu::TpetraMultiVector_To_XpetraMultiVector(motions));
  }
  setup.SetupHierarchy(*hierarchy);
  if (from.ranks) {
    using Level = CoarsestLevel::Level;
    const RCP<MueLu::Level>& last = hierarchy->GetLevel(hierarchy->GetNumLevels() - 1);
    const auto coarsest = Teuchos::rcp_dynamic_cast<Level>(
        last->Get<RCP<Xpetra::Operator<double, int, long long>>>("A"));
    const RCP<MueLu::SmootherBase<double, int, long long>> solver =
        rcp(new CoarsestLevel(from, *coarsest));
    last->Set("PreSmoother", solver);
  }
  return rcp(new Cycle(hierarchy));
}

class TrilinosPreconditioner : public Preconditioner {
 public:
  TrilinosPreconditioner(MatrixPreconditionerKind kind, const MatrixPreconditionerOptions& options)
      : kind_(kind), options_(options) {}

  void build(const CompressedRows& from, const EquationBlocks& blocks,
             const NearNullSpace& near_null_space) override {
    inverse_ = Teuchos::null;  // frees the old one before the next is built
    check(from);
    const bool by_points = kind_ == MatrixPreconditionerKind::multigrid;
    embedding_ = embed(from.rows, by_points ? blocks : EquationBlocks{});
    const GhostColumns ghosts(from);
    const RCP<Matrix> matrix = tpetra_matrix(from, embedding_, ghosts);
    switch (kind_) {
      case MatrixPreconditionerKind::riluk:
        inverse_ = make_riluk(from, matrix, options_);
        break;
      case MatrixPreconditionerKind::chebyshev:
        inverse_ = make_chebyshev(matrix, largest_eigenvalue(from, ghosts, options_.lanczos_steps),
                                  options_);
        break;
      case MatrixPreconditionerKind::multigrid:
        inverse_ =
            make_multigrid(from, matrix, largest_eigenvalue(from, ghosts, options_.lanczos_steps),
                           blocks.size, embedding_, near_null_space, options_);
        break;
    }
    argument_ = rcp(new Vector(matrix->getRowMap(), 1));
    result_ = rcp(new Vector(matrix->getRowMap(), 1));
  }

  void apply(const double* r, double* z) override {
    const std::vector<int>& rows = embedding_.row_of_equation;
    {
      const Teuchos::ArrayRCP<double> argument = argument_->getDataNonConst(0);
      for (std::size_t e = 0; e < rows.size(); ++e) argument[rows[e]] = r[e];
    }
    inverse_->apply(*argument_, *result_);
    const Teuchos::ArrayRCP<const double> result = result_->getData(0);
    for (std::size_t e = 0; e < rows.size(); ++e) z[e] = result[rows[e]];
  }

  [[nodiscard]] std::string describe() const override {
    switch (kind_) {
      case MatrixPreconditionerKind::riluk:
        return "incomplete factors, level of fill " + std::to_string(options_.level_of_fill) +
               " (Ifpack2)";
      case MatrixPreconditionerKind::chebyshev:
        return "Chebyshev polynomial of degree " + std::to_string(options_.chebyshev_degree) +
               " (Ifpack2)";
      case MatrixPreconditionerKind::multigrid:
        break;
    }
    std::string text = "smoothed aggregation";
    if (!inverse_.is_null()) {
      const auto hierarchy = Teuchos::rcp_dynamic_cast<Cycle>(inverse_)->GetHierarchy();
      text += " on " + std::to_string(hierarchy->GetNumLevels()) + " levels";
    }
    return text + " (MueLu)";
  }

 private:
  MatrixPreconditionerKind kind_;
  MatrixPreconditionerOptions options_;
  Embedding embedding_;
  RCP<Operator> inverse_;
  RCP<Vector> argument_, result_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_preconditioner(MatrixPreconditionerKind kind,
                                                    const MatrixPreconditionerOptions& options) {
  return std::make_unique<TrilinosPreconditioner>(kind, options);
}

std::string version() { return TRILINOS_VERSION_STRING; }

}  // namespace peristat::trilinos
