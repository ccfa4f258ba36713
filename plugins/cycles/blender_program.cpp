#include "plugins/cycles/blender_program.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <span>
#include <sstream>
#include <system_error>
#include <thread>

#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "framework/base/value.h"
#include "framework/scene/scene_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr const char* kVariable = "WEIR_BLENDER";
constexpr const char* kHint =
    "install Blender (https://www.blender.org, or apt install blender), or put its Python module into a "
    "Python (pip install bpy) and name that: WEIR_BLENDER=/path/to/python";
constexpr ProgramLimits kLimits{.idle = std::chrono::seconds(600), .end = std::chrono::seconds(60)};

bool isOnPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

bool hasModule(const std::string& python) {
  // A folder of that name beside the run is no module.
  constexpr const char* kAsk =
      "import importlib.util, sys; spec = importlib.util.find_spec('bpy'); "
      "sys.exit(spec is None or spec.origin is None)";
  try {
    PipedProgram asked(python, {"-B", "-c", kAsk}, kLimits);
    return asked.finish();
  } catch (const std::system_error&) {
    return false;
  }
}

BlenderCall byPython(const std::string& python, const fs::path& script) {
  return {python, {"-B", script.string()}};
}

BlenderCall byBlender(const std::string& blender, const fs::path& script) {
  return {blender,
          {"--background", "--factory-startup", "--python-exit-code", "1", "--python", script.string()}};
}

BlenderCall named(const std::string& program, const fs::path& script) {
  if (::access(program.c_str(), X_OK) != 0 || fs::is_directory(program))
    throw ioError(
        fmt::format("{} names {}, which is no program that can be run", kVariable, printable(program, 200)),
        "the path of a Blender, or of a Python with its module bpy", kHint);
  if (!fs::path(program).filename().string().starts_with("python")) return byBlender(program, script);
  if (hasModule(program)) return byPython(program, script);
  throw ioError(
      fmt::format("{} names the Python {}, which has no module bpy", kVariable, printable(program, 200)),
      "the path of a Blender, or of a Python with its module bpy", kHint);
}

/// The last line that the script wrote for the user; "" if it has written none.
std::string wordsFor(const std::string& messages) {
  constexpr std::string_view kMark = "weir: ";
  std::string words;
  std::istringstream lines(messages);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(kMark)) words = line.substr(kMark.size());
  return words;
}

}  // namespace

fs::path blenderFolder() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&blenderFolder), &self) == 0) return {};
  return fs::absolute(self.dli_fname).parent_path() / "../../../share/weir/blender";
}

BlenderCall findBlender(const fs::path& script) {
  if (const char* program = std::getenv(kVariable); program != nullptr && *program != '\0')
    return named(program, script);
  if (isOnPath("blender")) return byBlender("blender", script);
  if (hasModule("python3")) return byPython("python3", script);
  throw ioError(
      "there is no Blender here, which renders with Cycles: no program blender is on the PATH, and python3 "
      "has "
      "no module bpy",
      "", kHint);
}

BlenderProgram::BlenderProgram() : call_(findBlender(blenderFolder() / "weir_blender/worker.py")) {
  try {
    program_ = std::make_unique<PipedProgram>(call_.program, call_.arguments, kLimits);
  } catch (const std::system_error& error) {
    throw ioError(printable(call_.program, 200) + " cannot be started: " + error.code().message(), "", kHint);
  }
}

BlenderProgram::~BlenderProgram() {
  program_->finish();
}

bool BlenderProgram::render(const fs::path& frame, const fs::path& picture) {
  return ask(frame, "picture", picture);
}

bool BlenderProgram::save(const fs::path& frame, const fs::path& blend) {
  return ask(frame, "blend", blend);
}

bool BlenderProgram::ask(const fs::path& frame, const std::string& what, const fs::path& file) {
  constexpr std::chrono::milliseconds kPause(10);
  std::error_code error;
  fs::remove(file, error);
  Value request = Value::object();
  request["frame"] = fs::absolute(frame).string();
  request[what] = fs::absolute(file).string();
  const std::string line = writeJsonLine(request);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(line.data());
  if (!program_->write({bytes, line.size()})) throw failure();
  // The file takes its name when it is whole.
  while (!fs::exists(file, error)) {
    if (Interruption::asked()) {
      program_->cancel();
      program_->finish();
      return false;
    }
    if (!program_->isRunning() && !fs::exists(file, error)) throw failure();
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

Error BlenderProgram::failure() {
  program_->finish();
  const std::string words = wordsFor(program_->messages());
  const std::string name = fs::path(call_.program).filename().string();
  return ioError(fmt::format("Blender ({}) {}: {}", printable(name, 100), program_->ending(),
                             printable(words.empty() ? program_->messages() : words, 2000)));
}

}  // namespace weir::rendering
