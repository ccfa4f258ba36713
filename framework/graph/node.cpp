#include "framework/graph/node.h"

#include "framework/base/random.h"

namespace weir {

namespace {
template <class P>
P* findByName(const std::vector<P*>& ports, std::string_view name) {
  for (P* port : ports)
    if (port->name() == name) return port;
  return nullptr;
}
}  // namespace

InputPort* Node::findInput(std::string_view name) const {
  return findByName(inputs_, name);
}

OutputPort* Node::findOutput(std::string_view name) const {
  return findByName(outputs_, name);
}

std::uint64_t randomSeed(const Node& node, const SetupContext& context,
                         const std::optional<std::int64_t>& own) {
  if (own) return static_cast<std::uint64_t>(*own);
  const std::string key = std::string(node.info().type) + "#" + std::to_string(node.ordinal());
  return static_cast<std::uint64_t>(context.seed) ^ hashOf(key);
}

}  // namespace weir
