#include <array>

#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

/// A floor of 4 m, a plate of 2 m at height 1 m whose left half is transparent by its alpha mask, and a lamp at height
/// 2 m.
constexpr const char* kScene = R"gltf({
  "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
  "nodes": [{"mesh": 0, "name": "floor"}, {"mesh": 1, "name": "lamp"}, {"mesh": 2, "name": "plate"}],
  "extensionsUsed": ["KHR_materials_emissive_strength"],
  "materials": [
    {"name": "paper", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}},
    {"name": "lamp", "emissiveFactor": [1, 1, 1],
     "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 100}}},
    {"name": "lattice", "alphaMode": "MASK", "doubleSided": true,
     "pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.2, 0.2, 1], "baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
  "meshes": [
    {"primitives": [{"attributes": {"POSITION": 0}, "indices": 4, "material": 0}]},
    {"primitives": [{"attributes": {"POSITION": 1}, "indices": 4, "material": 1}]},
    {"primitives": [{"attributes": {"POSITION": 2, "TEXCOORD_0": 3}, "indices": 4, "material": 2}]}],
  "textures": [{"source": 0, "sampler": 0}], "samplers": [{"magFilter": 9728, "wrapS": 33071, "wrapT": 33071}],
  "images": [{"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEElEQVR4nGP4//8/AxD/BwAe6gb6OStlagAAAABJRU5ErkJggg=="}],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-2, 0, -2], "max": [2, 0, 2]},
    {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-0.1, 2, -0.1], "max": [0.1, 2, 0.1]},
    {"bufferView": 0, "byteOffset": 96, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, 1, -1], "max": [1, 1, 1]},
    {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
    {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
  "bufferViews": [{"buffer": 0, "byteLength": 144}, {"buffer": 0, "byteOffset": 144, "byteLength": 32},
                  {"buffer": 0, "byteOffset": 176, "byteLength": 12}],
  "buffers": [{"byteLength": 188, "uri": "data:application/octet-stream;base64,AAAAwAAAAAAAAABAAAAAQAAAAAAAAABAAAAAQAAAAAAAAADAAAAAwAAAAAAAAADAzczMvQAAAEDNzMy9zczMPQAAAEDNzMy9zczMPQAAAEDNzMw9zczMvQAAAEDNzMw9AACAvwAAgD8AAIA/AACAPwAAgD8AAIA/AACAPwAAgD8AAIC/AACAvwAAgD8AAIC/AAAAAAAAAAAAAIA/AAAAAAAAgD8AAIA/AAAAAAAAgD8AAAEAAgAAAAIAAwA="}]
})gltf";

class AlphaMasks : public ProgramTest {
 protected:
  void SetUp() override {
    folder_.write("scene.gltf", kScene);
    folder_.write("job.yaml",
                  "scene: scene.gltf\noutput: out\nimport: {patch_area: 0.05}\nsolve: {rays: 64}\n"
                  "cameras: {low: {look_from: [0, 0.6, 4], look_at: [0, 0, 0]}}\n"
                  "trace: {cameras: [low], resolution: [64, 32]}\n");
  }

  /// Mean radiance of the floor below the left and the right half of the plate.
  std::array<double, 2> floor_radiance(const std::vector<std::string>& sets) {
    std::vector<std::string> words{"run", "job.yaml"};
    for (const std::string& set : sets) words.push_back("--set=" + set);
    const Outcome outcome = run_program(folder_, "patchlight", words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const Image image = read_exr(folder_ / "out/frames/low.0001.exr");
    std::array<double, 2> sums{};
    for (int y = 17; y < 21; ++y)
      for (int x = 20; x < 28; ++x) {
        sums[0] += image.pixels[std::size_t(64 * y + x)].y / 32;
        sums[1] += image.pixels[std::size_t(64 * y + 63 - x)].y / 32;
      }
    return sums;
  }
};

TEST_F(AlphaMasks, LetLightThroughWhereTheyAreTransparent) {
  for (const char* method : {"matrix", "progressive"}) {
    const std::string by = std::string("solve.method=") + method;
    const auto [left, right] = floor_radiance({by});
    const auto [open, mirrored] = floor_radiance({by, "nodes.plate.exclude=true"});
    EXPECT_NEAR(open, mirrored, 0.02 * open) << method;
    EXPECT_NEAR(left, open, 0.1 * open) << method << ": the transparent half casts no shadow";
    EXPECT_LT(right, 0.1 * open) << method << ": the opaque half casts a shadow";
    EXPECT_GT(right, 0.0) << method << ": floor and plate light each other";
  }
}

}  // namespace
}  // namespace patchlight::test
