#include "apps/studio/server/served_folder.h"

#include <gtest/gtest.h>

#include <ctime>

#include "framework/base/error.h"
#include "tests/support/child_process.h"

namespace weir::studio {
namespace {

namespace fs = std::filesystem;

class ServedFolderTest : public testing::Test {
 protected:
  std::string prepared() const {
    fs::create_directories(folder / "served/meshes");
    folder.write("secret.txt", "secret");
    folder.write("served/scene.json", "{}");
    fs::create_symlink(folder / "secret.txt", folder / "served/way_out");
    fs::create_directory_symlink(folder.path(), folder / "served/up");
    return folder / "served";
  }
  const test::TemporaryFolder folder;
  const ServedFolder served{prepared()};
};

TEST_F(ServedFolderTest, GivesAndTakesWhatIsBelowIt) {
  EXPECT_EQ(served.read("scene.json"), "{}");
  served.write("new/folder/a.obj", "v 0 0 0\n");
  EXPECT_EQ(served.read("new/folder/a.obj"), "v 0 0 0\n");
  EXPECT_EQ(served.read("meshes/../scene.json"), "{}");
}

TEST_F(ServedFolderTest, NoPathLeadsOut) {
  for (const std::string path : {"../secret.txt", "meshes/../../secret.txt", "way_out", "up/secret.txt",
                                 "/etc/passwd", "..", "a\\b", "a\nb", "a\x7f", "\xff"}) {
    EXPECT_THROW(served.read(path), Error) << path;
    EXPECT_THROW(served.write(path, "x"), Error) << path;
  }
  EXPECT_THROW(served.write("", "x"), Error);
  EXPECT_THROW(served.list("../"), Error);
  EXPECT_EQ(ServedFolder(folder.path()).read("secret.txt"), "secret");
}

TEST_F(ServedFolderTest, AFolderThatIsNotThereYetHoldsNothingAndAFileIsNoFolder) {
  EXPECT_TRUE(served.list("pictures").empty());
  EXPECT_THROW(served.list("scene.json"), Error);
}

TEST_F(ServedFolderTest, ListsFoldersFirstAndHidesHiddenFiles) {
  folder.write("served/.hidden", "");
  const std::vector<ServedFile> files = served.list("");
  std::vector<std::string> names;
  for (const ServedFile& file : files) names.push_back(file.path);
  EXPECT_EQ(names, (std::vector<std::string>{"meshes", "up", "scene.json", "way_out"}));
  EXPECT_TRUE(files.front().isFolder);
  EXPECT_EQ(files[2].bytes, 2);
  EXPECT_NEAR(static_cast<double>(files[2].modified), static_cast<double>(std::time(nullptr)), 60);
}

TEST_F(ServedFolderTest, MustBeThere) {
  EXPECT_THROW(ServedFolder(folder / "nothing"), Error);
}

}  // namespace
}  // namespace weir::studio
