#include "importers/gltf/file/gltf_file.h"

#include <gtest/gtest.h>

#include "importers/gltf/file/uri.h"
#include "tests/expect_error.h"
#include "tests/importers/gltf_builder.h"

namespace patchlight::test {
namespace {

Bytes bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

void set_word(std::string& glb, std::size_t offset, std::uint32_t value) {
  std::memcpy(glb.data() + offset, &value, 4);
}

TEST(GltfUri, DecodesBase64WithAndWithoutPadding) {
  EXPECT_EQ(decode_data_uri("data:application/octet-stream;base64,aGVsbG8=", ""), bytes("hello"));
  EXPECT_EQ(decode_data_uri("data:;base64,aGVsbG8", ""), bytes("hello"));
  EXPECT_EQ(decode_data_uri("data:,a%20b", ""), bytes("a b"));
}

TEST(GltfUri, RefusesBrokenBase64) {
  EXPECT_ERROR(decode_data_uri("data:;base64,aG*s", "here"), ExitCode::bad_data, "here");
  EXPECT_ERROR(decode_data_uri("data:;base64,a", ""), ExitCode::bad_data, "middle of a byte");
  EXPECT_ERROR(decode_data_uri("data:;base64", ""), ExitCode::bad_data, "no data");
}

TEST(GltfUri, PathsOutsideTheScenesFolderAreRefused) {
  EXPECT_EQ(confined_path("a/../b%20c.bin", ""), "b c.bin");
  for (const char* uri : {"../a.bin", "a/../../b.bin", "%2e%2e/a.bin", "/etc/passwd", "file:///etc/passwd",
                          "http://a/b", "", ".", "folder/", "a%00b"}) {
    EXPECT_ERROR(confined_path(uri, "here"), ExitCode::bad_data, "here");
  }
}

TEST(GltfFile, MissingSceneIsMissingInput) {
  EXPECT_ERROR(read_gltf_file("/nowhere/scene.glb"), ExitCode::missing_input, "/nowhere/scene.glb");
}

TEST(GltfFile, FolderIsRefused) {
  const TemporaryFolder folder;
  EXPECT_ERROR(read_gltf_file(folder.path()), ExitCode::bad_data, "is not a regular file");
}

TEST(GltfFile, WrongChunkLengthsAreRefused) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  const std::string good = gltf.glb();
  EXPECT_NO_THROW(importer.import_bytes(good));
  const std::size_t offsets[] = {
      8, 12,
      20 + std::size_t(static_cast<unsigned char>(good[12])) + 256 * std::size_t(static_cast<unsigned char>(good[13]))};
  for (const std::size_t offset : offsets) {
    for (const std::uint32_t length : {0xffffffffu, 0x7fffffffu, static_cast<std::uint32_t>(good.size() + 4)}) {
      std::string bad = good;
      set_word(bad, offset, length);
      EXPECT_ERROR(importer.import_bytes(bad), ExitCode::bad_data, "GLB");
    }
  }
}

TEST(GltfFile, EveryTruncationIsRefused) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  const std::string good = gltf.glb();
  for (std::size_t length = 0; length < good.size(); length += 7) {
    EXPECT_ERROR(importer.import_bytes(good.substr(0, length)), ExitCode::bad_data, "scene.glb");
  }
}

TEST(GltfFile, FormatIsDetectedByContentNotByName) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  EXPECT_EQ(importer.import_file(importer.folder.write("scene.gltf", gltf.glb())).primitives.size(), 6u);
}

TEST(GltfFile, ExternalBufferIsReadAndRecorded) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  gltf.json["buffers"] = {{{"byteLength", gltf.binary.size()}, {"uri", "the%20data.bin"}}};
  importer.folder.write("the data.bin", gltf.binary);
  const PatchSet scene = importer.import_file(importer.folder.write("scene.gltf", gltf.json.dump()));
  EXPECT_EQ(scene.primitives.size(), 6u);
  ASSERT_EQ(scene.sources.size(), 2u);
  EXPECT_EQ(scene.sources[0].path, "scene.gltf");
  EXPECT_EQ(scene.sources[1].path, "the data.bin");
  EXPECT_NE(scene.sources[0].hash, scene.sources[1].hash);
}

TEST(GltfFile, MissingBufferIsMissingInputAndNamed) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  gltf.json["buffers"] = {{{"byteLength", gltf.binary.size()}, {"uri", "absent.bin"}}};
  EXPECT_ERROR(importer.import(gltf), ExitCode::missing_input, "absent.bin");
}

TEST(GltfFile, BufferUrisOutsideTheFolderOrOfFoldersAreRefused) {
  Importer importer;
  std::filesystem::create_directory(importer.folder / "folder");
  for (const char* uri : {"../secret.bin", "/dev/zero", "file:///dev/zero", "folder", "folder/"}) {
    GltfBuilder gltf = single_mesh(cube());
    gltf.json["buffers"] = {{{"byteLength", gltf.binary.size()}, {"uri", uri}}};
    EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "buffers[0]");
  }
}

TEST(GltfFile, ShortBufferIsRefused) {
  Importer importer;
  GltfBuilder gltf = single_mesh(cube());
  gltf.json["buffers"] = {{{"byteLength", gltf.binary.size()}, {"uri", "short.bin"}}};
  importer.folder.write("short.bin", gltf.binary.substr(1));
  EXPECT_ERROR(importer.import(gltf), ExitCode::bad_data, "buffers[0]");
}

}  // namespace
}  // namespace patchlight::test
