#include "solvers/linear/trilinos/matrix_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include <Ifpack2_Chebyshev.hpp>
#include <Ifpack2_RILUK.hpp>
#include <MueLu_Hierarchy.hpp>
#include <MueLu_ParameterListInterpreter.hpp>
#include <MueLu_TpetraOperator.hpp>
#include <MueLu_Utilities.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Trilinos_version.h>

#include "solvers/linear/trilinos/module.hpp"

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

/// MueLu ends by describing what it has built, by a call of MPI and even if it prints nothing. MPI
/// is not running.
class Hierarchy : public MueLu::Hierarchy<double, int, long long> {
 public:
  using MueLu::Hierarchy<double, int, long long>::describe;
  void describe(Teuchos::FancyOStream&, MueLu::VerbLevel) const override {}
};

/// Where the equations go in a matrix of whole points.
struct Embedding {
  int rows = 0;
  std::vector<int> row_of_equation;
};

/// Points without any equation have no rows.
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

/// Trilinos would go on with anything.
void check(const CompressedRows& matrix) {
  if (matrix.rows == 0) throw std::runtime_error("no equations");
  for (const double value : matrix.value) {
    if (!std::isfinite(value)) throw std::runtime_error("an entry is not finite");
  }
  for (int row = 0; row < matrix.rows; ++row) {
    if (!(diagonal_entry(matrix, row) > 0.0)) {
      throw std::runtime_error("a diagonal entry is not positive");
    }
  }
}

/// Tpetra's copy of a matrix, with rows of its own for the prescribed degrees of freedom of points
/// that have others: nothing but a diagonal, so that they couple with nothing.
RCP<Matrix> tpetra_matrix(const CompressedRows& from, const Embedding& to) {
  const auto rows = static_cast<std::size_t>(to.rows);
  const std::size_t added = rows - to.row_of_equation.size();
  double trace = 0.0;
  for (int row = 0; row < from.rows; ++row) trace += diagonal_entry(from, row);

  using Local = Matrix::local_matrix_device_type;
  // Before the arrays: this starts Kokkos.
  const RCP<const Map> map = rcp(new Map(to.rows, 0, rcp(new Teuchos::SerialComm<int>)));
  const Local::row_map_type::non_const_type begin("begin", rows + 1);
  const Local::index_type::non_const_type column("column", from.column.size() + added);
  const Local::values_type::non_const_type value("value", from.value.size() + added);
  std::size_t filled = 0;
  int equation = 0;
  for (int row = 0; row < to.rows; ++row) {
    begin(row) = filled;
    if (equation < from.rows && to.row_of_equation[equation] == row) {
      for (std::size_t k = from.begin[equation]; k < from.begin[equation + 1]; ++k, ++filled) {
        column(filled) = to.row_of_equation[from.column[k]];
        value(filled) = from.value[k];
      }
      ++equation;
    } else {
      column(filled) = row;
      value(filled++) = trace / from.rows;
    }
  }
  begin(rows) = filled;

  const RCP<Matrix> matrix = rcp(new Matrix(map, map, begin, column, value));
  matrix->expertStaticFillComplete(map, map);
  return matrix;
}

/// Largest eigenvalue of the symmetric tridiagonal matrix with that diagonal and, squared, those
/// entries beside it; by bisection on the number of eigenvalues above a value (Sturm).
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
/// dozen steps reach what takes hundreds of the power method, and from a start that is always the
/// same: Ifpack2's is random, and no two preconditioners would agree.
double largest_eigenvalue(const CompressedRows& matrix, int steps) {
  const auto rows = static_cast<std::size_t>(matrix.rows);
  std::vector<double> scale(rows), last(rows, 0.0), current(rows), next(rows);
  std::mt19937 random;
  double squared = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    scale[row] = 1.0 / std::sqrt(diagonal_entry(matrix, static_cast<int>(row)));
    current[row] = double(random()) * 0x1p-32 - 0.5;
    squared += current[row] * current[row];
  }
  for (double& entry : current) entry /= std::sqrt(squared);

  std::vector<double> diagonal, squares;
  double beside = 0.0;
  for (int step = 0; step < steps && step < matrix.rows; ++step) {
    double projection = 0.0;
    for (std::size_t row = 0; row < rows; ++row) {
      double sum = 0.0;
      for (std::size_t k = matrix.begin[row]; k < matrix.begin[row + 1]; ++k) {
        sum += matrix.value[k] * scale[matrix.column[k]] * current[matrix.column[k]];
      }
      next[row] = scale[row] * sum - beside * last[row];
      projection += next[row] * current[row];
    }
    diagonal.push_back(projection);
    squared = 0.0;
    for (std::size_t row = 0; row < rows; ++row) {
      next[row] -= projection * current[row];
      squared += next[row] * next[row];
    }
    beside = std::sqrt(squared);
    // The start spans an invariant space: there is nothing more to find in it.
    if (beside <= 1e-10 * projection) break;
    squares.push_back(squared);
    for (double& entry : next) entry /= beside;
    std::swap(last, current);
    std::swap(current, next);
  }
  return largest_eigenvalue(diagonal, squares);
}

RCP<Operator> make_riluk(const RCP<Matrix>& matrix, const MatrixPreconditionerOptions& options) {
  const auto riluk = rcp(new Ifpack2::RILUK<RowMatrix>(RCP<const RowMatrix>(matrix)));
  Teuchos::ParameterList parameters;
  parameters.set("fact: iluk level-of-fill", options.level_of_fill);
  riluk->setParameters(parameters);
  riluk->initialize();
  riluk->compute();
  // Ifpack2 goes on after any pivot; what it keeps are their inverses.
  const Teuchos::ArrayRCP<const double> pivots = riluk->getD().getData(0);
  for (const double inverse : pivots) {
    if (!(inverse > 0.0 && std::isfinite(inverse))) {
      throw std::runtime_error("a pivot of the incomplete factors is not positive");
    }
  }
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

RCP<Operator> make_multigrid(const RCP<Matrix>& matrix, double eigenvalue, int block_size,
                             const Embedding& embedding, const NearNullSpace& near_null_space,
                             const MatrixPreconditionerOptions& options) {
  Teuchos::ParameterList parameters;
  parameters.set("verbosity", "none");
  parameters.set("number of equations", block_size);
  parameters.set("multigrid algorithm", "sa");
  // On the coarse levels; ten, the default, give 1.35 for 1.60.
  parameters.set("sa: eigenvalue estimate num iterations", 80);
  parameters.set("coarse: max size", options.largest_coarse_system);
  parameters.set("coarse: type", "KLU2");
  // The same before and after the coarse correction, and symmetric in itself: so is the cycle.
  parameters.set("smoother: type", "RELAXATION");
  Teuchos::ParameterList& smoother = parameters.sublist("smoother: params");
  smoother.set("relaxation: type", "Symmetric Gauss-Seidel");
  smoother.set("relaxation: sweeps", 1);

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
      // move along one axis. In rows that stand for prescribed components motions are noise, too
      // small to matter beside a free one.
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
  return rcp(new Cycle(hierarchy));
}

class TrilinosPreconditioner : public Preconditioner {
 public:
  TrilinosPreconditioner(MatrixPreconditionerKind kind, const MatrixPreconditionerOptions& options)
      : kind_(kind), options_(options) {}

  void build(const CompressedRows& from, const EquationBlocks& blocks,
             const NearNullSpace& near_null_space) override {
    inverse_ = Teuchos::null;  // first, to have room for the next
    check(from);
    const bool by_points = kind_ == MatrixPreconditionerKind::multigrid;
    embedding_ = embed(from.rows, by_points ? blocks : EquationBlocks{});
    const RCP<Matrix> matrix = tpetra_matrix(from, embedding_);
    switch (kind_) {
      case MatrixPreconditionerKind::riluk:
        inverse_ = make_riluk(matrix, options_);
        break;
      case MatrixPreconditionerKind::chebyshev:
        inverse_ =
            make_chebyshev(matrix, largest_eigenvalue(from, options_.lanczos_steps), options_);
        break;
      case MatrixPreconditionerKind::multigrid:
        inverse_ = make_multigrid(matrix, largest_eigenvalue(from, options_.lanczos_steps),
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
