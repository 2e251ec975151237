// SPDX-License-Identifier: BSD-3-Clause
// Connects a running kernel stage with the VTK algorithm that started it.
#pragma once

#include "Monitor.h"

class vtkAlgorithm;

namespace pm {

/// Progress and caption go to the algorithm's observers, its abort flag and warnings come back.
class StageMonitor : public Monitor {
 public:
  explicit StageMonitor(vtkAlgorithm* algorithm) : algorithm_(algorithm) {}
  void progress(double fraction, const std::string& pass) override;
  bool aborted() const override;
  void warning(const std::string& sentence) override;

 private:
  vtkAlgorithm* algorithm_;
};

}  // namespace pm
