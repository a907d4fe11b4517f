#include "pipeline/system/text_scanner.h"

#include <gtest/gtest.h>

#include <string>

namespace patchlight {
namespace {

TEST(TextScanner, ReadsATextTokenByToken) {
  TextScanner text("rows.12-end");
  EXPECT_FALSE(text.skip("row."));
  EXPECT_TRUE(text.skip_any({"import", "rows"}));
  EXPECT_TRUE(text.take_digits().empty());
  EXPECT_TRUE(text.skip("."));
  EXPECT_EQ(text.take_digits(), "12");
  EXPECT_EQ(text.rest(), "-end");
  EXPECT_FALSE(text.skip_any({"end", "-ends"}));
  EXPECT_EQ(text.take([](char c) { return c != 'd'; }), "-en");
  EXPECT_FALSE(text.done());
  EXPECT_TRUE(text.skip("d"));
  EXPECT_TRUE(text.done());
  EXPECT_TRUE(text.take_digits().empty());
  EXPECT_TRUE(text.skip(""));
}

TEST(TextScanner, ReadsLongTexts) {
  const std::string digits(std::size_t(10) << 20, '7');
  EXPECT_EQ(TextScanner(digits).take_digits().size(), digits.size());
}

}  // namespace
}  // namespace patchlight
