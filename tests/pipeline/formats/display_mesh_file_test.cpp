#include "pipeline/formats/solution/display_mesh_file.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "pipeline/formats/solution/transport_file.h"
#include "tests/expect_error.h"
#include "tests/pipeline/formats/transport_sample.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::cut_patch;
using test::sample_with_display;
using test::TemporaryFolder;

TEST(DisplayMeshFile, ReadsBackWhatWasWritten) {
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

TEST(DisplayMeshFile, RefusesMeshesThatAreNone) {
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

}  // namespace
}  // namespace patchlight
