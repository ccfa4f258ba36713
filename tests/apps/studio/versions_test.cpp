// What a scene file was before it was saved again can be looked at, and what its run looked like.
#include "apps/studio/session/versions.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

namespace fs = std::filesystem;

const std::string kJpeg = "\xff\xd8\xff\xe0 some picture \xff\xd9";

class VersionsTest : public testing::Test {
 protected:
  VersionsTest() { folder.write("scene.json", kBriefScene); }
  std::unique_ptr<RunningStudio> start() const {
    StudioOptions options;
    options.folder = folder.path();
    options.threads = 1;
    return std::make_unique<RunningStudio>(options, "scene.json");
  }
  static void saveWithTitle(const Socket& socket, const std::string& title) {
    Value set = parseJson(R"({"id": 2, "do": "scene.set"})", "request");
    set["scene"] = parseJson(kBriefScene, "scene");
    set["scene"]["title"] = title;
    socket.ask(set);
    ASSERT_NE(socket.ask(R"({"id": 3, "do": "scene.save", "path": "scene.json"})").find("result"), nullptr);
  }
  static int put(const RunningStudio& studio, const std::string& address, const std::string& body) {
    const std::string length = "Content-Length: " + std::to_string(body.size()) + "\r\n";
    return studio.status(studio.head("PUT " + address, studio.bearer() + length) + "\r\n" + body);
  }
  void keep(const std::string& next) const {
    keepVersion(ServedFolder(folder.path()), "scene.json", next);
    folder.write("scene.json", next);
  }

  test::TemporaryFolder folder;
};

TEST_F(VersionsTest, WhatAFileHeldBeforeEachSaveCanBeReadAgain) {
  const auto studio = start();
  const Socket socket = studio->socket();
  for (const char* title : {"One", "Two", "Two", "Three"}) saveWithTitle(socket, title);
  const Value answer = socket.ask(R"({"id": 4, "do": "scene.versions"})");
  const auto& versions = answer.find("result")->find("versions")->asArray();
  ASSERT_EQ(versions.size(), 3u);  // what was saved as it was is no version
  std::vector<std::string> titles;
  for (const Value& version : versions) {
    EXPECT_GT(version.find("written")->asInt(), 0);
    Value ask = parseJson(R"({"id": 5, "do": "scene.version"})", "request");
    ask["number"] = *version.find("number");
    const Value old = socket.ask(ask);
    const Value* title = old.find("result")->find("scene")->find("title");
    titles.push_back(title != nullptr ? title->asString() : "");
  }
  EXPECT_EQ(titles, (std::vector<std::string>{"Two", "One", ""}));
  EXPECT_NE(socket.ask(R"({"id": 6, "do": "scene.version", "number": 9})").find("error"), nullptr);
}

TEST_F(VersionsTest, TheOldestGo) {
  for (std::size_t i = 0; i < kMaxVersions + 3; ++i) keep(std::to_string(i));
  const auto versions = versionsOf(ServedFolder(folder.path()), "scene.json");
  ASSERT_EQ(versions.size(), kMaxVersions);
  EXPECT_EQ(versions.front().number, static_cast<std::int64_t>(kMaxVersions) + 3);
  EXPECT_EQ(versions.back().number, 4);
  EXPECT_EQ(readVersion(ServedFolder(folder.path()), "scene.json", versions.front().number),
            std::to_string(kMaxVersions + 1));
}

TEST_F(VersionsTest, APictureBelongsToItsVersion) {
  const auto studio = start();
  EXPECT_EQ(studio->answer("GET /api/files").find("picture"), std::string::npos);
  EXPECT_EQ(put(*studio, "/api/picture/scene.json", kJpeg), 200);
  EXPECT_NE(studio->answer("GET /api/files").find("\"picture\""), std::string::npos);
  saveWithTitle(studio->socket(), "Later");
  const std::string later = "\xff\xd8\xff\xe0 later \xff\xd9";
  EXPECT_EQ(put(*studio, "/api/picture/scene.json", later), 200);
  EXPECT_NE(studio->answer("GET /api/picture/scene.json").find("later"), std::string::npos);
  EXPECT_NE(studio->answer("GET /api/picture/scene.json?version=1").find("some picture"), std::string::npos);
  EXPECT_NE(studio->answer("GET /api/picture/scene.json?version=2").find("404"), std::string::npos);
  EXPECT_TRUE(versionsOf(ServedFolder(folder.path()), "scene.json").at(0).hasPicture);
}

TEST_F(VersionsTest, ADraftOfASceneWithoutAFileHasAPictureUntilAnotherSceneTakesItsPlace) {
  const auto studio = start();
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "scene.new"})");
  EXPECT_EQ(put(*studio, "/api/picture/untitled.json", kJpeg), 400);
  socket.ask(R"({"id": 1, "do": "scene.set", "scene": {"weir": 1, "nodes": {}}})");
  EXPECT_EQ(put(*studio, "/api/picture/untitled.json", kJpeg), 200);
  EXPECT_NE(studio->answer("GET /api/picture/untitled.json").find("some picture"), std::string::npos);
  socket.ask(R"({"id": 2, "do": "scene.new"})");
  EXPECT_NE(studio->answer("GET /api/picture/untitled.json").find("404"), std::string::npos);
}

TEST_F(VersionsTest, NothingButASmallJpegOfASceneIsAPicture) {
  const auto studio = start();
  EXPECT_EQ(put(*studio, "/api/picture/scene.json", "<script>"), 400);
  EXPECT_EQ(
      put(*studio, "/api/picture/scene.json", "\xff\xd8\xff" + std::string(kMaxPicture, ' ') + "\xff\xd9"),
      400);
  EXPECT_EQ(put(*studio, "/api/picture/other.json", kJpeg), 400);
  EXPECT_EQ(put(*studio, "/api/picture/", kJpeg), 400);
  EXPECT_EQ(put(*studio, "/api/picture/../scene.json", kJpeg), 400);
  EXPECT_NE(studio->answer("GET /api/picture/scene.json?version=1x").find("400"), std::string::npos);
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().filename(), "scene.json") << entry.path();
}

TEST_F(VersionsTest, ALinkInTheirPlaceIsNotFollowed) {
  const test::TemporaryFolder outside;
  fs::create_directory_symlink(outside.path(), folder / ".scene.json.versions");
  outside.write("1.json", "secret");
  const ServedFolder served(folder.path());
  EXPECT_TRUE(versionsOf(served, "scene.json").empty());
  EXPECT_THROW(readVersion(served, "scene.json", 1), Error);
  EXPECT_THROW(keepVersion(served, "scene.json", "next"), Error);
  // Saving goes on without.
  const auto studio = start();
  saveWithTitle(studio->socket(), "Saved");
  EXPECT_NE(test::readFile(folder / "scene.json").find("Saved"), std::string::npos);
}

TEST_F(VersionsTest, TheCostIsToldBeforeAnythingIsBuilt) {
  const auto studio = start();
  const Socket socket = studio->socket();
  const Value cost = socket.ask(R"({"id": 2, "do": "scene.cost"})");
  const Value* result = cost.find("result");
  ASSERT_NE(result, nullptr);
  EXPECT_GE(result->find("particles")->asDouble(), 125);
  EXPECT_LT(result->find("particles")->asDouble(), 400);
  EXPECT_EQ(result->find("steps")->asInt(), 40);  // 0.04 s of 1 ms
  EXPECT_TRUE(result->find("fits")->asBool());
  Value set = parseJson(R"({"id": 3, "do": "scene.set"})", "request");
  set["scene"] = parseJson(kBriefScene, "scene");
  set["scene"]["nodes"]["water"]["params"]["spacing"] = 2.5e-4;
  socket.ask(set);
  const Value large = socket.ask(R"({"id": 4, "do": "scene.cost"})");
  ASSERT_NE(large.find("result"), nullptr) << writeJsonLine(large);
  EXPECT_FALSE(large.find("result")->find("fits")->asBool());
}

}  // namespace
}  // namespace weir::studio
