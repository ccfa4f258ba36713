// What the plugin adds to the registry.
#include "framework/graph/plugin_header.h"
#include "plugins/bodies/bullet_dynamics.h"

WEIR_PLUGIN("bodies", "Lets bodies collide and holds them by joints, by Bullet.", registry) {
  registry.addService<weir::BodyDynamics>("bullet", [] { return weir::makeBulletDynamics(); });
}
