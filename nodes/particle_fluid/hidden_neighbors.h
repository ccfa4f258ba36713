// Particles that a solid hides from each other are not neighbours: water on one side of a thin wall must not
// feel the water on the other.
//
// A pair is taken out of the neighbour lists if the straight segment between the two meets a sheet or passes
// through a thin part of a solid, at the predicted positions and with the solid as it stands at the end of
// the step. What the one loses with the other is what the integrals count as solid behind a thin wall
// (solids/solid_integrals.h).
//
// A part is thin if the segment enters it through a triangle with normal n and leaves it through one with
// normal m, and −n·m > 0.9. So pairs across an edge of a thick solid stay: water is on both its sides, and
// there the integrals add nothing. If they came and went as particles pass the edge, each time with a jump of
// the density, water would never rest there, and push 10 % too hard.
//
// Both of a pair ask about the same segment, from the lower index to the higher (on several ranks, the lower
// id), with the same numbers: so lists stay reciprocal. Of an image in a periodic domain the owner's index
// counts, and the sides that it sees.
//
// Few pairs need be asked. Each particle knows for each solid whether triangles within the support radius H
// turn their front or their back to it (the front of a closed solid is where fluid is). A segment shorter
// than H that meets a triangle does so within H of both its ends, and these are on different sides of its
// plane, or on it. So one end must see a front and the other a back. If a segment with both ends in the
// fluid passes through a closed solid, it also leaves it again, through a triangle that the end it came from
// sees from behind, and the same holds the other way round: both ends must see a back. Where walls are
// thicker than H and flat or concave, nobody sees a back, and nothing is asked.
#pragma once

#include "framework/solids/seen_sides.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

/// Edits fluid.neighbors; fluid.walls.sides must be known at the present positions.
template <class Backend>
void takeOutHiddenNeighbors(Backend& device, FluidStep& fluid);

}  // namespace weir
