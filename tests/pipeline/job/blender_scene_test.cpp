#include <cstdlib>
#include <thread>

#include "tests/pipeline/job/job_file.h"

namespace patchlight::test {
namespace {

/// Jobs whose scene is a Blender file, with a program in the place of Blender that writes what the exporter would.
class BlenderScene : public JobFile {
 protected:
  void SetUp() override {
    folder_.write("room.blend", "first");
    use_blender(R"(
echo run >> "$0.runs"
mkdir -p "$out"
printf 'glTF' > "$out/room.glb"
cat > "$out/room.yaml" << END
scene: room.glb
output: room.patchlight
environment: {image: sky.exr}
trace: {cameras: [Camera], samples: 5, resolution: [30, 20]}
END
echo '{"inputs": ["wood.png"], "files": ["room.glb", "room.yaml"]}' > "$record"
echo "patchlight-export: warning: the lamp is odd" >&2
)");
  }
  void TearDown() override { unsetenv("BLENDER"); }

  /// Makes a shell script take Blender's place; it has `blend`, `out` and `record`.
  void use_blender(const std::string& script) {
    const auto file = folder_.write("blender", R"(#!/bin/sh
while [ $# -gt 0 ]; do
  case "$1" in --output) out="$2";; --record) record="$2";; *.blend) blend="$1";; esac
  shift
done
)" + script);
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    setenv("BLENDER", file.c_str(), 1);
  }

  std::size_t runs() const { return read_text(folder_ / "blender.runs").size() / 4; }
};

constexpr const char* kJob = "scene: room.blend\noutput: out\ntrace: {samples: 9}\n";

TEST_F(BlenderScene, IsExportedAndTheJobOverridesItsExport) {
  const Job job = read(kJob);
  EXPECT_EQ(job.scene, folder_ / "out/blend/room.glb");
  EXPECT_EQ(job.output, folder_ / "out");
  EXPECT_EQ(job.environment.image, folder_ / "out/blend/sky.exr");
  EXPECT_EQ(job.trace.samples, 9);
  EXPECT_EQ(job.trace.resolution, (std::array{30, 20}));
  EXPECT_EQ(job.trace.cameras, std::vector<std::string>{"Camera"});
  EXPECT_EQ(job.export_warnings, std::vector<std::string>{"the lamp is odd"});
  const Job changed = read(kJob, {"trace.samples=3", "trace.resolution=[8, 6]", "environment.image=own.exr"});
  EXPECT_EQ(changed.trace.samples, 3);
  EXPECT_EQ(changed.trace.resolution, (std::array{8, 6}));
  EXPECT_EQ(changed.environment.image, folder_ / "own.exr");
}

TEST_F(BlenderScene, StandsForAJob) {
  const Job job = read_job(folder_ / "room.blend");
  EXPECT_EQ(job.output, folder_ / "room.patchlight");
  EXPECT_EQ(job.trace.samples, 5);
  EXPECT_EQ(job.scene, folder_ / "room.patchlight/blend/room.glb");
}

TEST_F(BlenderScene, IsExportedAgainOnlyAfterAChange) {
  read(kJob);
  EXPECT_EQ(read(kJob).export_warnings, std::vector<std::string>{"the lamp is odd"});
  EXPECT_EQ(runs(), 1u);
  folder_.write("room.blend", "second");
  read(kJob);
  EXPECT_EQ(runs(), 2u);
  folder_.write("wood.png", "an image that was missing");
  read(kJob);
  EXPECT_EQ(runs(), 3u);
  folder_.write("wood.png", "another");
  read(kJob);
  EXPECT_EQ(runs(), 4u);
  std::filesystem::remove(folder_ / "out/blend/room.glb");
  read(kJob);
  EXPECT_EQ(runs(), 5u);
}

TEST_F(BlenderScene, LeavesNothingOfKilledExportsAndNoFilesOfOldOnes) {
  read(kJob);
  const std::filesystem::path made = folder_ / "out/blend";
  std::filesystem::create_directories(made / ".room.k4x0_q1z");
  folder_.write("out/blend/.room.k4x0_q1z/room.glb", "half");
  folder_.write("out/blend/.patchlight-1.json", "{");
  folder_.write("out/blend/notes.txt", "a user's");
  folder_.write("out/blend/room_sky.exr", "of an export with a sky");
  folder_.write("room.blend", "second");
  read(kJob);
  EXPECT_FALSE(std::filesystem::exists(made / ".room.k4x0_q1z"));
  EXPECT_FALSE(std::filesystem::exists(made / ".patchlight-1.json"));
  EXPECT_TRUE(std::filesystem::exists(made / "notes.txt"));
  EXPECT_TRUE(std::filesystem::exists(made / "room.glb"));
}

TEST_F(BlenderScene, IsExportedOnceByRunsAtTheSameTime) {
  const std::filesystem::path job = folder_.write("both.yaml", kJob);
  std::thread other([&] { read_job(job); });
  read_job(job);
  other.join();
  EXPECT_EQ(runs(), 1u);
}

TEST_F(BlenderScene, ServesVariantsFromTheFolderAboveThem) {
  read(kJob);
  const Job variant = read_job(folder_ / "job.yaml", {"trace.samples=2"}, folder_ / "out/variant");
  EXPECT_EQ(runs(), 1u);
  EXPECT_EQ(variant.scene, folder_ / "out/blend/room.glb");
  EXPECT_EQ(variant.output, folder_ / "out/variant");
}

TEST_F(BlenderScene, NamesWhatWentWrongInBlender) {
  EXPECT_ERROR(read("scene: none.blend\noutput: out\n"), ExitCode::missing_input, "missing scene");
  use_blender("echo 'patchlight-export: error: Blender 2.8 is too old: install Blender 3.4 or newer' >&2; exit 69");
  EXPECT_ERROR(read(kJob), ExitCode::unavailable, "Blender 2.8 is too old: install Blender 3.4 or newer");
  use_blender("echo 'Error: File format is not supported in file' >&2; exit 1");
  EXPECT_ERROR(read(kJob), ExitCode::bad_data, "Blender cannot read the file");
  use_blender("echo 'Writing: /tmp/room.crash.txt' >&2; kill -SEGV $$");
  EXPECT_ERROR(read(kJob), ExitCode::unavailable, "Blender crashed; last it said: Writing: /tmp/room.crash.txt");
  use_blender("exit 0");
  EXPECT_ERROR(read(kJob), ExitCode::unavailable, "Blender wrote no export");
  setenv("BLENDER", "/none/blender", 1);
  EXPECT_ERROR(read(kJob), ExitCode::unavailable, "set it to Blender's program");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/blend/export.json"));
}

}  // namespace
}  // namespace patchlight::test
