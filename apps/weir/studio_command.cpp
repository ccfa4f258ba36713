#include "apps/weir/studio_command.h"

#include <spawn.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "apps/weir/describe.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"
#ifdef WEIR_HAS_STUDIO
#include "apps/studio/server/kept_token.h"
#include "apps/studio/session/studio.h"
#endif

namespace weir::app {

namespace fs = std::filesystem;

StudioCommand::StudioCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand("studio", "Compose, tune and watch scenes in the browser")) {
  constexpr int kMaxPort = 65535, kMaxThreads = 1024, kMaxFramesMb = 1 << 20;
  command_->add_option("scene", scene_, "A scene file to begin with")->type_name("SCENE");
  command_
      ->add_option("--folder", folder_,
                   "The folder that may be read and written; the scene's if it is left out")
      ->type_name("DIR");
  command_
      ->add_option("--allow-files", sceneFolders_,
                   "A further folder whose files scenes may read; can be given several times")
      ->type_name("DIR")
      ->take_all();
  command_->add_option("--port", port_, "The port to listen at; a free one if it is left out")
      ->type_name("P")
      ->check(CLI::Range(0, kMaxPort));
  command_
      ->add_option("--host", host_,
                   "The address to listen at; any but 127.0.0.1 lets others in who know the token")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command_->add_option("--device", device_, "auto, cpu, cuda or cuda:N")
      ->type_name("D")
      ->capture_default_str();
  command_->add_option("--threads", threads_, "Threads on the CPU; one a core if it is left out")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxThreads));
  command_
      ->add_option(
          "--frames-mb", framesMb_,
          "Memory for frames to go back to, in MB; where a run has more, every second one is left out")
      ->type_name("MB")
      ->check(CLI::Range(1, kMaxFramesMb))
      ->capture_default_str();
  command_->add_flag(
      "--new-token", newToken_,
      "With --port: a new token; else windows that are open go on with that of the last start");
  command_->add_flag("--no-browser", stay_, "Print the address, and open no browser");
}

#ifdef WEIR_HAS_STUDIO

namespace {

/// Opens the desktop's browser, where there is a desktop.
void openBrowser(std::string address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  std::string program = "xdg-open";
  char* const arguments[] = {program.data(), address.data(), nullptr};
  pid_t child = 0;
  // It is a convenience: the address is on the terminal, too.
  (void)posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ);
}

}  // namespace

int StudioCommand::run() {
  studio::StudioOptions options;
  options.host = host_;
  options.port = port_;
  options.device = device_;
  options.threads = threads_;
  options.maxRecordedBytes = std::int64_t{framesMb_} << 20;
  const fs::path scene = scene_;
  options.folder = !folder_.empty()          ? fs::path(folder_)
                   : scene.has_parent_path() ? scene.parent_path()
                                             : fs::path(".");
  options.sceneFolders.assign(sceneFolders_.begin(), sceneFolders_.end());
  options.page = dataFolder() / "studio";
  options.templates = dataFolder() / "scenes";
  options.tokens = studio::folderOfTokens();
  options.newToken = newToken_;
  options.types = writeJsonLine(typesAsValue(program_.registry(), ""));
  (void)openDevice(device_, threads_);  // a wrong one is told now

  studio::Studio* shown = nullptr;
  Log log([&](LogLevel level, std::string_view text) {
    program_.log().write(level, text);
    if (shown != nullptr) shown->showLog(level, text);
  });
  studio::Studio studio(options, program_.registry(), log);
  shown = &studio;
  if (!scene_.empty())
    studio.open(fs::absolute(scene).lexically_relative(fs::canonical(options.folder)).string());
  print(studio.address() + "\n");
  for (const std::string& address : studio.furtherAddresses()) print(address + "\n");
  finishPrinting();
  if (!stay_) openBrowser(studio.address());

  const Interruption interruption;
  std::jthread watch([&](const std::stop_token& done) {
    while (!done.stop_requested() && !interruption.asked())
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    studio.stop();
  });
  studio.run();
  shown = nullptr;
  return kDone;
}

#else

int StudioCommand::run() {
  throw usageError("this Weir was built without the studio", {},
                   "install Boost 1.74 or later, and build again");
}

#endif

}  // namespace weir::app
