// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "palpate/probing/acquisition_csv.h"
#include "repository.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Change = std::function<void(Acquisition&)>;

constexpr std::array<double, 4> kLevels = {0.3, 0.8, 1.6, 3};  // [N]

/// An object that follows the definitions exactly up to noise.
struct Spring {
  double normal = 0.3;      ///< [N/mm]
  double tangential = 0.2;  ///< [N/mm]
  double friction = 0.7;
  double noise = 0;  ///< [mm] of positions; [N] a fifth of it
  double late = 0;   ///< [mm] by which a touch was found too deep at every other contact
};

Eigen::Vector3d tangent(const Eigen::Vector3d& normal, double angle) {
  const Eigen::Vector3d u = normal.unitOrthogonal();
  return std::cos(angle) * u + std::sin(angle) * normal.cross(u);
}

/// Presses a part of a ball of radius 60 mm, 700 mm from the camera, in 12 directions and at 4
/// levels, with tangential forces of half, nearly and just over the limit of friction.
Acquisition dragged(const Spring& spring = {}) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1);
  const auto noise = [&](double size) {
    return Eigen::Vector3d(size * Eigen::Vector3d{normal(random), normal(random), normal(random)});
  };
  Acquisition acquisition;
  for (int c = 0; c < 9; ++c) {
    const double tilt = 0.1 + 0.1 * c;
    const Eigen::Vector3d n(std::sin(tilt) * std::cos(2.4 * c), std::sin(tilt) * std::sin(2.4 * c),
                            -std::cos(tilt));
    const Contact contact{10 + c, Eigen::Vector3d(0, 0, 760) + 60 * n, n};
    acquisition.contacts.push_back(contact);
    const Eigen::Vector3d touched = contact.position + (c % 2 == 0 ? spring.late : 0) * n;
    for (std::size_t level = 0; level < kLevels.size(); ++level) {
      const Eigen::Vector3d pressed = -kLevels[level] * n;
      for (int k = 0; k < 12; ++k) {
        for (const double share : {0.5, 0.95, 1.05}) {
          const Eigen::Vector3d drag =
              share * spring.friction * kLevels[level] * tangent(n, 0.1 + k * 0.52);
          const auto id = static_cast<long long>(acquisition.samples.size());
          acquisition.samples.push_back(
              {.id = id,
               .contact = contact.id,
               .group = static_cast<long long>(level),
               .force = pressed + drag + noise(spring.noise / 5),
               .a = touched + pressed / spring.normal + noise(spring.noise),
               .b = touched + pressed / spring.normal + drag / spring.tangential +
                    noise(spring.noise),
               .on_friction_boundary = share == 0.95,
               .slipped = share > 1,
               .time = 12.0 * static_cast<double>(id)});
        }
      }
    }
  }
  return acquisition;
}

/// Only pressed, each sample a group of its own, `b` = `a`, as most labs record palpation.
Acquisition pressed_only(const Spring& spring = {}) {
  Acquisition acquisition = dragged(spring);
  for (Sample& sample : acquisition.samples) {
    sample.group = sample.id;
    sample.b = sample.a;
    const auto& contact = acquisition.contacts[static_cast<std::size_t>(sample.contact - 10)];
    sample.force = sample.force.dot(contact.normal) * contact.normal;
    sample.slipped = sample.on_friction_boundary = false;
  }
  return acquisition;
}

std::vector<Implausibility> kinds(const std::vector<Finding>& findings) {
  std::vector<Implausibility> result;
  for (const Finding& finding : findings) result.push_back(finding.kind);
  return result;
}

std::vector<std::string> messages(const Acquisition& acquisition) {
  std::vector<std::string> result;
  for (const Finding& finding : find_implausible(acquisition)) result.push_back(message(finding));
  return result;
}

Finding the_finding(Acquisition acquisition, const Change& change) {
  change(acquisition);
  const std::vector<Finding> findings = find_implausible(acquisition);
  EXPECT_EQ(findings.size(), 1u) << ::testing::PrintToString(messages(acquisition));
  return findings.empty() ? Finding{} : findings.front();
}

/// The only finding after a change, for the measurement of a spring; also if its noise is that of a
/// poor sensor, and for any frame.
Finding finding_of(const Change& change) {
  const Finding found = the_finding(dragged(), change);
  for (Acquisition other : {dragged({.noise = 0.1}), dragged({.noise = 0.1, .late = 1})}) {
    const Finding again = the_finding(other, change);
    EXPECT_EQ(again.kind, found.kind);
    EXPECT_EQ(again.impossible, found.impossible);
  }
  return found;
}

void move(Acquisition& acquisition, const Eigen::Isometry3d& motion) {
  for (Contact& contact : acquisition.contacts) {
    contact.position = motion * contact.position;
    contact.normal = motion.linear() * contact.normal;
  }
  for (Sample& sample : acquisition.samples) {
    sample.force = motion.linear() * sample.force;
    sample.a = motion * sample.a;
    sample.b = motion * sample.b;
  }
}

void scale_tool(Acquisition& acquisition, double factor) {
  for (Sample& sample : acquisition.samples) {
    sample.a *= factor;
    sample.b *= factor;
  }
}

void scale_lengths(Acquisition& acquisition, double factor) {
  for (Contact& contact : acquisition.contacts) contact.position *= factor;
  scale_tool(acquisition, factor);
}

void scale_forces(Acquisition& acquisition, double factor) {
  for (Sample& sample : acquisition.samples) sample.force *= factor;
}

void reverse_forces(Acquisition& acquisition) { scale_forces(acquisition, -1); }

void reverse_normals(Acquisition& acquisition) {
  for (Contact& contact : acquisition.contacts) contact.normal *= -1;
}

/// Mirrors the tool positions at the surface.
void lift_tool(Acquisition& acquisition, std::size_t contacts) {
  for (std::size_t c = 0; c < contacts; ++c) {
    const Contact& contact = acquisition.contacts[c];
    for (Sample& sample : acquisition.samples) {
      if (sample.contact != contact.id) continue;
      const Eigen::Vector3d lift =
          -2 * contact.normal.dot(sample.a - contact.position) * contact.normal;
      sample.a += lift;
      sample.b += lift;
    }
  }
}

TEST(Plausibility, FindsNothingInMeasurementsOfAnyHardnessAndNoise) {
  for (const double hardness : {0.1, 1.0, 10.0, 100.0}) {
    for (const double noise : {0.0, 0.02, 0.1}) {
      // The noise of a measurement is far below its displacements, except for rigid objects.
      const Spring spring{.normal = 0.3 * hardness, .tangential = 0.2 * hardness, .noise = noise};
      EXPECT_THAT(messages(dragged(spring)), IsEmpty()) << hardness << ' ' << noise;
      EXPECT_THAT(messages(pressed_only(spring)), IsEmpty()) << hardness << ' ' << noise;
    }
  }
}

TEST(Plausibility, AllowsTouchesThatWereFoundLate) {
  for (const double late : {0.3, 0.5, 1.0}) {
    EXPECT_THAT(messages(dragged({.noise = 0.02, .late = late})), IsEmpty()) << late;
    EXPECT_THAT(messages(pressed_only({.noise = 0.02, .late = late})), IsEmpty()) << late;
  }
}

TEST(Plausibility, FindsNothingInTheBundledMeasurements) {
  for (const std::string folder : {"sheet", "sheet_block"}) {
    const auto data = repository("demo") / folder;
    const CheckedAcquisition acquisition =
        read_acquisition_csv(data / "contacts.csv", data / "samples.csv");
    EXPECT_THAT(messages(acquisition.records()), IsEmpty()) << folder;
    // Nor in a tenth of them, where a contact has few.
    Acquisition few = acquisition.records();
    std::erase_if(few.samples, [](const Sample& sample) { return sample.id % 10 != 3; });
    EXPECT_THAT(messages(few), IsEmpty()) << folder;
  }
}

TEST(Plausibility, FindsTheSameInEveryFrame) {
  const std::vector<Change> changes = {[](Acquisition&) {},
                                       reverse_forces,
                                       reverse_normals,
                                       [](Acquisition& a) { lift_tool(a, 9); },
                                       [](Acquisition& a) { lift_tool(a, 2); },
                                       [](Acquisition& a) {
                                         for (Sample& sample : a.samples) sample.group = 0;
                                       },
                                       [](Acquisition& a) {
                                         for (Sample& sample : a.samples)
                                           sample.slipped = !sample.slipped;
                                       }};
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.rotate(Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()));
  motion.pretranslate(Eigen::Vector3d(-300, 4000, 77));
  for (const Change& change : changes) {
    Acquisition here = dragged({.noise = 0.02});
    for (Sample& sample : here.samples) sample.on_friction_boundary = false;
    change(here);
    Acquisition there = here;
    move(there, motion);
    const std::vector<Finding> expected = find_implausible(here), found = find_implausible(there);
    EXPECT_EQ(kinds(found), kinds(expected));
    for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
      EXPECT_EQ(found[i].impossible, expected[i].impossible);
  }
}

TEST(Plausibility, TellsTheThreeWrongSignsApart) {
  const Finding forces = finding_of(reverse_forces);
  EXPECT_EQ(forces.kind, Implausibility::forces_reversed);
  EXPECT_TRUE(forces.impossible);
  EXPECT_THAT(message(forces), AllOf(HasSubstr("9 of 9 contacts"), HasSubstr("of the object on "
                                                                             "the tool")));
  const Finding normals = finding_of(reverse_normals);
  EXPECT_EQ(normals.kind, Implausibility::normals_inwards);
  EXPECT_TRUE(normals.impossible);
  EXPECT_THAT(message(normals), HasSubstr("normals point into the object"));
  const Finding tool = finding_of([](Acquisition& a) { lift_tool(a, 9); });
  EXPECT_EQ(tool.kind, Implausibility::tool_outside);
  EXPECT_TRUE(tool.impossible);
}

TEST(Plausibility, OnlySuspectsAMinorityOfContactsAndNamesThem) {
  const Finding tool = finding_of([](Acquisition& a) { lift_tool(a, 2); });
  EXPECT_EQ(tool.kind, Implausibility::tool_outside);
  EXPECT_FALSE(tool.impossible);
  EXPECT_THAT(message(tool), HasSubstr("2 of 9 contacts (contacts 10, 11)"));
  const Finding normals = finding_of([](Acquisition& a) { a.contacts[4].normal *= -1; });
  EXPECT_EQ(normals.kind, Implausibility::normals_inwards);
  EXPECT_FALSE(normals.impossible);
  EXPECT_THAT(message(normals), HasSubstr("1 of 9 contacts (contact 14)"));
  const Finding most = finding_of([](Acquisition& a) { lift_tool(a, 5); });
  EXPECT_TRUE(most.impossible);
}

TEST(Plausibility, NamesSingleSamplesThatPullOrAreOutside) {
  const Finding pulling = finding_of([](Acquisition& a) {
    // The highest level, slipped, so that neither groups nor slips change much.
    a.samples[143].force *= -1;
  });
  EXPECT_EQ(pulling.kind, Implausibility::pulling_samples);
  EXPECT_FALSE(pulling.impossible);
  EXPECT_THAT(message(pulling), HasSubstr("sample 143 pulls"));
  const Finding outside =
      finding_of([](Acquisition& a) { a.samples[143].a += 25 * a.contacts[0].normal; });
  EXPECT_EQ(outside.kind, Implausibility::outside_samples);
  EXPECT_THAT(message(outside), HasSubstr("sample 143 has"));
}

TEST(Plausibility, RefusesExchangedEnds) {
  const Finding found = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) {
      if (!sample.slipped) sample.b = 2 * sample.a - sample.b;
    }
  });
  EXPECT_EQ(found.kind, Implausibility::exchanged_ends);
  EXPECT_TRUE(found.impossible);
}

TEST(Plausibility, RefusesGroupsThatDoNotShareANormalForceAndSaysWhatAGroupIs) {
  const Finding all_one = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) sample.group = 0;
  });
  EXPECT_EQ(all_one.kind, Implausibility::mixed_groups);
  EXPECT_TRUE(all_one.impossible);
  EXPECT_THAT(message(all_one),
              AllOf(HasSubstr("0.3 to 3 N in one group"), HasSubstr("share their normal force")));
  const Finding shuffled = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) sample.group = sample.id % 4;
  });
  EXPECT_TRUE(shuffled.impossible);
  // Two neighbouring levels in one: twice the force of the other.
  const Finding two = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) sample.group = std::max<long long>(sample.group, 1);
  });
  EXPECT_EQ(two.kind, Implausibility::mixed_groups);
  EXPECT_FALSE(two.impossible);
  const Finding one_contact = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) {
      if (sample.contact == 12) sample.group = 0;
    }
  });
  EXPECT_FALSE(one_contact.impossible);
  EXPECT_THAT(message(one_contact), HasSubstr("contact 12"));
}

TEST(Plausibility, AllowsTheNoiseOfForcesWithinAGroup) {
  for (const bool levels : {true, false}) {
    Acquisition acquisition = dragged({.noise = 0.25});  // 0.05 N
    if (!levels) {
      std::erase_if(acquisition.samples, [](const Sample& sample) { return sample.group != 2; });
    }
    EXPECT_THAT(messages(acquisition), IsEmpty());
  }
}

TEST(Plausibility, SuspectsPositionsThatDifferWithinAGroup) {
  const Finding found = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) sample.a += Eigen::Vector3d(sample.id % 2 == 0 ? 5 : -5, 0, 0);
    for (Sample& sample : a.samples) sample.b += Eigen::Vector3d(sample.id % 2 == 0 ? 5 : -5, 0, 0);
  });
  EXPECT_EQ(found.kind, Implausibility::scattered_groups);
  EXPECT_FALSE(found.impossible);
}

TEST(Plausibility, RefusesToolPositionsInOtherUnitsThanTheContacts) {
  for (const auto& [factor, words] :
       std::vector<std::pair<double, std::string>>{{1e-3, "as in m beside contacts in mm"},
                                                   {1e3, "as in mm beside contacts in m"},
                                                   {0.1, "a larger unit"},
                                                   {10, "a smaller unit"}}) {
    for (const Eigen::Vector3d& middle : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, -760)}) {
      Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
      motion.translation() = middle;
      const Finding found = finding_of([&, factor = factor](Acquisition& a) {
        move(a, motion);
        scale_tool(a, factor);
      });
      EXPECT_EQ(found.kind, Implausibility::length_units) << factor;
      EXPECT_TRUE(found.impossible);
      EXPECT_THAT(message(found), HasSubstr(words));
    }
  }
}

TEST(Plausibility, RefusesDisplacementsInPlaceOfPositions) {
  const Finding found = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) {
      const Eigen::Vector3d at = a.contacts[static_cast<std::size_t>(sample.contact - 10)].position;
      sample.a -= at;
      sample.b -= at;
    }
  });
  EXPECT_EQ(found.kind, Implausibility::length_units);
  EXPECT_TRUE(found.impossible);
  EXPECT_THAT(message(found), HasSubstr("as displacements would"));
}

TEST(Plausibility, NamesAContactThatIsFarFromItsTool) {
  const Finding found = finding_of([](Acquisition& a) {
    a.contacts[3].position += 4000 * a.contacts[3].normal.unitOrthogonal();
  });
  EXPECT_EQ(found.kind, Implausibility::distant_tool);
  EXPECT_FALSE(found.impossible);
  EXPECT_THAT(message(found), HasSubstr("contact 13"));
  const Finding another_frame = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) sample.a += Eigen::Vector3d(9000, 9000, 0);
    for (Sample& sample : a.samples) sample.b += Eigen::Vector3d(9000, 9000, 0);
  });
  EXPECT_EQ(another_frame.kind, Implausibility::distant_tool);
  EXPECT_TRUE(another_frame.impossible);
}

/// Which finding says that the tool is at other contacts, if noise and late touches hide it or not.
/// Exchanged samples also contradict their groups.
Finding tool_at_others(const Change& change) {
  Finding result;
  for (Acquisition a : {dragged({.noise = 0.1, .late = 1}), dragged({.noise = 0.1}), dragged()}) {
    change(a);
    const std::vector<Finding> findings = find_implausible(a);
    const auto found = std::ranges::find(findings, Implausibility::distant_tool, &Finding::kind);
    EXPECT_NE(found, findings.end()) << ::testing::PrintToString(messages(a));
    if (found != findings.end()) result = *found;
  }
  return result;
}

TEST(Plausibility, RefusesToolsThatAreAtOtherContacts) {
  const auto expect_impossible = [](const Change& change) {
    const Finding found = tool_at_others(change);
    EXPECT_TRUE(found.impossible);
    EXPECT_THAT(message(found), HasSubstr("half as far from another contact"));
  };
  expect_impossible([](Acquisition& a) {  // contacts numbered from 1, not from 0
    for (Sample& sample : a.samples) sample.contact = 10 + (sample.contact - 10 + 1) % 9;
  });
  const auto turn_tools = [](Acquisition& a, const Eigen::Matrix3d& turn) {
    for (Sample& sample : a.samples) {
      sample.a = turn * sample.a;
      sample.b = turn * sample.b;
    }
  };
  Eigen::Matrix3d exchanged;  // columns
  exchanged << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  expect_impossible([&](Acquisition& a) { turn_tools(a, exchanged); });
  const Eigen::Vector3d signs(-1, -1, 1);
  expect_impossible([&](Acquisition& a) { turn_tools(a, signs.asDiagonal()); });
}

TEST(Plausibility, SuspectsTwoContactsWhoseSamplesAreExchanged) {
  const Finding found = tool_at_others([](Acquisition& a) {
    for (Sample& sample : a.samples)
      if (sample.contact == 12 || sample.contact == 13) sample.contact = 25 - sample.contact;
  });
  EXPECT_FALSE(found.impossible);
  EXPECT_THAT(message(found), HasSubstr("contacts 12, 13"));
}

TEST(Plausibility, SuspectsSizesThatNoArmMeasures) {
  for (const double factor : {1e-3, 1e3}) {
    const Finding lengths =
        the_finding(dragged(), [&](Acquisition& a) { scale_lengths(a, factor); });
    EXPECT_EQ(lengths.kind, Implausibility::length_scale) << factor;
    EXPECT_FALSE(lengths.impossible);
    EXPECT_THAT(message(lengths), HasSubstr("--length-unit"));
    const Finding forces = finding_of([&](Acquisition& a) { scale_forces(a, factor); });
    EXPECT_EQ(forces.kind, Implausibility::force_scale) << factor;
    EXPECT_FALSE(forces.impossible);
    EXPECT_THAT(message(forces), HasSubstr("--force-unit"));
  }
  // Grams in place of newtons.
  EXPECT_EQ(finding_of([](Acquisition& a) { scale_forces(a, 102); }).kind,
            Implausibility::force_scale);
  // Displacements in m on contacts in mm look rigid.
  const Finding rigid = the_finding(dragged(), [](Acquisition& a) {
    for (Sample& sample : a.samples) {
      const Eigen::Vector3d at = a.contacts[static_cast<std::size_t>(sample.contact - 10)].position;
      sample.a = at + 1e-3 * (sample.a - at);
      sample.b = at + 1e-3 * (sample.b - at);
    }
  });
  EXPECT_EQ(rigid.kind, Implausibility::length_scale);
  EXPECT_FALSE(rigid.impossible);
}

TEST(Plausibility, ForcesWithoutAnyMotionOfTheToolAreImpossible) {
  const Finding still = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) {
      sample.a = a.contacts[static_cast<std::size_t>(sample.contact - 10)].position;
      sample.b = sample.a;
    }
  });
  EXPECT_EQ(still.kind, Implausibility::length_scale);
  EXPECT_TRUE(still.impossible);
  EXPECT_THAT(message(still), HasSubstr("the tool stands still"));
}

TEST(Plausibility, SuspectsForcesThatHeldButAreNearlyTangential) {
  // Normal components a thousand times smaller than the others: mN read as N.
  const Finding found = finding_of([](Acquisition& a) {
    for (Sample& sample : a.samples) {
      const Eigen::Vector3d n = a.contacts[static_cast<std::size_t>(sample.contact - 10)].normal;
      sample.force -= 0.98 * n.dot(sample.force) * n;
    }
  });
  EXPECT_EQ(found.kind, Implausibility::tilted_forces);
}

TEST(Plausibility, TellsReversedAndUnrelatedSlips) {
  const auto unmark = [](Acquisition& a) {
    for (Sample& sample : a.samples) sample.on_friction_boundary = false;
  };
  const Finding reversed = finding_of([&](Acquisition& a) {
    unmark(a);
    for (Sample& sample : a.samples) sample.slipped = !sample.slipped;
  });
  EXPECT_EQ(reversed.kind, Implausibility::slips_reversed);
  EXPECT_TRUE(reversed.impossible);
  const Finding unrelated = finding_of([&](Acquisition& a) {
    unmark(a);
    for (Sample& sample : a.samples) sample.slipped = sample.id / 3 % 2 == 0;
  });
  EXPECT_EQ(unrelated.kind, Implausibility::slips_unrelated);
  EXPECT_FALSE(unrelated.impossible);
  const Finding all = finding_of([&](Acquisition& a) {
    unmark(a);
    for (Sample& sample : a.samples) sample.slipped = true;
  });
  EXPECT_EQ(all.kind, Implausibility::all_slipped);
  EXPECT_FALSE(all.impossible);
}

TEST(Plausibility, SaysNothingOfContactsWithoutSamples) {
  Acquisition acquisition = dragged();
  acquisition.samples.clear();
  EXPECT_THAT(messages(acquisition), IsEmpty());
}

TEST(Plausibility, GivesEveryKindANameOfItsOwn) {
  std::vector<std::string> names;
  for (int kind = 0; kind <= static_cast<int>(Implausibility::all_slipped); ++kind)
    names.emplace_back(to_string(static_cast<Implausibility>(kind)));
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
  EXPECT_FALSE(names.front().empty());
}

TEST(Plausibility, NamesContactsThatWereProbedInOneDirection) {
  EXPECT_THAT(probed_in_one_direction(dragged()), IsEmpty());
  Acquisition acquisition = dragged();
  // At two contacts only presses held; a press may be tilted, as long as all are.
  for (Sample& sample : acquisition.samples) {
    if (sample.contact != 12 && sample.contact != 15) continue;
    const Eigen::Vector3d& n =
        acquisition.contacts[static_cast<std::size_t>(sample.contact - 10)].normal;
    if (!sample.slipped) sample.force = sample.force.dot(n) * (n + 0.3 * tangent(n, 1));
  }
  EXPECT_THAT(probed_in_one_direction(acquisition), ElementsAre(12, 15));
  // Tilted in two ways, by 0.12 in all.
  bool left = false;
  for (Sample& sample : acquisition.samples) {
    if (sample.contact != 15 || sample.slipped) continue;
    const Eigen::Vector3d& n = acquisition.contacts[5].normal;
    left = !left;
    sample.force = sample.force.dot(n) * (n + (left ? 0.12 : -0.12) * tangent(n, 1));
  }
  EXPECT_THAT(probed_in_one_direction(acquisition), ElementsAre(12));
}

}  // namespace
}  // namespace palpate::probing
