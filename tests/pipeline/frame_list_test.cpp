#include "pipeline/files/frame_list.h"

#include <gtest/gtest.h>

namespace patchlight {
namespace {

std::vector<std::string> files(const std::vector<std::string>& cameras) {
  PatchSet scene;
  for (const auto& name : cameras) scene.cameras.emplace_back().name = name;
  std::vector<std::string> names;
  for (const Frame& frame : job_frames({}, scene)) names.push_back(frame.exr.filename().string());
  return names;
}

TEST(FrameList, WritesOneUnderscoreForACharacter) {
  EXPECT_EQ(files({"a b/c", "K\u00fcche \u2603\U0001f4a1", "\xbf\xc3x"}),
            (std::vector<std::string>{"a_b_c.0001.exr", "K_che___.0001.exr", "__x.0001.exr"}));
}

TEST(FrameList, TellsClashesApart) {
  EXPECT_EQ(files({"a b", "a_b", "a/b"}),
            (std::vector<std::string>{"a_b.0001.exr", "a_b_2.0001.exr", "a_b_3.0001.exr"}));
}

TEST(FrameList, CutsNamesThatNoFileCanHave) {
  EXPECT_EQ(files({std::string(246, 'x')})[0].size(), 255u);
  const std::vector<std::string> cut = files({std::string(247, 'x'), std::string(300, 'x')});
  EXPECT_EQ(cut[0], std::string(246, 'x') + ".0001.exr");
  EXPECT_EQ(cut[1], std::string(244, 'x') + "_2.0001.exr");
}

}  // namespace
}  // namespace patchlight
