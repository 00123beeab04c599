#include "src/core/table_calls.hpp"

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

constexpr const char* example = "table(\"file.csv\", t)";

class TableCallScanner {
 public:
  explicit TableCallScanner(const std::string& text) : text_(text) {}

  std::vector<TableCall> calls() {
    std::vector<TableCall> found;
    while (at_ < text_.size()) {
      if (is_word(here())) {
        const std::size_t begin = at_;
        while (is_word(here())) ++at_;
        if (text_.compare(begin, at_ - begin, "table") == 0) take_call(found);
      } else {
        if (is_quote(here())) {
          refuse("quotes are only for the file and the column of a table, as in " +
                 std::string(example));
        }
        ++at_;
      }
    }
    return found;
  }

 private:
  static bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  }
  static bool is_quote(char c) { return c == '"' || c == '\''; }
  [[nodiscard]] char here() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_blanks() {
    while (here() == ' ' || here() == '\t' || here() == '\n' || here() == '\r') ++at_;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("", '"' + text_ + '"',
                     "not a valid expression (character " + std::to_string(at_ + 1) + "): " + what);
  }

  /// Reads what follows the word; the variable of the table stays for the parser.
  void take_call(std::vector<TableCall>& found) {
    skip_blanks();
    if (here() != '(') return;  // the parser refuses a function without parentheses
    ++at_;
    skip_blanks();
    TableCall call;
    call.begin = at_;
    call.file = quoted();
    call.end = at_;
    skip_blanks();
    if (here() == ',') {
      const std::size_t comma = at_++;
      skip_blanks();
      if (is_quote(here())) {
        call.column = quoted();
        call.end = at_;
      } else {
        at_ = comma;
      }
    }
    found.push_back(std::move(call));
  }

  std::string quoted() {
    const char quote = here();
    if (!is_quote(quote)) {
      refuse("the first argument of table is the name of a file in quotes, as in " +
             std::string(example));
    }
    const std::size_t begin = at_ + 1, end = text_.find(quote, begin);
    if (end == std::string::npos) refuse("this quote is not closed");
    if (end == begin) refuse("the text in quotes is empty");
    at_ = end + 1;
    return text_.substr(begin, end - begin);
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<TableCall> table_calls(const std::string& text) {
  return TableCallScanner(text).calls();
}

std::string with_table_files(const std::string& text,
                             const std::function<std::string(const std::string& file)>& rename) {
  std::string result = text;
  std::vector<TableCall> calls = table_calls(text);
  for (auto call = calls.rbegin(); call != calls.rend(); ++call) {
    const std::string file = rename(call->file);
    const char quote = file.find('"') == std::string::npos ? '"' : '\'';
    if (file.find(quote) != std::string::npos) {
      throw InputError("", '"' + text + '"',
                       "a file of a table can't have both quotes in its name");
    }
    std::string quoted = quote + file + quote;
    if (!call->column.empty()) {
      const char of_column = call->column.find('"') == std::string::npos ? '"' : '\'';
      quoted += std::string(", ") + of_column + call->column + of_column;
    }
    result.replace(call->begin, call->end - call->begin, quoted);
  }
  return result;
}

}  // namespace peristat
