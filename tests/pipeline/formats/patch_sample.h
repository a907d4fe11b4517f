#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/formats/patches/patch_file.h"
#include "tests/expect_error.h"
#include "tests/patch_scene.h"
#include "tests/temporary_folder.h"

namespace patchlight::test {

/// Two quads, one of them folded to a triangle, and a sphere.
inline PatchSet sample() {
  PatchScene builder;
  builder.quad({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, 3, 2, {0.5f, 2.0f});
  builder.quad({{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 1, 1}}}, 2, 2, {});
  builder.sphere({1, 2, 3}, -0.5, 4, 6, {});
  PatchSet scene = builder.get();
  scene.sources = {{"", "abc"}, {"b.bin", "def"}};
  scene.inputs_key = "inputs";
  scene.cameras[0].vertical = 0.5;
  return scene;
}

/// The dataset that is to be named, and what spoils it.
using Fault = std::pair<std::string, std::function<void(PatchSet&)>>;

/// Expects files of `good` to be refused with each of the faults.
inline void expect_refused(const PatchSet& good, const std::vector<Fault>& faults) {
  for (const auto& [where, spoil] : faults) {
    const TemporaryFolder folder;
    PatchSet scene = good;
    spoil(scene);
    write_patches(folder / "patches.h5", scene);
    SCOPED_TRACE(where);
    EXPECT_ERROR(read_patches(folder / "patches.h5"), ExitCode::bad_data, where);
  }
}

}  // namespace patchlight::test
