// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "growth.h"

namespace palpate::extremes {
namespace {

constexpr Element kCells{"triangle of the sheet", 276}, kFacets{"triangle of the ball", 320},
    kPoints{"point", 400}, kContact{"contact", 12}, kSample{"sample", 576}, kPair{"pair", 36},
    kTrial{"trial", 120}, kTick{"tick", 200}, kDepth{"depth", 1728}, kPixel{"pixel", 19200},
    kSmallPixel{"pixel", 70}, kView{"view", 5, true}, kOrder{"trial", 12}, kPlanned{"contact", 5},
    kQuery{"query", 30};

}  // namespace

double elements_of(const Element& element, int extent) {
  return element.count * extent * (element.along ? 1 : extent);
}

const std::vector<Growth>& stated_growth() {
  static const std::vector<Growth> stated = {
      {"mesh measures", kCells, 2, 8, 1.3, 150},
      {"normals", kCells, 2, 8, 1.3, 190},
      {"find_all_defects", kCells, 2, 8, 1.3, 470},
      {"repair_mesh", kCells, 2, 8, 1.3, 460},
      {"fill_holes", kCells, 2, 8, 1.3, 140},
      {"smooth", kCells, 2, 8, 1.3, 120},
      {"vertex_curvature", kFacets, 2, 8, 1.3, 160},
      {"cross_section", kCells, 2, 8, 1.3, 25},
      {"closest_points", kCells, 2, 8, 1.3, 520},
      {"first_hits, all_hits", kFacets, 2, 8, 1.3, 400},
      {"winding_numbers", kFacets, 2, 8, 1.7, 460},
      {"geodesic_distance: fast_marching", kCells, 2, 8, 1.3, 380},
      {"geodesic_distance: exact", kCells, 2, 8, 1.6, 580},
      {"geodesic_distances", kCells, 2, 8, 1.3, 380},
      {"shortest_paths", kCells, 2, 8, 1.6, 3200},
      {"straighten_path", kCells, 2, 8, 1.5, 2900},
      {"decimate: tolerance", kFacets, 2, 8, 1.3, 1100},
      {"decimate: max_triangles", kFacets, 2, 8, 1.3, 880},
      {"hausdorff_distance", kCells, 2, 8, 1.3, 760},
      {"surface_distances", kCells, 2, 8, 1.3, 790},
      {"remesh", kCells, 2, 8, 1.3, 850},
      {"split_edges", kCells, 2, 8, 1.3, 260},
      {"farthest_points", kCells, 2, 8, 1.4, 370},
      {"facing_shares", kContact, 2, 8, 1.3, 1200},
      {"surface_strain", kCells, 2, 8, 1.3, 250},
      {"smooth_motion", kCells, 2, 8, 1.3, 300},
      {"intersecting_triangles", kCells, 2, 8, 1.3, 880},
      {"remove_self_intersections", kCells, 2, 8, 1.3, 580},
      {"triangulate_contacts: delaunay", kContact, 2, 8, 1.3, 7400},
      {"triangulate_contacts: voronoi_dual", kContact, 2, 8, 1.3, 8900},
      {"map_surface", kCells, 2, 8, 1.3, 2000},
      {"voxel_sample", kPoints, 2, 8, 1.5, 97},
      {"poisson_sample", kPoints, 2, 8, 1.3, 110},
      {"without_outliers", kPoints, 2, 8, 1.3, 86},
      {"without_isolated", kPoints, 2, 8, 1.3, 79},
      {"cloud_normals", kPoints, 2, 8, 1.3, 420},
      {"cloud_clusters", kPoints, 2, 8, 1.3, 270},
      {"distances of points", kPoints, 2, 8, 1.3, 420},
      {"find_plane", kPoints, 2, 8, 1.3, 110},
      {"find_sphere", kPoints, 2, 8, 1.6, 110},
      {"find_cylinder", kPoints, 2, 8, 1.3, 390},
      {"find_ball", kPoints, 2, 8, 1.3, 320},
      {"register_points", kPoints, 2, 8, 1.3, 290},
      {"merge_scans", kCells, 2, 8, 1.3, 1600},
      {"zipper_scans", kCells, 2, 8, 1.3, 850},
      {"register_scans", kCells, 2, 8, 1.3, 370},
      {"mesh_range_map", kDepth, 2, 8, 1.3, 130},
      {"smooth_range_map", kDepth, 2, 8, 1.3, 57},
      {"depth_noise", kDepth, 2, 8, 1.6, 130},
      {"fitted_camera", kDepth, 2, 8, 1.3, 45},
      {"select_depths", kDepth, 2, 8, 1.3, 72},
      {"SurfaceTracker", kDepth, 1, 4, 1.3, 650},
      {"Decoder::decode", kPixel, 2, 8, 1.4, 230},
      {"MultishotDecoder::decode", kSmallPixel, 2, 8, 1.3, 150},
      {"calibrate_rig", kView, 1, 8, 1.8, 250000, true},
      {"simulate", kSmallPixel, 2, 8, 1.3, 260},
      {"plan_contacts", kCells, 2, 8, 1.3, 560},
      {"try_specimen", kPlanned, 1, 4, 1.4, 490000},
      {"known_forces", kQuery, 1, 4, 1.5, 67000},
      {"contact_surface", kContact, 2, 8, 1.3, 950},
      {"CheckedAcquisition", kSample, 2, 8, 1.5, 240},
      {"judge_slip", kSample, 2, 8, 1.3, 47},
      {"ConePosterior", kTrial, 2, 8, 1.3, 200},
      {"ForceSurrogate", kPair, 1, 4, 2.9, 150000},
      {"place_by_touches", kCells, 2, 8, 1.3, 470},
      {"Campaign", kOrder, 1, 4, 1.3, 220000},
      {"ForceField", kPair, 2, 8, 1.3, 320},
      {"fit_force_field: convex", kPair, 2, 8, 1.3, 17000},
      {"fit_force_field: certified", kPair, 1, 4, 1.3, 4400},
      {"fit_force_field: local", kPair, 1, 4, 1.3, 3600},
      {"fit_friction", kTrial, 2, 8, 1.3, 92},
      {"build_model", kSample, 1, 4, 1.3, 1100, true},
      {"with_compliances", kContact, 2, 8, 1.3, 17000},
      {"BlendedField", kContact, 2, 8, 1.3, 17000},
      {"Playback", kTick, 2, 8, 1.3, 1600},
      {"SafetyFilter::filter", kTick, 2, 8, 1.3, 140},
      {"C interface", kTick, 2, 8, 1.3, 2300},
      {"evaluate_queries", kSample, 2, 8, 1.3, 450},
      {"leave_one_out", kSample, 1, 4, 1.7, 1200},
      {"scale_model", kContact, 2, 8, 1.3, 12000},
      {"merge_models", kContact, 1, 4, 1.3, 34000},
      {"transfer_model", kCells, 1, 4, 1.3, 2000},
      {"reduce_model", kContact, 1, 4, 1.3, 35000},
      {"identify_half_space", kSample, 1, 4, 1.3, 2800},
      {"drawn_shape", kCells, 2, 8, 1.3, 410},
  };
  return stated;
}

}  // namespace palpate::extremes
