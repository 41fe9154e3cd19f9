// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Each function calls the one of the same name in the module `pictures`, which loads VTK.
#include "drawings.h"
#include "palpate/core/module.h"

namespace palpate::pictures {
namespace {

const Drawings& drawings() {
  static const void* const loaded = module_symbol("pictures");
  return *static_cast<const Drawings*>(loaded);
}

}  // namespace

void draw_contacts(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                   const Eigen::Ref<const Eigen::VectorXi>& labels,
                   const geometry::TriangleMesh& contact_mesh, const std::vector<long long>& ids,
                   const std::string& title) {
  drawings().contacts(png, surface, labels, contact_mesh, ids, title);
}

void draw_deviation(const std::filesystem::path& png, const geometry::ImageF& sigma,
                    const std::string& title) {
  drawings().deviation(png, sigma, title);
}

void draw_differences(const std::filesystem::path& png, const geometry::RangeMapScore& score,
                      const std::string& title) {
  drawings().differences(png, score, title);
}

void draw_displacements(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                        const Eigen::Ref<const Eigen::Matrix3Xd>& contacts,
                        const Eigen::Ref<const Eigen::VectorXd>& displacements,
                        const std::string& title) {
  drawings().displacements(png, surface, contacts, displacements, title);
}

void draw_distances(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
                    const Eigen::Ref<const Eigen::VectorXd>& distances,
                    const DistancePicture& picture) {
  drawings().distances(png, mesh, distances, picture);
}

void draw_force_errors(const std::filesystem::path& png, const ForceErrors& errors,
                       const std::string& title) {
  drawings().force_errors(png, errors, title);
}

void draw_force_field(const std::filesystem::path& png, const ContactSamples& samples,
                      const ContactFit& fit, const std::string& title) {
  drawings().force_field(png, samples, fit, title);
}

void draw_forces(const std::filesystem::path& png, const Eigen::Ref<const Eigen::VectorXd>& times,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                 const Eigen::Ref<const Eigen::VectorXi>& states, const std::string& title) {
  drawings().forces(png, times, forces, states, title);
}

void draw_hues(const std::filesystem::path& png, const std::vector<HueDistribution>& hues,
               const std::string& title) {
  drawings().hues(png, hues, title);
}

void draw_joint_torques(const std::filesystem::path& png, const JointTorques& joint,
                        const std::string& title) {
  drawings().joint_torques(png, joint, title);
}

void draw_labels(const std::filesystem::path& png, const LabelImage& labels,
                 std::span<const std::string> names, const std::string& title) {
  drawings().labels(png, labels, names, title);
}

void draw_mesh(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
               const std::string& title, MeshPart part) {
  drawings().mesh(png, mesh, title, part);
}

void draw_range_map(const std::filesystem::path& png, const geometry::RangeMap& map,
                    const std::string& title) {
  drawings().range_map(png, map, title);
}

void draw_residuals(const std::filesystem::path& png, const std::vector<ResidualImage>& images,
                    const std::string& title) {
  drawings().residuals(png, images, title);
}

void draw_section(const std::filesystem::path& png, std::span<const SectionSeries> series,
                  const std::string& title, const SectionLabels& labels) {
  drawings().section(png, series, title, labels);
}

void draw_stiffness(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                    const StiffnessPicture& picture) {
  drawings().stiffness(png, surface, picture);
}

void draw_time_line(const std::filesystem::path& png, const TimeLine& trials,
                    const std::string& title) {
  drawings().time_line(png, trials, title);
}

void draw_touch(const std::filesystem::path& png, const Touch& touch, const std::string& title) {
  drawings().touch(png, touch, title);
}

}  // namespace palpate::pictures
