// Numbers with a unit in scene files: "5 cm", "90 deg", "1 g/cm^3".
#pragma once

#include <optional>
#include <string_view>

#include "framework/graph/place.h"

namespace weir {

struct ParamSpec;

/// Whether a text is a number with a unit that is known.
bool isQuantity(std::string_view text);

/// The number that the text "NUMBER UNIT" is in the unit of a parameter. No value if the text does not begin
/// as a number with something behind it; throws a scene Error if the unit is not one of that parameter.
std::optional<double> quantityIn(const ParamSpec& spec, const Value& v, const Place& place);

}  // namespace weir
