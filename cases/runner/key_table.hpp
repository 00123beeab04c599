#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "cases/runner/case.hpp"
#include "cases/runner/case_keys.hpp"
#include "cases/runner/toml_table.hpp"

namespace peristat {

/// What the value of a key may be: how it is read and checked, written as TOML, and described.
template <class Value>
struct Kind {
  /// @param so_far the case with all that was read before
  std::function<Value(const TomlTable& from, const std::string& key, const Case& so_far)> read;
  std::function<std::string(const Value&, const Case&)> text;
  std::string allowed, unit;
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
  using Action = std::function<void(const TomlTable& from, Spec&, const Case& so_far)>;

  /// @param member  pointer to a member of the specification, or what gives a reference to one
  /// @param meaning a sentence for the reference, as are the words below
  template <class Member, class Value>
  Key(std::string name, Member member, Kind<Value> kind, std::string meaning)
      : description_{name, std::move(meaning), kind.unit, {}, kind.allowed} {
    using Held = std::remove_cvref_t<std::invoke_result_t<Member, Spec&>>;
    read_ = [=](const TomlTable& from, Spec& spec, const Case& so_far) {
      std::invoke(member, spec) = static_cast<Held>(kind.read(from, name, so_far));
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
      : description_{name, std::move(meaning), {}, "all defaults", {}} {
    using Held = std::remove_cvref_t<std::invoke_result_t<Member, Spec&>>;
    constexpr bool is_array = requires(Held stored) { stored.push_back(Inner()); };
    if (is_array) description_.fallback = "none";
    describe_inside_ = [=](auto& all) { inner.describe(all, is_array); };
    if constexpr (is_array) {
      read_ = [=](const TomlTable& from, Spec& spec, const Case& so_far) {
        for (const TomlTable& table : from.tables(name)) {
          Inner element{};
          inner.read(table, element, so_far);
          std::invoke(member, spec).push_back(std::move(element));
        }
      };
    } else {
      read_ = [=](const TomlTable& from, Spec& spec, const Case& so_far) {
        inner.read(from.table(name), std::invoke(member, spec), so_far);
      };
      fallback_ = [=](const TomlTable& from, Spec& spec, const Case& so_far) {
        inner.read(from.empty_table(name), std::invoke(member, spec), so_far);
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
    fallback_ = [=](const TomlTable&, Spec& spec, const Case& so_far) { fallback(spec, so_far); };
    return default_words(std::move(words));
  }
  Key& default_words(std::string words) {
    description_.fallback = std::move(words);
    return *this;
  }
  /// Limits beside those of the kind.
  Key& moreover(const std::string& words) {
    description_.allowed += (description_.allowed.empty() ? "" : ", ") + words;
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
  /// What follows from the key, there or not: checks together with what was read before.
  Key& then(Action action) {
    then_ = std::move(action);
    return *this;
  }
  Key& written_if(Predicate holds) {
    written_if_ = std::move(holds);
    return *this;
  }
  /// Messages list it there and not where it stands in the resolved text.
  Key& listed_after(std::string name) {
    listed_after_ = std::move(name);
    return *this;
  }
  Key& describes(std::function<void(std::vector<TableDescription>&)> tables_inside) {
    describe_inside_ = std::move(tables_inside);
    return *this;
  }

 private:
  friend struct Table<Spec>;

  const std::string& name() const { return description_.name; }

  /// Whether the key means something here. @throws InputError if it is there and means nothing
  bool applies(const TomlTable& from, const Spec& spec, const Case& so_far) const {
    for (const auto& [holds, reason] : exclusions_) {
      if (!holds(spec, so_far)) continue;
      if (!reason.empty() && from.has(name())) from.refuse(name(), reason);
      return false;
    }
    return true;
  }

  void read(const TomlTable& from, Spec& spec, const Case& so_far) const {
    if (!applies(from, spec, so_far)) return;
    if (is_required_ || from.has(name()))
      read_(from, spec, so_far);
    else if (fallback_)
      fallback_(from, spec, so_far);
    if (then_) then_(from, spec, so_far);
  }

  std::string lines(const Spec& spec, const Case& from) const {
    if (written_if_ && !written_if_(spec, from)) return {};
    for (const auto& [holds, reason] : exclusions_)
      if (holds(spec, from)) return {};
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
  std::string listed_after_;
  bool is_required_ = false, is_one_of_ = false, is_early_ = false;
};

/// A table of the case file; its keys in the order of the resolved text.
template <class Spec>
struct Table {
  std::string name;  ///< dotted ("material.damage"); empty for the document
  std::vector<Key<Spec>> keys;
  typename Key<Spec>::Action before{}, after{};

  void read(const TomlTable& from, Spec& spec, const Case& so_far) const {
    if (before) before(from, spec, so_far);
    for (const auto& key : keys)
      if (key.is_early_) key.read(from, spec, so_far);
    std::vector<std::string> group;
    for (const auto& key : keys)
      if (key.applies(from, spec, so_far) && key.is_one_of_) group.push_back(key.name());
    const std::string one = group.empty() ? "" : from.exactly_one(group);
    for (const auto& key : keys)
      if (key.name() == one) key.read(from, spec, so_far);
    for (const auto& key : keys)
      if (!key.is_early_ && !key.is_one_of_) key.read(from, spec, so_far);
    if (after) after(from, spec, so_far);
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
      if (key.listed_after_.empty()) own.listed.push_back(key.name());
      if (key.is_one_of_) group += (group.empty() ? "`" : ", `") + key.name() + "`";
    }
    for (const auto& key : keys) {
      if (!key.listed_after_.empty())
        own.listed.insert(std::find(own.listed.begin(), own.listed.end(), key.listed_after_) + 1,
                          key.name());
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

}  // namespace peristat
