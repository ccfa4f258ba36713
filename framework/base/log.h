// Messages for the person who runs the program. A Log is passed to whoever may speak; there is no global one.
#pragma once

#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "framework/base/api.h"

namespace WEIR_API weir {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

class Log {
 public:
  using Sink = std::function<void(LogLevel, std::string_view message)>;

  /// Without a sink, messages are dropped.
  explicit Log(Sink sink = {}, LogLevel min = LogLevel::kInfo) : sink_(std::move(sink)), minLevel_(min) {}

  void write(LogLevel level, std::string_view message);
  void debug(std::string_view message) { write(LogLevel::kDebug, message); }
  void info(std::string_view message) { write(LogLevel::kInfo, message); }
  void warn(std::string_view message) { write(LogLevel::kWarning, message); }
  void error(std::string_view message) { write(LogLevel::kError, message); }

  /// Writes a warning the first time only that this text comes.
  void warnOnce(const std::string& message);

 private:
  Sink sink_;
  LogLevel minLevel_;
  std::mutex mutex_;
  std::set<std::string> seen_;
};

/// A sink that writes lines to stderr, coloured where stderr is a terminal.
Log::Sink stderrSink();

}  // namespace weir
