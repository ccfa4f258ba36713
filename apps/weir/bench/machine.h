// What a benchmark ran on, so that its numbers can be told from those of other machines and builds.
#pragma once

#include <string>
#include <string_view>

#include "framework/base/value.h"
#include "framework/compute/device.h"

namespace weir::app {

/// The commit that the program was built from, "34e863f", followed by "-changed" where files differed from
/// it; "unknown" where it was built outside of its repository.
std::string_view buildCommit();

/// version, commit, build_type, compiler, cuda, system, cpu, device {name, back_end, description, threads and
/// isa of the CPU, deterministic}, date (UTC, "2026-11-21T18:00:00Z").
Value machineValue(const Device& device);

}  // namespace weir::app
