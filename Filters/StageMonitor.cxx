// SPDX-License-Identifier: BSD-3-Clause
#include "StageMonitor.h"

#include "vtkAlgorithm.h"

namespace pm {

void StageMonitor::progress(double fraction, const std::string& pass) {
  algorithm_->SetProgressText(pass.c_str());
  algorithm_->UpdateProgress(fraction);
}

bool StageMonitor::aborted() const { return algorithm_->GetAbortExecute() != 0; }

void StageMonitor::warning(const std::string& sentence) {
  vtkWarningWithObjectMacro(algorithm_, << sentence);
}

}  // namespace pm
