#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cases/runner/input/case_keys.hpp"
#include "cases/runner/input/toml_table.hpp"
#include "src/core/json_object.hpp"

/// Keys and tables work on specifications and values behind `void`, so that untyped_keys.cpp
/// compiles them once: compiled for each type they took a minute. key_table.hpp puts the types
/// back.
namespace peristat {

/// A key while it is read: its table, and the case with all that was read before.
struct Entry {
  const TomlTable& from;
  std::string key;  ///< empty for the table itself
  const Case& so_far;

  [[noreturn]] void refuse(const std::string& why) const { from.refuse(key, why); }
};

/// A kind of values (see Kind) without their type. Here and below, copying is compiled once, too.
struct UntypedKind {
  using Read = std::function<void(const Entry&, void* value)>;
  using Text = std::function<std::string(const void* value, const Case&)>;

  Read read_into;
  Text text_of;
  JsonObject schema;          ///< of a value
  JsonObject schemas_beside;  ///< of keys that stand beside the value and that this kind reads
  std::string allowed, unit;
  ValueForm form;

  UntypedKind(Read read_into, Text text_of, JsonObject schema, std::string allowed,
              std::string unit, ValueForm form);
  UntypedKind(const UntypedKind&);
  UntypedKind(UntypedKind&&) noexcept;
  ~UntypedKind();
};

/// The member of a specification, by pointer to member or function.
template <class Spec, class Access>
auto& member_of(Spec& spec, const Access& access) {
  if constexpr (std::is_member_object_pointer_v<Access>)
    return spec.*access;
  else
    return access(spec);
}

/// Access to a member of a specification without its type. An access may create a missing member,
/// unless the specification is constant.
class UntypedMember {
 public:
  template <class Spec, class Access>
  static UntypedMember of(const Access& access) {
    static_assert(sizeof(Access) <= sizeof access_ && alignof(Access) <= alignof(void*) &&
                  std::is_trivially_copyable_v<Access>);
    UntypedMember member;
    new (member.access_) Access(access);
    member.find_ = [](const void* how, void* spec) -> void* {
      return &member_of(*static_cast<Spec*>(spec), *std::launder(static_cast<const Access*>(how)));
    };
    member.find_constant_ = [](const void* how, const void* spec) -> const void* {
      return &member_of(*static_cast<const Spec*>(spec),
                        *std::launder(static_cast<const Access*>(how)));
    };
    return member;
  }

  void* operator()(void* spec) const { return find_(access_, spec); }
  const void* operator()(const void* spec) const { return find_constant_(access_, spec); }

 private:
  alignas(void*) std::byte access_[2 * sizeof(void*)]{};
  void* (*find_)(const void* access, void* spec) = nullptr;
  const void* (*find_constant_)(const void* access, const void* spec) = nullptr;
};

/// How a value of a kind is stored in a member of another type, and converted to text from there.
struct ValueOfMember {
  void (*read)(const UntypedKind&, const Entry&, const UntypedMember&, void* spec);
  std::string (*text)(const UntypedKind&, const void* held, const Case&);
};

class UntypedTable;

/// How the elements of an array of tables are read and found.
struct ElementsOfMember {
  void (*read)(const UntypedTable&, const Entry&, const UntypedMember&, void* spec);
  const void* (*find)(const void* held, std::size_t k);  ///< null after the last one
};

/// A key of a table (see Key) without the type of its specification.
class UntypedKey {
 public:
  using Predicate = std::function<bool(const void* spec, const Case& so_far)>;
  using Action = std::function<void(const Entry&, void* spec)>;
  using DescribeInside = void (*)(std::vector<TableDescription>&);

  UntypedKey(std::string_view name, const UntypedMember&, const ValueOfMember&, const UntypedKind&,
             std::string_view meaning);
  /// @param elements null: one table
  UntypedKey(std::string_view name, const UntypedMember&, const UntypedTable&,
             const ElementsOfMember* elements, std::string_view meaning);
  UntypedKey(const UntypedKey&);
  UntypedKey(UntypedKey&&) noexcept;
  ~UntypedKey();

 protected:
  [[nodiscard]] const std::string& name() const { return description_.name; }
  void set_required(std::string_view words);
  void set_fallback(Action, std::string_view words);
  void set_default_words(std::string_view words);
  void add_limits(std::string_view words);
  void add_exclusion(Predicate holds, std::string_view reason);
  void set_one_of() { is_one_of_ = true; }
  void set_early() { is_early_ = true; }
  void set_extends() { description_.extends = true; }
  void set_on_ranks() { description_.on_ranks = true; }
  void set_then(Action action);
  void set_written_if(Predicate holds);
  void set_described(DescribeInside tables_inside) { describe_inside_ = tables_inside; }

 private:
  friend class UntypedTable;

  const std::string* exclusion(const void* spec, const Case& so_far) const;
  bool applies(const Entry& at, const void* spec) const;
  void read(const Entry& table, void* spec) const;
  void read_value(const Entry& at, void* spec) const;
  void read_default(const Entry& at, void* spec) const;
  std::string lines(const void* spec, const Case& from) const;
  std::string table_lines(const void* spec, const Case& from) const;
  std::string value_text(const void* spec, const Case& from) const;
  void describe_inside(std::vector<TableDescription>& all) const;
  /// Schema of the value, without its description.
  JsonObject value_schema() const;

  KeyDescription description_;
  UntypedMember member_;
  ValueOfMember value_{};
  std::shared_ptr<const UntypedKind> kind_;
  const ElementsOfMember* elements_ = nullptr;
  std::shared_ptr<const UntypedTable> inner_;  ///< null: a value
  Action fallback_, then_;
  std::vector<std::pair<Predicate, std::string>> exclusions_;
  Predicate written_if_;
  DescribeInside describe_inside_ = nullptr;
  bool is_required_ = false, is_one_of_ = false, is_early_ = false;
};

/// A table of the case file (see Table) without the type of its specification.
class UntypedTable {
 public:
  using Action = UntypedKey::Action;
  using Defaults = const void* (*)();  ///< returns a specification with default values

  UntypedTable(std::string_view name, Defaults);
  UntypedTable(const UntypedTable&);
  UntypedTable(UntypedTable&&) noexcept;
  ~UntypedTable();

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Appends this table and those in it.
  void describe(std::vector<TableDescription>& all, bool is_array = false) const;
  /// JSON schema of the table: its keys with their descriptions, limits and constant defaults, and
  /// those that are required, whatever the others are.
  [[nodiscard]] JsonObject schema() const;
  /// Schemas of the keys, by name.
  [[nodiscard]] JsonObject key_schemas() const;

  void read_untyped(const Entry& at, void* spec) const;
  [[nodiscard]] std::string untyped_lines(const void* spec, const Case& from) const;

 protected:
  void add_key(const UntypedKey& key);
  void set_before(Action action);
  void set_after(Action action);

 private:
  std::string default_of(const UntypedKey& key) const;
  std::vector<KeyDescription> descriptions() const;

  std::string name_;
  Defaults defaults_;
  std::vector<UntypedKey> keys_;
  Action before_, after_;
};

}  // namespace peristat
