// Standard output that cannot be written, and streams that whoever started the program has closed.
#include <gtest/gtest.h>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// By a shell, which closes and redirects streams; `command` is what stands behind the program's name.
ChildResult runInShell(const std::string& command, const std::string& folder) {
  return runChild("/bin/sh", {"-c", "exec '" + weirProgram() + "' " + command}, {.folder = folder});
}

TEST(StandardStreams, WhatCannotBePrintedIsAnError) {
  const TemporaryFolder folder;
  const std::string scene = resourcesFolder() + "/scenes/dam_break.json";
  for (const std::string& command :
       {std::string("schema"), std::string("info"), std::string("nodes"), std::string("nodes --json"),
        std::string("nodes ParticleFluid"), std::string("completion"), std::string("--help"),
        std::string("--version"), "validate " + scene, std::string("new-plugin my_force"),
        "run " + scene + " --frames 0 --set water.spacing=0.1 --quiet --stats stats.json"}) {
    const ChildResult result = runInShell(command + " >/dev/full", folder.path());
    EXPECT_EQ(result.code, 5) << command << ": " << result.err;
    EXPECT_CONTAINS(result.err, "standard output cannot be written");
    EXPECT_EQ(result.err.find("mistake in the program"), std::string::npos) << command;
  }
}

// Were they not opened, the scene or a pipe to a plugin's copy would become standard output.
TEST(StandardStreams, ClosedOnesDisableNothing) {
  const TemporaryFolder folder;
  const std::string run = "run " + resourcesFolder() +
                          "/scenes/dam_break.json --frames 1 --set water.spacing=0.1 --stats stats.json";
  for (const std::string closed : {"<&- >&-", ">&-", "<&-", "<&- >&- 2>&-"}) {
    const ChildResult result = runInShell(run + " " + closed, folder.path());
    EXPECT_EQ(result.code, 0) << closed << ": " << result.err;
    EXPECT_EQ(result.err.find("plugin"), std::string::npos) << result.err;
    const std::string stats = readFile(folder / "stats.json");
    EXPECT_EQ(stats.substr(0, 1), "{");
    EXPECT_EQ(stats.find("stats.json\n"), std::string::npos) << "it is not standard output";
  }
  const ChildResult info = runInShell("info <&-", folder.path());
  EXPECT_EQ(info.out, runWeir({"info"}).out);
}

}  // namespace
}  // namespace weir::test
