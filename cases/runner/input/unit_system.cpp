#include "cases/runner/input/unit_system.hpp"

#include <array>

#include "cases/runner/input/toml_text.hpp"
#include "cases/runner/input/value_schema.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// A key of the table, and the unit in SI whose dimension it has.
struct NamedUnit {
  const char* key;
  std::string UnitNames::*name;
  const char* si;
};
constexpr std::array all_named{
    NamedUnit{"length", &UnitNames::length, "m"}, NamedUnit{"time", &UnitNames::time, "s"},
    NamedUnit{"force", &UnitNames::force, "N"},   NamedUnit{"stress", &UnitNames::stress, "Pa"},
    NamedUnit{"energy", &UnitNames::energy, "J"}, NamedUnit{"mass", &UnitNames::mass, "kg"}};

Kind<std::string> name_of_unit(const std::string& si) {
  const auto read = [si](const Entry& at) {
    const std::string name = at.from.string(at.key);
    const Unit wanted = unit_of_key(si);
    std::string why_not;
    const auto unit = parse_unit(name, why_not);
    if (!unit) at.refuse(why_not + "; must be the unit of " + name_of(wanted.dimension));
    if (unit->dimension != wanted.dimension) {
      const std::string other = name_of(unit->dimension);
      at.refuse("must be the unit of " + name_of(wanted.dimension) +
                (other.empty() ? "" : ", not of " + other));
    }
    return name;
  };
  return {read, [](const std::string& name, const Case&) { return toml_string(name); },
          text_schema(), "a unit of this quantity"};
}

/// Refuses names that contradict the units that follow from the others.
void check_agreement(const Entry& at, const UnitNames& names) {
  const UnitSystem system = unit_system(names);
  for (const NamedUnit& named : all_named) {
    const std::string& name = names.*named.name;
    if (name.empty()) continue;
    const Unit given = unit_of_key(name), implied = system.unit_of(given.dimension);
    if (given.has_size_of(implied)) continue;
    at.from.refuse(at.from.has(named.key) ? named.key : "",
                   "does not agree with the other units, from which " + name_of(given.dimension) +
                       " has the unit " + number_text(implied.size()) + " " + named.si +
                       "; length and time are m and s if they are not given");
  }
}

}  // namespace

bool UnitSystem::is_si() const {
  const Unit one;
  return length.has_size_of(one) && mass.has_size_of(one) && time.has_size_of(one);
}

Unit UnitSystem::unit_of(const Dimension& dimension) const {
  const std::array<const Unit*, 3> base{&length, &mass, &time};
  Unit unit;
  for (std::size_t k = 0; k < base.size(); ++k) unit = unit * base[k]->power(dimension[k]);
  unit.dimension = dimension;
  return unit;
}

UnitSystem unit_system(const UnitNames& names) {
  const auto unit = [](const std::string& name, const char* si) {
    return unit_of_key(name.empty() ? si : name);
  };
  UnitSystem system{unit(names.length, "m"), {}, unit(names.time, "s")};
  const Unit area = system.length.power(4), speed = system.length / system.time;
  const Unit force = !names.force.empty()    ? unit_of_key(names.force)
                     : !names.stress.empty() ? unit_of_key(names.stress) * area
                     : !names.energy.empty() ? unit_of_key(names.energy) / system.length
                     : !names.mass.empty()   ? unit_of_key(names.mass) * speed / system.time
                                             : unit_of_key("N");
  system.mass = force * system.time / speed;
  return system;
}

Table<UnitNames> unit_keys() {
  using K = Key<UnitNames>;
  Table<UnitNames> keys{"units", {}, {}, check_agreement};
  const auto add = [&](const NamedUnit& of, const char* meaning, const char* fallback) {
    K key(of.key, of.name, name_of_unit(of.si), meaning);
    keys.add(key.default_words(fallback).on_ranks());
  };
  add(all_named[0], "unit of lengths: `\"mm\"`", "m");
  add(all_named[1], "unit of times: `\"ms\"`", "s");
  add(all_named[2], "unit of forces: `\"kN\"`", "from `stress`, `energy` or `mass`, otherwise N");
  add(all_named[3], "unit of stresses: `\"MPa\"`", "force / length²");
  add(all_named[4], "unit of energies: `\"mJ\"`", "force · length");
  add(all_named[5], "unit of masses: `\"t\"`", "force · time² / length");
  return keys;
}

}  // namespace peristat
