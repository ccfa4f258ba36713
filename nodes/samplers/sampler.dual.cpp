#include "nodes/samplers/sampler.h"

#include "framework/compute/parallel.h"

namespace weir {

namespace {

/// Mirrors what is outside at the surface, then keeps the distance from it.
struct PutInside {
  BoundaryView outside;
  float contact;
  ArrayView<Vec3f> positions;

  WEIR_HD void operator()(std::int64_t i) const {
    constexpr int kMaxContacts = 4;  // in a corner, leaving one face may mean to cross another
    Vec3f p = positions[i];
    BoundaryHit hit = boundaryQuery(outside, p);
    for (int k = 0; k < kMaxContacts && hit.distance < 0; ++k) {
      p -= 2 * hit.distance * hit.normal;
      hit = boundaryQuery(outside, p);
    }
    for (int k = 0; k < kMaxContacts && hit.distance < contact; ++k) {
      p += (contact - hit.distance) * hit.normal;
      hit = boundaryQuery(outside, p);
    }
    positions[i] = p;
  }
};

}  // namespace

template <class Backend>
void Sampler::putInsideOn(Backend& device, const Region& region) {
  parallelFor(device, "put inside", particles->count,
              PutInside{region.outside->view(), region.contact, particles->positions.view()});
}

template void Sampler::putInsideOn(ThisBackend&, const Region&);

}  // namespace weir
