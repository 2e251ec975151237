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

/// A part of a stage: its progress from 0 to 1 is that of the whole from `from` to `to`.
class PartMonitor : public Monitor {
 public:
  PartMonitor(Monitor& whole, double from, double to) : whole_(whole), from_(from), to_(to) {}
  void progress(double fraction, const std::string& pass) override {
    whole_.progress(from_ + fraction * (to_ - from_), pass);
  }
  bool aborted() const override { return whole_.aborted(); }
  void warning(const std::string& sentence) override { whole_.warning(sentence); }

 private:
  Monitor& whole_;
  const double from_, to_;
};

}  // namespace pm
