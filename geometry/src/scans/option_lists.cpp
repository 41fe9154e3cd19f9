// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/option_lists.h"

#include "palpate/geometry/cloud_clusters.h"
#include "palpate/geometry/cloud_normals.h"
#include "palpate/geometry/cloud_outliers.h"
#include "palpate/geometry/cloud_shapes.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/range_map_selection.h"
#include "palpate/geometry/range_map_smoothing.h"
#include "palpate/geometry/registration.h"
#include "palpate/geometry/remeshing.h"
#include "palpate/geometry/smoothing.h"
#include "palpate/geometry/surface_map.h"
#include "palpate/geometry/surface_tracker.h"

namespace palpate::geometry {

void visit_options(FieldVisitor& visitor) {
  RangeMapMeshOptions meshing;
  visit(meshing, visitor);
  HoleFillingOptions filling;
  visit(filling, visitor);
  SmoothingOptions smoothing;
  visit(smoothing, visitor);
  RemeshingOptions remeshing;
  visit(remeshing, visitor);
  DecimationOptions decimation;
  visit(decimation, visitor);
  TrackingOptions tracking;
  visit(tracking, visitor);
  MergeScansOptions merging;
  visit(merging, visitor);
  RangeMapSelectionOptions selection;
  visit(selection, visitor);
  RegistrationOptions registration;
  visit(registration, visitor);
  SurfaceMapOptions map;
  visit(map, visitor);
  RangeMapSmoothingOptions depth_smoothing;
  visit(depth_smoothing, visitor);
  OutlierOptions outliers;
  visit(outliers, visitor);
  CloudNormalOptions normals;
  visit(normals, visitor);
  CloudShapeOptions shapes;
  visit(shapes, visitor);
  CloudClusterOptions clusters;
  visit(clusters, visitor);
}

}  // namespace palpate::geometry
