#include "src/core/readable_text.hpp"

#include <string>

#include <gtest/gtest.h>

#include "src/core/input_error.hpp"

namespace peristat {
namespace {

TEST(Readable, LeavesTextsAsTheyAre) {
  for (const std::string text : {"", "spacing", "δ = 3 µm, 日本", "a \"b\" \\c"}) {
    EXPECT_EQ(readable(text, 80), text);
  }
}

TEST(Readable, EscapesWhatIsNotSeen) {
  EXPECT_EQ(readable(std::string("a\0b", 3), 80), "a\\u0000b");
  EXPECT_EQ(readable("\x1B[31m\x7F\n\t", 80), "\\u001B[31m\\u007F\\n\\t");
  EXPECT_EQ(readable("\xC2\x9B", 80), "\\u009B");  // a control sequence of eight-bit terminals
  EXPECT_EQ(readable("\xC2", 80), "\\xC2");        // no UTF-8, as are the next two
  EXPECT_EQ(readable("\xE2\x82x", 80), "\\xE2\\x82x");
  EXPECT_EQ(readable("\xC0\x80", 80), "\\xC0\\x80");
}

TEST(Readable, ShortensBetweenCharacters) {
  EXPECT_EQ(readable("abcdef", 6), "abcdef");
  EXPECT_EQ(readable("abcdefg", 6), "abcdef… (7 characters)");
  EXPECT_EQ(readable("µµµ", 2), "µµ… (3 characters)");
  EXPECT_LT(readable(std::string(700'000, 'x'), 80).size(), 120u);
}

TEST(InputErrorMessage, QuotesShortlyAndWhole) {
  const std::string value(700'000, 'x');
  const InputError error("key", value, std::string("ends\0here", 9), "--set " + value);
  EXPECT_LT(std::string(error.what()).size(), 1000u);
  EXPECT_NE(std::string(error.what()).find("ends\\u0000here"), std::string::npos);
  EXPECT_NE(std::string(error.what()).find("(700000 characters)"), std::string::npos);
  EXPECT_EQ(error.value(), value);  // for whoever tells it again
}

}  // namespace
}  // namespace peristat
