#include "cases/runner/input/untyped_keys.hpp"

#include "cases/runner/input/case.hpp"
#include "cases/runner/input/value_schema.hpp"

namespace peristat {

UntypedKind::UntypedKind(Read reads, Text writes, JsonObject has_schema, std::string is_allowed,
                         std::string has_unit, ValueForm has_form)
    : read_into(std::move(reads)),
      text_of(std::move(writes)),
      schema(std::move(has_schema)),
      allowed(std::move(is_allowed)),
      unit(std::move(has_unit)),
      form(has_form) {}
UntypedKind::UntypedKind(const UntypedKind&) = default;
UntypedKind::UntypedKind(UntypedKind&&) noexcept = default;
UntypedKind::~UntypedKind() = default;

// ---- A key

UntypedKey::UntypedKey(std::string_view name, const UntypedMember& member,
                       const ValueOfMember& value, const UntypedKind& kind,
                       std::string_view meaning)
    : description_{std::string(name), std::string(meaning), kind.unit, {}, kind.allowed, kind.form},
      member_(member),
      value_(value),
      kind_(std::make_shared<UntypedKind>(kind)) {}

UntypedKey::UntypedKey(std::string_view name, const UntypedMember& member,
                       const UntypedTable& inner, const ElementsOfMember* elements,
                       std::string_view meaning)
    : description_{std::string(name), std::string(meaning), {}, {}, {}},
      member_(member),
      elements_(elements),
      inner_(std::make_shared<UntypedTable>(inner)) {
  description_.fallback = elements != nullptr ? "none" : "all defaults";
}

UntypedKey::UntypedKey(const UntypedKey&) = default;
UntypedKey::UntypedKey(UntypedKey&&) noexcept = default;
UntypedKey::~UntypedKey() = default;

void UntypedKey::set_required(std::string_view words) {
  is_required_ = true;
  set_default_words(words);
}

void UntypedKey::set_fallback(Action action, std::string_view words) {
  fallback_ = std::move(action);
  set_default_words(words);
}

void UntypedKey::set_default_words(std::string_view words) { description_.fallback = words; }

void UntypedKey::add_limits(std::string_view words) {
  if (!description_.allowed.empty()) description_.allowed += "; ";
  description_.allowed += words;
}

void UntypedKey::add_exclusion(Predicate holds, std::string_view reason) {
  exclusions_.emplace_back(std::move(holds), reason);
}

void UntypedKey::set_then(Action action) { then_ = std::move(action); }
void UntypedKey::set_written_if(Predicate holds) { written_if_ = std::move(holds); }

const std::string* UntypedKey::exclusion(const void* spec, const Case& so_far) const {
  for (const auto& [holds, reason] : exclusions_)
    if (holds(spec, so_far)) return &reason;
  return nullptr;
}

/// True if the key applies here. @throws InputError if it is given and does not apply
bool UntypedKey::applies(const Entry& at, const void* spec) const {
  const std::string* reason = exclusion(spec, at.so_far);
  if (reason != nullptr && !reason->empty() && at.from.has(name())) at.from.refuse(name(), *reason);
  return reason == nullptr;
}

void UntypedKey::read(const Entry& table, void* spec) const {
  const Entry at{table.from, name(), table.so_far};
  if (!applies(at, spec)) return;
  if (is_required_ || at.from.has(name()))
    read_value(at, spec);
  else
    read_default(at, spec);
  if (then_) then_(at, spec);
}

void UntypedKey::read_value(const Entry& at, void* spec) const {
  if (!inner_)
    value_.read(*kind_, at, member_, spec);
  else if (elements_ == nullptr)
    inner_->read_untyped({at.from.table(name()), "", at.so_far}, member_(spec));
  else
    for (const TomlTable& table : at.from.tables(name()))
      elements_->read(*inner_, {table, "", at.so_far}, member_, spec);
}

/// Values and arrays keep the defaults of the specification's struct.
void UntypedKey::read_default(const Entry& at, void* spec) const {
  if (fallback_)
    fallback_(at, spec);
  else if (inner_ && elements_ == nullptr)
    inner_->read_untyped({at.from.empty_table(name()), "", at.so_far}, member_(spec));
}

std::string UntypedKey::lines(const void* spec, const Case& from) const {
  if (exclusion(spec, from) != nullptr || (written_if_ && !written_if_(spec, from))) return {};
  if (inner_) return table_lines(spec, from);
  const std::string value = value_text(spec, from);
  return value.empty() ? value : name() + " = " + value + "\n";
}

std::string UntypedKey::table_lines(const void* spec, const Case& from) const {
  const void* const held = member_(spec);
  if (elements_ == nullptr)
    return "\n[" + inner_->name() + "]\n" + inner_->untyped_lines(held, from);
  std::string lines;
  for (std::size_t k = 0; const void* element = elements_->find(held, k); ++k)
    lines += "\n[[" + inner_->name() + "]]\n" + inner_->untyped_lines(element, from);
  return lines;
}

std::string UntypedKey::value_text(const void* spec, const Case& from) const {
  return value_.text(*kind_, member_(spec), from);
}

void UntypedKey::describe_inside(std::vector<TableDescription>& all) const {
  if (describe_inside_ != nullptr)
    describe_inside_(all);
  else if (inner_)
    inner_->describe(all, elements_ != nullptr);
}

// ---- A table

UntypedTable::UntypedTable(std::string_view name, Defaults defaults)
    : name_(name), defaults_(defaults) {}
UntypedTable::UntypedTable(const UntypedTable&) = default;
UntypedTable::UntypedTable(UntypedTable&&) noexcept = default;
UntypedTable::~UntypedTable() = default;

void UntypedTable::add_key(const UntypedKey& key) { keys_.push_back(key); }
void UntypedTable::set_before(Action action) { before_ = std::move(action); }
void UntypedTable::set_after(Action action) { after_ = std::move(action); }

void UntypedTable::read_untyped(const Entry& at, void* spec) const {
  if (before_) before_(at, spec);
  for (const auto& key : keys_)
    if (key.is_early_) key.read(at, spec);
  std::vector<std::string> group;
  for (const auto& key : keys_)
    if (key.applies(at, spec) && key.is_one_of_) group.push_back(key.name());
  const std::string one = group.empty() ? "" : at.from.exactly_one(group);
  for (const auto& key : keys_)
    if (key.name() == one) key.read(at, spec);
  for (const auto& key : keys_)
    if (!key.is_early_ && !key.is_one_of_) key.read(at, spec);
  if (after_) after_(at, spec);
}

std::string UntypedTable::untyped_lines(const void* spec, const Case& from) const {
  std::string text;
  for (const auto& key : keys_) text += key.lines(spec, from);
  return text;
}

std::string short_exponents(std::string text) {
  using Replaced = std::pair<std::string_view, std::string_view>;
  for (const auto& [part, by] : {Replaced{"e-0", "e-"}, {"e+0", "e"}, {"e+", "e"}}) {
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += by.size())
      text.replace(at, part.size(), by);
  }
  return text;
}

namespace {

/// A default as the reference shows it, from its TOML text.
std::string default_text(const std::string& toml) {
  if (toml.empty()) return "none";
  if (toml.front() == '"' || toml.front() == '[') return "`" + toml + "`";
  return short_exponents(toml.ends_with(".0") ? toml.substr(0, toml.size() - 2) : toml);
}

}  // namespace

/// TOML of a constant default; empty if there is none.
std::string UntypedTable::default_of(const UntypedKey& key) const {
  static const Case no_case;
  const bool is_constant = key.description_.fallback.empty() && !key.is_one_of_;
  return is_constant ? key.value_text(defaults_(), no_case) : "";
}

/// Descriptions of the keys with their defaults.
std::vector<KeyDescription> UntypedTable::descriptions() const {
  std::string group;
  for (const auto& key : keys_)
    if (key.is_one_of_) group += (group.empty() ? "`" : ", `") + key.name() + "`";
  std::vector<KeyDescription> all;
  for (const auto& key : keys_) {
    all.push_back(key.description_);
    std::string& fallback = all.back().fallback;
    if (key.is_one_of_) fallback = "exactly one of " + group;
    if (fallback.empty()) fallback = default_text(default_of(key));
  }
  return all;
}

void UntypedTable::describe(std::vector<TableDescription>& all, bool is_array) const {
  TableDescription own{name_, is_array, descriptions(), {}};
  for (const auto& key : keys_) own.listed.push_back(key.name());
  all.push_back(std::move(own));
  for (const auto& key : keys_) key.describe_inside(all);
}

// ---- The schema

namespace {

/// A description in markdown with the words of its links alone: they lead to pages beside the
/// reference.
std::string without_links(std::string text) {
  for (std::size_t middle = 0; (middle = text.find("](")) != std::string::npos;) {
    const std::size_t begin = text.rfind('[', middle), end = text.find(')', middle);
    text.erase(middle, end + 1 - middle).erase(begin, 1);
  }
  return text;
}

std::string schema_text(const KeyDescription& key) {
  std::string text = key.meaning;
  if (!key.unit.empty()) text += " [" + key.unit + "]";
  const bool is_needed =
      key.fallback.find("required") != std::string::npos || key.fallback.starts_with("exactly one");
  if (!key.fallback.empty()) text += (is_needed ? "\n\n" : "\n\nDefault: ") + key.fallback;
  if (!key.allowed.empty()) text += "\n\nAllowed: " + short_exponents(key.allowed);
  return without_links(std::move(text));
}

}  // namespace

JsonObject UntypedKey::value_schema() const {
  if (!inner_) return kind_->schema;
  return elements_ != nullptr ? list_schema(inner_->schema(), 1) : inner_->schema();
}

JsonObject UntypedTable::key_schemas() const {
  JsonObject all;
  const auto described = descriptions();
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    JsonObject schema;
    schema.add("description", schema_text(described[k]));
    const std::string constant = default_of(keys_[k]);
    // The length of an array may depend on the dimension.
    if (!constant.empty() && constant.front() != '[' && constant != "inf")
      schema.add_json("default", constant);
    all.add(keys_[k].name(), schema.add_missing(keys_[k].value_schema()));
  }
  for (const auto& key : keys_)
    if (key.kind_) all.add_missing(key.kind_->schemas_beside);
  return all;
}

JsonObject UntypedTable::schema() const {
  std::vector<std::string> required;
  std::vector<JsonObject> group;
  for (const auto& key : keys_) {
    const std::vector<std::string> itself{key.name()};
    if (key.is_one_of_) group.push_back(JsonObject().add("required", itself));
    if (key.is_required_ && key.exclusions_.empty()) required.push_back(key.name());
  }
  JsonObject schema = table_schema(key_schemas());
  if (!required.empty()) schema.add("required", required);
  if (!group.empty()) schema.add("oneOf", group);
  return schema;
}

}  // namespace peristat
