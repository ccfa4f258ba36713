#include "plugins/video/image_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "framework/base/check.h"
#include "tests/plugins/video/read_png.h"
#include "tests/plugins/video/sample_pictures.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

using rendering::Picture;
using rendering::writePng;

TEST(ImageFile, GivesBackTheSamePixels) {
  const TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {17, 9}, {640, 361}}) {
    const Picture picture = noisePicture(width, height, 7);
    writePng(folder / "a.png", picture);
    const Picture back = readPng(folder / "a.png");
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_EQ(back.rgb, picture.rgb);
  }
}

TEST(ImageFile, HasTheTopRowFirst) {
  const TemporaryFolder folder;
  Picture picture = plainPicture(4, 3, {0, 0, 0});
  picture.rgb[0] = 200;  // red, top left
  writePng(folder / "a.png", picture);
  EXPECT_EQ(pixelOf(readPng(folder / "a.png"), 0, 0), (Rgb{200, 0, 0}));
  EXPECT_EQ(pixelOf(readPng(folder / "a.png"), 0, 2), (Rgb{0, 0, 0}));
}

TEST(ImageFile, LeavesNothingButTheFile) {
  const TemporaryFolder folder;
  writePng(folder / "a.png", plainPicture(4, 4, {1, 2, 3}));
  writePng(folder / "a.png", plainPicture(4, 4, {4, 5, 6}));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_EQ(pixelOf(readPng(folder / "a.png"), 0, 0), (Rgb{4, 5, 6}));
}

TEST(ImageFile, SaysWhatIsWrongWithThePath) {
  const TemporaryFolder folder;
  const Picture picture = plainPicture(2, 2, {});
  const Error noFolder = errorOf([&] { writePng(folder / "no/a.png", picture); });
  EXPECT_EQ(noFolder.kind(), ErrorKind::kIo);
  EXPECT_EQ(noFolder.location().file, folder / "no/a.png");
  EXPECT_CONTAINS(noFolder.what(), "there is no folder " + folder / "no");
  std::filesystem::create_directory(folder / "b.png");
  EXPECT_CONTAINS(errorOf([&] { writePng(folder / "b.png", picture); }).what(), "it is a folder");
  EXPECT_CONTAINS(errorOf([&] { writePng("/dev/full", picture); }).what(), "it is not a regular file");
}

TEST(ImageFile, RejectsPicturesThatAreNotWhole) {
  const TemporaryFolder folder;
  Picture picture = plainPicture(4, 4, {});
  picture.rgb.pop_back();
  EXPECT_THROW(writePng(folder / "a.png", picture), InternalError);
  EXPECT_THROW(writePng(folder / "a.png", Picture{}), InternalError);
}

TEST(ImageFile, KeepsTheOldFileWhenTheDiskIsFull) {
  const SmallDisk disk("64k");
  if (!disk.isThere()) GTEST_SKIP() << "this user cannot mount a small disk";
  const Picture old = plainPicture(8, 8, {9, 9, 9});
  writePng(disk / "a.png", old);
  const Error error = errorOf([&] { writePng(disk / "a.png", noisePicture(300, 300, 1)); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_EQ(error.location().file, disk / "a.png");
  EXPECT_CONTAINS(error.what(), "No space left on device");
  EXPECT_EQ(readPng(disk / "a.png").rgb, old.rgb);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(disk.path()), {}), 1);
}

}  // namespace
}  // namespace weir::test
