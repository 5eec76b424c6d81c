#include "core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace strata {
namespace {
spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> instance = [] {
    auto made = spdlog::stderr_color_mt("strata");
    made->set_pattern("%^%l%$: %v");
    return made;
  }();
  return *instance;
}
}  // namespace

void logInfo(const std::string& message) { logger().info("{}", message); }
void logWarning(const std::string& message) { logger().warn("{}", message); }
void setQuiet(bool quiet) { logger().set_level(quiet ? spdlog::level::warn : spdlog::level::info); }

}  // namespace strata
