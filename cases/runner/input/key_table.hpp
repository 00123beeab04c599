#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "cases/runner/input/case.hpp"
#include "cases/runner/input/case_keys.hpp"
#include "cases/runner/input/toml_table.hpp"

namespace peristat {

/// A key while it is read: its table, and the case with all that was read before.
struct Entry {
  const TomlTable& from;
  std::string key;  ///< empty for the table itself
  const Case& so_far;

  [[noreturn]] void refuse(const std::string& why) const { from.refuse(key, why); }
};

/// What the value of a key may be: how it is read and checked, written as TOML, and described.
template <class Value>
struct Kind {
  std::function<Value(const Entry&)> read;
  std::function<std::string(const Value&, const Case&)> text;
  std::string allowed, unit = {};
};

/// Member of a member, to be used like a pointer to a member.
template <class Outer, class Inner>
auto in(Outer outer, Inner inner) {
  return [=](auto& spec) -> auto& { return std::invoke(inner, std::invoke(outer, spec)); };
}

/// A key of a table: all that reading, the resolved text and the reference know of it. Unless more
/// is said it is optional, and its default is that of the specification's struct.
template <class Spec>
class Key {
 public:
  using Predicate = std::function<bool(const Spec&, const Case& so_far)>;
  using Action = std::function<void(const Entry&, Spec&)>;

  /// @param member  pointer to a member of the specification, or what gives a reference to one
  /// @param meaning a sentence for the reference, as are the words below
  template <class Member, class Value>
  Key(std::string name, Member member, Kind<Value> kind, std::string meaning)
      : description_{name, std::move(meaning), kind.unit, {}, kind.allowed, false} {
    using Held = std::remove_cvref_t<std::invoke_result_t<Member, Spec&>>;
    read_ = [=](const Entry& at, Spec& spec) {
      std::invoke(member, spec) = static_cast<Held>(kind.read(at));
    };
    value_text_ = [=](const Spec& spec, const Case& from) -> std::string {
      const Held& stored = std::invoke(member, spec);
      if constexpr (requires { stored.has_value(); })
        return stored ? kind.text(*stored, from) : std::string();
      else
        return kind.text(static_cast<Value>(stored), from);
    };
  }
  /// A table of its own, or an array of tables if the member is a vector.
  template <class Member, class Inner>
  Key(std::string name, Member member, const Table<Inner>& inner, std::string meaning)
      : description_{name, std::move(meaning), {}, "all defaults", {}, false} {
    using Held = std::remove_cvref_t<std::invoke_result_t<Member, Spec&>>;
    constexpr bool is_array = requires(Held stored) { stored.push_back(Inner()); };
    if (is_array) description_.fallback = "none";
    describe_inside_ = [=](auto& all) { inner.describe(all, is_array); };
    if constexpr (is_array) {
      read_ = [=](const Entry& at, Spec& spec) {
        for (const TomlTable& table : at.from.tables(name)) {
          Inner element{};
          inner.read({table, "", at.so_far}, element);
          std::invoke(member, spec).push_back(std::move(element));
        }
      };
    } else {
      read_ = [=](const Entry& at, Spec& spec) {
        inner.read({at.from.table(name), "", at.so_far}, std::invoke(member, spec));
      };
      fallback_ = [=](const Entry& at, Spec& spec) {
        inner.read({at.from.empty_table(name), "", at.so_far}, std::invoke(member, spec));
      };
    }
    lines_ = [=](const Spec& spec, const Case& from) {
      std::string lines;
      if constexpr (is_array)
        for (const auto& element : std::invoke(member, spec))
          lines += "\n[[" + inner.name + "]]\n" + inner.lines(element, from);
      else
        lines = "\n[" + inner.name + "]\n" + inner.lines(std::invoke(member, spec), from);
      return lines;
    };
  }

  Key& required(std::string words = "required") {
    is_required_ = true;
    return default_words(std::move(words));
  }
  /// A default that depends on other keys.
  template <class Fallback>
  Key& otherwise(Fallback fallback, std::string words) {
    fallback_ = [=](const Entry& at, Spec& spec) { fallback(spec, at.so_far); };
    return default_words(std::move(words));
  }
  Key& default_words(std::string words) {
    description_.fallback = std::move(words);
    return *this;
  }
  /// Limits beside those of the kind.
  Key& moreover(const std::string& words) {
    description_.allowed += (description_.allowed.empty() ? "" : "; ") + words;
    return *this;
  }
  /// Where this holds the key is neither read nor written: it is refused, or ignored if there is no
  /// reason.
  Key& unless(Predicate holds, std::string reason) {
    exclusions_.emplace_back(std::move(holds), std::move(reason));
    return *this;
  }
  /// Of the keys of the table that say so exactly one is needed.
  Key& one_of() {
    is_one_of_ = true;
    return *this;
  }
  /// Read first: which other keys apply may depend on it.
  Key& early() {
    is_early_ = true;
    return *this;
  }
  /// May change when a run goes on: see extending_keys.
  Key& extends() {
    description_.extends = true;
    return *this;
  }
  /// What follows from the key, there or not: checks together with what was read before.
  Key& then(Action action) {
    then_ = std::move(action);
    return *this;
  }
  Key& written_if(Predicate holds) {
    written_if_ = std::move(holds);
    return *this;
  }
  Key& describes(std::function<void(std::vector<TableDescription>&)> tables_inside) {
    describe_inside_ = std::move(tables_inside);
    return *this;
  }

 private:
  friend struct Table<Spec>;

  const std::string& name() const { return description_.name; }

  const std::string* exclusion(const Spec& spec, const Case& so_far) const {
    for (const auto& [holds, reason] : exclusions_)
      if (holds(spec, so_far)) return &reason;
    return nullptr;
  }

  /// Whether the key means something here. @throws InputError if it is there and means nothing
  bool applies(const Entry& at, const Spec& spec) const {
    const std::string* reason = exclusion(spec, at.so_far);
    if (reason != nullptr && !reason->empty() && at.from.has(name()))
      at.from.refuse(name(), *reason);
    return reason == nullptr;
  }

  void read(const Entry& table, Spec& spec) const {
    const Entry at{table.from, name(), table.so_far};
    if (!applies(at, spec)) return;
    if (is_required_ || at.from.has(name()))
      read_(at, spec);
    else if (fallback_)
      fallback_(at, spec);
    if (then_) then_(at, spec);
  }

  std::string lines(const Spec& spec, const Case& from) const {
    if (exclusion(spec, from) != nullptr || (written_if_ && !written_if_(spec, from))) return {};
    if (lines_) return lines_(spec, from);
    const std::string value = value_text_(spec, from);
    return value.empty() ? value : name() + " = " + value + "\n";
  }

  KeyDescription description_;
  Action read_, fallback_, then_;
  std::function<std::string(const Spec&, const Case&)> value_text_, lines_;
  std::vector<std::pair<Predicate, std::string>> exclusions_;
  Predicate written_if_;
  std::function<void(std::vector<TableDescription>&)> describe_inside_;
  bool is_required_ = false, is_one_of_ = false, is_early_ = false;
};

/// A table of the case file; its keys in the order of the resolved text.
template <class Spec>
struct Table {
  std::string name;  ///< dotted ("material.damage"); empty for the document
  std::vector<Key<Spec>> keys;
  typename Key<Spec>::Action before{}, after{};

  void read(const Entry& at, Spec& spec) const {
    if (before) before(at, spec);
    for (const auto& key : keys)
      if (key.is_early_) key.read(at, spec);
    std::vector<std::string> group;
    for (const auto& key : keys)
      if (key.applies(at, spec) && key.is_one_of_) group.push_back(key.name());
    const std::string one = group.empty() ? "" : at.from.exactly_one(group);
    for (const auto& key : keys)
      if (key.name() == one) key.read(at, spec);
    for (const auto& key : keys)
      if (!key.is_early_ && !key.is_one_of_) key.read(at, spec);
    if (after) after(at, spec);
  }

  /// Keys and values in force as lines of TOML, without the header.
  [[nodiscard]] std::string lines(const Spec& spec, const Case& from) const {
    std::string text;
    for (const auto& key : keys) text += key.lines(spec, from);
    return text;
  }

  /// Appends this table and those in it.
  void describe(std::vector<TableDescription>& all, bool is_array = false) const {
    TableDescription own{name, is_array, {}, {}};
    std::string group;
    for (const auto& key : keys) {
      own.listed.push_back(key.name());
      if (key.is_one_of_) group += (group.empty() ? "`" : ", `") + key.name() + "`";
    }
    for (const auto& key : keys) {
      own.keys.push_back(key.description_);
      std::string& fallback = own.keys.back().fallback;
      if (key.is_one_of_) fallback = "exactly one of " + group;
      if (fallback.empty()) fallback = default_text(key.value_text_(Spec{}, Case{}));
    }
    all.push_back(std::move(own));
    for (const auto& key : keys)
      if (key.describe_inside_) key.describe_inside_(all);
  }
};

/// For `unless`.
template <int dimension>
constexpr auto in_dimension = [](auto&, const Case& from) { return from.dimension == dimension; };

}  // namespace peristat
