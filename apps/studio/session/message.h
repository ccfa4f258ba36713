// What clients send: the members of their messages. A missing or wrong one is a usage Error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "framework/base/value.h"
#include "framework/run/live_pictures.h"

namespace weir::studio {

/// More values than this are refused in a message before it is read: each takes far more memory than in text.
inline constexpr std::size_t kMaxMessageValues = 500'000;

/// The message as a value. Throws an Error if it is no JSON object, or holds too many values.
Value readMessage(std::string_view text);
/// The "id" with which a message begins, where that is a whole number, also of one that cannot be read.
std::optional<std::int64_t> idOf(std::string_view text);

const Value& member(const Value& message, std::string_view name);
std::string textMember(const Value& message, std::string_view name);
std::int64_t wholeMember(const Value& message, std::string_view name, std::int64_t min, std::int64_t max);
/// The member "frame", where it is given: a frame of the run that is looked back at.
std::optional<std::int64_t> frameMember(const Value& message);
bool switchMember(const Value& message, std::string_view name);
/// [x, y, z], m.
Vec3f pointMember(const Value& message, std::string_view name);

/// The members "eye" and "target", and "up" and "fov" where they are given.
LiveCamera cameraOf(const Value& message);
/// Of a picture: the camera, and "width", "height" and "samples" where they are given.
LivePictureOptions pictureOptionsOf(const Value& message);

}  // namespace weir::studio
