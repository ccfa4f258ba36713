// weir nodes, weir schema and weir info: what this program can do, from what registered itself.
#pragma once

#include <string>
#include <string_view>

#include "apps/weir/program.h"

namespace weir::app {

/// Text broken into lines that fit a terminal, all but the first one indented.
std::string wrapped(std::string_view text, std::size_t indent);

/// All node and module types in a line each.
std::string describeAll(const Registry& registry);
/// One node or module type with its ports, parameters and modules. Throws a usage Error with a suggestion for
/// an unknown type.
std::string describeType(const Registry& registry, const std::string& type);
/// The same as data: an object {"nodes": {…}, "modules": {…}}, of one type if `type` is not empty.
Value typesAsValue(const Registry& registry, const std::string& type);

/// Version, build, devices, plugins and what they say of themselves.
std::string describeProgram(const Program& program, const Registry& registry);

}  // namespace weir::app
