#include <stdexcept>

#include <Teuchos_Comm.hpp>
#include <Teuchos_ParameterList.hpp>
#include <Tpetra_Details_initializeKokkos.hpp>
#include <Zoltan2_BasicVectorAdapter.hpp>
#include <Zoltan2_PartitioningProblem.hpp>

#include "solvers/linear/trilinos/teuchos_communicator.hpp"
#include "solvers/ranks/trilinos/module.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat::ranks {

std::vector<int> partition(const Communicator& ranks, int dimension,
                           const std::vector<double>& positions,
                           const std::vector<std::int64_t>& numbers,
                           const std::vector<double>& weights) {
  using Cloud = Zoltan2::BasicVectorAdapter<Zoltan2::BasicUserTypes<double, int, long long>>;
  Tpetra::Details::initializeKokkos();  // Tpetra's maps do so by themselves, Zoltan2 does not
  const std::vector<long long> ids(numbers.begin(), numbers.end());
  std::vector<const double*> coordinates;
  for (int c = 0; c < dimension; ++c) {
    coordinates.push_back(positions.empty() ? nullptr : &positions[std::size_t(c)]);
  }
  std::vector<int> strides(std::size_t(dimension), dimension), weight_strides(1, 1);
  std::vector<const double*> all_weights(1, weights.data());
  Cloud cloud(int(ids.size()), ids.data(), coordinates, strides, all_weights, weight_strides);

  Teuchos::ParameterList parameters;
  parameters.set("algorithm", "multijagged");
  parameters.set("num_global_parts", ranks.count());
  parameters.set("imbalance_tolerance", 1.01);
  Zoltan2::PartitioningProblem<Cloud> problem(&cloud, &parameters,
                                              trilinos::teuchos_communicator(ranks));
  problem.solve();
  const int* const parts = problem.getSolution().getPartListView();
  std::vector<int> result(ids.size());
  for (std::size_t k = 0; k < ids.size(); ++k) {
    result[k] = parts[k];
    if (result[k] < 0 || result[k] >= ranks.count()) {
      throw std::logic_error("Zoltan2 has given a point to no rank");
    }
  }
  return result;
}

}  // namespace peristat::ranks
