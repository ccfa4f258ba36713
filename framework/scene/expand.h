// What a scene file may have beyond the plain format: included files, variables, expressions, repetition and
// notes. All are replaced by what they stand for before a scene is built, so nothing behind this knows them.
#pragma once

#include <string_view>
#include <vector>

#include "framework/scene/scene_file.h"

namespace weir {

/// How a scene is written.
struct WrittenForm {
  bool comments = false;   ///< comments or trailing commas in the text
  bool notes = false;      ///< "note" somewhere
  bool shorthand = false;  ///< $include, let, repeat, an expression or a number with a unit somewhere
  bool isPlain() const { return !comments && !notes && !shorthand; }
};
WrittenForm writtenForm(std::string_view text, const Value& root);

/// Whether an override sets a variable: let.NAME.
bool setsVariable(const Override& o);

/// The scene in plain form, units apart: those are read by the parameters. Overrides of variables are put in
/// first, and those of parameters, in which variables may be named, last.
Value expandScene(const Value& root, const Place& place, const Registry& registry,
                  const std::vector<Override>& overrides);

}  // namespace weir
