#include "nodes/register_nodes.h"

#include "nodes/particle_file/particle_file.h"
#include "nodes/particle_fluid/modules/boundary_collision.h"
#include "nodes/particle_fluid/modules/neighbor_search.h"
#include "nodes/particle_fluid/modules/predict.h"
#include "nodes/particle_fluid/modules/semi_implicit_solver.h"
#include "nodes/particle_fluid/modules/xsph.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/square_emitter/square_emitter.h"
#include "nodes/static_boundary/static_boundary.h"

namespace weir {

void registerNodes(Registry& registry) {
  registry.addNode<ParticleFile>();
  registry.addNode<ParticleFluid>();
  registry.addNode<SquareEmitter>();
  registry.addNode<StaticBoundary>();

  registry.addModule<Predict>();
  registry.addModule<NeighborSearch>();
  registry.addModule<SemiImplicitSolver>();
  registry.addModule<Xsph>();
  registry.addModule<BoundaryCollision>();
}

}  // namespace weir
