// The group "cycles" in the "render" section of a scene file: pictures by Blender's path tracer.
#pragma once

#include <array>
#include <optional>

#include "framework/graph/configurable.h"

namespace weir {

namespace rendering {
/// What draws pictures.
enum class PictureEngine { kWeir, kCycles };
/// On what Cycles computes.
enum class CyclesDevice { kAuto, kCpu, kGpu };
}  // namespace rendering

template <>
struct EnumNames<rendering::PictureEngine> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"weir", "Weir itself, in milliseconds."},
      EnumName{"cycles", "Cycles, the path tracer of Blender, which must be installed: final pictures."}};
};

template <>
struct EnumNames<rendering::CyclesDevice> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"auto", "A GPU that Blender can use, or else the CPU."}, EnumName{"cpu", "The CPU."},
      EnumName{"gpu", "A GPU; the run ends if there is none."}};
};

namespace rendering {

class CyclesSettings final : public Configurable {
 public:
  Param<int> samples{*this,
                     "samples",
                     128,
                     {.min = 1, .max = 65536, .softMax = 4096, .doc = "Paths of light in a pixel, at most."}};
  Param<float> noise{
      *this,
      "noise",
      0.02f,
      {.min = 0,
       .max = 1,
       .doc = "A pixel that is less noisy than this gets no more samples; 0: all get all of them."}};
  Param<bool> denoise{
      *this, "denoise", true, {.doc = "Remove the noise that is left, where this Blender can."}};
  Param<CyclesDevice> device{*this, "device", CyclesDevice::kAuto, {.doc = "On what it computes."}};
  Param<bool> caustics{*this,
                       "caustics",
                       false,
                       {.doc = "Glass and water gather the light that they throw. It takes many samples."}};
  Param<float> shutter{
      *this,
      "shutter",
      0,
      {.unit = "frames",
       .min = 0,
       .max = 1,
       .doc = "How long the shutter is open: blurs what moves. 0.5 is that of films; 0: no blur."}};
  Param<float> aperture{*this,
                        "aperture",
                        0,
                        {.unit = "m",
                         .min = 0,
                         .max = 100,
                         .doc = "Diameter of the lens: blurs what is out of focus. 0: all is sharp."}};
  Param<std::optional<float>> focus{
      *this,
      "focus",
      std::nullopt,
      {.unit = "m",
       .min = 1e-6,
       .doc = "Distance from the camera at which all is sharp; that of its target if it is left out."}};
};

}  // namespace rendering
}  // namespace weir
