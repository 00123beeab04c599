#pragma once

#include <map>
#include <string>
#include <vector>

namespace peristat {

struct Case;
template <class Spec>
struct Table;

/// What the values of a key are made of: numbers in its unit, numbers or expressions whose values
/// have its unit, or something else. Where the unit is a unit of measure, each number may be a
/// string with a number and a unit.
enum class ValueForm { other, number, expression };

/// Entry of a key in the reference, in markdown.
struct KeyDescription {
  std::string name, meaning, unit, fallback, allowed;
  ValueForm form = ValueForm::other;
  bool extends = false;   ///< may change when a run is resumed
  bool on_ranks = false;  ///< runs on several ranks; a table: with all keys below it
};

/// Entry of a table in the reference; `listed` has its keys in the order of messages.
struct TableDescription {
  std::string name;  ///< dotted, without indices ("lattice.shape"); the document's is empty
  bool is_array = false;
  std::vector<KeyDescription> keys;
  std::vector<std::string> listed;
};

/// The single definition of the keys of a case file (see key_table.hpp). Reading and checking, the
/// resolved text, the known keys and the reference derive from it.
[[nodiscard]] const Table<Case>& document_keys();

/// A text with short exponents, as the reference shows it: 1e-6 for 1e-06.
[[nodiscard]] std::string short_exponents(std::string text);

/// Every table, the document first.
[[nodiscard]] const std::vector<TableDescription>& table_descriptions();

/// True if a table has the keys of another one, which represents both in lists.
[[nodiscard]] bool repeats_another(const std::string& table);

/// Every key that a table of a case file may have, by the table's dotted name.
[[nodiscard]] const std::map<std::string, std::vector<std::string>>& case_keys();

/// Dotted names of the keys that may change when a run is resumed: they set how far it goes and how
/// it is solved and reported from then on, but not the problem itself.
[[nodiscard]] const std::vector<std::string>& extending_keys();

/// Dotted names of the keys that run on several ranks, and of tables all of whose keys do.
[[nodiscard]] const std::vector<std::string>& keys_on_ranks();

}  // namespace peristat
