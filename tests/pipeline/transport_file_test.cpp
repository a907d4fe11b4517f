#include "pipeline/files/transport_file.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "pipeline/files/file_kind.h"
#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::TemporaryFolder;

Transport sample() {
  Transport transport;
  transport.starts = {0, 2, 4, 4, 6};  // two patches
  transport.ends = {1, 2, 1, 1, 0, 2};
  transport.mirrored = {{0, 1, 1, Color(0.5f, 0.25f, 0.0f)}, {1, 0, 0, Color(0.1f)}};
  transport.emitters = {{0, 1, {0.1f, 0.2f, 0.3f, -0.01f}}, {1, 1, {0.0f, 0.0f, 0.5f, 0.5f}}};
  transport.key = "key";
  return transport;
}

TEST(TransportFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  Transport written = sample();
  for (const bool weighted : {false, true}) {
    if (weighted) written.weights = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f};
    write_transport(folder / "transport.h5", written);
    const Transport read = read_transport(folder / "transport.h5");
    EXPECT_EQ(read.starts, written.starts);
    EXPECT_EQ(read.ends, written.ends);
    EXPECT_EQ(read.weights, written.weights);
    ASSERT_EQ(read.mirrored.size(), 2u);
    EXPECT_EQ(read.mirrored[0].half, 1);
    EXPECT_EQ(read.mirrored[0].weight, written.mirrored[0].weight);
    ASSERT_EQ(read.emitters.size(), 2u);
    EXPECT_EQ(read.emitters[1].first_patch, 1);
    EXPECT_EQ(read.emitters[1].factors, written.emitters[1].factors);
    EXPECT_FALSE(read.changed);
    EXPECT_EQ(read_transport_key(folder / "transport.h5"), "key");
  }
  EXPECT_EQ(kind_of(folder / "transport.h5"), FileKind::transport);
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

TEST(TransportFile, RefusesWhatIsOutOfBounds) {
  const std::vector<std::function<void(Transport&)>> faults{
      [](Transport& t) { t.starts[0] = 1; },
      [](Transport& t) { t.starts[1] = 5; },
      [](Transport& t) { t.starts.back() = 5; },
      [](Transport& t) { t.starts.push_back(6); },
      [](Transport& t) { t.ends[0] = 3; },
      [](Transport& t) { t.ends[0] = -1; },
      [](Transport& t) { t.weights.assign(6, std::numeric_limits<float>::quiet_NaN()); },
      [](Transport& t) { t.weights.assign(5, 0.1f); },
      [](Transport& t) { t.mirrored[0].row = 2; },
      [](Transport& t) { t.mirrored[0].half = 2; },
      [](Transport& t) { t.mirrored[0].patch = 2; },
      [](Transport& t) { t.mirrored[0].weight.x = std::numeric_limits<float>::infinity(); },
      [](Transport& t) { std::swap(t.mirrored[0], t.mirrored[1]); },
      [](Transport& t) { t.emitters[1].patches = 2; },
      [](Transport& t) { t.emitters[0].first_patch = -1; },
      [](Transport& t) { t.emitters[0].factors[0] = std::numeric_limits<float>::infinity(); },
      [](Transport& t) { t.emitters[0].factors.resize(2); },
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
