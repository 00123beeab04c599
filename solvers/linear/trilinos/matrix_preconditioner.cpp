#include "solvers/linear/trilinos/matrix_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
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

namespace peristat {
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

RCP<Operator> make_chebyshev(const RCP<Matrix>& matrix,
                             const MatrixPreconditionerOptions& options) {
  const auto chebyshev = rcp(new Ifpack2::Chebyshev<RowMatrix>(RCP<const RowMatrix>(matrix)));
  Teuchos::ParameterList parameters;
  parameters.set("chebyshev: degree", options.chebyshev_degree);
  parameters.set("chebyshev: eigenvalue max iterations", options.power_iterations);
  parameters.set("chebyshev: zero starting solution", true);
  chebyshev->setParameters(parameters);
  chebyshev->initialize();
  chebyshev->compute();
  return chebyshev;
}

RCP<Operator> make_multigrid(const RCP<Matrix>& matrix, int block_size, const Embedding& embedding,
                             const NearNullSpace& near_null_space,
                             const MatrixPreconditionerOptions& options) {
  Teuchos::ParameterList parameters;
  parameters.set("verbosity", "none");
  parameters.set("number of equations", block_size);
  parameters.set("multigrid algorithm", "sa");
  parameters.set("sa: eigenvalue estimate num iterations", options.power_iterations);
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
  hierarchy->GetLevel(0)->Set("A", MueLu::TpetraCrs_To_XpetraMatrix(matrix));
  if (near_null_space.count > 0) {
    const RCP<Vector> motions =
        rcp(new Vector(matrix->getRowMap(), static_cast<std::size_t>(near_null_space.count)));
    const std::size_t equations = embedding.row_of_equation.size();
    for (int motion = 0; motion < near_null_space.count; ++motion) {
      const Teuchos::ArrayRCP<double> column = motions->getDataNonConst(std::size_t(motion));
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

}  // namespace

struct MatrixPreconditioner::Trilinos {
  MatrixPreconditionerKind kind;
  MatrixPreconditionerOptions options;
  Embedding embedding;
  RCP<Operator> inverse;
  RCP<Vector> argument, result;
  std::string failure;

  void build(const CompressedRows& from, const EquationBlocks& blocks,
             const NearNullSpace& near_null_space) {
    for (int row = 0; row < from.rows; ++row) {
      if (!(diagonal_entry(from, row) > 0.0)) {
        throw std::runtime_error("a diagonal entry is not positive");
      }
    }
    const bool by_points = kind == MatrixPreconditionerKind::multigrid;
    embedding = embed(from.rows, by_points ? blocks : EquationBlocks{});
    const RCP<Matrix> matrix = tpetra_matrix(from, embedding);
    switch (kind) {
      case MatrixPreconditionerKind::riluk:
        inverse = make_riluk(matrix, options);
        break;
      case MatrixPreconditionerKind::chebyshev:
        inverse = make_chebyshev(matrix, options);
        break;
      case MatrixPreconditionerKind::multigrid:
        inverse = make_multigrid(matrix, blocks.size, embedding, near_null_space, options);
        break;
    }
    argument = rcp(new Vector(matrix->getRowMap(), 1));
    result = rcp(new Vector(matrix->getRowMap(), 1));
  }
};

MatrixPreconditioner::MatrixPreconditioner(MatrixPreconditionerKind kind,
                                           const MatrixPreconditionerOptions& options)
    : trilinos_(new Trilinos{kind, options, {}, {}, {}, {}, {}}) {}

MatrixPreconditioner::~MatrixPreconditioner() = default;

bool MatrixPreconditioner::build(const CompressedRows& matrix, const EquationBlocks& blocks,
                                 const NearNullSpace& near_null_space) {
  trilinos_->inverse = Teuchos::null;
  trilinos_->failure.clear();
  try {
    trilinos_->build(matrix, blocks, near_null_space);
    return true;
  } catch (const std::bad_alloc&) {
    trilinos_->failure = "out of memory";
  } catch (const std::exception& error) {
    trilinos_->failure = error.what();
  }
  trilinos_->inverse = Teuchos::null;
  return false;
}

const std::string& MatrixPreconditioner::failure() const { return trilinos_->failure; }

void MatrixPreconditioner::apply(const double* r, double* z) {
  const std::vector<int>& rows = trilinos_->embedding.row_of_equation;
  {
    const Teuchos::ArrayRCP<double> argument = trilinos_->argument->getDataNonConst(0);
    for (std::size_t e = 0; e < rows.size(); ++e) argument[rows[e]] = r[e];
  }
  trilinos_->inverse->apply(*trilinos_->argument, *trilinos_->result);
  const Teuchos::ArrayRCP<const double> result = trilinos_->result->getData(0);
  for (std::size_t e = 0; e < rows.size(); ++e) z[e] = result[rows[e]];
}

std::string MatrixPreconditioner::describe() const {
  const MatrixPreconditionerOptions& options = trilinos_->options;
  switch (trilinos_->kind) {
    case MatrixPreconditionerKind::riluk:
      return "incomplete factors, level of fill " + std::to_string(options.level_of_fill) +
             " (Ifpack2)";
    case MatrixPreconditionerKind::chebyshev:
      return "Chebyshev polynomial of degree " + std::to_string(options.chebyshev_degree) +
             " (Ifpack2)";
    case MatrixPreconditionerKind::multigrid:
      break;
  }
  std::string text = "smoothed aggregation";
  if (!trilinos_->inverse.is_null()) {
    const auto hierarchy = Teuchos::rcp_dynamic_cast<Cycle>(trilinos_->inverse)->GetHierarchy();
    text += " on " + std::to_string(hierarchy->GetNumLevels()) + " levels";
  }
  return text + " (MueLu)";
}

std::string trilinos_version() { return TRILINOS_VERSION_STRING; }

}  // namespace peristat
