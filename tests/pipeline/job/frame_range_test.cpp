#include "pipeline/job/frame_range.h"

#include <gmock/gmock.h>

namespace patchlight {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::string& list) {
  try {
    frame_numbers(list);
  } catch (const std::string& expected) {
    return expected;
  }
  return "";
}

TEST(FrameRange, ReadsBlendersAndFlamencosSyntax) {
  EXPECT_EQ(frame_numbers("7"), (std::vector{7}));
  EXPECT_EQ(frame_numbers("1-3"), (std::vector{1, 2, 3}));
  EXPECT_EQ(frame_numbers("1,5..7"), (std::vector{1, 5, 6, 7}));
  EXPECT_EQ(frame_numbers(" 3, 5 - 7,\t0047-49 "), (std::vector{3, 5, 6, 7, 47, 48, 49}));
  EXPECT_EQ(frame_numbers("0..0"), (std::vector{0}));
  EXPECT_EQ(frame_numbers("3, 5-10, 47-327").size(), 288u);
}

TEST(FrameRange, ReadsSteps) {
  EXPECT_EQ(frame_numbers("1-10x3"), (std::vector{1, 4, 7, 10}));
  EXPECT_EQ(frame_numbers("1..6:2, 20"), (std::vector{1, 3, 5, 20}));
}

TEST(FrameRange, KeepsTheOrderAndDropsRepetitions) {
  EXPECT_EQ(frame_numbers("1-9x4,1-4,3"), (std::vector{1, 5, 9, 2, 3, 4}));
}

TEST(FrameRange, RefusesWhatIsNoRange) {
  for (const char* list : {"", ",", "1,", "1-", "-1", "1-2-3", "1...3", "1x2", "1-3x", "1.5", "one", "12345678"})
    EXPECT_THAT(refusal(list), HasSubstr("expected frames such as 1-120")) << list;
  EXPECT_THAT(refusal("1,5-3"), HasSubstr("begins before it ends, not `5-3`"));
  EXPECT_THAT(refusal("1-3x0"), HasSubstr("step of at least 1"));
  EXPECT_THAT(refusal(std::string(1 << 20, '1')), HasSubstr("expected frames"));
}

TEST(FrameRange, IsBounded) {
  EXPECT_EQ(frame_numbers("1-9999999x100").size(), kMaxFrames);
  EXPECT_EQ(frame_numbers("1-100000").size(), kMaxFrames);
  EXPECT_THAT(refusal("1-100001"), HasSubstr("at most 100000 frames"));
}

}  // namespace
}  // namespace patchlight
