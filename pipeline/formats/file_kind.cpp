#include "pipeline/formats/file_kind.h"

#include <array>
#include <fstream>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/error.h"

namespace patchlight {

FileKind kind_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ExitCode::missing_input, "cannot open the file", file.string(), "check the path");
  std::array<unsigned char, 4> magic{};
  stream.read(reinterpret_cast<char*>(magic.data()), magic.size());
  if (magic == std::array<unsigned char, 4>{0x76, 0x2f, 0x31, 0x01}) return FileKind::frame;
  if (magic != std::array<unsigned char, 4>{0x89, 'H', 'D', 'F'}) return FileKind::scene;
  const std::string format = h5_format(file);
  if (format == kPatchFormat) return FileKind::patches;
  if (format == kTransportFormat) return FileKind::transport;
  if (format == kTransportShardFormat) return FileKind::transport_shard;
  if (format == kEnergyFormat) return FileKind::energy;
  throw Error(ExitCode::bad_data, "an HDF5 file of an unknown format", file.string(),
              "give a file that Patchlight wrote");
}

}  // namespace patchlight
