// What clients send: the members of their messages. A missing or wrong one is a usage Error.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "framework/base/value.h"
#include "framework/run/live_pictures.h"

namespace weir::studio {

const Value& member(const Value& message, std::string_view name);
std::string textMember(const Value& message, std::string_view name);
std::int64_t wholeMember(const Value& message, std::string_view name, std::int64_t least, std::int64_t most);
bool switchMember(const Value& message, std::string_view name);

/// The members "eye" and "target", and "up" and "fov" where they are given.
LiveCamera cameraOf(const Value& message);
/// Of a picture: the camera, and "width", "height" and "samples" where they are given.
LivePictureOptions pictureOptionsOf(const Value& message);

}  // namespace weir::studio
