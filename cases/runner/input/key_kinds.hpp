#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/runner/input/key_table.hpp"
#include "cases/runner/input/toml_text.hpp"
#include "src/core/spacing.hpp"
#include "src/core/types.hpp"
#include "src/geometry/side.hpp"

namespace peristat {

/// A finite number within the range.
[[nodiscard]] Kind<double> number(const Range& range, std::string allowed, std::string unit = {});
[[nodiscard]] Kind<double> positive(const std::string& unit, double high = 1e30);
/// Spacing of a lattice: a number, or one for each of its axes.
[[nodiscard]] Kind<Spacing> spacing();
[[nodiscard]] Kind<double> between(double low, double high, std::string unit = {});
[[nodiscard]] Kind<std::int64_t> integer(std::int64_t low, std::int64_t high,
                                         std::string unit = {});
/// An integer that counts something; its limit only protects the machine.
[[nodiscard]] Kind<std::int64_t> count_from(std::int64_t low, std::string unit = {},
                                            std::int64_t high = 1'000'000'000);
[[nodiscard]] Kind<bool> boolean();
[[nodiscard]] Kind<std::string> text();
/// A string out of a list.
[[nodiscard]] Kind<std::string> one_of(const std::vector<std::string>& names);

/// An existing file; its path is relative to the case file's folder, and becomes absolute.
[[nodiscard]] Kind<std::filesystem::path> file_beside_the_case();

/// A value of an enumeration, and its name.
template <class Value>
struct Choice {
  const char* name;
  Value value;
};

/// A number by its name.
[[nodiscard]] Kind<std::int64_t> choice_of_numbers(std::vector<Choice<std::int64_t>> choices);

/// A value of an enumeration by its name; as a number, so that enumerations share a kind.
template <class Value>
[[nodiscard]] Kind<std::int64_t> choice(std::initializer_list<Choice<Value>> choices) {
  std::vector<Choice<std::int64_t>> numbers;
  for (const auto& [name, value] : choices)
    numbers.push_back({name, static_cast<std::int64_t>(value)});
  return choice_of_numbers(std::move(numbers));
}

/// A new name: letters, digits, _ and -.
[[nodiscard]] Kind<std::string> name();
/// Numbers, or an expression of the step.
[[nodiscard]] Kind<LoadTable> load_table();
/// A new name of a set or layer (a layer is a set, too), different from all others.
[[nodiscard]] Kind<std::string> set_name();
/// Name of an existing set or layer.
[[nodiscard]] Kind<std::string> known_set();
[[nodiscard]] Kind<std::vector<std::string>> known_sets();
/// Dotted keys of the case file, as `--set` takes them.
[[nodiscard]] Kind<std::vector<std::string>> keys_of_case();

/// A component per dimension.
[[nodiscard]] Kind<Coordinates> coordinates(std::string unit = "m");
[[nodiscard]] Kind<std::vector<std::array<double, 2>>> pairs();
/// Two numbers, the second not below the first.
[[nodiscard]] Kind<std::array<double, 2>> range_of_numbers();
[[nodiscard]] Kind<std::vector<std::array<double, 3>>> triples();
/// A side of the body by its name, such as "x-".
[[nodiscard]] Kind<Side> side();
[[nodiscard]] Kind<std::optional<Side>> optional_side();
/// An axis, named "x", "y" or "z"; the value is its number.
[[nodiscard]] Kind<int> axis();

/// A component per dimension, none negative and not all zero.
[[nodiscard]] Kind<Coordinates> stiffnesses(const std::string& unit);

/// An expression that selects points.
[[nodiscard]] Kind<std::string> condition();
/// Per component an expression of place and load, or "free".
[[nodiscard]] Kind<std::array<std::optional<std::string>, 3>> prescribed_components();
/// Kind of free components: one per axis (axes, of_load), or rotations: one in 2D, three in 3D.
enum class Components { axes, rotations, of_load };
/// Per component an expression of load alone, or "free"; all may be free.
[[nodiscard]] Kind<std::array<std::optional<std::string>, 3>> free_components(
    Components components, const std::string& unit);
/// An expression of place and load, or "free".
[[nodiscard]] Kind<std::string> expression_or_free();
/// An expression of load alone.
[[nodiscard]] Kind<std::string> expression_of_load(const std::string& unit = "m");
/// Per component an expression of place.
[[nodiscard]] Kind<std::array<std::string, 3>> components_of_place(const std::string& unit);
/// A stretch of a bond: a number, or an expression of `horizon` and, on a lattice, of `spacing`.
[[nodiscard]] Kind<double> stretch();
/// An expression of place and load.
[[nodiscard]] Kind<std::string> scalar_field(const std::string& unit);
/// An expression of place.
[[nodiscard]] Kind<std::string> field_of_place(const std::string& unit);
/// Per component an expression of place and load.
[[nodiscard]] Kind<std::array<std::string, 3>> displacement_components();
/// Per component an expression of load, and of place unless it is a total.
[[nodiscard]] Kind<std::array<std::string, 3>> force_components(bool is_total,
                                                                const std::string& unit);
/// Per component an expression of load alone.
[[nodiscard]] Kind<std::array<std::string, 3>> obstacle_displacement();

/// Per entry of a stress, xx yy xy or xx yy zz xy yz xz, an expression of place and load.
[[nodiscard]] Kind<std::vector<std::string>> stress_components();
/// Expressions of place and parameters, for any number of components.
[[nodiscard]] Kind<std::vector<std::string>> expected_components();

/// "[a, b]"
template <class Items, class Text>
[[nodiscard]] std::string array_text(const Items& items, Text text) {
  std::string array;
  for (const auto& item : items) array += (array.empty() ? "" : ", ") + text(item);
  return "[" + array + "]";
}

}  // namespace peristat
