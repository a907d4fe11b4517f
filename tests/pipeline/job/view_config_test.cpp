#include "pipeline/job/view_config.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

/// A folder with a config that $OCIO names.
class ViewConfig : public ::testing::Test {
 protected:
  void SetUp() override { unsetenv("OCIO"); }
  void TearDown() override { unsetenv("OCIO"); }

  void use_config(const std::string& text) { setenv("OCIO", folder_.write("config.ocio", text).c_str(), 1); }

  /// Whether another content of a file makes another key.
  bool covers(const std::string& file) {
    std::filesystem::create_directories((folder_ / file).parent_path());
    folder_.write(file, "1");
    const std::string key = view_config_key({});
    folder_.write(file, "2");
    return view_config_key({}) != key;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ViewConfig, OfAJobPrecedesTheEnvironmentAndItsContentCounts) {
  use_config("a");
  const std::filesystem::path own = folder_.write("own.ocio", "b");
  const std::string key = view_config_key(own);
  EXPECT_NE(key, view_config_key({}));
  folder_.write("config.ocio", "c");
  EXPECT_EQ(view_config_key(own), key);
  folder_.write("own.ocio", "d");
  EXPECT_NE(view_config_key(own), key);
  EXPECT_ERROR(view_config_key(folder_ / "none.ocio"), ExitCode::missing_input, "trace.ocio");
}

TEST_F(ViewConfig, KeyCoversItsContent) {
  EXPECT_EQ(view_config_key({}), "shipped");
  use_config("a");
  EXPECT_TRUE(covers("config.ocio"));
  setenv("OCIO", folder_.path().c_str(), 1);
  EXPECT_ERROR(view_config_key({}), ExitCode::missing_input, "$OCIO");
}

TEST_F(ViewConfig, KeyCoversTheContentOfAnArchive) {
  use_config(std::string("PK\3\4\0\x14 { not YAML: [", 21));
  EXPECT_TRUE(covers("config.ocio"));
}

constexpr const char* kTransforms = R"(colorspaces:
  - !<ColorSpace>
    name: a
    from_scene_reference: !<FileTransform> {src: a.spi1d}
  - !<ColorSpace>
    name: b
    to_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {offset: [0, 0, 0, 0]}
        - !<FileTransform> {src: deep/b.cube, interpolation: linear}
looks:
  - !<Look> {name: c, process_space: a, transform: !<FileTransform> {src: "$SHOT/c.cc"}}
)";

TEST_F(ViewConfig, KeyCoversTheFilesOfItsTransforms) {
  use_config(std::string("environment: {SHOT: first}\nsearch_path: luts:grades\n") + kTransforms);
  EXPECT_TRUE(covers("luts/a.spi1d"));
  EXPECT_TRUE(covers("grades/deep/b.cube"));
  EXPECT_TRUE(covers("grades/first/c.cc"));
  EXPECT_FALSE(covers("luts/other.cube")) << "which no transform names";
  EXPECT_FALSE(covers("grades/a.spi1d")) << "which one earlier on the search path hides";
  EXPECT_TRUE(covers("luts/deep/b.cube")) << "which hides another";
}

TEST_F(ViewConfig, KeyCoversFilesBesideAConfigWithoutASearchPath) {
  use_config(kTransforms);
  EXPECT_TRUE(covers("a.spi1d"));
  const std::string search_path = "search_path: [\"\", luts]\n";
  use_config(search_path + kTransforms);
  EXPECT_TRUE(covers("a.spi1d"));
  EXPECT_TRUE(covers("luts/deep/b.cube"));
}

TEST_F(ViewConfig, KeyFollowsVariablesThatTheConfigUses) {
  use_config(std::string("environment: {SHOT: first}\nsearch_path: luts\n") + kTransforms);
  std::filesystem::create_directories(folder_ / "luts/first");
  std::filesystem::create_directories(folder_ / "luts/second");
  folder_.write("luts/first/c.cc", "1");
  folder_.write("luts/second/c.cc", "2");
  const std::string key = view_config_key({});
  setenv("SHOT", "second", 1);
  EXPECT_NE(view_config_key({}), key);
  EXPECT_TRUE(covers("luts/second/c.cc"));
  EXPECT_FALSE(covers("luts/first/c.cc"));
  unsetenv("SHOT");
}

}  // namespace
}  // namespace patchlight
