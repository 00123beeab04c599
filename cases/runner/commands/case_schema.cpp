#include "cases/runner/commands/case_schema.hpp"

#include <fmt/format.h>

#include "cases/runner/input/key_table.hpp"

namespace peristat {

std::string case_schema() {
  JsonObject schema;
  schema.add("$schema", "http://json-schema.org/draft-07/schema#")
      .add("$id", "urn:peristat:case")
      .add("title", "peristat case")
      .add("description", "A case file of peristat, made by `peristat schema` from its key tables.")
      .add_missing(document_keys().schema());
  return schema.text() + "\n";
}

Exit print_schema() {
  fmt::print("{}", case_schema());
  return Exit::done;
}

}  // namespace peristat
