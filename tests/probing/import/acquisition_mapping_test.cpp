// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_mapping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <utility>
#include <vector>

#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

AcquisitionMapping mapping_from(const std::string& text) {
  const ScratchFolder folder;
  write_text(folder / "lab.yaml", text);
  return read_mapping(folder / "lab.yaml");
}

TEST(AcquisitionMapping, HoldsWhatTheFileSays) {
  const AcquisitionMapping mapping = mapping_from(
      "# A comment.\n"
      "columns:\n  contacts.id: Point\n  px: 'F x'\n  pz: data.F(:,3)\n  slipped: 0\n"
      "  y: -Y\n  range_map:\n"
      "separator: tab\nheader: false\ndecimal: comma\nweight: [0, 0.5, -1]\n"
      "units: {length: m, force: mN, time: ms}\n"
      "forces_on: tool\n"
      "frame:\n  rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]]\n  translation: [1, 2.5, -3]\n"
      "content: time_series\ncontacts: place\nnormals: forces\nsame_place: 0.7\n"
      "probe_radius: 2.5\n"
      "time_series: {touch_force: 0.05, tare: false, saturation: 10}\n");
  EXPECT_EQ(mapping.columns, (ColumnNames{{"contacts.id", "Point"},
                                          {"px", "F x"},
                                          {"pz", "data.F(:,3)"},
                                          {"slipped", "0"},
                                          {"y", "-Y"},
                                          {"range_map", ""}}));
  EXPECT_EQ(mapping.separator, '\t');
  EXPECT_FALSE(mapping.header);
  EXPECT_TRUE(mapping.decimal_comma);
  EXPECT_EQ(mapping.weight, Eigen::Vector3d(0, 0.5, -1));
  EXPECT_EQ(mapping.length, 1000);
  EXPECT_EQ(mapping.force, 1e-3);
  EXPECT_EQ(mapping.time, 1e-3);
  EXPECT_TRUE(mapping.forces_on_tool);
  ASSERT_TRUE(mapping.T_surface_file);
  EXPECT_EQ(*mapping.T_surface_file * Eigen::Vector3d(10, 20, 30), Eigen::Vector3d(-19, 12.5, 27));
  EXPECT_EQ(mapping.content, RowContent::time_series);
  EXPECT_EQ(mapping.contacts, ContactSource::place);
  EXPECT_TRUE(mapping.normals_from_forces);
  EXPECT_EQ(mapping.same_place, 0.7);
  EXPECT_EQ(mapping.probe_radius, 2.5);
  EXPECT_EQ(mapping.series.touch_force, 0.05);
  EXPECT_FALSE(mapping.series.tare);
  EXPECT_EQ(mapping.series.saturation, 10);
}

TEST(AcquisitionMapping, MakesARotationOfAMatrixWithFewDigits) {
  const AcquisitionMapping mapping =
      mapping_from("frame: {rotation: [[0.866, -0.5, 0], [0.5, 0.866, 0], [0, 0, 1]]}\n");
  const Eigen::Matrix3d found = mapping.T_surface_file->linear();
  EXPECT_LT((found * found.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  const Eigen::AngleAxisd expected(std::numbers::pi / 6, Eigen::Vector3d::UnitZ());
  EXPECT_LT((found - expected.toRotationMatrix()).norm(), 2e-4);
}

TEST(AcquisitionMapping, NamesTheLineAndWhatWouldBeRight) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> wrong = {
      {"columns:\n  pX: Fx\n", {"line 2", "no column 'pX'", "px,py,pz"}},
      {"columns:\n  px: Fx\n  px: Fy\n", {"line 3", "'px' is there twice"}},
      {"columns:\n  px: [Fx, Fy]\n",
       {"line 2", "at /columns/px: found [\"Fx\",\"Fy\"], expected one word"}},
      {"columns: Fx\n", {"line 1", "at /columns: found \"Fx\", expected an object"}},
      {"\nunit: {length: m}\n",
       {"line 2", "'unit' is unknown",
        "columns, separator, units, weight, frame, time_series, header, decimal"}},
      {"units:\n  length: ell\n", {"line 2", "length", "um, mm, cm, m or in"}},
      {"units:\n  force: dyn\n", {"line 2", "force", "N, mN, kN, g, kg or lbf"}},
      {"units:\n  time: h\n", {"line 2", "time", "s, ms, us or min"}},
      {"units:\n  angle: deg\n", {"line 2", "'angle' is unknown", "length, force, time"}},
      {"forces_on: hand\n", {"line 1", "/forces_on: found \"hand\"", "\"object\" or \"tool\""}},
      {"header: none\n", {"/header: found \"none\"", "true or false"}},
      {"decimal: ','\n", {"/decimal: found \",\"", "\"point\" or \"comma\""}},
      {"weight: 0.5\n", {"/weight: found 0.5, expected an array of three numbers"}},
      {"weight: [0, 0, heavy]\n", {"/weight/2: found \"heavy\", expected a number"}},
      {"content: press\n", {"\"press\"", "\"presses_and_drags\", \"presses\" or \"time_series\""}},
      {"contacts: rows\n", {"\"table\", \"column\" or \"place\""}},
      {"same_place: near\n", {"/same_place: found \"near\"", "a number > 0 and finite"}},
      {"same_place: -1\n", {"line 1", "/same_place: found -1", "> 0"}},
      {"probe_radius: 0\n", {"line 1", "/probe_radius: found 0", "> 0"}},
      {"same_place: .nan\n", {"\".nan\"", "a number > 0 and finite"}},
      {"separator: '::'\n", {"one character, or tab"}},
      {"frame: {rotation: [[1, 0, 0], [0, 1, 0]]}\n", {"three arrays of three numbers"}},
      {"frame: {rotation: [[2, 0, 0], [0, 2, 0], [0, 0, 2]]}\n", {"perpendicular unit vectors"}},
      {"frame: {rotation: [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}\n", {"a reflection", "negate"}},
      {"frame: {translation: [1, 2]}\n",
       {"/frame/translation: found [1,2], expected an array of three"}},
      {"frame: {scale: 2}\n", {"'scale' is unknown"}},
      {"time_series: {touch_force: 0}\n", {"/time_series/touch_force: found 0", "> 0"}},
      {"time_series: {slide_length: 0}\n", {"/time_series/slide_length: found 0", "> 0"}},
      {"time_series: {speed: 0.5}\n", {"'speed' is unknown", "highest_speed"}},
      {"time_series: {tare: maybe}\n", {"/time_series/tare: found \"maybe\"", "true or false"}},
      {"columns: {px: Fx\n", {"line 2", "is not YAML"}},
      {"- px\n", {"at the top: found [\"px\"], expected an object"}},
      {"", {"is empty"}},
      {"# nothing\n", {"is empty; it must say what differs"}},
      {"columns: {depth: d, az: Z}\n", {"both 'depth' and 'az'"}},
      {"columns: {normal_force: F, pz: F}\n", {"both 'normal_force' and 'pz'"}},
      {"same_place: 2\n", {"same_place does nothing with", "contacts table"}},
      {"normals: forces\n", {"column or place"}}};
  for (const auto& [page, words] : wrong) {
    const std::string& text = page;  // clang 14 cannot capture bindings
    const std::string message = refusal([&] { return mapping_from(text); });
    EXPECT_THAT(message, HasSubstr("lab.yaml")) << text;
    for (const std::string& word : words) EXPECT_THAT(message, HasSubstr(word)) << text;
  }
  EXPECT_THAT(refusal([] { return read_mapping("/nowhere/lab.yaml"); }), HasSubstr("no such file"));
}

TEST(AcquisitionMapping, IsCheckedAlsoIfAProgramMadeIt) {
  const auto refused = [](const AcquisitionMapping& mapping) {
    return refusal([&] {
      check_mapping(mapping);
      return 0;
    });
  };
  EXPECT_THAT(refused({.columns = {{"pX", "Fx"}}}), HasSubstr("no column 'pX'"));
  EXPECT_THAT(refused({.length = 0}), HasSubstr("AcquisitionMapping::length"));
  EXPECT_THAT(refused({.force = -1}), HasSubstr("AcquisitionMapping::force"));
  EXPECT_THAT(refused({.weight = {0, NAN, 0}}), HasSubstr("AcquisitionMapping::weight"));
  EXPECT_THAT(refused({.time = NAN}), HasSubstr("AcquisitionMapping::time"));
}

TEST(AcquisitionMapping, KnowsTheUnitsOfForceAndTime) {
  EXPECT_EQ(unit_force("N"), 1);
  EXPECT_EQ(unit_force("mN"), 1e-3);
  EXPECT_EQ(unit_force("kN"), 1e3);
  EXPECT_DOUBLE_EQ(1000 * unit_force("g"), unit_force("kg"));
  EXPECT_NEAR(unit_force("lbf"), 4.4482216152605, 1e-12);  // its definition
  EXPECT_THAT(refusal([] { return unit_force("lbs"); }), HasSubstr("N, mN, kN, g, kg or lbf"));
  EXPECT_EQ(unit_time("ms"), 1e-3);
  EXPECT_EQ(unit_time("min"), 60);
}

}  // namespace
}  // namespace palpate::probing
