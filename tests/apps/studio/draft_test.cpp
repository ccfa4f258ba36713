// What was edited and not saved outlives the server.
#include "apps/studio/session/draft.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

namespace fs = std::filesystem;

class DraftTest : public testing::Test {
 protected:
  DraftTest() { folder.write("scene.json", kBriefScene); }
  std::unique_ptr<RunningStudio> start(const std::string& scene) const {
    StudioOptions options;
    options.folder = options.templates = folder.path();
    options.threads = 1;
    return std::make_unique<RunningStudio>(options, scene);
  }
  static Value edited() {
    Value scene = parseJson(kBriefScene, "scene");
    scene["title"] = "Changed";
    return scene;
  }
  static Value edit() {
    Value set = parseJson(R"({"id": 2, "do": "scene.set"})", "request");
    set["scene"] = edited();
    return set;
  }
  /// What is offered when somebody comes; null if it is nothing.
  static Value offered(const RunningStudio& studio) {
    const Value hello = studio.socket().ask(R"({"id": 1, "do": "hello"})");
    const Value* draft = hello.find("result")->find("scene")->find("draft");
    return draft != nullptr ? *draft : Value();
  }
  /// Edits as long as the server lives.
  void crash(const std::string& scene) const {
    const auto studio = start(scene);
    EXPECT_TRUE(offered(*studio).isNull());
    studio->socket().ask(edit());
    EXPECT_TRUE(offered(*studio).isNull());  // it is what is edited
  }

  test::TemporaryFolder folder;
};

TEST_F(DraftTest, IsOfferedByTheNextServerAndTheFileIsAsItWas) {
  crash("scene.json");
  EXPECT_EQ(test::readFile(folder / "scene.json"), kBriefScene);
  EXPECT_EQ(offered(*start("scene.json")), edited());
  EXPECT_EQ(offered(*start("scene.json")), edited());  // nobody has decided yet
}

TEST_F(DraftTest, OfASceneWithoutAFileToo) {
  crash("");
  EXPECT_EQ(offered(*start("")), edited());
  EXPECT_TRUE(offered(*start("scene.json")).isNull());
}

TEST_F(DraftTest, IsGoneWhenItIsNotWantedOrSaved) {
  crash("scene.json");
  {
    const auto studio = start("scene.json");
    studio->socket().ask(R"({"id": 3, "do": "draft.drop"})");
    EXPECT_TRUE(offered(*studio).isNull());
  }
  EXPECT_TRUE(offered(*start("scene.json")).isNull());
  crash("scene.json");
  {
    const auto studio = start("scene.json");
    const Socket socket = studio->socket();
    socket.ask(edit());
    socket.ask(R"({"id": 4, "do": "scene.save", "path": "other.json"})");
  }
  EXPECT_TRUE(offered(*start("scene.json")).isNull());
  EXPECT_TRUE(offered(*start("other.json")).isNull());
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".draft") << entry.path();
}

TEST_F(DraftTest, OfAnotherSceneIsOfferedWhenThatIsOpened) {
  crash("scene.json");
  folder.write("other.json", kBriefScene);
  const auto studio = start("other.json");
  const Socket socket = studio->socket();
  const Value opened = socket.ask(R"({"id": 5, "do": "scene.open", "path": "scene.json"})");
  ASSERT_NE(opened.find("result")->find("draft"), nullptr);
  EXPECT_EQ(*opened.find("result")->find("draft"), edited());
}

TEST_F(DraftTest, OneThatIsBrokenIsPassedOver) {
  folder.write(".scene.json.draft", R"({"weir": 1, "nod)");
  EXPECT_TRUE(offered(*start("scene.json")).isNull());
}

TEST_F(DraftTest, WhereItCannotBeWrittenEditingGoesOn) {
  fs::create_directory(folder / ".scene.json.draft");
  const auto studio = start("scene.json");
  const Socket socket = studio->socket();
  for (int i = 0; i < 2; ++i) EXPECT_NE(socket.ask(edit()).find("result"), nullptr);
  EXPECT_NE(socket.ask(R"({"id": 4, "do": "scene.save", "path": "scene.json"})").find("result"), nullptr);
  EXPECT_EQ(parseJson(test::readFile(folder / "scene.json"), "saved"), edited());
}

TEST_F(DraftTest, ANewSceneHasNoFileThatItCouldOverwrite) {
  const auto studio = start("scene.json");
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 6, "do": "scene.new"})");
  const Value set = socket.ask(edit());
  EXPECT_EQ(set.find("result")->find("path")->asString(), "");
}

TEST_F(DraftTest, OneWithoutAFileIsKeptBesideWhenAnotherSceneBegins) {
  const auto studio = start("");
  const Socket socket = studio->socket();
  const auto kept = [&] { return parseJson(test::readFile(folder / ".untitled.json.draft.1"), "kept"); };
  Value other = edit();
  other["scene"]["title"] = "other";
  socket.ask(edit());
  socket.ask(R"({"id": 6, "do": "scene.new"})");
  socket.ask(other);
  EXPECT_EQ(kept(), edited());
  socket.ask(R"({"id": 7, "do": "scene.open", "template": "scene.json"})");
  EXPECT_EQ(kept(), *other.find("scene"));
}

TEST_F(DraftTest, WhatDiffersFromItsFileSaysSo) {
  const auto studio = start("scene.json");
  const Socket socket = studio->socket();
  const auto changed = [&](const Value& request) {
    const Value answer = socket.ask(request);
    return answer.find("result")->find("changed")->asBool();
  };
  EXPECT_TRUE(changed(edit()));
  Value back = edit();
  back["scene"] = parseJson(kBriefScene, "scene");
  EXPECT_FALSE(changed(back));
  EXPECT_TRUE(changed(edit()));
  EXPECT_FALSE(changed(parseJson(R"({"id": 4, "do": "scene.save", "path": "scene.json"})", "request")));
}

}  // namespace
}  // namespace weir::studio
