#include "plugins/video/image_sequence.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "tests/plugins/video/read_png.h"
#include "tests/plugins/video/sample_pictures.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

using rendering::ImageSequence;

std::set<std::string> filesIn(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(ImageSequence, WritesEveryFrameUnderItsNumber) {
  const TemporaryFolder folder;
  ImageSequence images(folder / "new");
  for (int i = 0; i < 20; ++i) images.write(noisePicture(31, 17, static_cast<std::uint32_t>(i)));
  images.finish();
  EXPECT_EQ(images.frameCount(), 20);
  const std::set<std::string> files = filesIn(folder / "new");
  EXPECT_EQ(files.size(), 20u);
  EXPECT_EQ(*files.begin(), "frame_00000.png");
  EXPECT_EQ(*files.rbegin(), "frame_00019.png");
  int i = 0;
  for (const std::string& file : files)
    EXPECT_EQ(readPng(folder / "new/" + file).rgb, noisePicture(31, 17, static_cast<std::uint32_t>(i++)).rgb);
  EXPECT_EQ(images.leftovers(), "");
}

TEST(ImageSequence, ReplacesEarlierFramesAndTellsOfThoseLeftOver) {
  const TemporaryFolder folder;
  {
    ImageSequence images(folder.path());
    for (int i = 0; i < 5; ++i) images.write(plainPicture(4, 4, {0, 0, 0}));
    images.finish();
  }
  folder.write("frame_notes.png", "");
  folder.write("frame_9.png", "");
  folder.write("x.png", "");
  ImageSequence images(folder.path());
  for (int i = 0; i < 2; ++i) images.write(plainPicture(4, 4, {255, 0, 0}));
  images.finish();
  EXPECT_EQ(pixelOf(readPng(folder / "frame_00001.png"), 0, 0), (Rgb{255, 0, 0}));
  EXPECT_EQ(pixelOf(readPng(folder / "frame_00002.png"), 0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(images.leftovers(), folder.path() +
                                    " holds 3 more pictures of an earlier, longer run: "
                                    "frame_00002.png to frame_00004.png");
}

TEST(ImageSequence, SaysAtOnceThatTheFolderCannotBeUsed) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "");
  EXPECT_CONTAINS(errorOf([&] { ImageSequence images(file); }).what(), "it is not a folder");
  const Error missing = errorOf([&] { ImageSequence images(folder / "no/new"); });
  EXPECT_EQ(missing.kind(), ErrorKind::kIo);
  EXPECT_EQ(missing.location().file, folder / "no/new");
  EXPECT_CONTAINS(missing.what(), "No such file or directory");
  EXPECT_EQ(errorOf([&] { ImageSequence images("/proc"); }).kind(), ErrorKind::kIo);
}

TEST(ImageSequence, FailsForGoodWhenTheDiskIsFull) {
  const SmallDisk disk("256k");
  if (!disk.isThere()) GTEST_SKIP() << "this user cannot mount a small disk";
  ImageSequence images(disk.path());
  const auto writeMany = [&] {
    for (std::uint32_t i = 0; i < 50; ++i) images.write(noisePicture(100, 100, i));
    images.finish();
  };
  const Error error = errorOf(writeMany);
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.what(), "No space left on device");
  EXPECT_CONTAINS(error.location().file, disk / "frame_000");
  EXPECT_CONTAINS(errorOf([&] { images.write(plainPicture(1, 1, {})); }).what(), "No space left on device");
  EXPECT_CONTAINS(errorOf([&] { images.finish(); }).what(), "No space left on device");
  for (const std::string& file : filesIn(disk.path())) EXPECT_EQ(readPng(disk / file).width, 100) << file;
}

TEST(ImageSequence, LeavesWholeFilesOnlyWithoutFinish) {
  const TemporaryFolder folder;
  {
    ImageSequence images(folder.path());
    for (std::uint32_t i = 0; i < 6; ++i) images.write(noisePicture(200, 200, i));
  }
  for (const std::string& file : filesIn(folder.path())) EXPECT_EQ(readPng(folder / file).width, 200) << file;
}

}  // namespace
}  // namespace weir::test
