#include "plugins/views/frame_kernels.h"

#include <cmath>
#include <limits>

#include "framework/compute/parallel.h"
#include "framework/compute/reductions.h"
#include "framework/particles/single_number.h"

namespace weir::rendering {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <class T>
struct FindNumber {
  ArrayView<const T> elements;
  ArrayView<float> numbers;
  WEIR_HD void operator()(std::int64_t i) const { numbers[i] = singleNumber(elements[i]); }
};

struct FindPart {
  ArrayView<const float> values;
  Vec2f ends;
  ArrayView<float> parts;
  WEIR_HD void operator()(std::int64_t i) const {
    const float part = (values[i] - ends.x) / (ends.y - ends.x);
    parts[i] = part > 0 ? (part < 1 ? part : 1.0f) : 0.0f;
  }
};

struct FindWhiteRadius {
  ArrayView<const float> stored;
  ArrayView<const int> kinds;
  float mean;
  ArrayView<float> radii;
  WEIR_HD void operator()(std::int64_t i) const {
    const auto kind = kinds.size > 0 ? static_cast<WhiteKind>(kinds[i]) : WhiteKind::kSpray;
    const float ratio = stored[i] / mean;
    radii[i] = shownShareOf(kind) * mean * ratio * ratio;
  }
};

struct RangeOfOne {
  ArrayView<const float> values;
  WEIR_HD Vec2f operator()(std::int64_t i) const {
    const float v = values[i];
    const bool finite = v * 0.0f == 0.0f;
    return finite ? Vec2f{v, v} : Vec2f{kInfinity, -kInfinity};
  }
};

struct UniteRanges {
  WEIR_HD Vec2f operator()(const Vec2f& a, const Vec2f& b) const {
    return {a.x < b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
  }
};

struct PointBox {
  ArrayView<const Vec3f> positions;
  WEIR_HD Aabb operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isFinite(p) ? Aabb{p, p} : Aabb{};
  }
};

struct PlaceOfOne {
  ArrayView<const Vec3f> places;
  WEIR_HD PlacesSum operator()(std::int64_t i) const {
    const Vec3f p = places[i];
    return isFinite(p) ? PlacesSum{{p.x, p.y, p.z}, 1} : PlacesSum{};
  }
};

struct AddPlaces {
  WEIR_HD PlacesSum operator()(const PlacesSum& a, const PlacesSum& b) const {
    return {a.sum + b.sum, a.count + b.count};
  }
};

struct IsShown {
  ArrayView<const Vec3f> places;
  ArrayView<const Cut> cuts;
  WEIR_HD bool operator()(std::int64_t i) const {
    const Vec3f place = places[i];
    for (std::int64_t k = 0; k < cuts.size; ++k)
      if (!cuts[k].shows(place)) return false;
    return true;
  }
};

template <class T>
struct Take {
  ArrayView<const int> chosen;
  ArrayView<const T> from;
  ArrayView<T> to;
  WEIR_HD void operator()(std::int64_t i) const { to[i] = from[chosen[i]]; }
};

}  // namespace

template <class Backend, class T>
void findNumbers(Backend& device, ArrayView<const T> elements, ArrayView<float> numbers) {
  parallelFor(device, "numbers", elements.size, FindNumber<T>{elements, numbers});
}

template <class Backend>
void findParts(Backend& device, ArrayView<const float> values, const Vec2f& ends, ArrayView<float> parts) {
  parallelFor(device, "foam", values.size, FindPart{values, ends, parts});
}

template <class Backend>
void findWhiteRadii(Backend& device, ArrayView<const float> stored, ArrayView<const int> kinds, float mean,
                    ArrayView<float> radii) {
  parallelFor(device, "white water", stored.size, FindWhiteRadius{stored, kinds, mean, radii});
}

template <class Backend>
void rangeOf(Backend& device, ArrayView<const float> values, Vec2f* range) {
  reduce(device, "range", values.size, Vec2f{kInfinity, -kInfinity}, RangeOfOne{values}, UniteRanges{},
         range);
}

template <class Backend>
void boxOf(Backend& device, ArrayView<const Vec3f> positions, Aabb* box) {
  reduce(device, "box of spheres", positions.size, Aabb{}, PointBox{positions}, UniteBoxes{}, box);
}

template <class Backend>
void sumOf(Backend& device, ArrayView<const Vec3f> places, PlacesSum* sum) {
  reduce(device, "middle", places.size, PlacesSum{}, PlaceOfOne{places}, AddPlaces{}, sum);
}

template <class Backend>
void chooseShown(Backend& device, ArrayView<const Vec3f> places, ArrayView<const Cut> cuts,
                 ArrayView<int> chosen, int* kept) {
  compact(device, "cut", places.size, IsShown{places, cuts}, chosen, kept);
}

template <class Backend, class T>
void take(Backend& device, ArrayView<const int> chosen, ArrayView<const T> from, ArrayView<T> to) {
  parallelFor(device, "take shown", chosen.size, Take<T>{chosen, from, to});
}

template void findNumbers(ThisBackend&, ArrayView<const int>, ArrayView<float>);
template void findNumbers(ThisBackend&, ArrayView<const std::int64_t>, ArrayView<float>);
template void findNumbers(ThisBackend&, ArrayView<const Vec3f>, ArrayView<float>);
template void findNumbers(ThisBackend&, ArrayView<const Mat3f>, ArrayView<float>);
template void findParts(ThisBackend&, ArrayView<const float>, const Vec2f&, ArrayView<float>);
template void findWhiteRadii(ThisBackend&, ArrayView<const float>, ArrayView<const int>, float,
                             ArrayView<float>);
template void rangeOf(ThisBackend&, ArrayView<const float>, Vec2f*);
template void boxOf(ThisBackend&, ArrayView<const Vec3f>, Aabb*);
template void sumOf(ThisBackend&, ArrayView<const Vec3f>, PlacesSum*);
template void chooseShown(ThisBackend&, ArrayView<const Vec3f>, ArrayView<const Cut>, ArrayView<int>, int*);
template void take(ThisBackend&, ArrayView<const int>, ArrayView<const float>, ArrayView<float>);
template void take(ThisBackend&, ArrayView<const int>, ArrayView<const int>, ArrayView<int>);
template void take(ThisBackend&, ArrayView<const int>, ArrayView<const Vec3f>, ArrayView<Vec3f>);

}  // namespace weir::rendering
