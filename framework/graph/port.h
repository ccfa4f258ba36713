// Typed ports, the places where nodes are linked.
//
//   Output<ParticleBatch> particles{*this, "particles", "Particles born in this step."};
//   Input<TriangleMesh>   surface{*this, "surface", "The mesh to sample."};              // exactly one link
//   Inputs<Boundary>      boundaries{*this, "boundaries", "Walls of the fluid."};        // any number of
//   links
//
// A type that travels along links names itself: `static constexpr std::string_view kPortType = "Boundary";`
// the names are compared, so that types from different libraries meet.
//
// Data flows downstream: a node writes its outputs in reset() and step(), and reads its inputs there. Wishes
// flow upstream: if T has a nested type `T::Request`, a node may call `input.request({...})` in configure(),
// which runs from the last node to the first, and the node above reads `output.requested()` in its own
// configure() and later. A fluid asks its emitters and samplers for its particle spacing that way.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/check.h"
#include "framework/base/error.h"

namespace WEIR_API weir {

class Node;
class InputPort;

class Port {
 public:
  virtual ~Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  Node& node() const { return node_; }
  const std::string& name() const { return name_; }
  const std::string& doc() const { return doc_; }
  const std::string& typeName() const { return typeName_; }
  /// "water.fluid", for messages.
  std::string path() const;

 protected:
  Port(Node& node, std::string_view name, std::string_view typeName, std::string_view doc)
      : node_(node), name_(name), typeName_(typeName), doc_(doc) {}

 private:
  Node& node_;
  std::string name_, typeName_, doc_;
};

class OutputPort : public Port {
 public:
  const std::vector<InputPort*>& links() const { return links_; }
  virtual void forgetRequests() {}

 protected:
  OutputPort(Node& node, std::string_view name, std::string_view typeName, std::string_view doc);

 private:
  friend class InputPort;
  std::vector<InputPort*> links_;
};

class InputPort : public Port {
 public:
  bool required() const { return required_; }
  bool many() const { return many_; }
  const std::vector<OutputPort*>& links() const { return links_; }

  /// Throws a scene Error that names both ends if the types differ, the link exists, or the input is taken.
  void link(OutputPort& from);
  void unlink(OutputPort& from);

 protected:
  InputPort(Node& node, std::string_view name, std::string_view typeName, std::string_view doc, bool required,
            bool many);

 private:
  bool required_, many_;
  std::vector<OutputPort*> links_;
};

namespace detail {
template <class T>
struct RequestOf {
  struct type {
    friend bool operator==(const type&, const type&) = default;
  };
};
template <class T>
requires requires {
  typename T::Request;
}
struct RequestOf<T> {
  using type = typename T::Request;
};
}  // namespace detail

template <class T>
class Output final : public OutputPort {
 public:
  using Request = typename detail::RequestOf<T>::type;

  Output(Node& node, std::string_view name, std::string_view doc)
      : OutputPort(node, name, T::kPortType, doc) {}

  T& operator*() { return value_; }
  const T& operator*() const { return value_; }
  T* operator->() { return &value_; }
  const T* operator->() const { return &value_; }

  void addRequest(const InputPort& from, const Request& request) { requests_.emplace_back(&from, request); }
  void forgetRequests() override { requests_.clear(); }
  /// What each link below asks for, of those that ask.
  std::vector<Request> requests() const {
    std::vector<Request> all;
    for (const auto& [input, request] : requests_) all.push_back(request);
    return all;
  }
  /// What the nodes below ask for; empty if none asks. Throws a scene Error if two ask for different things.
  std::optional<Request> requested() const {
    if (requests_.empty()) return std::nullopt;
    for (const auto& [input, request] : requests_)
      if (!(request == requests_.front().second))
        throw sceneError("'" + path() + "' is linked to '" + requests_.front().first->path() + "' and to '" +
                             input->path() + "', which ask it for different things",
                         "links to nodes that agree, such as fluids of the same spacing",
                         "use one such node for each of them");
    return requests_.front().second;
  }

 private:
  T value_{};
  std::vector<std::pair<const InputPort*, Request>> requests_;
};

/// Any number of links.
template <class T>
class Inputs final : public InputPort {
 public:
  Inputs(Node& node, std::string_view name, std::string_view doc, bool required = false)
      : InputPort(node, name, T::kPortType, doc, required, true) {}

  std::size_t size() const { return links().size(); }
  bool empty() const { return links().empty(); }
  /// What arrives on link i, in the order in which the scene has the nodes above.
  T& operator[](std::size_t i) const { return *static_cast<Output<T>&>(*links()[i]); }
  void request(const typename Output<T>::Request& r) const {
    for (OutputPort* link : links()) static_cast<Output<T>&>(*link).addRequest(*this, r);
  }
};

/// At most one link.
template <class T>
class Input final : public InputPort {
 public:
  Input(Node& node, std::string_view name, std::string_view doc, bool required = true)
      : InputPort(node, name, T::kPortType, doc, required, false) {}

  bool linked() const { return !links().empty(); }
  /// Null if there is no link.
  T* get() const { return linked() ? &*static_cast<Output<T>&>(*links().front()) : nullptr; }
  T& operator*() const {
    WEIR_CHECK(linked());
    return *get();
  }
  T* operator->() const { return &**this; }
  void request(const typename Output<T>::Request& r) const {
    for (OutputPort* link : links()) static_cast<Output<T>&>(*link).addRequest(*this, r);
  }
};

}  // namespace weir
