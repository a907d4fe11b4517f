#include "pipeline/formats/solution/transport_file.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "pipeline/formats/file_kind.h"
#include "tests/expect_error.h"
#include "tests/pipeline/formats/transport_sample.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::sample_transport;
using test::sample_with_display;
using test::TemporaryFolder;

/// As rows by hemicubes are.
void weigh(Transport& transport) {
  transport.rays = 0;
  transport.hit_weights.clear();
  transport.weights = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f};
}

TEST(TransportFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  Transport written = sample_transport();
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

TEST(TransportFile, HoldsScenesWithoutMirrorsOrEmitters) {
  const TemporaryFolder folder;
  Transport bare = sample_transport();
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
    Transport broken = sample_transport();
    faults[k](broken);
    write_transport(folder / "transport.h5", broken);
    EXPECT_ERROR(read_transport(folder / "transport.h5"), ExitCode::bad_data, "transport.h5");
  }
}

}  // namespace
}  // namespace patchlight
