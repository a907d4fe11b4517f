#include "pipeline/hdf5/h5_store.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include "tests/expect_error.h"
#include "tests/temporary_folder.h"

namespace patchlight {
namespace {

using test::TemporaryFolder;

void write_sample(const std::filesystem::path& file) {
  H5Writer writer(file);
  writer.dataset<double>("/group/rows", std::vector<double>{1, 2, 3, 4, 5, 6}, 3);
  writer.dataset<std::int32_t>("/flat", std::vector<std::int32_t>{7, 8});
  writer.strings("/names", {"one", "", "three"});
  writer.attribute("format", std::string("sample"));
  writer.attribute("version", std::int64_t(1));
  writer.attribute("ratio", 0.1);
  writer.commit();
}

TEST(H5Store, ReadsBackWrittenValues) {
  const TemporaryFolder folder;
  write_sample(folder / "a.h5");
  const H5Reader reader(folder / "a.h5", "sample", 1);
  EXPECT_EQ(reader.dataset<double>("/group/rows", 2, 3), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(reader.dataset<std::int32_t>("/flat", -1), (std::vector<std::int32_t>{7, 8}));
  EXPECT_EQ(reader.strings("/names", 3), (std::vector<std::string>{"one", "", "three"}));
  EXPECT_EQ(reader.real("ratio"), 0.1);
}

TEST(H5Store, RefusesOtherShapesTypesAndFormats) {
  const TemporaryFolder folder;
  write_sample(folder / "a.h5");
  const H5Reader reader(folder / "a.h5", "sample", 1);
  EXPECT_ERROR(reader.dataset<double>("/group/rows", 3, 3), ExitCode::bad_data, "/group/rows");
  EXPECT_ERROR(reader.dataset<double>("/group/rows", -1, 2), ExitCode::bad_data, "wrong shape");
  EXPECT_ERROR(reader.dataset<float>("/group/rows", 2, 3), ExitCode::bad_data, "unexpected type");
  EXPECT_ERROR(reader.dataset<double>("/none", -1), ExitCode::bad_data, "missing dataset");
  EXPECT_ERROR(H5Reader(folder / "a.h5", "other", 1), ExitCode::bad_data, "not a other file but sample");
  EXPECT_ERROR(H5Reader(folder / "a.h5", "sample", 2), ExitCode::bad_data, "version");
  EXPECT_ERROR(H5Reader(folder / "none.h5", "sample", 1), ExitCode::missing_input, "none.h5");
}

TEST(H5Store, NoDamagedByteChangesValues) {
  const TemporaryFolder folder;
  write_sample(folder / "a.h5");
  const std::string whole = test::read_text(folder / "a.h5");
  int refused = 0, harmless = 0;
  for (std::size_t i = 0; i < whole.size(); i += 3) {
    std::string damaged = whole;
    damaged[i] = char(~damaged[i]);
    folder.write("b.h5", damaged);
    try {
      const H5Reader reader(folder / "b.h5", "sample", 1);
      // If the damage is not detected, it must not affect the values.
      EXPECT_EQ(reader.dataset<double>("/group/rows", 2, 3), (std::vector<double>{1, 2, 3, 4, 5, 6})) << "byte " << i;
      EXPECT_EQ(reader.strings("/names", 3), (std::vector<std::string>{"one", "", "three"})) << "byte " << i;
      ++harmless;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_data);
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(H5Store, WritesTextAttributesAsVariableLengthUtf8) {
  const TemporaryFolder folder;
  write_sample(folder / "a.h5");
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t attribute = H5Aopen(file, "format", H5P_DEFAULT), type = H5Aget_type(attribute);
  EXPECT_GT(H5Tis_variable_str(type), 0);
  EXPECT_EQ(H5Tget_cset(type), H5T_CSET_UTF8);
  H5Tclose(type);
  H5Aclose(attribute);
  H5Fclose(file);
}

TEST(H5Store, ReadsFilesWithTextAttributesOfFixedLength) {
  const H5Reader reader(std::string(PATCHLIGHT_SOURCE) + "/tests/pipeline/hdf5/fixed_length_text.h5", "sample", 1);
  EXPECT_EQ(reader.strings("/names", 3), (std::vector<std::string>{"one", "", "three"}));
}

TEST(H5Store, RefusesTruncatedFiles) {
  const TemporaryFolder folder;
  write_sample(folder / "a.h5");
  const std::string whole = test::read_text(folder / "a.h5");
  for (const std::size_t size : {std::size_t(0), std::size_t(10), whole.size() / 2, whole.size() - 1}) {
    folder.write("b.h5", whole.substr(0, size));
    EXPECT_ERROR(H5Reader(folder / "b.h5", "sample", 1), ExitCode::bad_data, "b.h5");
  }
}

TEST(H5Store, LeavesNoFileWithoutCommit) {
  const TemporaryFolder folder;
  folder.write("a.h5", "previous");
  {
    H5Writer writer(folder / "a.h5");
    writer.dataset<double>("/x", std::vector<double>{1});
  }
  EXPECT_EQ(test::read_text(folder / "a.h5"), "previous");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(H5Store, ReportsThatTheOutputCannotBeCreated) {
  const TemporaryFolder folder;
  folder.write("file", "");
  EXPECT_ERROR(H5Writer(folder / "file/sub/a.h5"), ExitCode::cannot_create, "--output");
  EXPECT_ERROR(H5Writer(folder.path()), ExitCode::cannot_create, "a folder has its name");
}

}  // namespace
}  // namespace patchlight
