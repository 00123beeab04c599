#include "cases/runner/input/key_kinds.hpp"

#include <filesystem>
#include <map>
#include <utility>
#include <variant>

#include "cases/runner/input/case_inputs.hpp"
#include "cases/runner/input/value_schema.hpp"
#include "src/core/expression.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/table_calls.hpp"

namespace peristat {
namespace {

std::size_t dimension_of(const Case& from) { return std::size_t(from.dimension); }

/// The first items, one per dimension.
template <class Item>
std::vector<Item> components_of(const std::array<Item, 3>& items, const Case& from) {
  return {items.begin(), items.begin() + from.dimension};
}

/// Spacing of the lattice; 1 in place of any positive number if points come from a file.
Spacing spacing_of(const Case& from) {
  const auto* lattice = std::get_if<Lattice>(&from.body);
  return lattice != nullptr ? lattice->spacing : Spacing(1.0);
}

/// Sets and layers that were read so far, and the keys that gave them their names.
std::map<std::string, std::string> set_names(const Case& from) {
  std::map<std::string, std::string> names;
  const auto add = [&](const auto& sets, const std::string& table) {
    for (std::size_t k = 0; k < sets.size(); ++k)
      names[sets[k].name] = table + "[" + std::to_string(k) + "].name";
  };
  if (const auto* lattice = std::get_if<Lattice>(&from.body)) add(lattice->layers, "lattice.layer");
  add(from.sets, "set");
  return names;
}

/// True if names of sets are not all known before a file of points is read.
bool has_sets_from_file(const Case& from) { return std::holds_alternative<PointSource>(from.body); }

/// Text of an expression whose tables have absolute paths, as all files in a resolved case.
std::string with_absolute_tables(const Entry& at, const std::string& text) {
  return with_table_files(text, [&](const std::string& name) {
    const std::filesystem::path file = absolute_beside_case(at.so_far, name);
    at.so_far.tables->insert(file);
    return file.string();
  });
}

/// Checks an expression of parameters and, in `dimension` > 0, of place and columns.
/// @returns its text with absolute paths
/// @throws InputError as Expression does
std::string checked(const Entry& at, const std::string& text, int dimension,
                    const std::vector<std::string>& parameters) {
  std::string resolved = with_absolute_tables(at, text);
  static_cast<void>(Expression(resolved, dimension, spacing_of(at.so_far), parameters,
                               at.so_far.columns, at.so_far.givens->functions));
  return resolved;
}

/// The same for a component, of the parameters of loads.
std::string checked_component(const Entry& at, std::size_t component, const std::string& text,
                              int dimension) {
  try {
    return checked(at, text, dimension, at.so_far.parameters());
  } catch (const InputError& error) {
    at.from.refuse(at.key, component, error.allowed());
  }
}

std::string string_text(const std::string& value, const Case&) { return toml_string(value); }

template <std::size_t count>
std::string tuples_text(const std::vector<std::array<double, count>>& tuples, const Case&) {
  return array_text(tuples, [](const auto& tuple) { return array_text(tuple, toml_number); });
}

/// Corners of a polygon, each of `count` coordinates.
JsonObject polygon_schema(std::size_t count) {
  return list_schema(list_schema(number_schema({}, "m"), count, count), 3);
}

}  // namespace

Kind<double> number(const Range& range, std::string allowed, std::string unit) {
  return {[=](const Entry& at) { return at.from.number(at.key, range); },
          [](double value, const Case&) { return toml_number(value); },
          number_schema(range, unit),
          std::move(allowed),
          std::move(unit),
          ValueForm::number};
}

Kind<double> positive(const std::string& unit, double high) {
  return number(Range::positive(unit, high), "positive", unit == "-" ? "" : unit);
}

Kind<Spacing> spacing() {
  const auto read = [](const Entry& at) {
    const Range range = Range::positive("m");
    if (!at.from.is_array(at.key)) return Spacing(at.from.number(at.key, range));
    Coordinates along{};
    const auto numbers = at.from.numbers(at.key, dimension_of(at.so_far), range);
    std::copy(numbers.begin(), numbers.end(), along.begin());
    return Spacing(along, at.so_far.dimension);
  };
  const auto text = [](const Spacing& spacing, const Case& from) {
    const std::array<double, 3> along{spacing.along(0), spacing.along(1), spacing.along(2)};
    return spacing.is_square() ? toml_number(spacing)
                               : array_text(components_of(along, from), toml_number);
  };
  const JsonObject one = number_schema(Range::positive("m"), "m");
  return {read,
          text,
          either_schema({one, components_schema(one)}),
          "positive, or a list with one number per dimension",
          "m",
          ValueForm::number};
}

Kind<double> between(double low, double high, std::string unit) {
  return number(Range::between(low, high), number_text(low) + " to " + number_text(high),
                std::move(unit));
}

Kind<std::int64_t> integer(std::int64_t low, std::int64_t high, std::string unit) {
  return {[=](const Entry& at) { return at.from.integer(at.key, low, high); },
          [](std::int64_t value, const Case&) { return std::to_string(value); },
          integer_schema(low, high), std::to_string(low) + " to " + std::to_string(high),
          std::move(unit)};
}

Kind<std::int64_t> count_from(std::int64_t low, std::string unit, std::int64_t high) {
  Kind<std::int64_t> kind = integer(low, high, std::move(unit));
  kind.allowed = "whole number from " + std::to_string(low);
  return kind;
}

Kind<bool> boolean() {
  return {[](const Entry& at) { return at.from.boolean(at.key); },
          [](bool value, const Case&) { return std::string(value ? "true" : "false"); },
          boolean_schema(), "true, false"};
}

Kind<std::string> text() {
  return {[](const Entry& at) { return at.from.string(at.key); }, string_text, text_schema(), ""};
}

Kind<std::string> one_of(const std::vector<std::string>& names) {
  std::string allowed;
  for (const auto& known : names) allowed += (allowed.empty() ? "`\"" : ", `\"") + known + "\"`";
  return {[=](const Entry& at) { return at.from.one_of(at.key, names); }, string_text,
          choice_schema(names), allowed};
}

Kind<std::filesystem::path> file_beside_the_case() {
  const auto read = [](const Entry& at) {
    try {
      return absolute_beside_case(at.so_far, at.from.string(at.key));
    } catch (const InputError& error) {
      at.refuse(error.allowed());
    }
  };
  return {read, [](auto& file, auto&) { return toml_string(file.string()); }, text_schema(),
          "an existing file"};
}

Kind<std::int64_t> choice_of_numbers(std::vector<Choice<std::int64_t>> choices) {
  std::vector<std::string> names;
  for (const auto& choice : choices) names.emplace_back(choice.name);
  const Kind<std::string> name = one_of(names);
  const auto read = [name, choices](const Entry& at) {
    const std::string chosen = name.read(at);
    return std::find_if(choices.begin(), choices.end(),
                        [&](const auto& choice) { return choice.name == chosen; })
        ->value;
  };
  const auto text = [choices](std::int64_t value, const Case&) {
    for (const auto& choice : choices)
      if (choice.value == value) return toml_string(choice.name);
    return std::string();
  };
  return {read, text, name.schema, name.allowed};
}

namespace {

/// Names of columns and files contain these names; file systems allow 255 bytes.
constexpr std::size_t longest_name = 100;

}  // namespace

Kind<std::string> name() {
  const auto read = [](const Entry& at) {
    const std::string given = at.from.string(at.key);
    const auto allowed = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             c == '_' || c == '-';
    };
    if (given.empty()) at.refuse("is empty");
    for (const char c : given)
      if (!allowed(c)) at.refuse("may only have letters, digits, _ and -");
    if (given.size() > longest_name)
      at.refuse("has " + std::to_string(given.size()) + " characters; at most " +
                std::to_string(longest_name) + " are allowed");
    return given;
  };
  return {read, string_text,
          text_schema().add("pattern", "^[A-Za-z0-9_-]+$").add("maxLength", longest_name),
          "letters, digits, `_`, `-`; at most " + std::to_string(longest_name) + " characters"};
}

Kind<std::string> set_name() {
  const Kind<std::string> any = name();
  const auto read = [any](const Entry& at) {
    const std::string given = any.read(at);
    const auto names = set_names(at.so_far);
    if (const auto taken = names.find(given); taken != names.end())
      at.refuse("this name is taken by " + taken->second +
                "; sets and layers need different names");
    return given;
  };
  return {read, string_text, any.schema, any.allowed + "; no other set or layer has it"};
}

Kind<std::string> known_set() {
  const auto read = [](const Entry& at) {
    const std::string asked = at.from.string(at.key);
    const auto known = set_names(at.so_far);
    if (known.count(asked) > 0 || has_sets_from_file(at.so_far)) return asked;
    std::vector<std::string> names;
    for (const auto& [set, path] : known) names.push_back(set);
    at.refuse(
        "no set or layer of this name" + did_you_mean(asked, names) +
        (names.empty() ? "; the case has no sets or layers" : "  (there: " + listed(names) + ")"));
  };
  return {read, string_text, text_schema(), "name of a set or layer"};
}

Kind<std::vector<std::string>> known_sets() {
  const auto read = [](const Entry& at) {
    const auto known = set_names(at.so_far);
    const std::vector<std::string> sets = at.from.strings(at.key);
    for (const std::string& set : sets)
      if (known.count(set) == 0 && !has_sets_from_file(at.so_far))
        at.refuse("there is no set or layer \"" + set + "\"");
    return sets;
  };
  return {read,
          [](const auto& sets, const Case&) {
            return sets.empty() ? std::string() : array_text(sets, toml_string);
          },
          list_schema(text_schema(), 1), "list of names of sets and layers"};
}

Kind<std::vector<std::string>> keys_of_case() {
  return {[](const Entry& at) { return at.from.strings(at.key); },
          [](const auto& keys, const Case&) {
            return keys.empty() ? std::string() : array_text(keys, toml_string);
          },
          list_schema(text_schema(), 1), "list of keys such as \"material.youngs_modulus\""};
}

Kind<Coordinates> coordinates(std::string unit) {
  const auto read = [](const Entry& at) {
    Coordinates place{};
    const auto numbers = at.from.numbers(at.key, dimension_of(at.so_far), Range{});
    std::copy(numbers.begin(), numbers.end(), place.begin());
    return place;
  };
  return {read,
          [](const Coordinates& place, const Case& from) {
            return array_text(components_of(place, from), toml_number);
          },
          components_schema(number_schema({}, unit)),
          "a number per dimension",
          std::move(unit),
          ValueForm::number};
}

Kind<Coordinates> stiffnesses(const std::string& unit) {
  const Kind<Coordinates> any = coordinates(unit);
  const auto read = [any](const Entry& at) {
    const Coordinates stiffness = any.read(at);
    for (std::size_t c = 0; c < stiffness.size(); ++c) {
      if (stiffness[c] < 0.0) at.from.refuse(at.key, c, "must be 0 or positive");
    }
    if (stiffness == Coordinates{})
      at.refuse("is zero in every component, so the spring has no effect");
    return stiffness;
  };
  const auto text = [any](const Coordinates& stiffness, const Case& from) {
    return any.text(stiffness, from);
  };
  const Range from_zero{0.0, Range().high, ""};
  return {read,
          text,
          components_schema(number_schema(from_zero, unit)),
          "numbers from 0, not all 0",
          unit,
          ValueForm::number};
}

Kind<Side> side() {
  const auto read = [](const Entry& at) {
    std::vector<std::string> sides;
    for (int axis = 0; axis < at.so_far.dimension; ++axis)
      for (const char sign : {'-', '+'}) sides.push_back({"xyz"[axis], sign});
    const std::string chosen = at.from.one_of(at.key, sides);
    return Side{chosen[0] - 'x', chosen[1] == '+' ? 1 : -1};
  };
  const auto text = [](const Side& side, const Case&) { return toml_string(peristat::name(side)); };
  return {read, text, choice_schema({"x-", "x+", "y-", "y+", "z-", "z+"}),
          "`\"x-\"`, `\"x+\"`, and so on for y and z"};
}

Kind<std::optional<Side>> optional_side() {
  const Kind<Side> kind = side();
  return {[=](const Entry& at) { return std::optional(kind.read(at)); },
          [=](const std::optional<Side>& side, const Case& from) {
            return side ? kind.text(*side, from) : std::string();
          },
          kind.schema, kind.allowed};
}

Kind<std::vector<std::array<double, 2>>> pairs() {
  return {[](const Entry& at) { return at.from.pairs(at.key); },
          tuples_text<2>,
          polygon_schema(2),
          "3 or more pairs `[x, y]`",
          "m",
          ValueForm::number};
}

Kind<std::array<double, 2>> range_of_numbers() {
  const auto read = [](const Entry& at) {
    const auto numbers = at.from.numbers(at.key, 2, Range{});
    if (numbers[0] > numbers[1]) at.refuse("the second number is below the first");
    return std::array<double, 2>{numbers[0], numbers[1]};
  };
  return {read, [](const auto& pair, const Case&) { return array_text(pair, toml_number); },
          list_schema(number_schema({}, ""), 2, 2), "two numbers, the second not below the first"};
}

Kind<std::vector<std::array<double, 3>>> triples() {
  return {[](const Entry& at) { return at.from.triples(at.key); },
          tuples_text<3>,
          polygon_schema(3),
          "3 or more `[x, y, z]`",
          "m",
          ValueForm::number};
}

Kind<int> axis() {
  const auto read = [](const Entry& at) {
    const std::vector<std::string> axes{"x", "y", "z"};
    return at.from.one_of(at.key, {axes.begin(), axes.begin() + at.so_far.dimension})[0] - 'x';
  };
  return {read, [](int axis, const Case&) { return toml_string(std::string(1, "xyz"[axis])); },
          choice_schema({"x", "y", "z"}), "`\"x\"`, `\"y\"`, `\"z\"`, as the dimension has them"};
}

Kind<std::string> condition() {
  const auto read = [](const Entry& at) {
    try {
      return checked(at, at.from.string(at.key), at.so_far.dimension, {});
    } catch (const InputError& error) {
      at.refuse(error.allowed());
    }
  };
  return {read, string_text, text_schema(), "an expression of place", "", ValueForm::expression};
}

Kind<LoadTable> load_table() {
  const auto read = [](const Entry& at) -> LoadTable {
    if (at.so_far.dynamics.is_asked_for) {
      if (at.from.is_string(at.key)) {
        at.refuse(
            "in mode dynamics a table has pairs [time, value]; write expressions of t in the "
            "supports and loads themselves");
      }
      return LoadTable{{}, {}, at.from.pairs(at.key)};
    }
    if (!at.from.is_string(at.key)) return LoadTable{at.from.numbers(at.key, Range()), {}, {}};
    try {
      return LoadTable{{}, with_absolute_tables(at, at.from.string(at.key)), {}};
    } catch (const InputError& error) {
      at.refuse(error.allowed());
    }
  };
  const auto text = [](const LoadTable& table, const Case& from) {
    if (!table.over_time.empty()) return tuples_text(table.over_time, from);
    return table.expression.empty() ? array_text(table.entries, toml_number)
                                    : toml_string(table.expression);
  };
  return {read,
          text,
          either_schema({list_schema(number_schema({}, "m"), 2),
                         list_schema(list_schema(number_schema({}, "s"), 2, 2), 2), text_schema()}),
          "at least two numbers, the first 0, or an expression of `step`, 0 at step 0; in mode "
          "`dynamics` two or more pairs `[t, value]`, from t = 0 to `end_time`, ascending",
          "",
          ValueForm::expression};
}

Kind<std::array<std::optional<std::string>, 3>> prescribed_components() {
  const auto read = [](const Entry& at) {
    std::array<std::optional<std::string>, 3> prescribed;
    const auto components = at.from.components(at.key, dimension_of(at.so_far));
    bool all_free = true;
    for (std::size_t c = 0; c < components.size(); ++c) {
      if (components[c] == "free") continue;
      all_free = false;
      prescribed[c] = checked_component(at, c, components[c], at.so_far.dimension);
    }
    if (all_free) at.refuse("every component is \"free\", so the support has no effect");
    return prescribed;
  };
  return {read,
          [](const auto& prescribed, const Case& from) {
            return array_text(components_of(prescribed, from), [](const auto& component) {
              return toml_string(component.value_or("free"));
            });
          },
          components_schema(expression_schema()),
          "number, expression of place and `load` (mode `dynamics`: `t`), or `\"free\"`",
          "m",
          ValueForm::expression};
}

Kind<std::array<std::optional<std::string>, 3>> free_components(Components kind,
                                                                const std::string& unit) {
  const auto count = [kind](const Case& from) {
    const std::size_t dimension = dimension_of(from);
    return kind != Components::rotations ? dimension : dimension == 3 ? std::size_t{3} : 1;
  };
  const auto read = [=](const Entry& at) {
    std::array<std::optional<std::string>, 3> prescribed;
    const auto components = at.from.components(at.key, count(at.so_far));
    for (std::size_t c = 0; c < components.size(); ++c) {
      if (components[c] == "free") continue;
      prescribed[c] = checked_component(at, c, components[c], 0);
    }
    return prescribed;
  };
  return {read,
          [=](const auto& prescribed, const Case& from) {
            return array_text(std::span(prescribed).first(count(from)), [](const auto& component) {
              return toml_string(component.value_or("free"));
            });
          },
          components_schema(expression_schema()),
          kind == Components::of_load ? "number, expression of `load` (`t`) alone, or `\"free\"`"
                                      : "number, expression of `load` alone, or `\"free\"`",
          unit,
          ValueForm::expression};
}

namespace {

Kind<std::string> expression(bool of_place, bool or_free, const std::string& unit) {
  const auto read = [=](const Entry& at) {
    const std::string text = at.from.is_string(at.key)
                                 ? at.from.string(at.key)
                                 : number_text(at.from.number(at.key, Range()));
    if (or_free && text == "free") return text;
    try {
      return checked(at, text, of_place ? at.so_far.dimension : 0, at.so_far.parameters());
    } catch (const InputError& error) {
      at.refuse(error.allowed());
    }
  };
  return {read,
          string_text,
          expression_schema(),
          std::string("number, or expression of ") +
              (of_place ? "place and `load`" : "`load` alone") + (or_free ? ", or `\"free\"`" : ""),
          unit,
          ValueForm::expression};
}

}  // namespace

Kind<std::array<std::string, 3>> components_of_place(const std::string& unit) {
  const auto read = [](const Entry& at) {
    std::array<std::string, 3> values{"0", "0", "0"};
    const auto components = at.from.components(at.key, dimension_of(at.so_far));
    for (std::size_t c = 0; c < components.size(); ++c) {
      try {
        values[c] = checked(at, components[c], at.so_far.dimension, {});
      } catch (const InputError& error) {
        at.from.refuse(at.key, c, error.allowed());
      }
    }
    return values;
  };
  return {read,
          [](const auto& values, const Case& from) {
            return array_text(components_of(values, from), toml_string);
          },
          components_schema(expression_schema()),
          "number or expression of place",
          unit,
          ValueForm::expression};
}

Kind<std::string> expression_or_free() { return expression(true, true, "m"); }
Kind<std::string> expression_of_load(const std::string& unit) {
  return expression(false, false, unit);
}

Kind<double> stretch() {
  const Range range = Range::between(1e-9, 1e3);
  const auto read = [=](const Entry& at) {
    if (!at.from.is_string(at.key)) return at.from.number(at.key, range);
    const auto* lattice = std::get_if<Lattice>(&at.so_far.body);
    if (const std::string own = key_of_own_horizons(at.so_far); !own.empty())
      at.refuse("must be a number: " + own + " gives every point its own horizon");
    const double horizon = lattice != nullptr
                               ? at.so_far.horizon_ratio * lattice->spacing
                               : std::get<PointSource>(at.so_far.body).horizon.length;
    double value = 0.0;
    try {
      const Expression of(with_absolute_tables(at, at.from.string(at.key)), 0,
                          lattice != nullptr ? lattice->spacing : Spacing(), {"horizon"},
                          at.so_far.columns, at.so_far.givens->functions);
      value = of({}, std::array{horizon});
    } catch (const InputError& error) {
      at.refuse(error.allowed());
    }
    if (!(value >= 1e-9 && value <= 1e3))
      at.refuse("is " + number_text(value) + "; must be between 1e-09 and 1000");
    return value;
  };
  return {read,
          [](double value, const Case&) { return toml_number(value); },
          either_schema({number_schema(range, "1"), text_schema()}),
          "1e-09 to 1000, or an expression of `horizon` and `spacing`",
          "1",
          ValueForm::expression};
}

namespace {

/// Reads a number, or an expression of place and, if `has_parameters`, of the load parameters.
std::string read_field(const Entry& at, bool has_parameters) {
  const std::string given = at.from.is_string(at.key)
                                ? at.from.string(at.key)
                                : toml_number(at.from.number(at.key, Range()));
  try {
    return checked(at, given, at.so_far.dimension,
                   has_parameters ? at.so_far.parameters() : std::vector<std::string>());
  } catch (const InputError& error) {
    at.refuse(error.allowed());
  }
}

}  // namespace

Kind<std::string> scalar_field(const std::string& unit) {
  return {[](const Entry& at) { return read_field(at, true); },
          string_text,
          expression_schema(),
          "number or expression of place and `load` (mode `dynamics`: `t`)",
          unit,
          ValueForm::expression};
}

Kind<std::string> field_of_place(const std::string& unit) {
  return {[](const Entry& at) { return read_field(at, false); },
          string_text,
          expression_schema(),
          "number or expression of place",
          unit,
          ValueForm::expression};
}

namespace {

/// An expression per component: of load, and of place if `has_place`.
/// @param against_free why no component can be "free"; empty: they can
Kind<std::array<std::string, 3>> located_components(bool has_place, const std::string& against_free,
                                                    const std::string& unit) {
  const auto read = [=](const Entry& at) {
    std::array<std::string, 3> values{"0", "0", "0"};
    const auto components = at.from.components(at.key, dimension_of(at.so_far));
    for (std::size_t c = 0; c < components.size(); ++c) {
      const bool is_free = components[c] == "free";
      if (is_free && !against_free.empty()) at.from.refuse(at.key, c, against_free);
      values[c] =
          is_free ? components[c]
                  : checked_component(at, c, components[c], has_place ? at.so_far.dimension : 0);
    }
    return values;
  };
  return {read,
          [](const auto& values, const Case& from) {
            return array_text(components_of(values, from), toml_string);
          },
          components_schema(expression_schema()),
          std::string(has_place ? "number or expression of place and `load` (mode `dynamics`: `t`)"
                                : "number or expression of `load` (`t`) alone") +
              (against_free.empty() ? ", or `\"free\"`" : ""),
          unit,
          ValueForm::expression};
}

}  // namespace

Kind<std::array<std::string, 3>> displacement_components() {
  return located_components(
      true,
      "the ground of a foundation can't be free; give a zero stiffness in this component instead",
      "m");
}

Kind<std::array<std::string, 3>> obstacle_displacement() {
  return located_components(false, "", "m");
}

Kind<std::vector<std::string>> stress_components() {
  const auto read = [](const Entry& at) {
    const std::size_t entries = at.so_far.dimension == 2 ? 3 : 6;
    std::vector<std::string> values = at.from.components(at.key, entries);
    for (std::size_t c = 0; c < values.size(); ++c) {
      if (values[c] == "free") at.from.refuse(at.key, c, "write 0 for no stress");
      values[c] = checked_component(at, c, values[c], at.so_far.dimension);
    }
    return values;
  };
  return {read,
          [](const auto& values, const Case&) { return array_text(values, toml_string); },
          list_schema(expression_schema(), 3, 6),
          "numbers or expressions of place and `load` (mode `dynamics`: `t`)",
          "Pa",
          ValueForm::expression};
}

Kind<std::vector<std::string>> expected_components() {
  const auto read = [](const Entry& at) {
    constexpr std::size_t any = 0;
    std::vector<std::string> values = at.from.components(at.key, any);
    for (std::size_t c = 0; c < values.size(); ++c) {
      values[c] = checked_component(at, c, values[c], at.so_far.dimension);
    }
    return values;
  };
  return {read,
          [](const auto& values, const Case&) { return array_text(values, toml_string); },
          list_schema(expression_schema(), 1),
          "list of numbers or expressions of place and `load` (mode `dynamics`: `t`), one for each "
          "component of the field",
          "",
          ValueForm::expression};
}

Kind<std::array<std::string, 3>> force_components(bool is_total, const std::string& unit) {
  return located_components(!is_total, "only displacements can be \"free\"; write 0 for no force",
                            unit);
}

}  // namespace peristat
