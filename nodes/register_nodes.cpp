#include "nodes/register_nodes.h"

#include "nodes/body_contacts/body_contacts.h"
#include "nodes/body_contacts/joint.h"
#include "nodes/box_mesh/box_mesh.h"
#include "nodes/emitters/circle_emitter.h"
#include "nodes/emitters/mesh_emitter.h"
#include "nodes/emitters/square_emitter.h"
#include "nodes/fluid_surface/fluid_surface.h"
#include "nodes/gauge/gauge.h"
#include "nodes/mesh_file/mesh_file.h"
#include "nodes/particle_file/particle_file.h"
#include "nodes/particle_fluid/modules/accelerated_solver.h"
#include "nodes/particle_fluid/modules/boundary_collision.h"
#include "nodes/particle_fluid/modules/capillary_force.h"
#include "nodes/particle_fluid/modules/drag.h"
#include "nodes/particle_fluid/modules/neighbor_search.h"
#include "nodes/particle_fluid/modules/pbf.h"
#include "nodes/particle_fluid/modules/predict.h"
#include "nodes/particle_fluid/modules/semi_implicit_solver.h"
#include "nodes/particle_fluid/modules/solid_approach.h"
#include "nodes/particle_fluid/modules/solid_contact.h"
#include "nodes/particle_fluid/modules/surface_tension.h"
#include "nodes/particle_fluid/modules/two_projections.h"
#include "nodes/particle_fluid/modules/viscosity_solver.h"
#include "nodes/particle_fluid/modules/vorticity_confinement.h"
#include "nodes/particle_fluid/modules/wall_integrals.h"
#include "nodes/particle_fluid/modules/xsph.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/rigid_body/rigid_body.h"
#include "nodes/samplers/box_sampler.h"
#include "nodes/samplers/mesh_sampler.h"
#include "nodes/samplers/sphere_sampler.h"
#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "nodes/sink/sink.h"
#include "nodes/static_boundary/static_boundary.h"
#include "nodes/terrain/terrain.h"
#include "nodes/turning_model/turning_model.h"
#include "nodes/white_water/white_water.h"

namespace weir {

void registerNodes(Registry& registry) {
  registry.addNode<BodyContacts>();
  registry.addNode<BoxMesh>();
  registry.addNode<BoxSampler>();
  registry.addNode<CircleEmitter>();
  registry.addNode<FluidSurface>();
  registry.addNode<Gauge>();
  registry.addNode<Joint>();
  registry.addNode<MeshEmitter>();
  registry.addNode<MeshFile>();
  registry.addNode<MeshSampler>();
  registry.addNode<ParticleFile>();
  registry.addNode<ParticleFluid>();
  registry.addNode<RigidBody>();
  registry.addNode<SemiAnalyticalSFI>();
  registry.addNode<Sink>();
  registry.addNode<SphereSampler>();
  registry.addNode<SquareEmitter>();
  registry.addNode<StaticBoundary>();
  registry.addNode<Terrain>();
  registry.addNode<TurningModel>();
  registry.addNode<WhiteWater>();

  registry.addModule<Predict>();
  registry.addModule<SolidApproach>();
  registry.addModule<NeighborSearch>();
  registry.addModule<WallIntegrals>();
  registry.addModule<SemiImplicitSolver>();
  registry.addModule<AcceleratedSolver>();
  registry.addService<MovedParameters>("SemiImplicitSolver", movedFromSemiImplicitSolver);
  registry.addModule<Pbf>();
  registry.addModule<TwoProjections>();
  registry.addModule<ViscositySolver>();
  registry.addModule<Xsph>();
  registry.addService<MovedParameters>("Xsph", strengthOfXsph);
  registry.addModule<SurfaceTension>();
  registry.addModule<CapillaryForce>();
  registry.addModule<VorticityConfinement>();
  registry.addModule<Drag>();
  registry.addModule<BoundaryCollision>();
  registry.addModule<SolidContact>();
}

}  // namespace weir
