#include "cases/runner/input/given_values.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "src/conditions/loading_programme.hpp"
#include "src/core/input_error.hpp"
#include "src/core/table_calls.hpp"
#include "src/geometry/side.hpp"

namespace peristat {
namespace {

using ValueKind = GivenValue::Kind;

std::string indexed(const std::string& table, std::size_t number) {
  return table + "[" + std::to_string(number) + "]";
}

std::string unit_of(LoadSpecification::Kind kind) {
  switch (kind) {
    case LoadSpecification::Kind::body_force:
      return "N/m3";
    case LoadSpecification::Kind::total_force:
      return "N";
    case LoadSpecification::Kind::gravity:
      return "m/s2";
    default:
      return "Pa";
  }
}

/// Collects the values of one case.
class Collection {
 public:
  explicit Collection(const Case& from)
      : from_(from), dimension_(static_cast<std::size_t>(from.dimension)) {}

  std::vector<GivenValue> all() {
    add_supports();
    add_constraints();
    add_loads();
    add_strains();
    for (std::size_t k = 0; k < from_.probes.size(); ++k) {
      const ProbeSpecification& probe = from_.probes[k];
      for (std::size_t c = 0; c < probe.expected.size(); ++c) {
        add({ValueKind::expected, indexed(indexed("probe", k) + ".expected", c), probe.expected[c],
             "", probe.name, probe.set, true});
      }
    }
    return std::move(values_);
  }

 private:
  void add(GivenValue value) { values_.push_back(std::move(value)); }

  /// Adds the components of a vector, except free ones.
  template <class Components>
  void add_components(const GivenValue& like, const Components& components, std::size_t count) {
    for (std::size_t c = 0; c < count; ++c) {
      GivenValue value = like;
      value.key = indexed(like.key, c);
      if constexpr (requires { components[c].has_value(); }) {
        if (!components[c]) continue;
        value.text = *components[c];
      } else {
        value.text = components[c];
      }
      add(std::move(value));
    }
  }

  void add_supports() {
    for (std::size_t k = 0; k < from_.supports.size(); ++k) {
      const SupportSpecification& support = from_.supports[k];
      add_components({ValueKind::displacement, indexed("support", k) + ".displacement", "", "m",
                      support.set, support.set, true},
                     support.displacement, dimension_);
    }
    for (std::size_t k = 0; k < from_.foundations.size(); ++k) {
      const FoundationSpecification& of = from_.foundations[k];
      add_components({ValueKind::displacement, indexed("foundation", k) + ".displacement", "", "m",
                      of.name, of.set, true},
                     of.displacement, dimension_);
    }
    for (std::size_t k = 0; k < from_.obstacles.size(); ++k) {
      const ObstacleSpecification& of = from_.obstacles[k];
      const std::string table = indexed("obstacle", k);
      for (std::size_t c = 0; c < dimension_; ++c) {
        if (of.displacement[c] == "free") continue;
        add({ValueKind::displacement, indexed(table + ".displacement", c), of.displacement[c], "m",
             of.name, ""});
      }
      if (!of.force.empty()) add({ValueKind::load, table + ".force", of.force, "N", of.name, ""});
    }
  }

  void add_constraints() {
    const ConstraintSpecification& of = from_.constraints;
    for (std::size_t k = 0; k < of.rigid_sets.size(); ++k) {
      const RigidSetSpecification& rigid = of.rigid_sets[k];
      const std::string table = indexed("rigid", k);
      add_components({ValueKind::displacement, table + ".displacement", "", "m", rigid.set, ""},
                     rigid.displacement, dimension_);
      add_components({ValueKind::displacement, table + ".rotation", "", "rad", rigid.set, ""},
                     rigid.rotation, dimension_ == 3 ? 3 : 1);
    }
    for (std::size_t k = 0; k < of.rollers.size(); ++k) {
      const RollerSpecification& roller = of.rollers[k];
      if (roller.displacement == "free") continue;
      add({ValueKind::displacement, indexed("roller", k) + ".displacement", roller.displacement,
           "m", roller.name(), roller.set, true, roller.at});
    }
    for (std::size_t k = 0; k < of.linear.size(); ++k) {
      add({ValueKind::displacement, indexed("constraint", k) + ".displacement",
           of.linear[k].displacement, "m", of.linear[k].name, ""});
    }
    for (std::size_t k = 0; k < of.periods.size(); ++k) {
      add_components({ValueKind::displacement, indexed("period", k) + ".gradient", "", "1",
                      name_of_period(of.periods[k]), ""},
                     of.periods[k].gradient, dimension_);
    }
  }

  void add_loads() {
    for (std::size_t k = 0; k < from_.loads.size(); ++k) {
      const LoadSpecification& load = from_.loads[k];
      const bool is_total = load.kind == LoadSpecification::Kind::total_force;
      GivenValue like{ValueKind::load, indexed("load", k) + "." + load_key(load.kind),
                      load.value[0],   unit_of(load.kind),
                      load.set,        load.set,
                      !is_total};
      if (like.where.empty()) like.where = load.side ? name(*load.side) : load.boundary;
      if (load.kind == LoadSpecification::Kind::pressure) {
        add(like);
      } else if (load.kind == LoadSpecification::Kind::stress) {
        add_components(like, load.stress, load.stress.size());
      } else {
        add_components(like, load.value, dimension_);
      }
    }
  }

  void add_strains() {
    const Eigenstrains& of = from_.eigenstrains;
    for (std::size_t k = 0; k < of.given.size(); ++k) {
      add({ValueKind::strain, indexed("eigenstrain", k) + ".strain", of.given[k].strain, "1",
           of.given[k].set, of.given[k].set, true});
    }
    if (of.temperature_change) {
      add({ValueKind::strain, "temperature.change", *of.temperature_change, "K", "", "", true});
    }
  }

  const Case& from_;
  const std::size_t dimension_;
  std::vector<GivenValue> values_;
};

/// True if a name occurs in an expression by itself, not as a part of a longer one or in quotes.
bool has_word(std::string text, const std::string& word) {
  for (const TableCall& call : table_calls(text)) {
    std::fill(text.begin() + std::ptrdiff_t(call.begin), text.begin() + std::ptrdiff_t(call.end),
              ' ');
  }
  const auto belongs = [&](std::size_t at) {
    return at < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_');
  };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    if (!(at > 0 && belongs(at - 1)) && !belongs(at + word.size())) return true;
  }
  return false;
}

}  // namespace

std::vector<GivenValue> given_values(const Case& from) { return Collection(from).all(); }

void refuse_idle_tables(const Case& from) {
  const std::vector<std::string> parameters =
      LoadingProgramme::names(std::max<std::size_t>(from.loading.tables.size(), 1));
  std::vector<bool> is_used(parameters.size(), false);
  is_used.front() = !from.controls.empty();  // the controlled displacement uses its table
  for (const GivenValue& value : given_values(from)) {
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      is_used[k] = is_used[k] || has_word(value.text, parameters[k]);
    }
  }
  // In statics the first table may be needed for those that follow it.
  if (!from.dynamics.is_asked_for)
    is_used.front() = std::ranges::find(is_used, true) != is_used.end();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const std::string key = "loading.table" + (k > 0 ? std::to_string(k + 1) : std::string());
    if (is_used[k] || !from.locations.contains(key)) continue;
    throw InputError(key, "",
                     "gives values of " + parameters[k] +
                         ", but no displacement and no load uses it; use it in one, as in \"1e-3*" +
                         parameters[k] + "\", or leave the table out");
  }
}

}  // namespace peristat
