// Where the camera is at a time: between keyframes, on an orbit, and behind what it follows.
#pragma once

#include <optional>

#include "plugins/views/render_settings.h"
#include "plugins/views/view.h"

namespace weir::rendering {

/// The camera at a time in seconds. `resting` is the pose of a camera without keyframes. `followed` is the
/// place of what the camera follows, if there is such a thing: the target goes there, and the eye goes with
/// it.
///
/// Between keyframes eye, target and field of view follow cubics (or straight lines, if the settings say so);
/// before the first and after the last they rest. The cubics' speeds at a keyframe are those of the parabola
/// through it and its neighbours, which for times that are evenly spaced is the spline of E. Catmull and R.
/// Rom (1974), and zero at the ends, so that the camera starts and stops gently.
CameraPose cameraAt(const CameraSettings& settings, const CameraPose& resting, double time,
                    const std::optional<Vec3f>& followed);

}  // namespace weir::rendering
