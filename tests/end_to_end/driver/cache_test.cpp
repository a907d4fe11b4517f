#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <map>
#include <regex>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

class Cache : public ProgramTest {
 protected:
  void SetUp() override {
    small_job(folder_);
    ASSERT_EQ(stages(run({})), "import runs, solve runs, trace runs");
  }

  Outcome run(std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "job.yaml"});
    const Outcome outcome = run_program(folder_, "patchlight", more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome;
  }

  Outcome set(const std::string& setting) { return run({"--set", setting}); }

  /// The stages that ran or were restored, in order.
  static std::string stages(const Outcome& outcome) {
    std::string names;
    static const std::regex state("patchlight-run: (?:warning: )?((?:import|solve|trace) (?:runs|restored))");
    for (std::sregex_iterator i(outcome.err.begin(), outcome.err.end(), state), end; i != end; ++i)
      names += (names.empty() ? "" : ", ") + (*i)[1].str();
    return names;
  }

  std::map<std::string, std::string> outputs() {
    std::map<std::string, std::string> content;
    for (const char* file :
         {"patches.h5", "energy.h5", "transport.h5", "frames/camera.0001.exr", "frames/camera.0001.png"})
      content[file] = read_text(folder_ / (std::string("out/") + file));
    return content;
  }

  std::vector<fs::path> cached(const std::string& beginning) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_ / "out/cache"))
      if (entry.path().filename().string().starts_with(beginning)) files.push_back(entry.path());
    return files;
  }
};

TEST_F(Cache, RestoresOutputsOfEarlierSettings) {
  const auto before = outputs();
  EXPECT_EQ(stages(set("import.patch_area=0.02")), "import runs, solve runs, trace runs");
  EXPECT_NE(outputs(), before);
  EXPECT_EQ(stages(run({})), "import restored, solve restored, trace restored");
  EXPECT_EQ(outputs(), before) << "to the bit";
  EXPECT_EQ(stages(set("import.patch_area=0.02")), "import restored, solve restored, trace restored");
  EXPECT_EQ(stages(set("solve.rays=80")), "import restored, solve runs, trace runs");
  EXPECT_EQ(stages(set("trace.samples=9")), "solve restored, trace runs");
  EXPECT_EQ(stages(run({})), "trace restored");
  EXPECT_EQ(outputs(), before);
}

TEST_F(Cache, RestoresOutputsOfAnEarlierScene) {
  const std::string glb = read_text(folder_ / "box.glb");
  std::string moved = glb;
  moved[moved.find("\"yfov\":0.6") + 9] = '7';
  folder_.write("box.glb", moved);
  EXPECT_EQ(stages(run({})), "import runs, trace runs");
  folder_.write("box.glb", glb);
  EXPECT_EQ(stages(run({})), "import restored, trace restored");
  fs::remove_all(folder_ / "out/frames");
  fs::remove(folder_ / "out/patches.h5");
  EXPECT_EQ(stages(run({})), "import restored, trace restored");
}

TEST_F(Cache, TakesNoRoomForWhatStandsInTheOutputToo) {
  for (const fs::path& file : cached("")) EXPECT_EQ(fs::hard_link_count(file), 2) << file;
}

TEST_F(Cache, SharesRowsOfOtherColours) {
  set("solve.rays=80");
  const Outcome outcome = run({"--set", "materials.red.reflectance=[0.5, 0.1, 0.1]"});
  EXPECT_EQ(stages(outcome), "import runs, solve runs, trace runs");
  EXPECT_THAT(outcome.err, Not(HasSubstr("million rays"))) << "its rows of 64 rays were restored";
}

TEST_F(Cache, IsNotTrustedWhereItIsDamaged) {
  set("solve.rays=80");
  for (const char* name : {"energy-", "frame-"})
    for (const fs::path& file : cached(name)) {
      const std::string whole = read_text(file);
      std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() / 2);
    }
  const Outcome outcome = run({});
  EXPECT_EQ(stages(outcome), "solve runs, trace runs") << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: solve runs again: "));
  EXPECT_THAT(outcome.err, HasSubstr("warning: trace runs again: "));
  EXPECT_EQ(stages(run({})), "");
  set("solve.rays=80");
  EXPECT_EQ(stages(run({})), "solve restored, trace restored") << "the damaged files were replaced";
}

TEST_F(Cache, RestoresADamagedOutputWithAWarning) {
  const auto before = outputs();
  for (const auto& [file, stage] : {std::pair("patches.h5", "import"), std::pair("transport.h5", "solve"),
                                    std::pair("frames/camera.0001.png", "trace")}) {
    fs::remove(folder_ / (std::string("out/") + file));
    folder_.write(std::string("out/") + file, "something else");
    EXPECT_THAT(run({}).err, HasSubstr(std::string("warning: ") + stage + " restored, made before: "));
    EXPECT_EQ(outputs(), before);
  }
}

TEST_F(Cache, ChecksTheContentOfAFileAndNotItsName) {
  set("solve.rays=80");
  const std::vector<fs::path> files = cached("energy-");
  ASSERT_EQ(files.size(), 2u);
  const std::string a = read_text(files[0]), b = read_text(files[1]);
  std::ofstream(files[0], std::ios::binary) << b;
  std::ofstream(files[1], std::ios::binary) << a;
  EXPECT_EQ(stages(run({})), "solve runs, trace restored");
}

TEST_F(Cache, KeepsItsLimitAndTheLastUsedFiles) {
  set("solve.rays=80");
  run({});
  set("solve.rays=96");
  const auto size = [](const fs::path& file) { return fs::file_size(file); };
  std::uintmax_t one = 0;
  for (const fs::path& file : cached("energy-")) one = std::max(one, size(file));
  for (const fs::path& file : cached("transport-")) one += size(file) / 3;
  set("cache=" + std::to_string(one * 5 / 4));  // solves with 64 rays again, and evicts the oldest files
  std::uintmax_t alone = 0;
  for (const fs::path& file : cached(""))
    if (fs::hard_link_count(file) == 1) alone += size(file);
  EXPECT_LE(alone, one * 5 / 4);
  EXPECT_GT(alone, 0u);
  set("cache=0");
  for (const fs::path& file : cached("")) EXPECT_EQ(fs::hard_link_count(file), 2) << file;
}

TEST_F(Cache, IsNotCreatedWithALimitOfZero) {
  ASSERT_EQ(run_program(folder_, "patchlight", {"run", "job.yaml", "--output", "other", "--set", "cache=0"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "other/cache"));
}

TEST_F(Cache, IsSkippedWhereItCannotBeCreated) {
  folder_.write("none", "");
  fs::remove_all(folder_ / "out/cache");
  fs::rename(folder_ / "none", folder_ / "out/cache");
  EXPECT_EQ(stages(set("solve.rays=80")), "solve runs, trace runs");
  EXPECT_EQ(stages(run({})), "solve runs, trace runs");
}

TEST_F(Cache, IsNotUsedWithForce) {
  set("solve.rays=80");
  EXPECT_EQ(stages(run({"--force"})), "import runs, solve runs, trace runs");
}

TEST_F(Cache, IsCleaned) {
  set("solve.rays=80");
  EXPECT_THAT(run_program(folder_, "patchlight", {"clean", "job.yaml"}).err, HasSubstr("removed "));
  EXPECT_FALSE(fs::exists(folder_ / "out/cache"));
  EXPECT_EQ(stages(set("solve.rays=80")), "");
  folder_.write("out/mine.txt", "");
  folder_.write("out/cache/mine.txt", "");
  EXPECT_EQ(run_program(folder_, "patchlight", {"clean", "job.yaml", "--all"}).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/mine.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "out/cache/mine.txt"));
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder_ / "out"), {}), 3);
  fs::remove(folder_ / "out/mine.txt");
  fs::remove(folder_ / "out/cache/mine.txt");
  EXPECT_EQ(run_program(folder_, "patchlight", {"clean", "job.yaml"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_THAT(run_program(folder_, "patchlight", {"clean", "job.yaml"}).err, HasSubstr("nothing to remove"));
}

TEST_F(Cache, CleaningLeavesFilesOfOthersAlone) {
  const std::vector<std::string> others{
      "out/frames/photo.exr",     "out/frames/photo.png",  "out/frames/alone.0001.png",
      "out/relit/notes.exr",      "out/preview/mine.png",  "out/report.html",
      "out/bench/mine/energy.h5", "out/bench/results.txt", "out/transport.1-of-2.h5"};
  for (const std::string& file : others) {
    fs::create_directories((folder_ / file).parent_path());
    folder_.write(file, "of another");
  }
  folder_.write("out/bench/bench.json", "[]");
  folder_.write("out/frames/.patchlight-half.1.0.exr", "");
  fs::copy(folder_ / "out/energy.h5", folder_ / "out/bench/mine/patches.h5");
  fs::remove(folder_ / "out/patches.h5");
  folder_.write("out/patches.h5", "of another");
  const Outcome outcome = run_program(folder_, "patchlight", {"clean", "job.yaml", "--all"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("; 11 other files stay in "));
  for (const std::string& file : others) EXPECT_EQ(read_text(folder_ / file), "of another") << file;
  EXPECT_EQ(read_text(folder_ / "out/patches.h5"), "of another");
  EXPECT_FALSE(fs::exists(folder_ / "out/frames/camera.0001.exr"));
  EXPECT_FALSE(fs::exists(folder_ / "out/frames/camera.0001.png"));
  EXPECT_FALSE(fs::exists(folder_ / "out/energy.h5"));
  EXPECT_FALSE(fs::exists(folder_ / "out/bench/mine/patches.h5"));
}

}  // namespace
}  // namespace patchlight::test
