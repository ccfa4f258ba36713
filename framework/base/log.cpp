#include "framework/base/log.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <memory>

namespace weir {

void Log::write(LogLevel level, std::string_view message) {
  if (!sink_ || level < minLevel_) return;
  const std::scoped_lock lock(mutex_);
  sink_(level, message);
}

void Log::warnOnce(const std::string& message) {
  {
    const std::scoped_lock lock(mutex_);
    if (!seen_.insert(message).second) return;
  }
  warn(message);
}

Log::Sink stderrSink() {
  auto logger =
      std::make_shared<spdlog::logger>("weir", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%^%l%$: %v");
  logger->set_level(spdlog::level::trace);
  return [logger](LogLevel level, std::string_view message) {
    constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::debug, spdlog::level::info,
                                                     spdlog::level::warn, spdlog::level::err};
    logger->log(kLevels[static_cast<int>(level)], message);
  };
}

}  // namespace weir
