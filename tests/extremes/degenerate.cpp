// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "degenerate.h"

#include <cmath>
#include <limits>
#include <utility>

#include "operations.h"
#include "test_surfaces.h"

namespace palpate::extremes {
namespace {

using Eigen::Vector3d;
using geometry::SurfacePoint;
using geometry::TriangleMesh;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

void add_vertex(TriangleMesh& mesh, const Vector3d& place) {
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols(1) = place;
}

void add_triangle(TriangleMesh& mesh, int a, int b, int c) {
  mesh.triangles.conservativeResize(3, mesh.triangles.cols() + 1);
  mesh.triangles.rightCols(1) << a, b, c;
}

int vertices_of(const TriangleMesh& mesh) { return static_cast<int>(mesh.vertices.cols()); }

/// One triangle, or two that share an edge.
TriangleMesh few_triangles(int count) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 30, 0, 30, 0, 0, 40, 40, 0, 1, 0, 3;
  mesh.triangles.resize(3, count);
  mesh.triangles.col(0) << 0, 1, 2;
  if (count > 1) mesh.triangles.col(1) << 2, 1, 3;
  if (count == 1) mesh.vertices.conservativeResize(3, 3);
  return mesh;
}

/// Changes one mesh, and puts the contacts back on it.
Degenerate sheet(std::string name, std::function<void(TriangleMesh&)> change) {
  return {std::move(name), kSheet, [change](Input& input) {
            change(input.sheet);
            const auto triangles = static_cast<int>(input.sheet.triangles.cols());
            if (triangles > 0)
              for (SurfacePoint& contact : input.contacts) contact.triangle %= triangles;
          }};
}

Degenerate ball(std::string name, std::function<void(TriangleMesh&)> change) {
  return {std::move(name), kBall, [change](Input& input) { change(input.ball); }};
}

/// The same for both meshes.
void both(std::vector<Degenerate>& all, const std::string& name,
          const std::function<void(TriangleMesh&)>& change) {
  all.push_back(sheet("sheet: " + name, change));
  all.push_back(ball("ball: " + name, change));
}

void add_meshes(std::vector<Degenerate>& all) {
  for (const double far : {1e4, 1e9, 1e15})
    both(all, "a stray vertex " + std::to_string(static_cast<long long>(far)) + " mm away",
         [far](TriangleMesh& mesh) {
           add_vertex(mesh, {far, -far, far});
         });
  both(all, "a vertex twice", [](TriangleMesh& mesh) {
    add_vertex(mesh, mesh.vertices.col(5));
    mesh.triangles(0, 3) = vertices_of(mesh) - 1;
  });
  both(all, "a triangle without area", [](TriangleMesh& mesh) {
    add_vertex(mesh, (mesh.vertices.col(0) + mesh.vertices.col(1)) / 2);
    add_triangle(mesh, 1, 0, vertices_of(mesh) - 1);
  });
  both(all, "two corners of a triangle at one place", [](TriangleMesh& mesh) {
    mesh.vertices.col(mesh.triangles(0, 7)) = mesh.vertices.col(mesh.triangles(1, 7));
  });
  both(all, "all vertices at one place", [](TriangleMesh& mesh) { mesh.vertices.setConstant(3); });
  both(all, "all vertices on a line",
       [](TriangleMesh& mesh) { mesh.vertices.bottomRows(2).setZero(); });
  both(all, "flat", [](TriangleMesh& mesh) { mesh.vertices.row(2).setZero(); });
  both(all, "needles of 1e8", [](TriangleMesh& mesh) { mesh.vertices.row(1) *= 1e-8; });
  both(all, "a fin on an edge", [](TriangleMesh& mesh) {
    add_vertex(mesh, mesh.vertices.col(mesh.triangles(0, 4)) + Vector3d(1, 2, 9));
    add_triangle(mesh, mesh.triangles(0, 4), mesh.triangles(1, 4), vertices_of(mesh) - 1);
  });
  both(all, "a triangle twice", [](TriangleMesh& mesh) {
    add_triangle(mesh, mesh.triangles(0, 4), mesh.triangles(1, 4), mesh.triangles(2, 4));
  });
  both(all, "a triangle turned",
       [](TriangleMesh& mesh) { mesh.triangles.col(4).reverseInPlace(); });
  both(all, "one triangle", [](TriangleMesh& mesh) { mesh = few_triangles(1); });
  both(all, "two triangles", [](TriangleMesh& mesh) { mesh = few_triangles(2); });
  both(all, "sizes from 1e-6 to 1e6",
       [](TriangleMesh& mesh) { mesh = geometry::test::star_of_many_scales(); });
  both(all, "triangles at random",
       [](TriangleMesh& mesh) { mesh = geometry::test::random_triangles(60, 30, 1); });
  both(all, "no triangles", [](TriangleMesh& mesh) { mesh.triangles.resize(3, 0); });
  both(all, "a corner that does not exist",
       [](TriangleMesh& mesh) { mesh.triangles(1, 0) = vertices_of(mesh); });
  both(all, "a vertex that is no number",
       [](TriangleMesh& mesh) { mesh.vertices(1, 9) = std::nan(""); });
  both(all, "coordinates of 1e300", [](TriangleMesh& mesh) { mesh.vertices *= 1e299; });
}

Degenerate points(std::string name, std::function<void(Eigen::Matrix3Xd&)> change) {
  return {std::move(name), kCloud | kPlaces, [change](Input& input) {
            change(input.cloud);
            change(input.places);
          }};
}

void add_points(std::vector<Degenerate>& all) {
  using Points = Eigen::Matrix3Xd;
  all.push_back(points("no points", [](Points& p) { p.resize(3, 0); }));
  all.push_back(points("one point", [](Points& p) { p.conservativeResize(3, 1); }));
  all.push_back(points("two points", [](Points& p) { p.conservativeResize(3, 2); }));
  all.push_back(points("equal points", [](Points& p) { p.setConstant(7); }));
  all.push_back(points("collinear points", [](Points& p) { p.bottomRows(2).setZero(); }));
  all.push_back(points("coplanar points", [](Points& p) { p.row(2).setZero(); }));
  all.push_back(points("a far point", [](Points& p) { p.col(0).setConstant(1e9); }));
  all.push_back(points("points 1e-9 apart", [](Points& p) { p = p * 1e-11; }));
  all.push_back(points("a point that is no number", [](Points& p) { p(1, 3) = std::nan(""); }));
  all.push_back(points("no point a number", [](Points& p) { p.setConstant(kInfinite); }));
  all.push_back(points("points at 1e300", [](Points& p) { p *= 1e299; }));
}

Degenerate contacts(std::string name, std::function<void(std::vector<SurfacePoint>&)> change) {
  return {std::move(name), kContacts, [change](Input& input) { change(input.contacts); }};
}

void add_contacts(std::vector<Degenerate>& all) {
  using Contacts = std::vector<SurfacePoint>;
  const auto everywhere = [](const Vector3d& barycentric) {
    return [barycentric](Contacts& all_contacts) {
      for (SurfacePoint& one : all_contacts) one.barycentric = barycentric;
    };
  };
  all.push_back(contacts("contacts at vertices", everywhere({1, 0, 0})));
  all.push_back(contacts("contacts on edges", everywhere({0.5, 0.5, 0})));
  all.push_back(contacts("contacts 1e-9 from vertices", everywhere({1 - 2e-9, 1e-9, 1e-9})));
  all.push_back(contacts("contacts on the border", [](Contacts& c) {
    for (std::size_t i = 0; i < c.size(); ++i) c[i] = {static_cast<int>(2 * i), {0.6, 0.4, 0}};
  }));
  all.push_back(contacts("contacts 1e-9 apart", [](Contacts& c) {
    c[1] = c[0];
    c[1].barycentric += Vector3d(1e-10, -1e-10, 0);
  }));
  all.push_back(contacts("a contact twice", [](Contacts& c) { c[1] = c[0]; }));
  all.push_back(contacts("two contacts", [](Contacts& c) { c.resize(2); }));
  all.push_back(contacts("no contacts", [](Contacts& c) { c.clear(); }));
  all.push_back(contacts("a contact beside the surface", [](Contacts& c) {
    c[0].barycentric = {2, -0.5, -0.5};
  }));
  all.push_back(contacts("a contact in no triangle", [](Contacts& c) { c[0].triangle = -1; }));
  all.push_back(contacts("a contact that is no number",
                         [](Contacts& c) { c[0].barycentric[0] = std::nan(""); }));
}

void add_samples(std::vector<Degenerate>& all) {
  const auto add = [&all](std::string name, std::function<void(Input&)> change) {
    all.push_back({std::move(name), kSamples, std::move(change)});
  };
  add("no samples", [](Input& input) {
    input.displacements.resize(3, 0);
    input.forces.resize(3, 0);
  });
  add("one sample", [](Input& input) {
    input.displacements.conservativeResize(3, 1);
    input.forces.conservativeResize(3, 1);
  });
  add("equal samples", [](Input& input) {
    input.displacements.colwise() = Vector3d(0.1, 0.2, 1);
    input.forces.colwise() = Vector3d(0, 0, 2);
  });
  add("collinear samples", [](Input& input) {
    input.displacements.topRows(2).setZero();
    input.forces.topRows(2).setZero();
  });
  add("coplanar samples", [](Input& input) {
    input.displacements.row(0).setZero();
    input.forces.row(0).setZero();
  });
  add("no displacements", [](Input& input) { input.displacements.setZero(); });
  add("displacements of 1e-15", [](Input& input) { input.displacements *= 1e-15; });
  add("displacements of 1e6", [](Input& input) { input.displacements *= 1e6; });
  add("no forces", [](Input& input) { input.forces.setZero(); });
  add("forces of 1e-15", [](Input& input) { input.forces *= 1e-15; });
  add("forces of 1e15", [](Input& input) { input.forces *= 1e15; });
  add("forces of 1e200", [](Input& input) { input.forces *= 1e200; });
  add("forces that pull", [](Input& input) { input.forces *= -1; });
  add("a force that is no number", [](Input& input) { input.forces(1, 2) = std::nan(""); });
  add("a displacement that is infinite",
      [](Input& input) { input.displacements(1, 2) = kInfinite; });
}

void add_trials(std::vector<Degenerate>& all) {
  const auto add = [&all](std::string name, std::function<void(haptics::FrictionTrial&)> change) {
    all.push_back({std::move(name), kTrials, [change](Input& input) {
                     for (haptics::FrictionTrial& trial : input.trials) change(trial);
                   }});
  };
  all.push_back({"no trials", kTrials, [](Input& input) { input.trials.clear(); }});
  add("all slipped", [](auto& trial) { trial.slipped = true; });
  add("none slipped", [](auto& trial) { trial.slipped = false; });
  add("friction of 0",
      [](auto& trial) { trial.slipped = trial.force.template head<2>().norm() > 0; });
  add("friction of 100", [](auto& trial) {
    const double ratio = trial.force.template head<2>().norm() / trial.force.z();
    trial.force.template head<2>() *= 100 / 0.6;
    trial.slipped = ratio > 0.6;
  });
  add("trials that contradict each other",
      [odd = false](auto& trial) mutable { trial.slipped = odd = !odd; });
  add("equal trials", [](auto& trial) { trial.force = {0.1, 0, 1}; });
  add("trials in one plane", [](auto& trial) { trial.force.y() = 0; });
  add("forces of zero", [](auto& trial) { trial.force.setZero(); });
  add("forces of 1e-200 in trials", [](auto& trial) { trial.force *= 1e-200; });
  add("forces of 1e200 in trials", [](auto& trial) { trial.force *= 1e200; });
  add("forces that are no numbers", [](auto& trial) { trial.force.x() = std::nan(""); });
}

void add_acquisitions(std::vector<Degenerate>& all) {
  const auto add = [&all](std::string name, std::function<void(probing::Acquisition&)> change) {
    all.push_back(
        {std::move(name), kAcquisition, [change](Input& input) { change(input.acquisition); }});
  };
  /// Changes each sample, given its contact.
  const auto each = [](auto change) {
    return [change](probing::Acquisition& acquisition) {
      for (probing::Sample& sample : acquisition.samples)
        for (const probing::Contact& contact : acquisition.contacts)
          if (contact.id == sample.contact) change(sample, contact);
    };
  };
  add("nothing measured", [](auto& a) { a = {}; });
  add("no samples at all", [](auto& a) { a.samples.clear(); });
  add("samples at one contact only", [](auto& a) {
    std::erase_if(a.samples, [](const probing::Sample& sample) { return sample.contact != 0; });
  });
  add("one sample at each contact", [](auto& a) {
    std::erase_if(a.samples, [last = -1LL](const probing::Sample& sample) mutable {
      return last == std::exchange(last, sample.contact);
    });
  });
  add("equal samples at each contact", each([](auto& sample, const auto& contact) {
        sample.a = sample.b = contact.position - contact.normal;
        sample.force = -contact.normal;
        sample.on_friction_boundary = sample.slipped = false;
      }));
  add("only pressed", each([](auto& sample, const auto&) {
        sample.b = sample.a;
        sample.on_friction_boundary = sample.slipped = false;
      }));
  add("never moved",
      each([](auto& sample, const auto& contact) { sample.a = sample.b = contact.position; }));
  add("moved by 1e-15", each([](auto& sample, const auto& contact) {
        sample.a = contact.position + 1e-15 * (sample.a - contact.position);
        sample.b = contact.position + 1e-15 * (sample.b - contact.position);
      }));
  add("moved by 1e6", each([](auto& sample, const auto& contact) {
        sample.a = contact.position + 1e6 * (sample.a - contact.position);
        sample.b = contact.position + 1e6 * (sample.b - contact.position);
      }));
  add("no forces measured", each([](auto& sample, const auto&) { sample.force.setZero(); }));
  add("forces of 1e-12 measured", each([](auto& sample, const auto&) { sample.force *= 1e-12; }));
  add("forces of 1e12 measured", each([](auto& sample, const auto&) { sample.force *= 1e12; }));
  add("all samples slipped", each([](auto& sample, const auto&) {
        sample.slipped = true;
        sample.on_friction_boundary = false;
      }));
  add("normals turned", [](auto& a) {
    for (probing::Contact& contact : a.contacts) contact.normal *= -1;
  });
  add("contacts far from the surface", [](auto& a) {
    for (probing::Contact& contact : a.contacts) contact.position.z() += 1e4;
    for (probing::Sample& sample : a.samples) {
      sample.a.z() += 1e4;
      sample.b.z() += 1e4;
    }
  });
  add("contacts on a line", [](auto& a) {
    for (probing::Contact& contact : a.contacts) contact.position.y() = 30;
  });
  add("two contacts at one place",
      [](auto& a) { a.contacts[1].position = a.contacts[0].position; });
  add("a force that was not measured", [](auto& a) { a.samples[3].force.x() = std::nan(""); });
}

void add_trajectories(std::vector<Degenerate>& all) {
  const auto add = [&all](std::string name, std::function<void(Vector3d&, int)> change) {
    all.push_back({std::move(name), kTrajectory, [change](Input& input) {
                     int tick = 0;
                     for (haptics::TrajectoryPoint& point : input.trajectory)
                       change(point.tool, tick++);
                   }});
  };
  all.push_back({"no ticks", kTrajectory, [](Input& input) { input.trajectory.clear(); }});
  add("a tool at rest", [](Vector3d& tool, int) { tool = {40, 30, -1}; });
  add("a tool that jumps", [](Vector3d& tool, int tick) { tool.z() += tick % 2 == 0 ? 45 : -45; });
  add("a tool at 1e300", [](Vector3d& tool, int) { tool *= 1e298; });
  add("a tool at vertices", [](Vector3d& tool, int tick) { tool = {6.0 * (tick % 12), 30, -1}; });
  add("a tool that is no number", [](Vector3d& tool, int tick) {
    if (tick % 3 == 0) tool.x() = std::nan("");
  });
  add("a tool deep inside", [](Vector3d& tool, int) { tool.z() -= 1e6; });
}

void add_frames(std::vector<Degenerate>& all) {
  const auto add = [&all](std::string name, std::function<void(Input&)> change) {
    all.push_back({std::move(name), kFrame, std::move(change)});
  };
  add("a black frame", [](Input& input) {
    input.frame = cv::Mat(input.frame.size(), input.frame.type(), cv::Scalar::all(0));
  });
  add("a white frame", [](Input& input) {
    input.frame = cv::Mat(input.frame.size(), input.frame.type(), cv::Scalar::all(65535));
  });
  add("a grey frame", [](Input& input) {
    input.frame = cv::Mat(input.frame.size(), input.frame.type(), cv::Scalar::all(30000));
  });
  add("a frame of noise", [](Input& input) {
    input.frame = input.frame.clone();
    cv::RNG(1).fill(input.frame, cv::RNG::UNIFORM, 0, 65535);
  });
  add("a frame of 1 x 1 px", [](Input& input) {
    input.frame = input.frame(cv::Rect(0, 0, 1, 1)).clone();
    input.rig.camera.width = input.rig.camera.height = 1;
  });
  add("a frame of 2 x 160 px", [](Input& input) {
    input.frame = input.frame(cv::Rect(0, 0, 160, 2)).clone();
    input.rig.camera.height = 2;
  });
  add("a frame of another size",
      [](Input& input) { input.frame = input.frame(cv::Rect(0, 0, 40, 30)).clone(); });
  add("no frame", [](Input& input) { input.frame = cv::Mat(); });
  add("camera and projector at one place",
      [](Input& input) { input.rig.T_projector_camera.setIdentity(); });
  add("a projector behind the camera",
      [](Input& input) { input.rig.T_projector_camera.translation() = Vector3d(0, 0, 5000); });
  add("a focal length of 1e-12 px", [](Input& input) { input.rig.camera.fx = 1e-12; });
  add("a focal length of 1e12 px", [](Input& input) { input.rig.camera.fx = 1e12; });
  add("a distortion of 1e6", [](Input& input) { input.rig.camera.distortion[0] = 1e6; });
  add("a period of 1e-6 px", [](Input& input) { input.pattern.period = 1e-6; });
  add("a period of 1e6 px", [](Input& input) { input.pattern.period = 1e6; });
  add("no stripes", [](Input& input) {
    input.pattern.stripes.clear();
    input.pattern.stripe_edges.clear();
  });
  add("a translation that is no number",
      [](Input& input) { input.rig.T_projector_camera.translation().x() = std::nan(""); });
  if (is_large()) {
    // 60 million pixels would take minutes: the largest edge, as a strip.
    add("a frame of 20000 px", [](Input& input) {
      cv::Mat wide;
      cv::repeat(input.frame, 1, 125, wide);
      input.frame = wide;
      input.rig.camera.width = 20'000;
    });
  }
}

}  // namespace

const std::vector<Degenerate>& degenerate_inputs() {
  static const std::vector<Degenerate> catalogue = [] {
    std::vector<Degenerate> all;
    add_meshes(all);
    add_points(all);
    add_contacts(all);
    add_samples(all);
    add_trials(all);
    add_acquisitions(all);
    add_trajectories(all);
    add_frames(all);
    return all;
  }();
  return catalogue;
}

}  // namespace palpate::extremes
