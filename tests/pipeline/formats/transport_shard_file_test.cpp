#include "pipeline/formats/solution/transport_shard_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::TemporaryFolder;

/// Of four patches the middle two, which see any.
TransportShard sample() {
  TransportShard shard;
  shard.rows.starts = {0, 2, 4, 4, 6};
  shard.rows.columns = {1, 3, 1, 1, 0, 2};
  shard.rows.hit_weights = {0.25f, 0.5f, 0.25f, 0.5f};
  shard.rows.visible_fractions = {0.5f, 0.5f, 1.0f, 1.0f};
  shard.rows.rays = 4;
  shard.rows.mirrored = {{0, 1, 3, Color(0.5f, 0.25f, 0.0f)}};
  shard.display_rows.emplace();
  shard.display_rows->starts = {0, 1, 2};
  shard.display_rows->columns = {4, 3};
  shard.display_rows->hit_weights = {1.0f, 1.0f};
  shard.display_rows->rays = 2;
  shard.cast = 12;
  shard.key = "key";
  return shard;
}

DisplayMesh mesh() {
  DisplayMesh mesh;
  mesh.roots = {0, -1, -1, -1};
  mesh.cells.resize(1);
  mesh.cells[0].face = 0;
  mesh.faces = {{0, 0, 4, 1.0f}};
  mesh.corners = {0, 0, 0, 0};
  mesh.vertices = {{0, 0.5f, 0.5f}};
  mesh.gathered = 1;
  return mesh;
}

TEST(TransportShardFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const TransportShard written = sample();
  const DisplayMesh of_first = mesh();
  write_transport_shard(folder / "shard.h5", written);
  const TransportShard read = read_transport_shard(folder / "shard.h5", 4, 0, &of_first);
  EXPECT_EQ(read.rows.starts, written.rows.starts);
  EXPECT_EQ(read.rows.columns, written.rows.columns);
  EXPECT_EQ(read.rows.hit_weights, written.rows.hit_weights);
  EXPECT_EQ(read.rows.visible_fractions, written.rows.visible_fractions);
  EXPECT_EQ(read.rows.rays, 4);
  EXPECT_EQ(read.rows.mirrored.at(0).weight, written.rows.mirrored[0].weight);
  EXPECT_EQ(read.display_rows->columns, written.display_rows->columns);
  EXPECT_EQ(read.display_rows->rays, 2);
  EXPECT_FALSE(read.mesh);
  EXPECT_EQ(read.cast, 12);
  EXPECT_EQ(read.key, "key");
  EXPECT_TRUE(is_fresh_shard(folder / "shard.h5", "key"));
  EXPECT_FALSE(is_fresh_shard(folder / "shard.h5", "other"));
  EXPECT_FALSE(is_fresh_shard(folder / "none.h5", "key"));

  std::fstream file(folder / "shard.h5", std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t hit_weights =
      bytes.find(std::string(reinterpret_cast<const char*>(written.rows.hit_weights.data()), 8));
  ASSERT_NE(hit_weights, std::string::npos);
  file.seekp(std::streamoff(hit_weights));
  file.put(char(bytes[hit_weights] ^ 1));
  file.close();
  EXPECT_FALSE(is_fresh_shard(folder / "shard.h5", "key")) << "with another byte in what only a merge reads";
}

TEST(TransportShardFile, HoldsTheDisplayMeshOfTheFirst) {
  const TemporaryFolder folder;
  TransportShard first = sample();
  first.mesh = mesh();
  write_transport_shard(folder / "shard.h5", first);
  EXPECT_EQ(read_transport_shard(folder / "shard.h5", 4, 0, nullptr).mesh->gathered, 1);
  write_transport_shard(folder / "shard.h5", sample());
  EXPECT_ERROR(read_transport_shard(folder / "shard.h5", 4, 0, nullptr), ExitCode::bad_data,
               "that the file does not contain");
}

TEST(TransportShardFile, MayHoldNoRow) {
  const TemporaryFolder folder;
  TransportShard none;
  none.rows.starts = {0};
  none.rows.rays = 4;
  write_transport_shard(folder / "shard.h5", none);
  EXPECT_EQ(read_transport_shard(folder / "shard.h5", 4, 0, nullptr).rows.rows(), 0);
}

TEST(TransportShardFile, RefusesWhatIsOutOfBounds) {
  const std::vector<std::function<void(TransportShard&)>> faults{
      [](TransportShard& s) { s.rows.starts[0] = 1; },
      [](TransportShard& s) { s.rows.columns[0] = 4; },
      [](TransportShard& s) { s.rows.columns[0] = -1; },
      [](TransportShard& s) { s.rows.hit_weights[0] = std::numeric_limits<float>::quiet_NaN(); },
      [](TransportShard& s) { s.rows.visible_fractions[0] = 0; },
      [](TransportShard& s) { s.rows.visible_fractions.pop_back(); },
      [](TransportShard& s) { s.rows.mirrored[0].row = 2; },
      [](TransportShard& s) { s.rows.mirrored[0].patch = 4; },
      [](TransportShard& s) { s.display_rows->columns[0] = 5; },
      [](TransportShard& s) { s.display_rows->hit_weights.pop_back(); },
  };
  const TemporaryFolder folder;
  const DisplayMesh of_first = mesh();
  for (std::size_t k = 0; k < faults.size(); ++k) {
    SCOPED_TRACE(k);
    TransportShard broken = sample();
    faults[k](broken);
    write_transport_shard(folder / "shard.h5", broken);
    EXPECT_ERROR(read_transport_shard(folder / "shard.h5", 4, 0, &of_first), ExitCode::bad_data, "shard.h5");
  }
}

}  // namespace
}  // namespace patchlight
