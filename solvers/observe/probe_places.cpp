#include "solvers/observe/probe_places.hpp"

#include <cstdint>
#include <string>

#include "src/core/input_error.hpp"
#include "src/geometry/points_on_line.hpp"

namespace peristat {

void require_places_of_probes(std::span<const ProbeSpecification> probes,
                              const RecordedPoints& recorded) {
  const Points& points = recorded.points();
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const ProbeSpecification& probe = probes[k];
    const std::string table = "probe[" + std::to_string(k) + "]";
    const auto require = [&](const std::string& key, const std::string& set) {
      if (set.empty() || points.sets.contains(set)) return;
      throw InputError(table + key, '"' + set + '"', "no set of this name");
    };
    require(".set", probe.set);
    require(".other", probe.other);
    if (probe.at &&
        nearest_recorded(recorded, *probe.at).distance > 2.0 * points.spacing.largest()) {
      throw InputError(table + ".at", "", "no point lies within two spacings of this place");
    }
    if (!probe.from) continue;
    const auto here = points_on_line(points, *probe.from, *probe.to, recorded.count()).size();
    if (recorded.ranks().count_all(std::int64_t(here)).all == 0) {
      throw InputError(table + ".from", "", "no point lies within half a spacing of this line");
    }
  }
}

}  // namespace peristat
