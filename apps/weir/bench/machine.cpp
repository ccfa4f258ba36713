#include "apps/weir/bench/machine.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <ctime>

#include "framework/base/build_info.h"

namespace weir::app {

namespace {

std::string systemName() {
  utsname name{};
  if (uname(&name) != 0) return "unknown";
  return fmt::format("{} {} {}", name.sysname, name.release, name.machine);
}

std::string cpuDescription() {
  for (const DeviceInfo& info : listDevices())
    if (info.name == "cpu") return info.description;
  return "unknown";
}

Value deviceValue(const Device& device) {
  Value v = Value::object();
  v["name"] = device.name();
  v["back_end"] = device.kind() == DeviceKind::kCpu ? "cpu" : "cuda";
  v["description"] = device.description();
  v["deterministic"] = device.deterministic();
  if (device.kind() == DeviceKind::kCpu) {
    const auto& cpu = static_cast<const CpuBackend&>(device);
    v["threads"] = cpu.threads();
    v["isa"] = cpuIsaName(cpu.isa());
  }
  return v;
}

}  // namespace

Value machineValue(const Device& device) {
  Value v = Value::object();
  v["version"] = version();
  v["commit"] = buildCommit();
  v["build_type"] = buildType();
  v["compiler"] = compilerName();
  v["cuda"] = cudaBuildInfo();
  v["system"] = systemName();
  v["cpu"] = cpuDescription();
  v["device"] = deviceValue(device);
  v["date"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return v;
}

}  // namespace weir::app
