#include "pipeline/formats/solution/transport_file.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "pipeline/formats/file_kind.h"
#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::TemporaryFolder;

Transport sample() {
  Transport transport;
  transport.starts = {0, 2, 4, 4, 6};  // two patches
  transport.columns = {1, 0, 1, 1, 0, 1};
  transport.hit_weights = {0.25f, 0.5f, 0.25f, 0.5f};
  transport.visible_fractions = {0.5f, 0.5f, 1.0f, 1.0f};
  transport.rays = 4;
  transport.mirrored = {{0, 1, 1, Color(0.5f, 0.25f, 0.0f)}, {1, 0, 0, Color(0.1f)}};
  transport.emitters = {{0, 1, {0.1f, 0.2f, 0.3f, -0.01f}}, {1, 1, {0.0f, 0.0f, 0.5f, 0.5f}}};
  for (auto& emitter : transport.emitters) emitter.mirrored.assign(4, Color(0.25f, 0.5f, 0.75f));
  transport.key = "key";
  return transport;
}

/// As rows by hemicubes are.
void weigh(Transport& transport) {
  transport.rays = 0;
  transport.hit_weights.clear();
  transport.weights = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f};
}

TEST(TransportFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  Transport written = sample();
  for (const bool weighted : {false, true}) {
    if (weighted) weigh(written);
    write_transport(folder / "transport.h5", written);
    const Transport read = read_transport(folder / "transport.h5");
    EXPECT_EQ(read.starts, written.starts);
    EXPECT_EQ(read.columns, written.columns);
    EXPECT_EQ(read.weights, written.weights);
    EXPECT_EQ(read.hit_weights, written.hit_weights);
    EXPECT_EQ(read.visible_fractions, written.visible_fractions);
    EXPECT_EQ(read.rays, written.rays);
    ASSERT_EQ(read.mirrored.size(), 2u);
    EXPECT_EQ(read.mirrored[0].sample_set, 1);
    EXPECT_EQ(read.mirrored[0].weight, written.mirrored[0].weight);
    ASSERT_EQ(read.emitters.size(), 2u);
    EXPECT_EQ(read.emitters[1].first_patch, 1);
    EXPECT_EQ(read.emitters[1].factors, written.emitters[1].factors);
    EXPECT_EQ(read.emitters[1].mirrored, written.emitters[1].mirrored);
    EXPECT_FALSE(read.changed);
    EXPECT_EQ(read_transport_key(folder / "transport.h5"), "key");
  }
  EXPECT_EQ(kind_of(folder / "transport.h5"), FileKind::transport);
}

/// The second patch cut once, something standing on its last quarter.
DisplayMesh cut_patch() {
  DisplayMesh mesh;
  mesh.roots = {-1, 0};
  mesh.cells.resize(5);
  mesh.cells[0].children = 1;
  for (int k = 0; k < 3; ++k) mesh.cells[1 + k].face = k;
  mesh.cells[4].cut = 0;
  mesh.cuts = {{{0.5, 0}, {0.5, 1}, {~3, 1}}, {{0, 0.5}, {1, 0.5}, {~4, ~5}}};
  for (std::int32_t f = 0; f < 6; ++f) mesh.faces.push_back({1, 4 * f, 4, 0.25f});
  mesh.corners.resize(24, 1);
  mesh.corners[2] = 4;
  mesh.vertices = {{1, 0.5f, 0.5f}, {1, 0.6f, 0.5f}, {1, 0.7f, 0.5f}, {1, 0.5f, 0.0f}, {1, 0.5f, 0.25f}};
  mesh.gathered = 2;
  mesh.midpoints = {{0, 3}};
  mesh.facets = {{0, {1, -1, 0, 5}, 3}};
  mesh.blends = {{0, 2}};
  mesh.blended = {{0, 0.25f}, {1, 0.75f}};
  mesh.vertices[1].facet = 2;
  return mesh;
}

Transport sample_with_display() {
  Transport transport = sample();
  transport.display = {cut_patch(), {}, {}};
  transport.display->rows.starts = {0, 1, 2, 4, 6};
  transport.display->rows.columns = {6, 7, 0, 1, 2, 3};  // 2 patches, 6 faces
  transport.display->rows.hit_weights = {1.0f, 1.0f, 0.5f, 0.5f};
  transport.display->rows.rays = 4;
  transport.display->rows.mirrored = {{1, 0, 7, Color(0.5f)}};
  for (auto& emitter : transport.emitters) emitter.display.assign(12, 0.125f);
  return transport;
}

TEST(TransportFile, ReadsBackSamplesOfManyLights) {
  const TemporaryFolder folder;
  Transport written = sample_with_display();
  written.lights = {{0, 1, 1, 2, 3}, {1, 0, 1}, {0.5f, 0.25f, 0.125f}};
  written.display->lights = {{0, 0, 1, 1, 2}, {1, 0}, {0.5f, 0.25f}};
  written.lights_id = 77;
  write_transport(folder / "transport.h5", written);
  const Transport read = read_transport(folder / "transport.h5");
  EXPECT_EQ(read.lights_id, 77);
  EXPECT_EQ(read.lights.starts, written.lights.starts);
  EXPECT_EQ(read.lights.patches, written.lights.patches);
  EXPECT_EQ(read.lights.weights, written.lights.weights);
  EXPECT_EQ(read.display->lights.patches, written.display->lights.patches);
  written.lights.patches[0] = 2;
  write_transport(folder / "bad.h5", written);
  EXPECT_THROW(read_transport(folder / "bad.h5"), Error) << "a patch out of bounds";
}

TEST(TransportFile, ReadsBackWhatTheDisplaySolutionNeeds) {
  const TemporaryFolder folder;
  const Transport written = sample_with_display();
  write_transport(folder / "transport.h5", written);
  const Transport read = read_transport(folder / "transport.h5");
  ASSERT_TRUE(read.display);
  EXPECT_EQ(read.display->rows.columns, written.display->rows.columns);
  EXPECT_EQ(read.display->rows.mirrored[0].patch, 7);
  EXPECT_EQ(read.emitters[1].display, written.emitters[1].display);
  const DisplayMesh &mesh = read.display->mesh, &cut = written.display->mesh;
  ASSERT_EQ(mesh.facets.size(), 1u);
  EXPECT_EQ(mesh.facets[0].corners, cut.facets[0].corners);
  EXPECT_EQ(mesh.facets[0].facet, 3);
  EXPECT_EQ(mesh.vertices[1].facet, 2);
  ASSERT_EQ(mesh.blends.size(), 1u);
  ASSERT_EQ(mesh.parts_of(mesh.blends[0]).size(), 2u);
  EXPECT_EQ(mesh.parts_of(mesh.blends[0])[1].vertex, 1);
  EXPECT_EQ(mesh.parts_of(mesh.blends[0])[1].weight, 0.75f);
  EXPECT_EQ(mesh.roots, cut.roots);
  EXPECT_EQ(mesh.elements(), 6);
  EXPECT_EQ(mesh.gathered, 2);
  EXPECT_EQ(mesh.midpoints, cut.midpoints);
  EXPECT_EQ(mesh.vertices[4].v, 0.25f);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(mesh.cells[k].children, cut.cells[k].children);
    EXPECT_EQ(mesh.cells[k].cut, cut.cells[k].cut);
    EXPECT_EQ(mesh.cells[k].face, cut.cells[k].face);
  }
  EXPECT_EQ(mesh.corners, cut.corners);
  EXPECT_EQ(mesh.cuts[1].sides, cut.cuts[1].sides);
  EXPECT_EQ(mesh.cuts[1].to.x, 1);
  EXPECT_EQ(mesh.faces[5].first, cut.faces[5].first);
  EXPECT_EQ(mesh.faces[5].part, 0.25f);
}

TEST(TransportFile, RefusesMeshesThatAreNone) {
  const std::vector<std::function<void(Transport::Display&)>> faults{
      [](Transport::Display& d) { d.mesh.roots[0] = 0; },
      [](Transport::Display& d) { d.mesh.roots[1] = 5; },
      [](Transport::Display& d) { d.mesh.roots[1] = -2; },
      [](Transport::Display& d) { d.mesh.roots[1] = -1; },
      [](Transport::Display& d) { d.mesh.roots.push_back(-1); },
      [](Transport::Display& d) { d.mesh.cells[0].children = 0; },
      [](Transport::Display& d) { d.mesh.cells[0].children = 2; },
      [](Transport::Display& d) { d.mesh.cells[0].children = 1 << 30; },
      [](Transport::Display& d) { d.mesh.cells[1].children = 2; },
      [](Transport::Display& d) { d.mesh.cells[1].face = 1; },
      [](Transport::Display& d) { d.mesh.cells[1].face = 6; },
      [](Transport::Display& d) { d.mesh.cells[1].cut = 0; },
      [](Transport::Display& d) { d.mesh.cells[4].cut = 2; },
      [](Transport::Display& d) { d.mesh.cuts[1].sides[0] = 0; },
      [](Transport::Display& d) { d.mesh.cuts[1].sides[0] = ~6; },
      [](Transport::Display& d) { d.mesh.cuts[1].to.x = std::numeric_limits<double>::infinity(); },
      [](Transport::Display& d) { d.mesh.cuts[1].to = d.mesh.cuts[1].from; },
      [](Transport::Display& d) { d.mesh.faces[5].count = 2; },
      [](Transport::Display& d) { d.mesh.faces[5].count = 9; },
      [](Transport::Display& d) { d.mesh.faces[5].patch = 2; },
      [](Transport::Display& d) { d.mesh.faces[5].part = 0; },
      [](Transport::Display& d) { d.mesh.corners[2] = 5; },
      [](Transport::Display& d) { d.mesh.corners[2] = -1; },
      [](Transport::Display& d) { d.mesh.vertices[0].patch = 2; },
      [](Transport::Display& d) { d.mesh.vertices[0].u = std::numeric_limits<float>::quiet_NaN(); },
      [](Transport::Display& d) { d.mesh.vertices[0].v = 1.5f; },
      [](Transport::Display& d) { d.mesh.midpoints[0][1] = 4; },
      [](Transport::Display& d) { d.mesh.facets[0].patch = 1; },
      [](Transport::Display& d) { d.mesh.facets[0].patch = 2; },
      [](Transport::Display& d) { d.mesh.facets[0].facet = -1; },
      [](Transport::Display& d) { d.mesh.facets[0].corners[1] = 6; },
      [](Transport::Display& d) { d.mesh.vertices[0].facet = -1; },
      [](Transport::Display& d) { d.mesh.blends[0].count = 0; },
      [](Transport::Display& d) { d.mesh.blends[0].count = 1; },
      [](Transport::Display& d) { d.mesh.blends[0].count = 3; },
      [](Transport::Display& d) { d.mesh.blended[0].vertex = 2; },
      [](Transport::Display& d) { d.mesh.blended[0].vertex = -1; },
      [](Transport::Display& d) { d.mesh.blended[0].weight = std::numeric_limits<float>::quiet_NaN(); },
      [](Transport::Display& d) { d.mesh.facets[0].corners[1] = -2; },
      [](Transport::Display& d) { d.mesh.facets[0].corners[1] = 2; },
      [](Transport::Display& d) { d.mesh.gathered = 5; },
      [](Transport::Display& d) { d.mesh.gathered = 1; },
      [](Transport::Display& d) { d.rows.columns[0] = 9; },
      [](Transport::Display& d) { d.rows.mirrored[0].patch = 9; },
      [](Transport::Display& d) { d.rows.mirrored[0].row = 2; },
  };
  const TemporaryFolder folder;
  for (std::size_t k = 0; k < faults.size(); ++k) {
    SCOPED_TRACE(k);
    Transport broken = sample_with_display();
    faults[k](*broken.display);
    write_transport(folder / "transport.h5", broken);
    EXPECT_ERROR(read_transport(folder / "transport.h5"), ExitCode::bad_data, "transport.h5");
  }
}

TEST(TransportFile, HoldsScenesWithoutMirrorsOrEmitters) {
  const TemporaryFolder folder;
  Transport bare = sample();
  bare.mirrored.clear();
  bare.emitters.clear();
  write_transport(folder / "transport.h5", bare);
  const Transport read = read_transport(folder / "transport.h5");
  EXPECT_TRUE(read.mirrored.empty() && read.emitters.empty() && read.weights.empty());
  EXPECT_EQ(read.rows(), 2);
}

TEST(TransportFile, HoldsLightsAndWhatRowsSeeOfTheSky) {
  const TemporaryFolder folder;
  Transport written = sample_with_display();
  for (const std::int64_t light : {5, 7}) {
    Transport::Emitter& emitter = written.emitters.emplace_back(written.emitters[0]);
    emitter.first_patch = 2;
    emitter.patches = 0;
    emitter.light = light;
    emitter.factors[0] = float(light);
  }
  written.sky = 3;
  written.columns[0] = 4;                 // 2 patches, 3 cells
  written.display->rows.columns[0] = 10;  // behind 6 faces
  for (TransportRows* rows : {static_cast<TransportRows*>(&written), &written.display->rows}) {
    rows->sky_starts = {0, 1, 1, 3, 3};
    rows->sky_columns = {4, 3, 4};
    rows->sky_weights = {0.25f, 0.0f, 0.5f, 0.0f};
  }
  write_transport(folder / "transport.h5", written);
  const Transport read = read_transport(folder / "transport.h5");
  EXPECT_EQ(read.sky_starts, written.sky_starts);
  EXPECT_EQ(read.sky_columns, written.sky_columns);
  EXPECT_EQ(read.sky_weights, written.sky_weights);
  EXPECT_EQ(read.display->rows.sky_starts, written.sky_starts);
  EXPECT_EQ(read.display->rows.sky_columns, written.sky_columns);
  EXPECT_EQ(read.display->rows.sky_weights, written.sky_weights);
  ASSERT_EQ(read.emitters.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(read.emitters[k].first_patch, written.emitters[k].first_patch);
    EXPECT_EQ(read.emitters[k].patches, written.emitters[k].patches);
    EXPECT_EQ(read.emitters[k].light, written.emitters[k].light);
    EXPECT_EQ(read.emitters[k].factors, written.emitters[k].factors);
    EXPECT_EQ(read.emitters[k].display, written.emitters[k].display);
    EXPECT_EQ(read.emitters[k].mirrored, written.emitters[k].mirrored);
  }
  EXPECT_EQ(read.sky, 3);
  EXPECT_EQ(read.columns, written.columns);
  for (const bool display : {false, true}) {
    Transport broken = written;
    ++(display ? broken.display->rows.columns[0] : broken.columns[0]);
    write_transport(folder / "transport.h5", broken);
    EXPECT_ERROR(read_transport(folder / "transport.h5"), ExitCode::bad_data, "rows/patch");
  }
  const std::vector<std::function<void(Transport&)>> faults{
      [](Transport& t) { t.sky_columns[1] = 5; },      [](Transport& t) { t.sky_columns[1] = -1; },
      [](Transport& t) { t.sky_starts[2] = 0; },       [](Transport& t) { t.sky_starts.push_back(3); },
      [](Transport& t) { t.sky_weights[0] = 1.5f; },   [](Transport& t) { t.sky_weights.pop_back(); },
      [](Transport& t) { t.sky_weights[0] = -0.25f; }, [](Transport& t) { t.sky_columns.pop_back(); },
  };
  for (std::size_t k = 0; k < faults.size(); ++k) {
    SCOPED_TRACE(k);
    Transport broken = written;
    faults[k](broken);
    write_transport(folder / "transport.h5", broken);
    EXPECT_ERROR(read_transport(folder / "transport.h5"), ExitCode::bad_data, "sky/");
  }
}

TEST(TransportFile, RefusesWhatIsOutOfBounds) {
  const std::vector<std::function<void(Transport&)>> faults{
      [](Transport& t) { t.starts[0] = 1; },
      [](Transport& t) { t.starts[1] = 5; },
      [](Transport& t) { t.starts.back() = 5; },
      [](Transport& t) { t.starts.push_back(6); },
      [](Transport& t) { t.columns[0] = 2; },
      [](Transport& t) { t.columns[0] = -1; },
      [](Transport& t) { weigh(t), t.weights[1] = std::numeric_limits<float>::quiet_NaN(); },
      [](Transport& t) { weigh(t), t.weights.pop_back(); },
      [](Transport& t) { t.hit_weights[1] = std::numeric_limits<float>::quiet_NaN(); },
      [](Transport& t) { t.hit_weights[1] = 1.5f; },
      [](Transport& t) { t.hit_weights.pop_back(); },
      [](Transport& t) { t.rays = -1; },
      [](Transport& t) { t.visible_fractions[0] = 0.0f; },
      [](Transport& t) { t.visible_fractions.pop_back(); },
      [](Transport& t) { t.mirrored[0].row = 2; },
      [](Transport& t) { t.mirrored[0].sample_set = 2; },
      [](Transport& t) { t.mirrored[0].patch = 2; },
      [](Transport& t) { t.mirrored[0].weight.x = std::numeric_limits<float>::infinity(); },
      [](Transport& t) { std::swap(t.mirrored[0], t.mirrored[1]); },
      [](Transport& t) { t.emitters[1].patches = 2; },
      [](Transport& t) { t.emitters[0].first_patch = -1; },
      [](Transport& t) { t.emitters[0].factors[0] = std::numeric_limits<float>::infinity(); },
      [](Transport& t) { t.emitters[0].factors.resize(2); },
      [](Transport& t) { t.emitters[0].mirrored.resize(2); },
      [](Transport& t) { t.emitters[1].mirrored[3].z = std::numeric_limits<float>::quiet_NaN(); },
      [](Transport& t) { t.emitters[1].mirrored[0].x = -0.1f; },
      [](Transport& t) { t.emitters[1].mirrored.clear(); },
  };
  const TemporaryFolder folder;
  for (std::size_t k = 0; k < faults.size(); ++k) {
    Transport broken = sample();
    faults[k](broken);
    write_transport(folder / "transport.h5", broken);
    EXPECT_ERROR(read_transport(folder / "transport.h5"), ExitCode::bad_data, "transport.h5");
  }
}

}  // namespace
}  // namespace patchlight
