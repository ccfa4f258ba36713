// A token is known again after a restart, by the same folder and port alone, and is believed only where
// nobody else could have read or written it.
#include "apps/studio/server/kept_token.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/apps/studio/web_client.h"
#include "tests/support/variable_for.h"

namespace weir::studio {
namespace {

namespace fs = std::filesystem;

class KeptTokenTest : public testing::Test {
 protected:
  KeptTokenTest() { fs::create_directory(served); }

  KeptToken kept(bool fresh = false) const { return keptToken(tokens, owner, fresh); }
  fs::path file() const {
    EXPECT_EQ(std::distance(fs::directory_iterator(tokens), fs::directory_iterator()), 1);
    return fs::directory_iterator(tokens)->path();
  }
  static mode_t modeOf(const fs::path& path) {
    struct stat found {};
    EXPECT_EQ(::lstat(path.c_str(), &found), 0);
    return found.st_mode & 07777;
  }
  /// The file is not believed, and what takes its place is.
  void expectReplaced(const std::string& before, const std::string& why) const {
    const KeptToken next = kept();
    EXPECT_NE(next.token, before);
    if (why.empty())
      EXPECT_EQ(next.problem, "");
    else
      EXPECT_NE(next.problem.find(why), std::string::npos) << next.problem;
    EXPECT_EQ(modeOf(file()), 0600u);
    EXPECT_EQ(kept().token, next.token);
  }

  test::TemporaryFolder folder;
  fs::path served = fs::path(folder / "scenes"), tokens = fs::path(folder / "state/weir/studio");
  TokenOwner owner{served, "127.0.0.1", 8123};
};

TEST_F(KeptTokenTest, IsTheSameAgainForTheSameFolderHostAndPort) {
  const KeptToken first = kept();
  EXPECT_EQ(first.problem, "");
  EXPECT_EQ(first.token.size(), 32u);
  EXPECT_EQ(kept().token, first.token);
  owner.served = served / ".." / "scenes";
  EXPECT_EQ(kept().token, first.token);
  owner.port = 8124;
  EXPECT_NE(kept().token, first.token);
  owner.port = 8123;
  owner.host = "::1";
  EXPECT_NE(kept().token, first.token);
  owner.host = "127.0.0.1";
  owner.served = folder.path();
  EXPECT_NE(kept().token, first.token);
}

TEST_F(KeptTokenTest, IsReadAndWrittenByItsOwnerAlone) {
  const mode_t before = ::umask(0);
  kept();
  ::umask(before);
  EXPECT_EQ(modeOf(tokens), 0700u);
  EXPECT_EQ(modeOf(file()), 0600u);
}

TEST_F(KeptTokenTest, IsAnotherOneWhereThatIsAskedFor) {
  const std::string first = kept().token, second = kept(true).token;
  EXPECT_NE(first, second);
  EXPECT_EQ(kept().token, second);
}

TEST_F(KeptTokenTest, IsNotKeptForOtherMachinesNorAtAPortThatChangesNorWithoutAFolder) {
  for (const TokenOwner& other : {TokenOwner{served, "0.0.0.0", 8123}, TokenOwner{served, "127.0.0.1", 0}})
    EXPECT_NE(keptToken(tokens, other, false).token, keptToken(tokens, other, false).token);
  EXPECT_FALSE(fs::exists(tokens));
  EXPECT_NE(keptToken({}, owner, false).token, keptToken({}, owner, false).token);
}

TEST_F(KeptTokenTest, ThatOthersCouldReadIsNotValidAnyMore) {
  for (const mode_t mode : {0640u, 0604u, 0660u, 0602u}) {
    const std::string before = kept().token;
    ASSERT_EQ(::chmod(file().c_str(), mode), 0);
    expectReplaced(before, "could be read by others");
  }
}

TEST_F(KeptTokenTest, OfSomebodyElseIsNotValid) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  const std::string before = kept().token;
  ASSERT_EQ(::chown(file().c_str(), 12345, 12345), 0);
  expectReplaced(before, "belongs to somebody else");
}

TEST_F(KeptTokenTest, IsNotReadThroughALinkAndNotWrittenThroughOne) {
  const std::string before = kept().token;
  const fs::path path = file(), elsewhere = folder / "elsewhere";
  fs::rename(path, elsewhere);
  fs::create_symlink(elsewhere, path);
  expectReplaced(before, "cannot be read");
  EXPECT_FALSE(fs::is_symlink(path));
  EXPECT_NE(test::readFile(elsewhere.string()).find(before),
            std::string::npos);  // what it led to is as it was
  fs::remove(path);
  fs::create_hard_link(elsewhere, path);
  expectReplaced(before, "no file of its own");
}

TEST_F(KeptTokenTest, IsNotTakenFromAFileThatIsNoneOrOld) {
  const std::string before = kept().token;
  const std::string text = test::readFile(file().string());
  for (const std::string& wrong :
       {std::string(), before, "../" + text, text + "more", std::string(5000, '0')}) {
    std::ofstream(file()) << wrong;
    const std::string now = kept().token;
    EXPECT_NE(now, before) << wrong;
    EXPECT_EQ(kept().token, now);
  }
  const std::string recent = kept().token;
  fs::last_write_time(file(), fs::file_time_type::clock::now() - std::chrono::hours(29 * 24));
  EXPECT_EQ(kept().token, recent);
  fs::last_write_time(file(), fs::file_time_type::clock::now() - std::chrono::hours(31 * 24));
  expectReplaced(recent, "");
}

TEST_F(KeptTokenTest, IsNotKeptInAFolderThatOthersMayWriteTo) {
  kept();
  const fs::path path = file();
  ASSERT_EQ(::chmod(tokens.c_str(), 0770), 0);
  const std::string before = test::readFile(path.string());
  const KeptToken next = kept();
  EXPECT_NE(next.problem.find("others may write to"), std::string::npos) << next.problem;
  EXPECT_EQ(before.find(next.token), std::string::npos);
  EXPECT_EQ(test::readFile(path.string()), before);
  // Nor in one that a link leads to, which may be anywhere.
  fs::rename(tokens, folder / "real");
  fs::create_directory_symlink(folder / "real", tokens);
  EXPECT_NE(kept().problem.find("is no folder"), std::string::npos);
}

TEST_F(KeptTokenTest, LiesInTheUsersStateFolder) {
  const test::VariableFor home("HOME", "/home/someone");
  {
    const test::VariableFor state("XDG_STATE_HOME", "/state");
    EXPECT_EQ(folderOfTokens(), "/state/weir/studio");
  }
  const test::VariableFor state("XDG_STATE_HOME", "relative");
  EXPECT_EQ(folderOfTokens(), "/home/someone/.local/state/weir/studio");
}

TEST_F(KeptTokenTest, LetsAWindowInAgainAfterARestartAtTheSamePort) {
  folder.write("scenes/scene.json", kBriefScene);
  StudioOptions options;
  options.folder = served;
  options.threads = 1;
  options.tokens = tokens;
  options.port = RunningStudio(options, "scene.json").port();  // one that is free
  const auto start = [&] { return std::make_unique<RunningStudio>(options, "scene.json"); };
  const std::string first = start()->token();
  const auto again = start();
  EXPECT_EQ(again->token(), first);
  EXPECT_TRUE(
      Socket(options.port, again->head("GET /api/live", "Cookie: weir_studio_token=" + first + "\r\n"))
          .accepted());
}

TEST_F(KeptTokenTest, DoesNotLetAWindowInWhereANewOneWasAskedFor) {
  StudioOptions options;
  options.folder = served;
  options.threads = 1;
  options.tokens = tokens;
  options.port = RunningStudio(options, "").port();
  const std::string first = RunningStudio(options, "").token();
  options.newToken = true;
  const RunningStudio again(options, "");
  EXPECT_NE(again.token(), first);
  EXPECT_FALSE(
      Socket(options.port, again.head("GET /api/live", "Cookie: weir_studio_token=" + first + "\r\n"))
          .accepted());
}

}  // namespace
}  // namespace weir::studio
