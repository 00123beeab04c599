#include "solvers/linear/trilinos/teuchos_communicator.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <Teuchos_RCP.hpp>
#include <mpi.h>

#include "src/parallel/communicator.hpp"

namespace peristat::trilinos {

Teuchos::RCP<const Teuchos::Comm<int>> teuchos_communicator(const Communicator& ranks) {
  const auto* const handle = static_cast<const MPI_Comm*>(ranks.handle());
  if (!handle) return Teuchos::rcp(new Teuchos::SerialComm<int>);
  return Teuchos::rcp(new Teuchos::MpiComm<int>(*handle));
}

}  // namespace peristat::trilinos
