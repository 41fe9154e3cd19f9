// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/option_lists.h"

#include "palpate/probing/acquisition_mapping.h"
#include "palpate/probing/campaign_options.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/contact_surface.h"
#include "palpate/probing/known_forces.h"
#include "palpate/probing/touch_placement.h"

namespace palpate::probing {

void visit_options(FieldVisitor& visitor) {
  PlanOptions plan;
  visit(plan, visitor);
  CampaignOptions campaign;
  visit(campaign, visitor);
  KnownForceOptions known;
  visit(known, visitor);
  TouchPlacementOptions placement;
  visit(placement, visitor);
  AcquisitionMapping mapping;
  visit(mapping, visitor);
  ContactSurfaceOptions surface;
  visit(surface, visitor);
}

}  // namespace palpate::probing
