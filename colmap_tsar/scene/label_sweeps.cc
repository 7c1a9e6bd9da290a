// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/label_sweeps.h"

#include "colmap_tsar/base/error.h"

#include <memory>
#include <utility>

namespace tsar {

LabelSweeps::LabelSweeps(const ModelSceneInputs& inputs,
                         const std::vector<std::vector<int>>& assignment,
                         const std::vector<ModelPlane>& planes)
    : inputs_(inputs),
      assignment_(assignment),
      planes_(planes),
      gpus_(inputs.resources.gpus),
      next_labels_(inputs.views.size()),
      costs_(inputs.views.size()) {}

void LabelSweeps::LabelView(size_t view, bool keeps_costs, Device& cpu) {
  Image<PlaneCost> costs = std::move(costs_[view]);
  const bool were_kept = !costs.Empty();
  next_labels_[view] = Label(view, cpu, &costs);
  if (keeps_costs && (were_kept || ReserveMemory(costs))) {
    costs_[view] = std::move(costs);
  }
}

void LabelSweeps::EndSweep() {
  labels_ =
      std::exchange(next_labels_, std::vector<LabelsInModel>(costs_.size()));
}

void LabelSweeps::RestartWithin(std::vector<BoundingCrease> creases) {
  creases_ = std::move(creases);
  labels_.clear();
  costs_ = std::vector<Image<PlaneCost>>(costs_.size());
  kept_bytes_ = 0;
}

std::vector<ViewLabels> LabelSweeps::TakeLabels() {
  std::vector<ViewLabels> result;
  for (LabelsInModel& of_view : labels_) {
    result.push_back(std::move(of_view.labels));
  }
  labels_.clear();
  return result;
}

LabelsInModel LabelSweeps::Label(size_t view,
                                 Device& cpu,
                                 Image<PlaneCost>* costs) {
  const auto modeled = [&](size_t i, const ViewEvidence& evidence) {
    return ModeledView{MakeObservedView(evidence, inputs_.views[i].camera),
                       &assignment_[i],
                       labels_.empty() ? nullptr : &labels_[i]};
  };
  const ViewEvidence own = inputs_.evidence.read_all(view);
  std::vector<std::shared_ptr<const ViewEvidence>> others;
  std::vector<ModeledView> views = {modeled(view, own)};
  for (const size_t source : inputs_.views[view].sources) {
    if (source != view) {
      others.push_back(inputs_.evidence.get(source));
      views.push_back(modeled(source, *others.back()));
    }
  }
  const auto lend_device = [&](const std::function<void(Device&)>& work) {
    if (gpus_.Size() > 0) {
      try {
        return gpus_.Run(work);
      } catch (const Error& error) {
        // The view is too large. The CPU gives the same bits.
        if (error.Code() != ErrorCode::kOutOfMemory) {
          throw;
        }
      }
    }
    work(cpu);
  };
  return LabelInModel(
      views, planes_, creases_, inputs_.refine_options, lend_device, costs);
}

bool LabelSweeps::ReserveMemory(const Image<PlaneCost>& costs) {
  const auto num_bytes =
      static_cast<int64_t>(costs.NumPixels() * sizeof(PlaneCost));
  if (kept_bytes_.fetch_add(num_bytes) + num_bytes <=
      inputs_.resources.max_kept_bytes) {
    return true;
  }
  kept_bytes_ -= num_bytes;
  return false;
}

}  // namespace tsar
