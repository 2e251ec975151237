// SPDX-License-Identifier: BSD-3-Clause
#include "KnownIntersections.h"

#include <mutex>

namespace pm {
namespace {

struct Known {
  std::uint64_t content = 0;
  Id triangles = 0;
  std::shared_ptr<const SelfIntersections> found;

  bool isOf(const SurfaceModel& model) const {
    return found && content == model.contentHash() && triangles == model.triangleCount();
  }
};

}  // namespace

std::shared_ptr<const SelfIntersections> knownIntersections(const SurfaceModel& model, Monitor& monitor) {
  static std::mutex mutex;
  static Known last;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (last.isOf(model)) return last.found;
  }
  auto found = std::make_shared<const SelfIntersections>(selfIntersections(model, monitor));
  const std::lock_guard<std::mutex> lock(mutex);
  last = {model.contentHash(), model.triangleCount(), found};
  return found;
}

}  // namespace pm
