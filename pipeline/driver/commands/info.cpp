#include "pipeline/driver/commands/info.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "pipeline/driver/stages/stage_program.h"
#include "pipeline/formats/describe.h"
#include "pipeline/formats/file_kind.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/image/image_file.h"
#include "pipeline/system/standard_streams.h"

namespace patchlight {

namespace {

void show_frame(const std::string& file) {
  const Image image = read_exr_layers(file);
  Vec3d sum(0.0);
  for (const Color& pixel : image.pixels) sum += Vec3d(pixel);
  sum /= double(image.pixels.size());
  print(fmt::format("pixels      {} x {}, mean radiance {:.4g} {:.4g} {:.4g} W/m2/sr\n", image.width, image.height,
                    sum.x, sum.y, sum.z));
  if (!image.layers.empty()) print("layers\n");
  for (const ImageLayer& layer : image.layers) print(fmt::format("  {}.{}\n", layer.name, layer.channels));
  for (const auto& [name, value] : image.metadata)
    if (value.find('\n') == std::string::npos) print(fmt::format("{:<24}{}\n", name, value));
}

void show_shard(const std::string& file) {
  const H5Reader reader(file, kTransportShardFormat, kTransportShardVersion);
  const std::size_t rows = reader.dataset<std::int64_t>("/rows/start", -1).size() / 2;
  print(fmt::format("rows        {}, {} rays cast\n", rows, reader.integer("rays_cast")));
}

}  // namespace

int show_info(const InfoCommand& command) {
  switch (kind_of(command.file)) {
    case FileKind::patches:
      print(describe(read_patches(command.file)));
      break;
    case FileKind::transport:
      print(describe(read_transport(command.file)));
      break;
    case FileKind::transport_shard:
      show_shard(command.file);
      break;
    case FileKind::energy:
      print(describe(read_energy(command.file)));
      break;
    case FileKind::frame:
      show_frame(command.file);
      break;
    case FileKind::scene:
      Progress::catch_signals();
      return run_stage_program("import", {"--info", command.file}).exit_code;
  }
  return 0;
}

}  // namespace patchlight
