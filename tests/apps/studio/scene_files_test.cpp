// What a scene in the studio may read, and what others may make of the files of the served folder.
#include "apps/studio/session/scene_files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

namespace fs = std::filesystem;

class SceneFilesTest : public testing::Test {
 protected:
  SceneFilesTest() {
    outside.write("secret.csv", "password,hunter2\n1,2\n");
    folder.write("scene.json", kBriefScene);
    folder.write("particles.csv", "x,y,z\n0,0,0\n0.1,0,0\n");
    folder.write(".hidden.csv", "password,hunter2\n1,2\n");
    fs::create_symlink(outside / "secret.csv", folder / "window.csv");
    fs::create_directory_symlink(outside.path(), folder / "door");
    options.folder = folder.path();
    options.threads = 1;
  }
  /// The whole answer to a scene that reads a file, and of the reset after it.
  std::string answerTo(const std::string& file) {
    const RunningStudio studio(options, "scene.json");
    const Socket socket = studio.socket();
    Value set = parseJson(R"({"id": 2, "do": "scene.set", "scene": {"weir": 1, "nodes": {
        "file": {"type": "ParticleFile", "params": {}},
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.04, "rest_steps": 0}}},
      "links": ["file.particles -> water.initial"]}})",
                          "request");
    set["scene"]["nodes"]["file"]["params"]["file"] = file;
    std::string answers = writeJsonLine(socket.ask(set));
    const Value reset = socket.ask(R"({"id": 3, "do": "run.reset"})");
    answers += writeJsonLine(reset);
    if (reset.find("result") != nullptr)
      answers += writeJsonLine(socket.event("status", [](const Value& status) {
        const std::string& state = status.find("state")->asString();
        return state == "paused" || state == "failed";
      }));
    return answers;
  }

  test::TemporaryFolder folder, outside;
  StudioOptions options;
};

TEST_F(SceneFilesTest, NoSceneReadsWhatLiesElsewhereOrIsHidden) {
  for (const std::string& file :
       {outside / "secret.csv", "../" + fs::path(outside.path()).filename().string() + "/secret.csv",
        std::string("window.csv"), std::string("door/secret.csv"), std::string(".hidden.csv")}) {
    const std::string answers = answerTo(file);
    EXPECT_NE(answers.find("may not read"), std::string::npos) << answers;
    EXPECT_NE(answers.find("--allow-files"), std::string::npos) << answers;
    EXPECT_EQ(answers.find("hunter2"), std::string::npos) << answers;
    EXPECT_EQ(answers.find("password"), std::string::npos) << answers;
  }
}

TEST_F(SceneFilesTest, ScenesReadTheServedFolderAndWhatTheUserHasAllowed) {
  EXPECT_NE(answerTo("particles.csv").find(R"("particles": 2)"), std::string::npos);
  EXPECT_NE(answerTo(folder / "particles.csv").find(R"("particles": 2)"), std::string::npos);
  options.sceneFolders = {outside.path()};
  // It is read, and is not particles.
  EXPECT_NE(answerTo(outside / "secret.csv").find("password"), std::string::npos);
}

TEST_F(SceneFilesTest, APipeInTheFolderStopsNobody) {
  ASSERT_EQ(mkfifo((folder / "pipe.json").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((folder / "pipe.csv").c_str(), 0600), 0);
  EXPECT_NE(answerTo("pipe.csv").find("a regular file"), std::string::npos);
  const RunningStudio studio(options, "scene.json");
  EXPECT_NE(studio.answer("GET /api/file/pipe.json").find("not a regular file"), std::string::npos);
  EXPECT_NE(studio.answer("GET /api/files").find("pipe.json"), std::string::npos);
  const Socket socket = studio.socket();
  for (const char* request : {R"({"id": 1, "do": "scene.open", "path": "pipe.json"})",
                              R"({"id": 2, "do": "scene.save", "path": "pipe.json", "overwrite": true})"})
    EXPECT_NE(socket.ask(request).find("error"), nullptr) << request;
  EXPECT_NE(socket.ask(R"({"id": 3, "do": "hello"})").find("result"), nullptr);
}

TEST_F(SceneFilesTest, NothingOfTheFolderRunsInTheStudiosPage) {
  for (const char* name : {"a.html", "a.svg", "a.js", "a.xml", "a.json", "a.txt", "a"})
    folder.write(name, "<script>1</script>");
  folder.write("a.jpg", "x");
  const RunningStudio studio(options, "scene.json");
  for (const char* name : {"a.html", "a.svg", "a.js", "a.xml", "a.json", "a.txt", "a", "a.jpg"}) {
    const std::string answer = studio.answer(std::string("GET /api/file/") + name);
    EXPECT_NE(answer.find("Content-Security-Policy: sandbox; default-src 'none'"), std::string::npos)
        << answer;
    EXPECT_NE(answer.find("nosniff"), std::string::npos);
    for (const char* active : {"text/html", "svg", "javascript", "xml"})
      EXPECT_EQ(answer.substr(0, answer.find("\r\n\r\n")).find(active), std::string::npos) << answer;
    const bool isPicture = name == std::string("a.jpg");
    EXPECT_EQ(answer.find("Content-Disposition: attachment") == std::string::npos, isPicture) << answer;
  }
}

TEST_F(SceneFilesTest, HiddenFilesAreNeitherReadNorWritten) {
  fs::create_directory(folder / ".git");
  folder.write(".git/config", "x");
  fs::create_symlink(folder / ".git/config", folder / "config.json");
  const RunningStudio studio(options, "scene.json");
  for (const char* path : {".git/config", ".hidden.csv", "config.json", "a/../.git/config"}) {
    EXPECT_EQ(studio.answer(std::string("GET /api/file/") + path).substr(9, 3), "400") << path;
    EXPECT_EQ(studio.status(studio.head(std::string("PUT /api/file/") + path,
                                        studio.bearer() + "Content-Length: 1\r\n") +
                            "\r\nx"),
              400)
        << path;
  }
  EXPECT_EQ(studio.answer("GET /api/files?folder=.git").substr(9, 3), "400");
  const Socket socket = studio.socket();
  for (const char* request : {R"({"id": 1, "do": "scene.save", "path": ".x.json"})",
                              R"({"id": 1, "do": "scene.save", "path": ".git/x.json"})"})
    EXPECT_NE(socket.ask(request).find("error"), nullptr) << request;
  EXPECT_FALSE(fs::exists(folder / ".x.json"));
}

TEST_F(SceneFilesTest, NoFileIsReplacedUnasked) {
  folder.write("tank.json", kBriefScene);
  folder.write(".tank.json.draft", R"({"weir": 1})");
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  EXPECT_NE(socket.ask(R"({"id": 1, "do": "scene.save", "path": "scene.json"})").find("result"), nullptr);
  const std::string before = test::readFile(folder / "tank.json");
  const Value refused = socket.ask(R"({"id": 2, "do": "scene.save", "path": "tank.json"})");
  ASSERT_NE(refused.find("error"), nullptr);
  EXPECT_TRUE(refused.find("error")->find("exists")->asBool());
  EXPECT_EQ(test::readFile(folder / "tank.json"), before);
  EXPECT_NE(
      socket.ask(R"({"id": 3, "do": "scene.save", "path": "tank.json", "overwrite": true})").find("result"),
      nullptr);
  EXPECT_NE(test::readFile(folder / "tank.json"), before);
  // What somebody had made of the tank and not saved is not gone.
  EXPECT_EQ(test::readFile(folder / ".tank.json.draft.1"), R"({"weir": 1})");
  EXPECT_EQ(
      studio.status(studio.head("PUT /api/file/tank.json?new", studio.bearer() + "Content-Length: 1\r\n") +
                    "\r\nx"),
      400);
  EXPECT_NE(test::readFile(folder / "tank.json"), "x");
}

}  // namespace
}  // namespace weir::studio
