#include "nodes/rigid_body/body_contact.h"

#include "framework/compute/compact_once.h"
#include "framework/compute/reductions.h"
#include "nodes/rigid_body/move_on.h"
#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace {

struct MoveOn {
  FreeBody* body;
  Vec3d gravity;
  double dt;

  WEIR_HD void operator()(std::int64_t) const { moveOn(*body, gravity, dt); }
};

struct Walls {
  ArrayView<const BoundaryPiece> pieces;

  template <class F>
  WEIR_HD void forEachNear(const Vec3f& p, const F& f) const {
    for (std::int64_t k = 0; k < pieces.size; ++k) forEachWall(pieces[k], p, f);
  }
};

struct DepthInWalls {
  Walls walls;
  BodyMass mass;
  BodyState at;
  ArrayView<const Vec3f> vertices;

  WEIR_HD float operator()(std::int64_t i) const {
    const Vec3d p = at.center + rotate(at.rotation, doubleOf(vertices[i]) - mass.center);
    float depth = 0;
    walls.forEachNear(floatOf(p),
                      [&](float distance, const Vec3f&) { depth = -distance > depth ? -distance : depth; });
    return depth;
  }
};

struct NearWalls {
  Walls walls;
  const FreeBody* body;
  ArrayView<const Vec3f> vertices;
  double dt;

  /// Whether it may reach a wall in this step or while the body is turned out of others.
  WEIR_HD bool operator()(std::int64_t i) const {
    const BodyState& state = body->state;
    const Vec3d arm = rotate(state.rotation, doubleOf(vertices[i]) - body->mass.center);
    const double reach = 2 * dt * length(body->motion.at(arm));
    bool near = false;
    walls.forEachNear(floatOf(state.center + arm),
                      [&](float distance, const Vec3f&) { near = near || double(distance) <= reach; });
    return near;
  }
};

/// Of one body.
struct HoldBody {
  FreeBody* body;
  Walls walls;
  ArrayView<const Vec3f> vertices;
  ArrayView<const int> near;
  const int* count;
  ContactMaterial material;
  double dt, bounces;  // m/s: what is slower does not bounce

  static constexpr int kMaxContacts = 64, kSweeps = 40;

  struct Contact {
    Vec3d normal, arm;
    double approach;    // −n·u at first
    double wanted;      // the least n·u'
    double distance;    // m, at the end of the step
    double pushed = 0;  // N·s along the normal
    Vec3d rubbed;       // and along the wall
  };

  WEIR_HD void operator()(std::int64_t) const {
    Contact contacts[kMaxContacts];
    const int found = find(contacts);
    if (found == 0) return;
    FreeBody& b = *body;
    const Inverse inverse(b.mass, b.state.rotation);
    Twist change;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (int c = 0; c < found; ++c) hold(contacts[c], inverse, change);
    SolidImpulse sum;
    for (int c = 0; c < found; ++c) {
      const Vec3d j = contacts[c].pushed * contacts[c].normal + contacts[c].rubbed;
      sum += {j, cross(contacts[c].arm, j)};
    }
    const SolidImpulse taken = b.mass.taken(sum);
    b.state.velocity += taken.linear / b.mass.mass;
    b.state.spin += taken.angular;
    b.state = b.state.moved(dt * change);
    moveOut(contacts, found, inverse, dt * change);
    b.motion = twistOf(b.mass, b.state);
  }

 private:
  /// Of the matrix of mass and inertia, without what is locked.
  struct Inverse {
    Twist column[6];

    WEIR_HD Inverse(const BodyMass& mass, const Quatd& rotation) {
      const TwistMatrix matrix = mass.matrix(rotation);
      for (int k = 0; k < 6; ++k) {
        Twist unit;
        (k < 3 ? unit.linear[k] : unit.angular[k - 3]) = 1;
        column[k] = solved(matrix, unit, mass.locked);
      }
    }
    /// By an impulse j at `arm`.
    WEIR_HD Twist changeBy(const Vec3d& j, const Vec3d& arm) const {
      const Vec3d moment = cross(arm, j);
      Twist sum;
      for (int k = 0; k < 3; ++k) {
        sum += j[k] * column[k];
        sum += moment[k] * column[k + 3];
      }
      return sum;
    }
    /// m/s along `direction` at `arm`, of an impulse of 1 there.
    WEIR_HD double mobility(const Vec3d& direction, const Vec3d& arm) const {
      return dot(direction, changeBy(direction, arm).at(arm));
    }
  };

  /// Deepest first where there are more than can be held.
  WEIR_HD int find(Contact (&contacts)[kMaxContacts]) const {
    int found = 0;
    const FreeBody& b = *body;
    for (int k = 0; k < *count; ++k) {
      const Vec3d arm = rotate(b.state.rotation, doubleOf(vertices[near[k]]) - b.mass.center);
      const Vec3d u = b.motion.at(arm);
      walls.forEachNear(floatOf(b.state.center + arm), [&](float distance, const Vec3f& normal) {
        const Vec3d n = doubleOf(normal);
        const double d = distance, along = dot(n, u), before = d - dt * along;
        if (d > 2 * dt * length(u)) return;
        double wanted = -(before > 0 ? before : 0.0) / dt;
        if (d < 0 && -along > bounces) {
          const double back = -material.restitution * along;
          wanted = back > wanted ? back : wanted;
        }
        add({.normal = n, .arm = arm, .approach = -along, .wanted = wanted, .distance = d, .rubbed = {}},
            contacts, found);
      });
    }
    return found;
  }

  WEIR_HD static void add(const Contact& contact, Contact (&contacts)[kMaxContacts], int& found) {
    if (found < kMaxContacts) {
      contacts[found++] = contact;
      return;
    }
    int farthest = 0;
    for (int c = 1; c < kMaxContacts; ++c)
      if (contacts[c].distance > contacts[farthest].distance) farthest = c;
    if (contact.distance < contacts[farthest].distance) contacts[farthest] = contact;
  }

  WEIR_HD void hold(Contact& contact, const Inverse& inverse, Twist& change) const {
    const Vec3d n = contact.normal;
    const double mobility = inverse.mobility(n, contact.arm);
    if (!(mobility > 0)) return;  // it is locked
    const double along = dot(n, change.at(contact.arm)) - contact.approach;
    const double before = contact.pushed, wanted = before + (contact.wanted - along) / mobility;
    contact.pushed = wanted > 0 ? wanted : 0;
    change += inverse.changeBy((contact.pushed - before) * n, contact.arm);
    rub(contact, inverse, change);
  }

  WEIR_HD void rub(Contact& contact, const Inverse& inverse, Twist& change) const {
    const double most = material.friction * contact.pushed;
    const Vec3d before = contact.rubbed;
    if (most == 0 && dot(before, before) == 0) return;
    const Vec3d u = (body->motion - -1.0 * change).at(contact.arm);
    const Vec3d slides = u - dot(u, contact.normal) * contact.normal;
    const double speed = length(slides);
    Vec3d wanted = before;
    if (speed > 0) {
      const double mobility = inverse.mobility(slides / speed, contact.arm);
      if (!(mobility > 0)) return;
      wanted = before - slides / mobility;
    }
    const double size = length(wanted);
    contact.rubbed = size > most ? (most / size) * wanted : wanted;
    change += inverse.changeBy(contact.rubbed - before, contact.arm);
  }

  /// The same for places: what is still in a wall after the body has gone `way`.
  WEIR_HD void moveOut(Contact (&contacts)[kMaxContacts], int found, const Inverse& inverse,
                       const Twist& way) const {
    Twist out;
    for (int c = 0; c < found; ++c) contacts[c].pushed = 0;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (int c = 0; c < found; ++c) {
        Contact& contact = contacts[c];
        const double mobility = inverse.mobility(contact.normal, contact.arm);
        if (!(mobility > 0)) continue;
        const double depth = -contact.distance - dot(contact.normal, (way - -1.0 * out).at(contact.arm));
        const double before = contact.pushed, wanted = before + depth / mobility;
        contact.pushed = wanted > 0 ? wanted : 0;
        out += inverse.changeBy((contact.pushed - before) * contact.normal, contact.arm);
      }
    body->state = body->state.moved(out);
  }
};

}  // namespace

template <class Backend>
void BodyContact::stepOn(Backend& device, Array<FreeBody>& body, const Vec3f& gravity, double dt,
                         bool holds) {
  constexpr double kSteps = 2;  // of a fall
  parallelFor(device, "move on", 1, MoveOn{body.data(), doubleOf(gravity), dt});
  if (!holds || pieces_.empty()) return;
  const Walls walls{std::as_const(pieces_).view()};
  const ArrayView<const Vec3f> vertices = std::as_const(vertices_).view();
  compactOnce(device, "near walls", vertices.size, NearWalls{walls, body.data(), vertices, dt}, marks_,
              near_.view(), nearCount_.data());
  parallelFor(device, "hold", 1,
              HoldBody{body.data(), walls, vertices, std::as_const(near_).view(), nearCount_.data(),
                       material_, dt, kSteps * dt * length(doubleOf(gravity))});
}

template <class Backend>
void BodyContact::depthOn(Backend& device, const BodyMass& mass, const BodyState& at) {
  reduce(device, "depth", vertices_.size(), 0.0f,
         DepthInWalls{{std::as_const(pieces_).view()}, mass, at, std::as_const(vertices_).view()}, Max{},
         depth_.data());
}

template void BodyContact::depthOn(ThisBackend&, const BodyMass&, const BodyState&);
template void BodyContact::stepOn(ThisBackend&, Array<FreeBody>&, const Vec3f&, double, bool);

}  // namespace weir
