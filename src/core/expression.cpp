#include "src/core/expression.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <utility>

#include <muParser.h>

#include "src/core/input_error.hpp"
#include "src/core/linear_table.hpp"
#include "src/core/nearest_name.hpp"
#include "src/core/number_text.hpp"
#include "src/core/table_calls.hpp"

namespace peristat {
namespace {

/// muParser takes fewer than 20 000 characters.
constexpr std::size_t longest_text = 19'999;

constexpr const char* table_name = "table";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// True for a letter, a digit and _.
bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || is_digit(c);
}

bool is_identifier(const std::string& name) {
  return !name.empty() && !is_digit(name.front()) && std::ranges::all_of(name, is_word);
}

/// Places of the commas between the arguments of a call and of its last parenthesis; without the
/// latter it is not closed.
std::vector<std::size_t> ends_of_arguments(const std::string& text, std::size_t open) {
  std::vector<std::size_t> ends;
  int depth = 0;
  for (std::size_t at = open; at < text.size(); ++at) {
    depth += text[at] == '(' ? 1 : text[at] == ')' ? -1 : 0;
    if (depth == 0 || (depth == 1 && text[at] == ',')) ends.push_back(at);
    if (depth == 0) return ends;
  }
  return {};
}

}  // namespace

const Columns Expression::none;
const GivenFunctions Expression::no_functions;

std::string why_no_column(const std::string& name) {
  constexpr std::size_t longest = 100;
  if (!is_identifier(name)) {
    return "is not a valid name in expressions: a name has letters, digits and _, and does not "
           "begin with a digit";
  }
  if (name.size() > longest) return "has more than " + std::to_string(longest) + " characters";
  static const std::vector<std::string> words{
      "x",       "y",         "z",         "load",      "load2",   "load3", "load4", "t",
      "spacing", "spacing_x", "spacing_y", "spacing_z", "horizon", "pi",    "free",  table_name};
  const bool is_function = mu::Parser().GetFunDef().contains(name);
  if (is_function || std::ranges::count(words, name) > 0) {
    return "already has another meaning in expressions; choose another name";
  }
  return "";
}

struct Expression::Parser {
  std::string text;
  int dimension = 3;
  Spacing spacing = 0.0;
  std::vector<std::string> constants;
  std::vector<std::string> parameters;
  std::optional<double> constant;
  mu::Parser parser;
  // Variables of the parser point at these; this struct therefore never moves.
  Coordinates place{};
  std::vector<double> values;  // of the parameters
  std::vector<double> values_of_columns;
  struct UsedColumn {
    const std::string* name;
    const std::vector<double>* of_points;
    double* value;
  };
  std::vector<UsedColumn> used;
  const Columns* columns = nullptr;
  const GivenFunctions* functions = nullptr;
  /// A call of a given function, whose value is a variable of the parser.
  struct GivenCall {
    const GivenFunction* function;
    std::vector<Expression> arguments;
    double value = 0.0;
  };
  std::deque<GivenCall> calls;  // never moves, either
  bool has_parameters = false;  // it depends on parameters
  bool is_local = false;        // it depends on the place or on columns
  std::vector<LinearTable> tables;
  std::vector<std::string> files;  // of the tables
  bool is_trial = false;           // the value does not count: tables may be left

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("", '"' + text + '"', what);
  }

  [[noreturn]] void refuse_parse(const mu::ParserError& error) const {
    const std::string where =
        error.GetPos() >= 0 ? " (character " + std::to_string(error.GetPos() + 1) + ")" : "";
    std::string what = error.GetMsg();
    // Drops the position that muParser counts from 0; `where` counts from 1.
    const std::size_t position = what.find(" at position ");
    if (position != std::string::npos) {
      const std::size_t end = what.find_first_not_of("0123456789", position + 13);
      what.erase(position, std::min(end, what.size()) - position);
    }
    refuse("not a valid expression" + where + ": " + what);
  }

  void define(const std::string& name, double value) {
    parser.DefineConst(name, value);
    constants.push_back(name);
  }

  void define_all() {
    parser.ClearConst();  // _pi and _e
    define("pi", std::numbers::pi);
    if (spacing > 0.0) {
      if (spacing.is_square()) define("spacing", spacing);
      for (int c = 0; c < dimension; ++c)
        define(std::string("spacing_") + "xyz"[c], spacing.along(c));
    }
    for (int c = 0; c < dimension; ++c) parser.DefineVar(std::string(1, "xyz"[c]), &place[c]);
    values.resize(parameters.size());
    for (std::size_t k = 0; k < values.size(); ++k) parser.DefineVar(parameters[k], &values[k]);
    if (dimension > 0) {
      values_of_columns.resize(columns->size());
      double* value = values_of_columns.data();
      for (const auto& [name, of_points] : *columns) parser.DefineVar(name, value++);
    }
    // Not folded in advance, so that a constant place outside a table is refused, too.
    constexpr bool may_fold = false;
    parser.DefineFunUserData(table_name, value_of_table, this, may_fold);
  }

  /// Called by muParser: value of a table, whose number stands in place of its name.
  static double value_of_table(void* parser, double number, double place) {
    const auto& of = *static_cast<const Parser*>(parser);
    const auto k = static_cast<std::size_t>(number);
    const LinearTable& table = of.tables[k];
    if (!of.is_trial && !std::isnan(place) && !table.covers(place)) {
      of.refuse("the table " + of.files[k] + " goes from " + number_text(table.first()) + " to " +
                number_text(table.last()) + ", but its value at " + number_text(place) +
                " is needed" + of.where(" at ") + "; add a row, or hold its ends with min and max");
    }
    return table(place);
  }

  /// Reads the tables of the text. Returns the text with their numbers in place of their names; it
  /// is as long as before, so that errors have their places.
  std::string read_tables() {
    std::string plain = text;
    for (const TableCall& call : table_calls(text)) {
      try {
        tables.emplace_back(call.file, call.column);
      } catch (const InputError& error) {
        refuse(error.what());
      }
      files.push_back(call.file);
      const std::string number = std::to_string(files.size() - 1);
      const std::size_t length = call.end - call.begin;
      if (number.size() > length) refuse("has too many tables");
      plain.replace(call.begin, length, number + std::string(length - number.size(), ' '));
    }
    return plain;
  }

  void find_used_variables() {
    const mu::varmap_type& variables = parser.GetUsedVar();
    const auto is_used = [&](const std::string& name) { return variables.contains(name); };
    has_parameters = std::ranges::any_of(parameters, is_used);
    for (int c = 0; c < dimension; ++c) is_local |= is_used(std::string(1, "xyz"[c]));
    for (const GivenCall& call : calls) {
      for (const Expression& argument : call.arguments) {
        has_parameters |= argument.has_parameters();
        is_local |= argument.parser_->is_local;
      }
    }
    double* value = values_of_columns.data();
    for (const auto& [name, of_points] : *columns) {
      if (variables.contains(name)) used.push_back({&name, &of_points, value});
      ++value;
    }
    is_local |= !used.empty();
  }

  /// Puts variables in place of calls of given functions. The text stays as long as it is, so that
  /// errors have their places.
  std::string take_calls(std::string plain) {
    int number = 0;
    for (std::size_t end = 0; end < plain.size();) {
      const std::size_t begin = end;
      while (end < plain.size() && is_word(plain[end])) ++end;
      if (end == begin) ++end;
      const auto known = functions->find(plain.substr(begin, end - begin));
      if (known == functions->end()) continue;
      const std::size_t open = plain.find_first_not_of(' ', end);
      end = take_call(plain, known->first, known->second, open);
      std::string name;
      do name.assign(1, '_').append(std::to_string(number++));  // GCC 12 warns of "_" + ...
      while (parser.GetVar().contains(name) || functions->contains(name));
      if (name.size() > end - begin) refuse("has too many calls of given functions");
      parser.DefineVar(name, &calls.back().value);
      plain.replace(begin, end - begin, name + std::string(end - begin - name.size(), ' '));
    }
    return plain;
  }

  /// Reads a call with its parenthesis. Returns the place behind it.
  std::size_t take_call(const std::string& plain, const std::string& name,
                        const GivenFunction& function, std::size_t open) {
    const std::vector<std::size_t> ends = ends_of_arguments(plain, open);
    if (ends.empty()) {
      refuse("not a valid expression: the parenthesis at character " + std::to_string(open + 1) +
             " is not closed");
    }
    const bool has_none = ends.size() == 1 && plain.find_first_not_of(' ', open + 1) == ends[0];
    if (has_none || ends.size() != std::size_t(function.arguments)) {
      refuse("the function " + name + " takes " + std::to_string(function.arguments) +
             (function.arguments == 1 ? " argument, not " : " arguments, not ") +
             std::to_string(has_none ? 0 : ends.size()));
    }
    GivenCall call{&function, {}};
    std::size_t begin = open + 1;
    for (const std::size_t end : ends) {
      call.arguments.push_back(argument(begin, end));
      begin = end + 1;
    }
    calls.push_back(std::move(call));
    return begin;
  }

  [[nodiscard]] Expression argument(std::size_t begin, std::size_t end) const {
    try {  // the blanks keep the places of errors
      return {std::string(begin, ' ') + text.substr(begin, end - begin),
              dimension,
              spacing,
              parameters,
              *columns,
              *functions};
    } catch (const InputError& error) {
      refuse(error.allowed());
    }
  }

  /// Calls a given function: a value for each place, or one if it is the same for all.
  [[nodiscard]] std::vector<double> values_of(const GivenCall& call,
                                              std::span<const Coordinates> places,
                                              std::span<const double> of_parameters,
                                              std::span<const Index> points) const {
    std::vector<std::vector<double>> arguments;
    std::size_t count = 1;
    for (const Expression& argument : call.arguments) {
      const std::size_t needed = argument.parser_->is_local ? places.size() : 1;
      try {
        arguments.push_back(argument.at(places.first(needed), of_parameters,
                                        points.first(std::min(needed, points.size()))));
      } catch (const InputError& error) {
        refuse(error.allowed());
      }
      count = std::max(count, needed);
    }
    std::vector<double> found(count);
    const std::vector<std::span<const double>> spans(arguments.begin(), arguments.end());
    call.function->fill(spans, found);
    return found;
  }

  /// Takes the place and the parameters of an evaluation.
  void take(const Coordinates& at, std::span<const double> of_parameters, Index point) {
    place = at;
    std::copy_n(of_parameters.begin(), std::min(of_parameters.size(), values.size()),
                values.begin());
    take_columns(point);
  }

  /// Takes the values of a point.
  void take_columns(Index point) {
    for (const auto& [name, of_points, value] : used) {
      if (point < 0 || static_cast<std::size_t>(point) >= of_points->size()) {
        refuse("column " + *name + " has a value at each point, but the value" + where(" at ") +
               " is needed, where there is none");
      }
      *value = (*of_points)[static_cast<std::size_t>(point)];
    }
  }

  /// Place and parameters of the present evaluation, after these words; or nothing.
  [[nodiscard]] std::string where(const std::string& words) const {
    // Without a dimension (total forces) only the parameters say where.
    static constexpr const char* names[] = {"", "(x) = ", "(x, y) = ", "(x, y, z) = "};
    std::string all = names[dimension];
    if (dimension > 0) all += place_text(place, dimension);
    for (std::size_t k = 0; k < values.size(); ++k) {
      all += (all.empty() ? "" : ", ") + parameters[k] + " = " + number_text(values[k]);
    }
    return all.empty() ? all : words + all;
  }

  [[noreturn]] void refuse_word(const std::string& word, bool is_called) const {
    if (functions->contains(word)) {
      refuse("the function " + word + " needs its arguments in parentheses, as in " + word + "(x)");
    }
    std::vector<std::string> variables{"x", "y", "z"}, callable;
    variables.resize(dimension);
    variables.insert(variables.end(), parameters.begin(), parameters.end());
    variables.insert(variables.end(), constants.begin(), constants.end());
    if (dimension > 0) {
      for (const auto& [name, of_points] : *columns) variables.push_back(name);
    } else if (columns->contains(word)) {
      refuse("column " + word +
             " has a value at each point, but this number does not belong to a point");
    }
    for (const auto& [name, callback] : parser.GetFunDef()) callable.push_back(name);
    for (const auto& [name, function] : *functions) callable.push_back(name);

    std::vector<std::string> allowed = is_called ? callable : variables;
    std::string what = (is_called ? "unknown function " : "unknown variable ") + word + "; allowed";
    for (const std::string& name : allowed) what += (name == allowed[0] ? " are " : ", ") + name;
    // Correctly spelt, but not defined in this dimension or for this key.
    for (const char* known : {"x", "y", "z", "load", "t"}) {
      if (word == known) refuse(what);
    }
    // The parentheses of a function may have been forgotten.
    if (!is_called) allowed.insert(allowed.end(), callable.begin(), callable.end());
    const std::string nearest = nearest_name(word, allowed);
    refuse(what + (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }

  /// Reads the text once for unknown words, a single '=' and a second comparison beside another
  /// one, which muParser does not report or silently accepts.
  /// @return whether a variable occurs
  bool scan(const std::string& plain) const {
    const auto at = [&](std::size_t i) { return i < plain.size() ? plain[i] : '\0'; };
    bool varies = false;
    std::vector<bool> compared{false};  // per open parenthesis: a comparison stands to the left
    for (std::size_t i = 0; i < plain.size();) {
      const char c = plain[i];
      if (is_digit(c) || c == '.') {
        while (is_digit(at(i)) || at(i) == '.') ++i;
        const bool is_signed = at(i + 1) == '+' || at(i + 1) == '-';
        if ((at(i) == 'e' || at(i) == 'E') && is_digit(at(i + 1 + is_signed))) {
          for (i += 1 + is_signed; is_digit(at(i));) ++i;
        }
      } else if (is_word(c)) {
        std::size_t end = i, next;
        while (is_word(at(end))) ++end;
        for (next = end; at(next) == ' ';) ++next;
        const std::string word = plain.substr(i, end - i);
        const bool is_variable = parser.GetVar().count(word) > 0;
        const bool is_given = at(next) == '(' && functions->contains(word);
        if (!is_variable && !is_given && !parser.GetConst().count(word) &&
            !parser.GetFunDef().count(word)) {
          refuse_word(word, at(next) == '(');
        }
        // A given function is not called before it is needed.
        varies = varies || is_variable || is_given;
        i = end;
      } else if (c == '<' || c == '>' || c == '=' || (c == '!' && at(i + 1) == '=')) {
        const bool two_characters = at(i + 1) == '=';
        if (c == '=' && !two_characters) {
          refuse("'=' at character " + std::to_string(i + 1) + " assigns; == compares");
        }
        if (compared.back()) {
          refuse("the comparison at character " + std::to_string(i + 1) +
                 " would compare the result of the comparison before it; join the two with &&");
        }
        compared.back() = true;
        i += two_characters ? 2 : 1;
      } else {
        if (c == '*' && at(i + 1) == '*') {
          refuse("'**' at character " + std::to_string(i + 1) +
                 " is not an operator; write a power with ^, as in load^2");
        }
        if (c == '(') compared.push_back(false);
        if (c == ')' && compared.size() > 1) compared.pop_back();
        if (c == '&' || c == '|' || c == '?' || c == ':' || c == ',') compared.back() = false;
        ++i;
      }
    }
    return varies;
  }

  void compile() {
    // A multi-line string of the case file is one line here; muParser refuses line breaks.
    for (char& c : text) {
      if (c == '\n' || c == '\r' || c == '\t') c = ' ';
    }
    if (text.find_first_not_of(' ') == std::string::npos) {
      refuse("an expression must not be empty; allowed is a number or an expression");
    }
    if (text.size() > longest_text) {
      refuse("an expression may have at most " + std::to_string(longest_text) +
             " characters; this one has " + std::to_string(text.size()) +
             ". Many values are better kept in a file, as in table(\"file.csv\", x)");
    }
    // muParser stops silently at a zero character.
    if (text.find('\0') != std::string::npos)
      refuse("an expression must not contain a zero character");
    std::string plain = read_tables();
    const bool varies = scan(plain);
    plain = take_calls(std::move(plain));
    try {
      parser.SetExpr(plain);
      int count = 0;
      is_trial = varies;
      const double first = *parser.Eval(count);
      is_trial = false;
      if (count != 1) refuse("an expression has one value; a decimal point is '.', not ','");
      if (!varies) constant = first;
      find_used_variables();
    } catch (const mu::ParserError& error) {
      refuse_parse(error);
    }
    if (constant && !std::isfinite(*constant)) {
      refuse("the value is " + number_text(*constant) + "; it must be finite");
    }
  }

  double value() {
    double result = 0.0;
    try {
      result = parser.Eval();
    } catch (const mu::ParserError& error) {
      refuse_parse(error);
    }
    if (!std::isfinite(result)) {
      refuse("the value" + where(" at ") + " is " + number_text(result) + "; it must be finite");
    }
    return result;
  }
};

Expression::Expression(const std::string& text, int dimension, const Spacing& spacing,
                       std::vector<std::string> parameters, const Columns& columns,
                       const GivenFunctions& functions)
    : parser_(std::make_unique<Parser>()) {
  parser_->text = text;
  parser_->dimension = dimension;
  parser_->spacing = spacing;
  parser_->parameters = std::move(parameters);
  parser_->columns = &columns;
  parser_->functions = &functions;
  parser_->define_all();
  parser_->compile();
}

Expression::Expression(double value) : parser_(std::make_unique<Parser>()) {
  parser_->text = number_text(value);
  parser_->constant = value;
  if (!std::isfinite(value)) parser_->refuse("the value must be finite");
}

Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

double Expression::operator()(const Coordinates& place, std::span<const double> parameters,
                              Index point) const {
  if (parser_->constant) return *parser_->constant;
  if (!parser_->calls.empty()) return at({&place, 1}, parameters, {&point, 1}).front();
  parser_->take(place, parameters, point);
  return parser_->value();
}

std::vector<double> Expression::at(std::span<const Coordinates> places,
                                   std::span<const double> parameters,
                                   std::span<const Index> points) const {
  if (parser_->constant) return std::vector<double>(places.size(), *parser_->constant);
  if (places.size() > 1 && !parser_->is_local) {
    const auto first = at(places.first(1), parameters, points.first(std::min(points.size(), 1ul)));
    return std::vector<double>(places.size(), first.front());
  }
  std::vector<std::vector<double>> of_calls;
  for (const Parser::GivenCall& call : parser_->calls) {
    if (!places.empty()) of_calls.push_back(parser_->values_of(call, places, parameters, points));
  }
  std::vector<double> values;
  values.reserve(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    parser_->take(places[k], parameters, points.empty() ? no_point : points[k]);
    for (std::size_t call = 0; call < of_calls.size(); ++call) {
      const std::vector<double>& of_call = of_calls[call];
      parser_->calls[call].value = of_call[of_call.size() == 1 ? 0 : k];
    }
    values.push_back(parser_->value());
  }
  return values;
}

bool Expression::is_constant() const { return parser_->constant.has_value(); }

bool Expression::has_parameters() const { return parser_->has_parameters; }

const std::string& Expression::text() const { return parser_->text; }

}  // namespace peristat
