// What a scene file may have beyond the plain format: included files, variables, expressions, repetition and
// notes. All are replaced by what they stand for before a scene is built, so nothing behind this knows them.
#pragma once

#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/scene/scene_file.h"

namespace WEIR_API weir {

/// Whether an override sets a variable: let.NAME.
bool setsVariable(const Override& o);

struct ExpandedScene {
  Value plain;  ///< but for units, which the parameters read
  std::vector<Override> overrides;
};
/// Overrides of variables are put in first. The others, in which variables may be named, are given back as
/// they are to be put into the plain scene.
ExpandedScene expandScene(const Value& written, const Place& place, const std::vector<Override>& overrides);

/// The JSON Schema of plain values as one that also takes expressions, units, notes, included files and
/// repetition.
Value withShorthand(Value schema);

}  // namespace weir
