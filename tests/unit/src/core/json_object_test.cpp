#include "src/core/json_object.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace peristat {
namespace {

TEST(JsonObject, HasItsMembersInTheOrderInWhichTheyAreAdded) {
  JsonObject object;
  object.add("text", "a \"b\"\n\\").add("whole", -3).add("number", 1e-30);
  object.add("numbers", std::vector<double>{1.5, 2.0});
  object.add("texts", std::vector<std::string>{"x", "y"}).add_json("none", "null");
  EXPECT_EQ(object.text(), R"({
  "text": "a \"b\"\n\\",
  "whole": -3,
  "number": 1e-30,
  "numbers": [1.5, 2],
  "texts": ["x", "y"],
  "none": null
})");
}

TEST(JsonObject, IndentsObjectsInside) {
  const JsonObject inner = JsonObject().add("a", JsonObject().add("b", "1\n2"));
  EXPECT_EQ(JsonObject()
                .add("empty", JsonObject())
                .add("inner", inner)
                .add("all", std::vector<JsonObject>{inner})
                .text(),
            R"({
  "empty": {},
  "inner": {
    "a": {
      "b": "1\n2"
    }
  },
  "all": [{
    "a": {
      "b": "1\n2"
    }
  }]
})");
}

TEST(JsonObject, KeepsAMemberThatAnotherObjectHasToo) {
  const JsonObject other = JsonObject().add("a", 2).add("b", 3);
  EXPECT_EQ(JsonObject().add("a", 1).add_missing(other).text(), "{\n  \"a\": 1,\n  \"b\": 3\n}");
}

TEST(JsonObject, RefusesNumbersThatAreNotFinite) {
  EXPECT_THROW(JsonObject().add("x", std::numeric_limits<double>::infinity()), std::logic_error);
  EXPECT_THROW(JsonObject().add("x", std::vector<double>{std::numeric_limits<double>::quiet_NaN()}),
               std::logic_error);
}

}  // namespace
}  // namespace peristat
