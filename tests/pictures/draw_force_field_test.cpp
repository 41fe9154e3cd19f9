// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_force_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

const Region kFieldScene(0, 130, 680, 600);  // without the scale bars
const Region kFrictionChart(775, 170, 400, 222);
const Region kFitChart(775, 520, 400, 220);

/// A linear spring that was pressed and dragged; the last of each ring is about to slip.
struct Contact {
  ContactSamples samples;
  ContactFit fit;

  Contact() {
    constexpr int kRings = 5;
    constexpr int kPerRing = 8;
    samples.displacements.resize(3, kRings * kPerRing);
    for (int ring = 0; ring < kRings; ++ring) {
      for (int place = 0; place < kPerRing; ++place) {
        const double angle = 0.7 + 0.78 * place;
        const double depth = 1.1 + ring;
        const bool slips = place % 4 == 3;
        const double aside = depth * (slips ? 0.8 : 0.3);
        samples.displacements.col(ring * kPerRing + place) << aside * std::cos(angle),
            aside * std::sin(angle), depth;
        samples.on_boundary.push_back(slips);
      }
    }
    samples.forces = 0.6 * samples.displacements;
    fit.field = [](const Eigen::Vector3d& displacement) -> Eigen::Vector3d {
      return 0.6 * displacement;
    };
    fit.friction_axis = Eigen::Vector3d(0, 0, 2);
    fit.friction_coefficient = 0.8;
  }
};

cv::Mat3b force_field_picture(const Contact& contact) {
  return draw_picture([&](const std::filesystem::path& png) {
    draw_force_field(png, contact.samples, contact.fit, "Contact 19");
  });
}

/// The picture of the contact as it is, drawn once for all tests.
const cv::Mat3b& field_picture() {
  static const cv::Mat3b picture = force_field_picture({});
  return picture;
}

int count(const cv::Mat3b& picture, const Rgb& color, const Region& region) {
  return cv::countNonZero(mask_of(picture, color, 40, region));
}

TEST(DrawForceField, TellsStickingFromSlippingSamples) {
  const cv::Mat3b& both = field_picture();
  EXPECT_EQ(both.size(), cv::Size(1200, 820));
  for (const Region& region : {kFieldScene, kFrictionChart}) {
    EXPECT_GT(count(both, kBlue, region), 50);
    EXPECT_GT(count(both, kVermilion, region), 50);
  }
  Contact contact;
  contact.samples.on_boundary.assign(contact.samples.on_boundary.size(), false);
  const cv::Mat3b sticking = force_field_picture(contact);
  EXPECT_EQ(count(sticking, kVermilion, kFrictionChart), 0);
  EXPECT_GT(count(sticking, kBlue, kFieldScene), count(both, kBlue, kFieldScene));
}

TEST(DrawForceField, ArrowsKeepAwayFromTheScaleBars) {
  Contact contact;
  // So far down and aside that the scene is as high and wide as it may be.
  contact.samples.displacements.row(2) *= 3;
  contact.samples.displacements.topRows(2) *= 1.5;
  contact.samples.forces = 0.6 * contact.samples.displacements;
  const cv::Mat3b picture = force_field_picture(contact);
  const Region bars(0, 722, 560, 98);
  EXPECT_GT(count(picture, kBlack, bars), 100);
  // Whatever the light does to their colours, arrows are neither black nor grey.
  int colored = 0;
  for (const cv::Vec3b& color : picture(bars)) {
    const auto [low, high] = std::minmax({color[0], color[1], color[2]});
    colored += high - low > 40;
  }
  EXPECT_EQ(colored, 0);
}

TEST(DrawForceField, PressingGoesDownFromThePlaneOfTheSurface) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-0.3, -0.9, 0.2)}) {
    Contact contact;
    contact.fit.friction_axis = axis;
    contact.samples.displacements = axis.normalized() * Eigen::RowVectorXd::LinSpaced(40, 0.5, 6);
    contact.samples.forces = contact.samples.displacements;
    const cv::Mat3b picture = force_field_picture(contact);
    const double plane = center_of(mask_of(picture, {170, 170, 170}, 30, kFieldScene)).y();
    const double arrows = center_of(mask_of(picture, kBlue, 60, kFieldScene)).y();
    EXPECT_GT(arrows, plane + 50) << "axis " << axis.transpose();
  }
}

TEST(DrawForceField, ConeLineHasTheSlopeOfTheFrictionCoefficient) {
  // All forces are on the cone: the markers are below the line, and covered by it.
  Contact contact;
  contact.fit.friction_coefficient = 0.5;
  for (Eigen::Index sample = 0; sample < contact.samples.forces.cols(); ++sample) {
    const double normal = 0.1 * static_cast<double>(sample);
    contact.samples.forces.col(sample) << 0.3 * normal, 0.4 * normal, normal;
  }
  contact.samples.on_boundary.assign(contact.samples.on_boundary.size(), true);
  const cv::Mat3b picture = force_field_picture(contact);
  const cv::Mat1b markers = mask_of(picture, kVermilion, 40, kFrictionChart);
  const cv::Mat1b line = mask_of(picture, kOrange, 40, kFrictionChart);
  EXPECT_GT(cv::countNonZero(line), 500);
  EXPECT_NEAR(center_of(line).x(), center_of(markers).x(), 15);
  EXPECT_NEAR(center_of(line).y(), center_of(markers).y(), 15);

  contact.fit.friction_coefficient = 0.25;
  const cv::Mat1b lower = mask_of(force_field_picture(contact), kOrange, 40, kFrictionChart);
  EXPECT_GT(center_of(lower).y(), center_of(line).y() + 20);
}

TEST(DrawForceField, DrawsAContactWithoutFriction) {
  Contact contact;
  contact.fit.friction_coefficient = 0;
  const Region with_axis(775, 170, 400, 250);
  const cv::Mat1b line = mask_of(force_field_picture(contact), kOrange, 40, with_axis);
  EXPECT_GT(cv::countNonZero(line), 500);
  cv::Mat1b rows;
  cv::reduce(line, rows, 1, cv::REDUCE_MAX);
  EXPECT_LT(cv::countNonZero(rows), 8);  // px high: it lies on the axis
}

TEST(DrawForceField, ShowsWhetherTheFitIsGood) {
  const int on_line = count(field_picture(), kBlack, kFitChart);
  Contact contact;
  contact.fit.field = [](const Eigen::Vector3d& displacement) -> Eigen::Vector3d {
    return 0.6 * displacement + Eigen::Vector3d(0, std::sin(9 * displacement.z()), 0);
  };
  const cv::Mat1b spread = mask_of(force_field_picture(contact), kBlack, 40, kFitChart);
  EXPECT_GT(cv::countNonZero(spread), 1.2 * on_line) << "markers on the line are covered by it";
}

TEST(DrawForceField, DrawsOneSampleWithoutForceAtTheContact) {
  Contact contact;
  contact.samples = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), {false}};
  EXPECT_EQ(force_field_picture(contact).size(), cv::Size(1200, 820));
}

TEST(DrawForceField, RefusesInputThatDoesNotFit) {
  Contact contact;
  const auto attempt = [&contact](const std::filesystem::path& png) {
    draw_force_field(png, contact.samples, contact.fit, "");
  };
  contact.samples.forces(1, 3) = HUGE_VAL;
  expect_refused(attempt, "forces: sample 3 is not finite");
  contact = {};
  contact.samples.displacements(0, 4) = std::nan("");
  expect_refused(attempt, "displacements: sample 4 is not finite");
  contact = {};
  contact.samples.forces.conservativeResize(3, 7);
  expect_refused(attempt, "forces: has 7 entries where 40 are needed");
  contact = {};
  contact.samples.on_boundary.pop_back();
  expect_refused(attempt, "on_boundary: has 39 entries");
  contact = {};
  contact.samples = {};
  expect_refused(attempt, "displacements: is empty");
  contact = {};
  contact.fit.field = nullptr;
  expect_refused(attempt, "field: there is none");
  contact = {};
  contact.fit.field = [](const Eigen::Vector3d&) -> Eigen::Vector3d {
    return Eigen::Vector3d::Constant(std::nan(""));
  };
  expect_refused(attempt, "field: is not finite at the displacement of sample 0");
  contact = {};
  contact.fit.friction_axis.setZero();
  expect_refused(attempt, "friction axis");
  contact = {};
  contact.fit.friction_coefficient = -0.5;
  expect_refused(attempt, "friction_coefficient is -0.5; it must be >= 0");
}

TEST(DrawForceField, GivesTheSameBytesAgain) {
  expect_same_again([](const std::filesystem::path& png) {
    const Contact contact;
    draw_force_field(png, contact.samples, contact.fit, "Again");
  });
}

TEST(DrawForceField, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    const Contact contact;
    draw_force_field(png, contact.samples, contact.fit, "");
  });
}

}  // namespace
}  // namespace palpate::pictures
