// The layout in which Weir writes JSON and scene files.
#pragma once

#include <string>
#include <string_view>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// The text of a scene file in the layout that Weir writes: one member a line, indented by two; arrays and
/// objects of up to 100 columns on one line, unless a comment ends a line in them or a line between their
/// items is empty; as many numbers of a long list on a line as fit; no trailing commas. Names, numbers, texts
/// and comments stay as they are, in their order. The text must be one that parseScene or parseJson takes.
std::string inLayout(std::string_view text);

/// The same for any text. Throws a scene Error with the place if parseScene does not take it.
std::string formattedScene(std::string_view text, const std::string& fileName);

}  // namespace weir
