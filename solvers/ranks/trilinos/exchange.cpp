#include <algorithm>
#include <stdexcept>
#include <string>

#include <Teuchos_Comm.hpp>
#include <Tpetra_Distributor.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include "solvers/linear/trilinos/teuchos_communicator.hpp"
#include "solvers/ranks/trilinos/module.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat::ranks {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;

// The only types for which Debian instantiates Tpetra.
using Map = Tpetra::Map<int, long long>;
using Import = Tpetra::Import<int, long long>;
using Vector = Tpetra::MultiVector<double, int, long long>;

/// Map of entries, `width` per point, from numbers of points.
RCP<const Map> map_of(const std::vector<std::int64_t>& points, int width,
                      const RCP<const Teuchos::Comm<int>>& ranks) {
  std::vector<long long> entries;
  entries.reserve(points.size() * std::size_t(width));
  for (const std::int64_t point : points) {
    for (int c = 0; c < width; ++c) entries.push_back(point * width + c);
  }
  const auto any = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  return rcp(new Map(any, Teuchos::arrayViewFromVector(entries), 0, ranks));
}

class Importer : public GhostExchange {
 public:
  Importer(const Communicator& ranks, const std::vector<std::int64_t>& owned,
           const std::vector<std::int64_t>& ghosts, int width) {
    const RCP<const Teuchos::Comm<int>> all = trilinos::teuchos_communicator(ranks);
    owned_ = rcp(new Vector(map_of(owned, width, all), 1));
    ghosts_ = rcp(new Vector(map_of(ghosts, width, all), 1));
    import_ = rcp(new Import(owned_->getMap(), ghosts_->getMap()));
    const auto remote = std::size_t(import_->getNumRemoteIDs());
    if (remote != ghosts.size() * std::size_t(width) || !import_->isLocallyComplete()) {
      throw std::logic_error("a ghost is this rank's own or nobody's");
    }
    const Tpetra::Distributor& distributor = import_->getDistributor();
    each_.exchanges = 1;
    each_.messages = std::int64_t(distributor.getNumSends());
    each_.bytes = std::int64_t(import_->getNumExportIDs() * sizeof(double));
  }

  void update(double* values) override {
    const std::size_t owned = owned_->getLocalLength();
    std::copy_n(values, owned, owned_->getDataNonConst(0).begin());
    ghosts_->doImport(*owned_, *import_, Tpetra::INSERT);
    const Teuchos::ArrayRCP<const double> received = ghosts_->getData(0);
    std::copy(received.begin(), received.end(), values + owned);
    ++exchanges_;
  }

  [[nodiscard]] Traffic traffic() const override {
    return {exchanges_, exchanges_ * each_.messages, exchanges_ * each_.bytes};
  }

 private:
  RCP<Vector> owned_, ghosts_;
  RCP<const Import> import_;
  Traffic each_;
  std::int64_t exchanges_ = 0;
};

}  // namespace

Records exchange(const Communicator& ranks, const std::vector<int>& to, const Records& records) {
  Tpetra::Distributor distributor(trilinos::teuchos_communicator(ranks));
  const std::size_t count = distributor.createFromSends(Teuchos::arrayViewFromVector(to));
  Records received{records.doubles, records.integers, {}, {}};
  received.values.resize(count * std::size_t(records.doubles));
  received.numbers.resize(count * std::size_t(records.integers));
  distributor.doPostsAndWaits(Teuchos::arrayViewFromVector(records.values),
                              std::size_t(records.doubles),
                              Teuchos::arrayViewFromVector(received.values));
  distributor.doPostsAndWaits(Teuchos::arrayViewFromVector(records.numbers),
                              std::size_t(records.integers),
                              Teuchos::arrayViewFromVector(received.numbers));
  return received;
}

std::unique_ptr<GhostExchange> make_ghost_exchange(const Communicator& ranks,
                                                   const std::vector<std::int64_t>& owned,
                                                   const std::vector<std::int64_t>& ghosts,
                                                   int width) {
  return std::make_unique<Importer>(ranks, owned, ghosts, width);
}

}  // namespace peristat::ranks
