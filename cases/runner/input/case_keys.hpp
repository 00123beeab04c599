#pragma once

#include <map>
#include <string>
#include <vector>

namespace peristat {

struct Case;
template <class Spec>
struct Table;

/// What the reference tells of a key, in markdown.
struct KeyDescription {
  std::string name, meaning, unit, fallback, allowed;
  bool extends = false;  ///< may change when a run goes on
};

/// What the reference tells of a table, and its keys in the order in which messages list them.
struct TableDescription {
  std::string name;  ///< dotted, without indices ("lattice.shape"); the document's is empty
  bool is_array = false;
  std::vector<KeyDescription> keys;
  std::vector<std::string> listed;
};

/// The one place that knows the keys of a case file (see key_table.hpp): from it come reading and
/// checking, the resolved text, the known keys and the reference.
[[nodiscard]] const Table<Case>& document_keys();

/// A default as the reference shows it, from its TOML text.
[[nodiscard]] std::string default_text(const std::string& toml);

/// Every table, the document first.
[[nodiscard]] const std::vector<TableDescription>& table_descriptions();

/// Whether a table has the keys of another one, which stands for both in lists.
[[nodiscard]] bool repeats_another(const std::string& table);

/// Every key that a table of a case file may have, by the table's dotted name.
[[nodiscard]] const std::map<std::string, std::vector<std::string>>& case_keys();

/// Dotted names of the keys that may change when a run goes on: they say how far it goes, how it
/// is searched and told from then on, and not what is searched.
[[nodiscard]] const std::vector<std::string>& extending_keys();

}  // namespace peristat
