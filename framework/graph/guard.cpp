#include "framework/graph/guard.h"

#include <exception>
#include <new>

#include "framework/base/error.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "framework/communication/communicator.h"

namespace weir {

void callGuarded(std::string_view source, const std::function<std::string()>& part,
                 const std::function<void()>& f, bool filesSayEnough) {
  if (source == kOwnSource) return f();
  try {
    f();
  } catch (Error& e) {
    if (!filesSayEnough || e.location().file.empty()) e.at({.part = part()});
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const RanksEnded&) {
    throw;
  } catch (const std::exception& e) {
    throw simulationError("it threw an exception: " + printable(e.what(), 500)).at({.part = part()});
  } catch (...) {
    throw simulationError("it threw an exception of a kind that says nothing").at({.part = part()});
  }
}

std::string hookText(std::string_view what, std::string_view hook, std::string_view source) {
  std::string text(what);
  if (!text.empty() && !hook.empty()) text += ", ";
  return text.append(hook).append(text.empty() ? "(" : " (").append(source).append(")");
}

void GuardedPart::call(std::string_view hook, const std::function<void()>& f) const {
  constexpr bool kFilesSayEnough = true;
  callGuarded(
      source, [&] { return hookText(what, hook, source); }, f, kFilesSayEnough);
}

}  // namespace weir
