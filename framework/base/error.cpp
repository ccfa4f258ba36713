#include "framework/base/error.h"

#include <utility>

#include "framework/base/text.h"

namespace weir {

Error::Error(ErrorKind kind, std::string message, std::string allowed, std::string hint)
    : kind_(kind), message_(std::move(message)), allowed_(std::move(allowed)), hint_(std::move(hint)) {
  compose();
}

namespace {
void fill(std::string& to, const std::string& from) {
  if (to.empty()) to = from;
}
}  // namespace

Error& Error::at(Location location) {
  if (location_.line == 0 && (location_.file.empty() || location_.file == location.file)) {
    location_.line = location.line;
    location_.column = location.column;
  }
  fill(location_.file, location.file);
  fill(location_.pointer, location.pointer);
  fill(location_.node, location.node);
  fill(location_.parameter, location.parameter);
  fill(location_.part, location.part);
  compose();
  return *this;
}

Error& Error::inNode(const std::string& name) {
  return at({.node = name});
}

Error& Error::inParameter(const std::string& name) {
  return at({.parameter = name});
}

void Error::compose() {
  // Pointers and names hold keys as the user wrote them, which may be anything.
  constexpr std::size_t kLongestShown = 200, kLongestPath = 4096;
  std::string where = printable(location_.file, kLongestPath);
  if (location_.line > 0)
    where += ":" + std::to_string(location_.line) + ":" + std::to_string(location_.column);
  const auto append = [&](const std::string& part) {
    if (!part.empty()) where += (where.empty() ? "" : ": ") + part;
  };
  append(printable(location_.pointer, kLongestShown));
  if (!location_.node.empty()) append("node " + inQuotes(location_.node));
  if (!location_.parameter.empty()) append("parameter " + inQuotes(location_.parameter));
  append(printable(location_.part, kLongestShown));

  text_ = where.empty() ? message_ : where + ": " + message_;
  if (!allowed_.empty()) text_ += "\n  allowed: " + allowed_;
  if (!hint_.empty()) text_ += "\n  hint: " + hint_;
}

ExitCode exitCode(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return kUsage;
    case ErrorKind::kScene:
      return kInvalidScene;
    case ErrorKind::kSimulation:
      return kSimulationFailed;
    case ErrorKind::kIo:
      return kIoFailed;
  }
  return kSimulationFailed;
}

}  // namespace weir
