#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/input/untyped_keys.hpp"

namespace peristat {

/// Kind of a key's value: how it is read and checked, written as TOML, and described.
template <class Value>
struct Kind : UntypedKind {
  /// @param reads  function that returns the value of an Entry
  /// @param writes function that returns the TOML of a value of a case
  /// @param schema of its values (value_schema.hpp)
  template <class Reads, class Writes>
  Kind(Reads reads, Writes writes, JsonObject has_schema, std::string is_allowed,
       std::string has_unit = {}, ValueForm has_form = ValueForm::other)
      : UntypedKind([=](const Entry& at, void* value) { *static_cast<Value*>(value) = reads(at); },
                    [=](const void* value, const Case& from) -> std::string {
                      return writes(*static_cast<const Value*>(value), from);
                    },
                    std::move(has_schema), std::move(is_allowed), std::move(has_unit), has_form) {}

  [[nodiscard]] Value read(const Entry& at) const {
    Value value{};
    read_into(at, &value);
    return value;
  }
  [[nodiscard]] std::string text(const Value& value, const Case& from) const {
    return text_of(&value, from);
  }
};

/// Member of a member, to be used like a pointer to a member.
template <class Outer, class Inner>
auto in(Outer outer, Inner inner) {
  return [=](auto& spec) -> auto& { return member_of(member_of(spec, outer), inner); };
}

/// Wraps an action without the type of its specification. Actions that capture nothing become
/// functions, for which std::function is compiled once.
template <class Spec, class Action>
UntypedKey::Action untyped_action(Action action) {
  if constexpr (std::is_empty_v<Action>)
    return +[](const Entry& at, void* spec) { Action()(at, *static_cast<Spec*>(spec)); };
  else
    return [=](const Entry& at, void* spec) { action(at, *static_cast<Spec*>(spec)); };
}

/// The same for a predicate.
template <class Spec, class Predicate>
UntypedKey::Predicate untyped_predicate(Predicate holds) {
  if constexpr (std::is_empty_v<Predicate>)
    return +[](const void* spec, const Case& so_far) -> bool {
      return Predicate()(*static_cast<const Spec*>(spec), so_far);
    };
  else
    return [=](const void* spec, const Case& so_far) -> bool {
      return holds(*static_cast<const Spec*>(spec), so_far);
    };
}

template <class Value, class Held>
void read_value_of_member(const UntypedKind& kind, const Entry& at, const UntypedMember& member,
                          void* spec) {
  Value value{};
  kind.read_into(at, &value);
  if constexpr (requires { static_cast<Held>(std::move(value)); })
    *static_cast<Held*>(member(spec)) = static_cast<Held>(std::move(value));
  else  // a number for an optional enumeration
    *static_cast<Held*>(member(spec)) = static_cast<typename Held::value_type>(value);
}

template <class Value, class Held>
std::string text_of_member(const UntypedKind& kind, const void* held, const Case& from) {
  const Held& stored = *static_cast<const Held*>(held);
  if constexpr (requires { stored.has_value(); }) {
    if (!stored) return {};
    const Value value = static_cast<Value>(*stored);
    return kind.text_of(&value, from);
  } else {
    const Value value = static_cast<Value>(stored);
    return kind.text_of(&value, from);
  }
}

template <class Value, class Held>
constexpr ValueOfMember value_of_member{read_value_of_member<Value, Held>,
                                        text_of_member<Value, Held>};

template <class Element>
void read_element_of_member(const UntypedTable& table, const Entry& at, const UntypedMember& member,
                            void* spec) {
  Element element{};
  table.read_untyped(at, &element);
  static_cast<std::vector<Element>*>(member(spec))->push_back(std::move(element));
}

template <class Element>
const void* find_element_of_member(const void* held, std::size_t k) {
  const auto& elements = *static_cast<const std::vector<Element>*>(held);
  return k < elements.size() ? &elements[k] : nullptr;
}

template <class Element>
constexpr ElementsOfMember elements_of_member{read_element_of_member<Element>,
                                              find_element_of_member<Element>};

/// Null for a single table.
template <class Held, class Inner>
constexpr const ElementsOfMember* elements_if_array() {
  if constexpr (std::is_same_v<Held, std::vector<Inner>>) {
    return &elements_of_member<Inner>;
  } else {
    static_assert(std::is_same_v<Held, Inner>);
    return nullptr;
  }
}

/// A key of a table, with all that reading, the resolved text and the reference need. By default it
/// is optional, and its default value is that of the specification's struct.
///
/// A predicate takes the specification and the case so far, an action the entry and the
/// specification.
template <class Spec>
class Key : public UntypedKey {
  template <class Access>
  using Held = std::remove_cvref_t<decltype(member_of(std::declval<Spec&>(),
                                                      std::declval<const Access&>()))>;

 public:
  /// @param member  pointer to a member of the specification, or a function that returns a
  ///                reference to one
  /// @param meaning a sentence for the reference, as are the words below
  template <class Access, class Value>
  Key(std::string_view name, Access member, const Kind<Value>& kind, std::string_view meaning)
      : UntypedKey(name, UntypedMember::of<Spec>(member), value_of_member<Value, Held<Access>>,
                   kind, meaning) {}
  /// A single table, or an array of tables if the member is a vector.
  template <class Access, class Inner>
  Key(std::string_view name, Access member, const Table<Inner>& inner, std::string_view meaning)
      : UntypedKey(name, UntypedMember::of<Spec>(member), inner,
                   elements_if_array<Held<Access>, Inner>(), meaning) {}

  Key& required(std::string_view words = "required") {
    set_required(words);
    return *this;
  }
  /// A default that depends on other keys. It takes the specification and the case so far.
  template <class Fallback>
  Key& otherwise(Fallback, std::string_view words) {
    static_assert(std::is_empty_v<Fallback>);
    set_fallback(
        +[](const Entry& at, void* spec) { Fallback()(*static_cast<Spec*>(spec), at.so_far); },
        words);
    return *this;
  }
  Key& default_words(std::string_view words) {
    set_default_words(words);
    return *this;
  }
  /// Adds limits to those of the kind.
  Key& moreover(std::string_view words) {
    add_limits(words);
    return *this;
  }
  /// If the predicate holds, the key is neither read nor written: it is refused with the reason, or
  /// ignored if the reason is empty.
  template <class Predicate>
  Key& unless(Predicate holds, std::string_view reason) {
    add_exclusion(untyped_predicate<Spec>(holds), reason);
    return *this;
  }
  /// The same by those rules of a specification that have its name: { key, is_idle, why }.
  template <class Rules>
  Key& by_rules(const Rules& rules) {
    for (const auto& rule : rules) {
      if (name() != rule.key) continue;
      unless([is_idle = rule.is_idle](const Spec& spec, const Case&) { return is_idle(spec); },
             rule.why);
    }
    return *this;
  }
  /// Exactly one of the keys of the table that are marked by this is needed.
  Key& one_of() {
    set_one_of();
    return *this;
  }
  /// Reads this key first: other keys may depend on it.
  Key& early() {
    set_early();
    return *this;
  }
  /// The key may change when a run is resumed: see extending_keys.
  Key& extends() {
    set_extends();
    return *this;
  }
  /// Tests run the key on several ranks, a table with all that is in it: see keys_on_ranks. Any
  /// other key is refused there.
  Key& on_ranks() {
    set_on_ranks();
    return *this;
  }
  /// Action after the key, given or not: checks that involve keys read before.
  template <class Action>
  Key& then(Action action) {
    set_then(untyped_action<Spec>(action));
    return *this;
  }
  template <class Predicate>
  Key& written_if(Predicate holds) {
    set_written_if(untyped_predicate<Spec>(holds));
    return *this;
  }
  /// Describes inner tables that a kind reads.
  Key& describes(DescribeInside tables_inside) {
    set_described(tables_inside);
    return *this;
  }
};

/// No action before or after the keys of a table.
struct NoAction {};

/// A table of the case file; its keys in the order of the resolved text.
template <class Spec>
struct Table : UntypedTable {
  /// @param name   dotted ("material.damage"); empty for the document
  /// @param before action before the first key is read, as is `after` after the last one
  template <class Before = NoAction, class After = NoAction>
  Table(std::string_view name, std::initializer_list<Key<Spec>> keys, Before before = {},
        After after = {})
      : UntypedTable(name, [] {
          static const Spec defaults{};
          return static_cast<const void*>(&defaults);
        }) {
    for (const auto& key : keys) add(key);
    if constexpr (!std::is_same_v<Before, NoAction>) do_before(before);
    if constexpr (!std::is_same_v<After, NoAction>) do_after(after);
  }
  void add(const Key<Spec>& key) { add_key(key); }
  template <class Before>
  void do_before(Before action) {
    set_before(untyped_action<Spec>(action));
  }
  template <class After>
  void do_after(After action) {
    set_after(untyped_action<Spec>(action));
  }

  void read(const Entry& at, Spec& spec) const { read_untyped(at, &spec); }
  /// Keys and values in force as lines of TOML, without the header.
  [[nodiscard]] std::string lines(const Spec& spec, const Case& from) const {
    return untyped_lines(&spec, from);
  }
};

/// Predicate for `unless`.
template <int dimension>
constexpr auto in_dimension = [](auto&, const Case& from) { return from.dimension == dimension; };

}  // namespace peristat
