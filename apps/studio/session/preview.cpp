#include "apps/studio/session/preview.h"

#include "framework/graph/outputs_of.h"
#include "framework/particles/particles.h"

namespace weir::studio {

void coarsen(Scene& scene, int times) {
  if (times == 1) return;
  for (const auto& [name, unused] : outputsOf<Particles>(scene.graph)) {
    Node& node = *scene.graph.find(name);
    const Property* spacing = node.findProperty("spacing");
    if (spacing == nullptr || !spacing->value().isNumber()) continue;
    Value values = Value::object();
    values["spacing"] = times * spacing->value().asDouble();
    node.assignAll(values, {});
  }
}

}  // namespace weir::studio
