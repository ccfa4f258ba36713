// Where images are, and what they show.
#include "framework/particles/periodic_images.h"

#include "framework/compute/parallel.h"

namespace weir {

namespace {

struct Wrap {
  Period period;
  ArrayView<Vec3f> positions;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    if (isFinite(p)) positions[i] = period.wrapped(p);
  }
};

/// The images of a particle that are within reach of the box.
struct ImagesOf {
  Period period;
  float reach;
  ArrayView<const Vec3f> positions;

  /// f(turns)
  template <class F>
  WEIR_HD void operator()(std::int64_t i, const F& f) const {
    const Vec3f p = positions[i];
    forEachImage(period, [&](const Vec3i& turns) {
      const bool isItself = turns.x == 0 && turns.y == 0 && turns.z == 0;
      if (!isItself && isSeen(p, turns)) f(turns);
    });
  }

 private:
  WEIR_HD bool isSeen(const Vec3f& p, const Vec3i& turns) const {
    bool seen = true;
    for (int axis = 0; axis < 3; ++axis) {
      const float fromLow = p[axis] - period.lo[axis];
      if (turns[axis] > 0) seen = seen && fromLow < reach;
      if (turns[axis] < 0) seen = seen && period.size[axis] - fromLow < reach;
    }
    return seen;
  }
};

struct CountImages {
  ImagesOf imagesOf;
  std::int64_t particles;
  ArrayView<int> counts;  // one more than there are particles

  WEIR_HD void operator()(std::int64_t i) const {
    int count = 0;
    if (i < particles) imagesOf(i, [&](const Vec3i&) { ++count; });
    counts[i] = count;
  }
};

struct WriteImages {
  ImagesOf imagesOf;
  ArrayView<const int> firsts;
  ArrayView<int> owners;
  ArrayView<Vec3f> shifts;

  WEIR_HD void operator()(std::int64_t i) const {
    int k = firsts[i];
    imagesOf(i, [&](const Vec3i& turns) {
      owners[k] = static_cast<int>(i);
      shifts[k++] = imagesOf.period.shift(turns);
    });
  }
};

struct ShiftImages {
  ArrayView<const Vec3f> shifts;
  std::int64_t first;
  ArrayView<Vec3f> positions;
  WEIR_HD void operator()(std::int64_t k) const { positions[first + k] += shifts[k]; }
};

template <class T>
struct ShowValues {
  ArrayView<const int> owners;
  ArrayView<const Vec3f> shifts;
  std::int64_t first;
  ArrayView<T> values;

  WEIR_HD void operator()(std::int64_t k) const { values[first + k] = shown(values[owners[k]], shifts[k]); }

 private:
  WEIR_HD static float shown(float value, const Vec3f&) { return value; }
  WEIR_HD static Vec3f shown(const Vec3f& value, const Vec3f&) { return value; }
  WEIR_HD static Vec4f shown(const Vec4f& at, const Vec3f& shift) {
    return {at.x + shift.x, at.y + shift.y, at.z + shift.z, at.w};
  }
};

}  // namespace

template <class Backend>
void PeriodicImages::wrapOn(Backend& device) {
  parallelFor(device, "wrap", particles_.count(), Wrap{period_, particles_.positions().write()});
}

template <class Backend>
void PeriodicImages::findOn(Backend& device) {
  const std::int64_t n = particles_.bound();
  firsts_.resizeDiscarding(n + 1);
  const ImagesOf imagesOf{period_, reach_, particles_.positions().read()};
  parallelFor(device, "count images", n + 1, CountImages{imagesOf, n, firsts_.view()});
  exclusiveScan(device, std::as_const(firsts_).view(), firsts_.view(), n + 1);
  int images = 0;
  particles_.device().download(&images, firsts_.data() + n, sizeof(images));
  if (images > owners_.capacity()) {  // such that a few more take no new memory
    const std::int64_t room = grownSize(owners_.capacity(), images);
    owners_.reserveDiscarding(room);
    shifts_.reserveDiscarding(room);
  }
  owners_.resizeDiscarding(images);
  shifts_.resizeDiscarding(images);
  parallelFor(device, "images", n,
              WriteImages{imagesOf, std::as_const(firsts_).view(), owners_.view(), shifts_.view()});
}

template <class Backend>
void PeriodicImages::shiftOn(Backend& device) {
  parallelFor(device, "shift", owners_.size(),
              ShiftImages{std::as_const(shifts_).view(), particles_.bound(), particles_.positions().write()});
}

template <class Backend, class T>
void PeriodicImages::refreshOn(Backend& device, ArrayView<T> values) {
  parallelFor(device, "images", owners_.size(),
              ShowValues<T>{std::as_const(owners_).view(), std::as_const(shifts_).view(), particles_.bound(),
                            values});
}

template void PeriodicImages::wrapOn(ThisBackend&);
template void PeriodicImages::findOn(ThisBackend&);
template void PeriodicImages::shiftOn(ThisBackend&);
template void PeriodicImages::refreshOn(ThisBackend&, ArrayView<float>);
template void PeriodicImages::refreshOn(ThisBackend&, ArrayView<Vec3f>);
template void PeriodicImages::refreshOn(ThisBackend&, ArrayView<Vec4f>);

}  // namespace weir
