// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/mesh_steps.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/attribute_transfer.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/self_intersections.h"
#include "palpate/geometry/surface_query.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/surface_colors.h"

namespace palpate::apps {
namespace {

/// The deviations that `decode --sigma` has written beside the range map: those of the noise, if
/// the rig's part, which moves neighbours equally, is in another file.
geometry::ImageF deviations_beside(const fs::path& input) {
  if (!is_range_map(input)) {
    throw InvalidInput(input.string() +
                       ": --smooth-depths needs the noise of the camera: pass depth images of a "
                       "scene that does not move with --still");
  }
  const fs::path file = noise_beside(input);
  if (!is_there(file)) {
    throw FileError(file.string() +
                    ": missing. --smooth-depths needs the predicted deviations, which palpate "
                    "decode --sigma writes beside the range map; or pass frames of a scene that "
                    "does not move with --still.");
  }
  return geometry::read_depth_tiff(file);
}

void smooth_depths(const fs::path& input, const MeshSteps& steps, geometry::RangeMap& map) {
  const geometry::ImageF sigma =
      steps.noise ? geometry::deviations(*steps.noise, map.z) : deviations_beside(input);
  map.z = geometry::smooth_range_map(map.z, sigma, steps.depth_smoothing);
}

/// Of noisy or wrong depths, less than this share of the pixels is part of a surface.
constexpr double kLeastMeshed = 0.5;

/// The key of MeshLab for the pictures of a texture in PLY files.
constexpr const char* kTextureComment = "TextureFile ";

MadeMesh from_file(geometry::MeshFile file) {
  MadeMesh made;
  made.mesh = std::move(file.mesh);
  made.attributes = std::move(file.vertex_attributes);
  made.texture = geometry::corner_texture(file.triangle_attributes);
  made.material_files = std::move(file.material_files);
  made.materials = std::move(file.materials);
  for (std::string& comment : file.comments)
    if (comment.starts_with(kTextureComment)) made.comments.push_back(std::move(comment));
  return made;
}

/// Transfers the texture to the mesh that a step has made.
/// \param source of its vertices among those of `made`, or -1.
void carry_texture(MadeMesh& made, const geometry::TriangleMesh& after,
                   std::span<const int> source) {
  if (made.texture)
    made.texture = geometry::carried_texture(*made.texture, made.mesh, after, source);
}

MadeMesh load(const fs::path& input, const MeshSteps& steps) {
  if (!is_range_map(input) && !is_image(input)) {
    if (steps.smooth_depths)
      throw InvalidInput(input.string() +
                         ": --smooth-depths works for range maps, not for meshes.");
    check_is_no_depth_call(input, steps.camera);
    check_selects_nothing(input, steps.camera);
    geometry::RangeMapMeshOptions meshing = steps.meshing, usual;
    const std::string given = changed_options(fields_of(meshing), fields_of(usual));
    if (!given.empty())
      throw InvalidInput(input.string() + ":" + given + " works for range maps, not for meshes.");
    if (lower_extension(input) == ".pcd") {
      throw InvalidInput(input.string() +
                         ": holds points without a surface. If they are organised, a point per "
                         "pixel, make a range map of them first: palpate cloud " +
                         input.string() + " -o NAME.tiff");
    }
    geometry::ReadOptions options = steps.meshes;
    options.keep_defects = steps.repair;
    if (steps.color || !steps.color_images.empty()) {
      throw InvalidInput(input.string() + (steps.color ? ": --color" : ": --color-images") +
                         " works for range maps, not for meshes.");
    }
    return from_file(geometry::read_mesh_file(input, options));
  }
  check_has_no_unit(input, steps.meshes);
  geometry::RangeMap map = load_range_map(input, steps.camera);
  if (steps.smooth_depths) smooth_depths(input, steps, map);
  const auto known = (map.z == map.z).count();
  MadeMesh made;
  made.mesh = geometry::mesh_range_map(map, steps.meshing).mesh;
  made.camera = map.camera;
  made.figures["pixels"] = known;
  made.prose = fmt::format("{} pixels with a depth\n", known);
  if (steps.noise && known > 0) {
    std::vector<double> deviations;
    for (const float z : map.z.reshaped())
      if (z > 0) deviations.push_back(steps.noise->deviation(z));
    const double noise = median(deviations);
    made.figures["depth_noise"] = noise;
    made.prose += fmt::format("standard deviation of the depths {:.3g} mm (median)\n", noise);
  }
  if (made.mesh.triangles.cols() == 0)
    throw InvalidInput(input.string() + ": no two neighbouring pixels have a depth.");
  if (static_cast<double>(made.mesh.vertices.cols()) < kLeastMeshed * static_cast<double>(known)) {
    tell_doubts(
        input.string(),
        {{.subject = "mesh",
          .message = fmt::format("only {} of {} pixels with a depth are part of a surface; do "
                                 "camera and unit belong to these depths?",
                                 made.mesh.vertices.cols(), known)}});
  }
  return made;
}

/// Removes the normals of vertices, which would no longer be those of the surface.
void drop_normals(geometry::Attributes& attributes) {
  std::erase_if(attributes, [](const geometry::Attribute& attribute) {
    return attribute.name == "nx" || attribute.name == "ny" || attribute.name == "nz";
  });
}

void repair(MadeMesh& made, const MeshSteps& steps) {
  geometry::RepairedMesh repaired = geometry::repair_mesh(made.mesh, steps.repairing);
  made.attributes = geometry::selected_attributes(made.attributes, repaired.source);
  carry_texture(made, repaired.mesh, repaired.source);
  made.mesh = std::move(repaired.mesh);
  made.figures["repair"] = {{"removed_triangles", repaired.removed_triangles},
                            {"flipped_edges", repaired.flipped_edges},
                            {"turned_triangles", repaired.turned_triangles},
                            {"welded_vertices", repaired.welded_vertices},
                            {"split_vertices", repaired.split_vertices},
                            {"removed_vertices", repaired.removed_vertices},
                            {"cut_edges", repaired.cut_edges}};
  made.prose += fmt::format(
      "repaired: {} triangles removed, {} edges flipped, {} triangles reoriented, {} vertices "
      "welded, {} split and {} removed, {} edges cut\n",
      repaired.removed_triangles, repaired.flipped_edges, repaired.turned_triangles,
      repaired.welded_vertices, repaired.split_vertices, repaired.removed_vertices,
      repaired.cut_edges);
  for (const geometry::MeshDefect& defect : geometry::find_all_defects(made.mesh))
    made.prose += "  remaining: " + geometry::describe(defect) + "\n";
}

/// Adopts the mesh of a step that replaces parts by patches. New vertices get the attributes of the
/// nearest point of the mesh before.
/// \param source of its vertices among those of `made`, or -1.
void take_patched(MadeMesh& made, geometry::TriangleMesh after, std::span<const int> source) {
  if (!made.attributes.empty()) {
    const geometry::SurfaceQuery query(made.mesh);
    const std::vector<geometry::SurfacePoint> of_vertices = geometry::vertex_points(made.mesh);
    std::vector<geometry::SurfacePoint> places;
    for (std::size_t v = 0; v < source.size(); ++v) {
      const bool kept =
          source[v] >= 0 && of_vertices[static_cast<std::size_t>(source[v])].triangle >= 0;
      places.push_back(
          kept ? of_vertices[static_cast<std::size_t>(source[v])]
               : query.closest_point(after.vertices.col(static_cast<Eigen::Index>(v))).at);
    }
    made.attributes = geometry::interpolated_attributes(made.attributes, made.mesh, places);
  }
  carry_texture(made, after, source);
  made.mesh = std::move(after);
}

void fill_holes(MadeMesh& made, const MeshSteps& steps) {
  geometry::FilledMesh filled = geometry::fill_holes(made.mesh, steps.filling);
  std::vector<int> source(static_cast<std::size_t>(filled.mesh.vertices.cols()), -1);
  std::iota(source.begin(), source.begin() + made.mesh.vertices.cols(), 0);
  take_patched(made, std::move(filled.mesh), source);
  made.figures["holes"] = {{"filled", filled.filled}, {"left", filled.left}};
  made.prose += fmt::format("{} holes filled, {} border loops left\n", filled.filled, filled.left);
}

void remove_intersections(MadeMesh& made, const MeshSteps& steps) {
  geometry::SelfIntersectionRemoval removal =
      geometry::remove_self_intersections(made.mesh, steps.intersections);
  take_patched(made, std::move(removal.mesh), removal.source);
  made.figures["self_intersections"] = {{"found", removal.found}, {"left", removal.left}};
  made.prose +=
      fmt::format("{} triangles passed through others, {} still do\n", removal.found, removal.left);
}

void remesh(MadeMesh& made, const MeshSteps& steps) {
  geometry::Remeshing remeshed = geometry::remesh(made.mesh, steps.remeshing);
  made.attributes = geometry::interpolated_attributes(made.attributes, made.mesh, remeshed.places);
  const geometry::MeshShape shape = geometry::mesh_shape(remeshed.mesh);
  made.figures["remeshing"] = {{"edge_length", *steps.remeshing.edge_length},
                               {"triangles_before", made.mesh.triangles.cols()},
                               {"triangles_after", remeshed.mesh.triangles.cols()},
                               {"mean_edge", shape.mean_edge}};
  made.prose +=
      fmt::format("{} triangles before, {} after remeshing; edges of {:.3g} mm on average\n",
                  made.mesh.triangles.cols(), remeshed.mesh.triangles.cols(), shape.mean_edge);
  if (made.texture) {
    spdlog::warn("--remesh: the texture is left out: the new vertices are not at its seams");
    made.texture.reset();
    made.material_files.clear();
    made.comments.clear();
  }
  made.mesh = std::move(remeshed.mesh);
}

void decimate(const fs::path& input, MadeMesh& made, const MeshSteps& steps) {
  const geometry::DecimationOptions& options = steps.decimation;
  const std::optional<double> tolerance = options.tolerance;
  const double diagonal = geometry::bounding_diagonal(made.mesh);
  if (tolerance > diagonal) {
    throw InvalidInput(fmt::format(
        "{}: --tolerance: {:g} mm exceeds the mesh's diagonal of {:.1f} mm; nothing of the mesh "
        "would remain",
        input.string(), *tolerance, diagonal));
  }
  geometry::Decimation decimated;
  if (made.texture) {
    geometry::TexturedDecimation textured = geometry::decimate(made.mesh, *made.texture, options);
    decimated = std::move(textured.decimation);
    made.texture = std::move(textured.texture);
  } else {
    decimated = geometry::decimate(made.mesh, options);
  }
  made.figures["decimation"] = {{"tolerance", number_or_null(tolerance)},
                                {"triangles_before", made.mesh.triangles.cols()},
                                {"triangles_after", decimated.mesh.triangles.cols()},
                                {"distance", decimated.distance}};
  if (decimated.mesh.triangles.cols() == made.mesh.triangles.cols()) {
    made.prose += fmt::format("none of {} triangles can be removed{}\n", made.mesh.triangles.cols(),
                              tolerance ? fmt::format(" within {:g} mm", *tolerance) : "");
  } else {
    made.prose += fmt::format(
        "{} triangles before, {} after; the Hausdorff distance is at most {:.4f} mm (verified)\n",
        made.mesh.triangles.cols(), decimated.mesh.triangles.cols(), decimated.distance);
  }
  if (options.max_triangles && decimated.mesh.triangles.cols() > *options.max_triangles) {
    spdlog::warn(
        "{}: {} triangles are left, not {} (--max-triangles): to remove more would fold or tear "
        "the surface. --remesh makes larger triangles",
        input.string(), decimated.mesh.triangles.cols(), *options.max_triangles);
  }
  made.attributes = geometry::selected_attributes(made.attributes, decimated.source);
  made.mesh = std::move(decimated.mesh);
}

}  // namespace

geometry::DepthNoise noise_in(const std::vector<fs::path>& still, MapCamera camera) {
  // The noise is that of the whole scene, also if only a part of it is meshed.
  camera.selection = {};
  camera.mask.clear();
  // All are in memory; more would hardly change a standard deviation.
  constexpr std::size_t kMostFrames = 100;
  std::vector<fs::path> files = list_range_maps(still, camera);
  files.resize(std::min(files.size(), kMostFrames));
  std::vector<geometry::ImageF> frames;
  for (const fs::path& file : files) frames.push_back(load_range_map(file, camera).z);
  const double resolution = is_range_map(files.front()) ? 0 : *unit_of(files.front(), camera);
  try {
    return geometry::depth_noise(frames, resolution);
  } catch (const InvalidInput& error) {
    throw InvalidInput("--still: " + still.front().string() + ": " + error.what());
  }
}

MadeMesh make_mesh(const fs::path& input, const MeshSteps& steps) {
  MadeMesh made = load(input, steps);
  drop_normals(made.attributes);
  if (steps.repair) repair(made, steps);
  if (steps.filling.max_diameter) fill_holes(made, steps);
  if (steps.smoothing.iterations > 0) made.mesh = geometry::smooth(made.mesh, steps.smoothing);
  if (steps.remove_intersections) remove_intersections(made, steps);
  if (steps.remeshing.edge_length) remesh(made, steps);
  if (steps.decimation.tolerance || steps.decimation.max_triangles) decimate(input, made, steps);
  if (steps.color) made.attributes = colors_beside(input, made.mesh.vertices, steps.camera);
  if (!steps.color_images.empty())
    made.attributes =
        colors_in(steps.color_images, input, made.mesh.vertices, made.camera, steps.camera);
  made.figures["vertices"] = made.mesh.vertices.cols();
  made.figures["triangles"] = made.mesh.triangles.cols();
  return made;
}

void check_color(const MeshSteps& steps, const std::string& extension) {
  const bool has_images = !steps.color_images.empty();
  if ((steps.color || has_images) && extension == ".stl") {
    throw InvalidInput(std::string(has_images ? "--color-images" : "--color") +
                       ": STL has no colours; write PLY or OBJ.");
  }
}

std::vector<std::string> seen_from(const fs::path& output, const fs::path& input,
                                   std::vector<std::string> names) {
  const fs::path from = fs::absolute(output).lexically_normal().parent_path();
  const fs::path folder = fs::absolute(input).lexically_normal().parent_path();
  if (folder == from) return names;
  for (std::string& name : names)
    name = (folder / name).lexically_normal().lexically_relative(from).string();
  return names;
}

void write_made(const MadeMesh& made, const fs::path& input, const fs::path& output) {
  geometry::MeshFile file;
  file.mesh = made.mesh;
  file.vertex_attributes = made.attributes;
  if (made.texture) {
    const std::string extension = lower_extension(output);
    if (extension == ".ply" && !made.material_files.empty())
      spdlog::warn("{}: PLY has no materials, so those of {} are left out; write OBJ to keep them",
                   output.string(), made.material_files.front());
    if (extension != ".ply" && extension != ".obj")
      spdlog::warn("{}: the texture is left out; write OBJ or PLY to keep it", output.string());
    geometry::set_corner_texture(file.triangle_attributes, *made.texture);
    file.materials = made.materials;
    file.material_files = seen_from(output, input, made.material_files);
    file.comments = made.comments;
  }
  geometry::write_mesh_file(output, file);
}

}  // namespace palpate::apps
