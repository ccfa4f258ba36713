// The types of particles' attributes: the one list that sorting, checkpoints, exports, pictures, the studio
// and Python go by. A type is added here, and whoever cannot do something with it does not compile.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/mat3.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

enum class AttributeType { kFloat, kVec3, kInt, kMat3, kInt64 };

/// What is known of a type: its name, and the numbers that an element consists of.
template <class T>
struct AttributeTraits;

template <>
struct AttributeTraits<float> {
  static constexpr AttributeType kType = AttributeType::kFloat;
  static constexpr std::string_view kName = "float";
  using Number = float;
  static constexpr std::array<std::string_view, 1> kComponents{""};
};
template <>
struct AttributeTraits<Vec3f> {
  static constexpr AttributeType kType = AttributeType::kVec3;
  static constexpr std::string_view kName = "vec3";
  using Number = float;
  static constexpr std::array<std::string_view, 3> kComponents{"x", "y", "z"};
};
template <>
struct AttributeTraits<int> {
  static constexpr AttributeType kType = AttributeType::kInt;
  static constexpr std::string_view kName = "int";
  using Number = int;
  static constexpr std::array<std::string_view, 1> kComponents{""};
};
template <>
struct AttributeTraits<Mat3f> {
  static constexpr AttributeType kType = AttributeType::kMat3;
  static constexpr std::string_view kName = "mat3";
  using Number = float;
  static constexpr std::array<std::string_view, 9> kComponents{"xx", "xy", "xz", "yx", "yy",
                                                               "yz", "zx", "zy", "zz"};
};
template <>
struct AttributeTraits<std::int64_t> {
  static constexpr AttributeType kType = AttributeType::kInt64;
  static constexpr std::string_view kName = "int64";
  using Number = std::int64_t;
  static constexpr std::array<std::string_view, 1> kComponents{""};
};

template <class... T>
struct AttributeTypeList {
  static constexpr int kSize = sizeof...(T);
  /// One Of<T> of each.
  template <template <class> class Of>
  using TupleOf = std::tuple<Of<T>...>;
  template <template <class> class Of>
  using VariantOf = std::variant<Of<T>...>;
  template <template <class> class Of, class... Args>
  static TupleOf<Of> makeTuple(Args&... args) {
    return TupleOf<Of>(Of<T>(args...)...);
  }
};
/// In the order of the enumeration.
using AttributeTypes = AttributeTypeList<float, Vec3f, int, Mat3f, std::int64_t>;
inline constexpr int kAttributeTypes = AttributeTypes::kSize;

template <class T>
inline constexpr int kNumbersIn = static_cast<int>(AttributeTraits<T>::kComponents.size());

namespace detail {
template <class First, class... Rest, class F>
decltype(auto) withAttributeType(AttributeTypeList<First, Rest...>, AttributeType type, F&& f) {
  static_assert(sizeof(First) == kNumbersIn<First> * sizeof(typename AttributeTraits<First>::Number));
  if constexpr (sizeof...(Rest) > 0)
    if (type != AttributeTraits<First>::kType)
      return withAttributeType(AttributeTypeList<Rest...>{}, type, f);
  return f(std::type_identity<First>{});
}
}  // namespace detail

/// Calls f(std::type_identity<T>{}) with the T of the type.
template <class F>
decltype(auto) withAttributeType(AttributeType type, F&& f) {
  return detail::withAttributeType(AttributeTypes{}, type, f);
}

/// Of a scalar, one component without a name.
inline std::vector<std::string_view> componentsOf(AttributeType type) {
  return withAttributeType(type, []<class T>(std::type_identity<T>) {
    const auto& names = AttributeTraits<T>::kComponents;
    return std::vector<std::string_view>(names.begin(), names.end());
  });
}
inline int numbersIn(AttributeType type) {
  return withAttributeType(type, []<class T>(std::type_identity<T>) { return kNumbersIn<T>; });
}
/// Whether its numbers are whole ones.
inline bool isWhole(AttributeType type) {
  return withAttributeType(type, []<class T>(std::type_identity<T>) {
    return std::is_integral_v<typename AttributeTraits<T>::Number>;
  });
}
inline std::string_view nameOf(AttributeType type) {
  return withAttributeType(type, []<class T>(std::type_identity<T>) { return AttributeTraits<T>::kName; });
}
inline std::vector<std::string> attributeTypeNames() {
  std::vector<std::string> names;
  for (int type = 0; type < kAttributeTypes; ++type) names.emplace_back(nameOf(AttributeType(type)));
  return names;
}
inline std::optional<AttributeType> attributeTypeNamed(std::string_view name) {
  for (int type = 0; type < kAttributeTypes; ++type)
    if (nameOf(AttributeType(type)) == name) return AttributeType(type);
  return std::nullopt;
}

struct AttributeInfo {
  std::string name;
  AttributeType type = AttributeType::kFloat;
  std::string unit;
  std::string doc;
  bool derived = false;   ///< made anew for every frame, so it does not travel with its particle in between
  bool internal = false;  ///< means nothing between steps, so it is neither shown nor exported nor saved
};

}  // namespace weir
