// SPDX-License-Identifier: BSD-3-Clause
// Progress in, abort out: the one interface between a running stage and whoever started it.
#pragma once

#include <string>

#include "Types.h"

namespace pm {

/// Stages call check() from one thread, at least every few tenths of a second; the default does nothing.
class Monitor {
 public:
  virtual ~Monitor() = default;
  /// fraction in [0,1] of the running stage; pass is its caption, e.g. "front smoothing".
  virtual void progress(double fraction, const std::string& pass) { (void)fraction, (void)pass; }
  virtual bool aborted() const { return false; }
  /// Something the user should read though the stage goes on.
  virtual void warning(const std::string& sentence) { (void)sentence; }
  /// Reports progress, then throws AbortError when the user asked to stop.
  void check(double fraction, const std::string& pass) {
    progress(fraction, pass);
    if (aborted()) throw AbortError("Stopped on request during " + pass + ".");
  }
};

}  // namespace pm
